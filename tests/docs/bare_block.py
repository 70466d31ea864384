#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints the commands of the block annotated with `<!-- bare: NAME -->` (page.py): bare_block.py docs/user/install.md NAME"""
import sys

import page as pages


def main():
    found = [block.text for block in pages.Page(sys.argv[1]).blocks if block.notes.get("bare") == sys.argv[2]]
    if len(found) != 1:
        sys.exit(f"bare_block.py: {sys.argv[1]} has {len(found)} blocks {sys.argv[2]!r}, not 1")
    print(found[0], end="")


if __name__ == "__main__":
    main()
