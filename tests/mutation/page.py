# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of docs/quality/mutation.md, from the results and from survivors.json: {key of a surviving mutant: why it may}."""
import collections
import json
import os
import re
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "pages"))
# pylint: disable=wrong-import-position
from sections import rewrite

SURVIVORS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "survivors.json")
EQUIVALENT = "equivalent: "  # begins the reason of a mutant that no test can tell


def write(path, mutants, results, dropped):
    """Returns 1, and names them, where mutants survive that survivors.json does not know. Of libraries that were not run the
    page keeps what it says."""
    with open(SURVIVORS, encoding="utf-8") as file:
        reasons = json.load(file)
    with open(path, encoding="utf-8") as file:
        text = file.read()
    mutants = [m for m in mutants if m["key"] in results]
    ran = {library(m) for m in mutants}
    rows, sections = kept_rows(text, ran), kept_sections(text, ran)
    rows.update(counted_rows(mutants, results, dropped, reasons))
    sections.update(survivors(mutants, results, reasons))
    rewrite(path, {"Results": table(rows), "Survivors": [line for file in sorted(sections) for line in sections[file]]})
    unknown = [m for m in mutants if not results[m["key"]]["by"] and m["key"] not in reasons]
    for mutant in unknown:
        print(f"{mutant['file']}:{mutant['line']}: {mutant['key']}{'' if results[mutant['key']]['covered'] else ' (not covered)'}")
    alive = {m["key"] for m in mutants if not results[m["key"]]["by"]}
    gone = sorted(key for key in set(reasons) - alive if key.split("/")[1] in ran)
    for key in gone:
        print("no longer a survivor:", key)
    return 1 if unknown or gone else 0


def library(mutant):
    return mutant["file"].split("/")[1]


def kept_rows(text, ran):
    """{library: its numbers} of the page's table."""
    rows = {}
    for found in re.finditer(r"^\| lib/(\w+) \|(.*)\|$", text, re.M):
        if found[1] not in ran:
            cells = [cell.strip().replace(",", "") for cell in found[2].split("|")]
            rows[found[1]] = [int(cell) for cell in cells if not cell.endswith("%")]
    return rows


def kept_sections(text, ran):
    """{file: its lines} of the page's survivors."""
    sections = {}
    for found in re.finditer(r"^\*\*(lib/(\w+)/[^*]+)\*\*\n\n((?:\|.*\n)+)", text, re.M):
        if found[2] not in ran:
            sections[found[1]] = [f"**{found[1]}**", "", *found[3].strip().split("\n"), ""]
    return sections


def counted_rows(mutants, results, dropped, reasons):
    rows, groups = {}, collections.defaultdict(list)
    for mutant in mutants:
        groups[library(mutant)].append(mutant)
    for name, members in groups.items():
        killed = [results[m["key"]]["by"] for m in members if results[m["key"]]["by"]]
        by_chain = sum(by.startswith("chain") for by in killed)
        lived = [m["key"] for m in members if not results[m["key"]]["by"]]
        equivalent = sum(reasons.get(key, "").startswith(EQUIVALENT) for key in lived)
        out = sum(key.startswith(f"lib/{name}/") for key in dropped)
        rows[name] = [len(members), len(killed) - by_chain, by_chain, len(lived), equivalent, out]
    return rows


def table(rows):
    lines = ["| library | mutants | unit tests | chain | survive | equivalent | killed | of those not equivalent | left out |",
             "|---|---|---|---|---|---|---|---|---|"]
    total = [sum(column) for column in zip(*rows.values())]
    for name, row in [*((f"lib/{name}", row) for name, row in sorted(rows.items())), ("all", total)]:
        count, by_tests, by_chain, lived, equivalent, out = row
        killed = 100 * (by_tests + by_chain)
        lines.append(f"| {name} | {count:,} | {by_tests:,} | {by_chain} | {lived} | {equivalent} | "
                     f"{killed / count:.1f} % | {killed / (count - equivalent):.1f} % | {out} |")
    return lines


def survivors(mutants, results, reasons):
    """{file: its lines}."""
    sections, by_file = {}, collections.defaultdict(list)
    for mutant in mutants:
        if not results[mutant["key"]]["by"] and mutant["key"] in reasons:
            by_file[mutant["file"]].append(mutant)
    for file, members in by_file.items():
        lines = [f"**{file}**", "", "| function | mutant | why it lives |", "|---|---|---|"]
        for mutant in members:
            change = mutant["change"].replace("|", "\\|")
            lines.append(f"| {mutant['function'] or '-'} | {change} | {reasons[mutant['key']]} |")
        sections[file] = [*lines, ""]
    return sections
