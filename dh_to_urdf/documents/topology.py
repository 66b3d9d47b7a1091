"""Checks across the rows of a table: unique names of joints, and a tree."""

from __future__ import annotations

from dh_to_urdf.documents.checks import Report
from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import say
from dh_to_urdf.table import DHRow


def check_names(rows: list[DHRow], report: Report) -> None:
    """Report joints that share a name."""
    first: dict[str, int] = {}
    for k, row in enumerate(rows):
        if row.name in first:
            report.add(
                ("joints", k, "name"),
                say(
                    "joint {k}: the name {row} is taken by joint {first}; give each joint its own",
                    k=k + 1,
                    row=quoted(row.name),
                    first=first[row.name] + 1,
                ),
            )
        first.setdefault(row.name, k)


def check_tree(rows: list[DHRow], report: Report) -> None:
    """Report antecedents that form no tree whose rows follow their parents."""
    for k, row in enumerate(rows):
        if row.parent > len(rows):
            report.add(
                ("joints", k, "ant"),
                say(
                    "joint {k} ({row}): ant is {parent}, but the last frame is {count}",
                    k=k + 1,
                    row=row.name,
                    parent=row.parent,
                    count=len(rows),
                ),
            )
        elif row.parent == k + 1:
            report.add(
                ("joints", k, "ant"),
                say(
                    "joint {k} ({row}): ant is the joint itself; closed loops are not computed",
                    k=k + 1,
                    row=row.name,
                ),
            )
        elif row.parent > k + 1:
            report.add(
                ("joints", k, "ant"),
                say(
                    "joint {k} ({row}): ant is {parent}, a later row; list each joint after"
                    " its antecedent. If none of them can come first, the table describes a"
                    " closed loop, which is not computed",
                    k=k + 1,
                    row=row.name,
                    parent=row.parent,
                ),
            )
