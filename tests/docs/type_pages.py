#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Types pages as a reader does: every visible block, in order, at the size that the page shows, in an empty folder or in a clone.

    tests/docs/type_pages.py                   README.md and all pages of docs/user
    tests/docs/type_pages.py PAGE ...          some pages
    --skip REGEX                               do not type blocks that match; they are named in the result

This is run_docs_test.py without what makes its runs smaller, and with the blocks that take minutes. It takes hours: each study of the pages runs.
Blocks that build, install packages, or need data that is not in the repository are not typed. Exits with 1 if a block fails or
prints something else than the page shows. LANDFALL_BIN names the tools, by default those of build/release.
"""
import argparse
import os
import re
import subprocess
import sys
import time

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
for variable, value in (("LANDFALL_ROOT", ROOT), ("LANDFALL_BIN", os.path.join(ROOT, "build", "release", "bin")), ("LANDFALL_TEST_LONG", "1")):
    os.environ.setdefault(variable, value)

import page as pages  # pylint: disable=wrong-import-position  # the modules read the variables
import run_docs_test  # pylint: disable=wrong-import-position

NOT_TYPED = re.compile(r"\b(builds|installs|needs)\b")


def fault_of(page, skip=None):
    """The first fault of a page, or None; names the blocks that are not typed."""
    for block in page.blocks:
        reason = block.notes.get("long", "")
        if block.is_command and (NOT_TYPED.search(reason) or skip and skip.search(block.text)):
            print(f"note: {page.name}:{block.line}: not typed: {reason or 'skipped'}")
            block.notes["all tests"] = ""
    try:
        run_docs_test.Commands().check(page, run_docs_test.Run(page, as_shown=True))
    except (AssertionError, subprocess.TimeoutExpired) as error:
        return str(error)
    return None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pages", nargs="*", metavar="PAGE", default=[name for name in pages.names() if name.startswith(("README", "docs/user/"))])
    parser.add_argument("--skip", type=re.compile, metavar="REGEX")
    options = parser.parse_args()
    faults = 0
    for name in options.pages:
        started = time.monotonic()
        fault = fault_of(pages.Page(name), options.skip)
        faults += fault is not None
        print(f"{name}: {time.monotonic() - started:.0f} s{f', FAULT: {fault}' if fault else ''}", flush=True)
    print(f"{faults} faults in {len(options.pages)} pages")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
