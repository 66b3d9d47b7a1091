"""``python -m bench``: every benchmark, as ratios of two things measured in turns in one run."""

from bench import compute, http, redundancy

if __name__ == "__main__":
    reports = (
        ("In process", compute.run()),
        ("Redundancy", redundancy.run()),
        ("Over HTTP", http.run()),
    )
    for title, rows in reports:
        print(f"\n{title}")
        width = max((len(row.what) for row in rows), default=0)
        for row in rows:
            print(f"  {row.what:{width}}  {row.ours:>12}  {row.other:>12}  ratio {row.ratio:.2f}")
