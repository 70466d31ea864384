#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the version script of liblandfall.so: it exports the tools' start functions, the functions for Python
(lib/app/python/engine.h) and what some objects need, and hides all else.

usage: exported_symbols.py NM OUTPUT OBJECT...

Needed is what the objects do not define, and the data of inline functions and classes that both sides define (nm's u, V and B),
of which a program shall have one copy.
"""
import subprocess
import sys

SHARED = "UuVB"


def main():
    nm, output, *objects = sys.argv[1:]
    # Without objects nm would take a.out.
    listing = subprocess.run([nm, "--format=posix", *objects], capture_output=True, text=True, check=True).stdout if objects else ""
    rows = (line.split() for line in listing.splitlines())
    names = {row[0] for row in rows if len(row) > 1 and row[1] in SHARED and "8landfall" in row[0]}
    with open(output, "w", encoding="utf-8") as file:
        file.write("{\nglobal:\n" + "".join(f"  {name};\n" for name in sorted(names)) +
                   "  _ZN8landfall*5startE*;\n  landfall_*;\n  _ZN3hwy8platform15TimerResolutionEv;\nlocal:\n  *;\n};\n")


if __name__ == "__main__":
    main()
