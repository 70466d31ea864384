# SPDX-License-Identifier: GPL-3.0-or-later
"""The error messages of tests/cli/catalogue.json as a page, each with its cause and its remedy."""
import json
import os
import textwrap

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
PAGE, CATALOGUE = "docs/user/errors.md", "tests/cli/catalogue.json"
HEAD = """# Error messages

Every error message, with its cause and its remedy. To find yours, search this page for a few of its words.

An error is one line on stderr that begins with the tool's name. The exit code gives the kind of error ([cli.md](cli.md)): 1, the content of a data
file is wrong, or reading or writing failed; 2, an option or the configuration is wrong, or the output exists; 3, `dem-eval --require-pass` was given
and the DEM does not pass, or `hazard-map --require-safe` and no site is safe enough, or `monte-carlo --require-pass` and a draw fails. With 1 and 2 no output is written, and an existing output is unchanged ([tests.md](../quality/tests.md#guarantees)
lists the exceptions); with 3 all outputs are written.

This page is made from tests/cli/catalogue.json; a test provokes each of its messages.
"""


def page():
    """The text of the page."""
    text = HEAD
    with open(os.path.join(ROOT, CATALOGUE), encoding="utf-8") as file:
        catalogue = json.load(file)
    for section in catalogue:
        text += f"\n## {section['section']}\n"
        for fault in section["faults"]:
            lines = "\n".join(dict.fromkeys(shortened(case["text"]) for case in fault["cases"]))
            about = textwrap.fill(f"**{fault['cause']}** {fault['do']} Exit {fault['exit']}.", 140, break_on_hyphens=False)
            text += f"\n{about}\n\n```text\n{lines}\n```\n"
    return text


def shortened(text):
    return text if len(text) <= 400 else text[:397] + "..."
