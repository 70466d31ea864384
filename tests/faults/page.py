# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of docs/quality/tests.md that tests write or compare; each is the first below its heading."""
import os

PAGE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "docs", "quality", "tests.md")
FAULTS, LIMITS, ORACLE, HOSTILE = "## Faults", "## Limits", "## The chain in numpy", "## Wrong values"


def row(judge):
    counts = judge.counts
    return (f"| {judge.fault} | {counts['runs']:,} | {counts['whole']:,} | {counts['refused']:,} | {counts['ended']:,} | "
            f"{counts['parts']:,} | {len(judge.broken)} |")


def parts(text, heading):
    """The lines before the first table below the heading, the table's, and those after it."""
    lines = text.split("\n")
    begin = next(i for i in range(lines.index(heading), len(lines)) if lines[i].startswith("|"))
    end = next(i for i in range(begin, len(lines)) if not lines[i].startswith("|"))
    return lines[:begin], lines[begin:end], lines[end:]


def with_table(text, heading, lines):
    before, _, after = parts(text, heading)
    return "\n".join([*before, *lines, *after])


def with_rows(text, heading, lines):
    """The page with `lines` for the rows that begin with the same cell; those of other cells are added to the table."""
    new = {line.split(" | ")[0]: line for line in lines}
    _, table, _ = parts(text, heading)
    return with_table(text, heading, [new.pop(line.split(" | ")[0], line) for line in table] + list(new.values()))


def read():
    with open(PAGE, encoding="utf-8") as file:
        return file.read()


def write(text):
    with open(PAGE, "w", encoding="utf-8") as file:
        file.write(text)
