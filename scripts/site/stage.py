#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Copies the pages, and every file that they link to, into the folder that MkDocs reads: stage.py FOLDER.

The paths are those of the repository, so that the links of the pages hold in the site too.
"""
import os
import re
import shutil
import sys

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
TOP = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")
LINK = re.compile(r"\]\(([^()\s#]+)(?:#[^()\s]*)?\)")
KATEX = "/usr/share/javascript/katex"


def pages():
    """The paths of all pages, relative to the repository."""
    yield from TOP
    for folder, _, names in sorted(os.walk(os.path.join(ROOT, "docs"))):
        yield from (os.path.relpath(os.path.join(folder, name), ROOT) for name in sorted(names) if name.endswith(".md"))


def linked(page):
    """The files that a page links to and that exist."""
    with open(os.path.join(ROOT, page), encoding="utf-8") as file:
        for target in LINK.findall(file.read()):
            path = os.path.normpath(os.path.join(os.path.dirname(page), target))
            if ":" not in target and os.path.isfile(os.path.join(ROOT, path)):
                yield path


def needed():
    """The pages, and all that they link to."""
    found, waiting = set(), list(pages())
    while waiting:
        path = waiting.pop()
        if path not in found:
            found.add(path)
            waiting += linked(path) if path.endswith(".md") else []
    return found


def copy(path, folder):
    target = os.path.join(folder, path)
    os.makedirs(os.path.dirname(target), exist_ok=True)
    shutil.copyfile(os.path.join(ROOT, path), target)


def main(folder):
    shutil.rmtree(folder, ignore_errors=True)
    for path in needed():
        copy(path, folder)
    here = os.path.dirname(os.path.abspath(__file__))
    shutil.copytree(os.path.join(here, "assets"), os.path.join(folder, "assets"))
    katex = os.path.join(folder, "assets", "katex")
    shutil.copytree(os.path.realpath(os.path.join(KATEX, "fonts")), os.path.join(katex, "fonts"))
    for name in ("katex.min.css", "katex.min.js"):
        shutil.copyfile(os.path.join(KATEX, name), os.path.join(katex, name))


if __name__ == "__main__":
    main(*sys.argv[1:])
