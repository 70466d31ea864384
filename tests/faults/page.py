# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of docs/quality/reliability.md; each is below the heading of its kind."""
import os

PAGE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "docs", "quality", "reliability.md")
HEADINGS = {"calls": "## Every call fails once", "disks": "## Full disks", "folders": "## Folders and other writers",
            "signals": "## Signals", "resources": "## Memory, threads, descriptors", "surroundings": "## Surroundings",
            "studies": "## Studies", "limits": "## Limits"}
HEAD = ["| fault | runs | complete, exit 0 | one message, exit 1 or 2 | ended by the signal | hidden files left | guarantees violated |",
        "|---|---|---|---|---|---|---|"]


def row(judge):
    counts = judge.counts
    return (f"| {judge.fault} | {counts['runs']:,} | {counts['whole']:,} | {counts['refused']:,} | {counts['ended']:,} | "
            f"{counts['parts']:,} | {len(judge.broken)} |")


def with_table(text, heading, lines):
    """The page with `lines` instead of the first table below the heading."""
    rows = text.split("\n")
    begin = next(i for i in range(rows.index(heading), len(rows)) if rows[i].startswith("|"))
    end = next(i for i in range(begin, len(rows)) if not rows[i].startswith("|"))
    return "\n".join([*rows[:begin], *lines, *rows[end:]])


def table(judges):
    return [*HEAD, *map(row, judges)]


def write_table(kind, lines):
    with open(PAGE, encoding="utf-8") as file:
        text = file.read()
    if HEADINGS[kind] not in text.split("\n"):
        print(f"docs/quality/reliability.md has no heading {HEADINGS[kind]}: no table is written")
        return
    with open(PAGE, "w", encoding="utf-8") as file:
        file.write(with_table(text, HEADINGS[kind], lines))
