"""``python -m bench``: every benchmark, as ratios of two things measured in turns in one run."""

from bench import compute, http

if __name__ == "__main__":
    for title, rows in (("In process", compute.run()), ("Over HTTP", http.run())):
        print(f"\n{title}")
        width = max((len(row.what) for row in rows), default=0)
        for row in rows:
            print(f"  {row.what:{width}}  {row.ours:>12}  {row.other:>12}  ratio {row.ratio:.2f}")
