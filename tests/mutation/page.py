# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of docs/mutation.md, from the results and from survivors.json: {key of a surviving mutant: why it may}."""
import collections
import json
import os
import re

SURVIVORS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "survivors.json")
EQUIVALENT = "equivalent: "  # begins the reason of a mutant that no test can tell


def write(path, mutants, results, dropped):
    """Returns 1, and names them, where mutants survive that survivors.json does not know."""
    with open(SURVIVORS, encoding="utf-8") as file:
        reasons = json.load(file)
    with open(path, encoding="utf-8") as file:
        text = file.read()
    for name, lines in (("Results", table(mutants, results, dropped, reasons)), ("Survivors", survivors(mutants, results, reasons))):
        text = re.sub(f"(## {name}\n\n).*?(?=\n## |$(?![\\s\\S]))", lambda m, l=lines: m[1] + "\n".join(l) + "\n", text, flags=re.S)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    unknown = [m for m in mutants if not results[m["key"]]["by"] and m["key"] not in reasons]
    for mutant in unknown:
        print(f"{mutant['file']}:{mutant['line']}: {mutant['key']}{'' if results[mutant['key']]['covered'] else ' (not covered)'}")
    gone = sorted(set(reasons) - {m["key"] for m in mutants if not results[m["key"]]["by"]})
    for key in gone:
        print("no longer a survivor:", key)
    return 1 if unknown or gone else 0


def library(mutant):
    return mutant["file"].split("/")[1]


def table(mutants, results, dropped, reasons):
    lines = ["| library | mutants | unit tests | chain | survive | equivalent | killed | of those not equivalent | left out |",
             "|---|---|---|---|---|---|---|---|---|"]
    groups = collections.defaultdict(list)
    for mutant in mutants:
        groups[f"lib/{library(mutant)}"].append(mutant)
    for name, members in [*sorted(groups.items()), ("all", mutants)]:
        killed = [results[m["key"]]["by"] for m in members if results[m["key"]]["by"]]
        by_chain = sum(by.startswith("chain") for by in killed)
        lived = [m["key"] for m in members if not results[m["key"]]["by"]]
        equivalent = sum(reasons.get(key, "").startswith(EQUIVALENT) for key in lived)
        out = sum(name == "all" or key.startswith(name + "/") for key in dropped)
        lines.append(f"| {name} | {len(members):,} | {len(killed) - by_chain:,} | {by_chain} | {len(lived)} | {equivalent} | "
                     f"{100 * len(killed) / len(members):.1f} % | {100 * len(killed) / (len(members) - equivalent):.1f} % | {out} |")
    return lines


def survivors(mutants, results, reasons):
    lines = []
    by_file = collections.defaultdict(list)
    for mutant in mutants:
        if not results[mutant["key"]]["by"] and mutant["key"] in reasons:
            by_file[mutant["file"]].append(mutant)
    for file, members in sorted(by_file.items()):
        lines += ["", f"**{file}**", "", "| function | mutant | why it lives |", "|---|---|---|"]
        for mutant in members:
            change = mutant["change"].replace("|", "\\|")
            lines.append(f"| {mutant['function'] or '-'} | {change} | {reasons.get(mutant['key'], 'not looked at')} |")
    return lines[1:]
