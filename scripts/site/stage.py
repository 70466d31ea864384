#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the pages of the site, and every file that they link to, into the folder that MkDocs reads: stage.py FOLDER; or docs/ alone, as the
package has it: stage.py --docs FOLDER.

The paths are those of the repository, so that the links of the pages hold in the site too. The pages that keys.py and errors.py make are added;
where a page links to the file that such a page is made from, the copy links to the page.
"""
import os
import re
import shutil
import sys

import errors
import keys

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
TOP = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")
LINK = re.compile(r"\]\(([^()\s#:]+)((?:#[^()\s]*)?)\)")
KATEX = "/usr/share/javascript/katex"
# The files and folders that pages are made from, and the pages.
MADE_FROM = {errors.CATALOGUE: errors.PAGE, "schemas": f"{keys.FOLDER}/README.md",
             **{f"schemas/{kind}.schema.json": f"{keys.FOLDER}/{name}.md" for kind, name in keys.PAGES.items()}}


def made():
    """{path of a page that is made: its text}."""
    return {**keys.texts(), errors.PAGE: errors.page()}


def target_of(page, link):
    return os.path.normpath(os.path.join(os.path.dirname(page), link))


def staged(page):
    """The text of a page of the repository, with links to the pages that are made. README's list of pages is the navigation of the site."""
    def to_made(link):
        target = MADE_FROM.get(target_of(page, link[1]))
        return f"]({os.path.relpath(target, os.path.dirname(page) or '.')}{link[2]})" if target else link[0]
    with open(os.path.join(ROOT, page), encoding="utf-8") as file:
        text = file.read()
    if page == "README.md":
        text = re.sub(r"(?ms)^## Where things are\n.*?(?=^## )", "", text)
    return LINK.sub(to_made, text)


def texts():
    """{path of a page, relative to the repository: its text on the site}."""
    found = list(TOP)
    for folder, _, names in sorted(os.walk(os.path.join(ROOT, "docs"))):
        found += [os.path.relpath(os.path.join(folder, name), ROOT) for name in sorted(names) if name.endswith(".md")]
    return {**{page: staged(page) for page in found}, **made()}


def linked(page, text):
    """The files that exist and that a page links to."""
    return {path for link, _ in LINK.findall(text) if os.path.isfile(os.path.join(ROOT, path := target_of(page, link)))}


def write(folder, pages):
    for path, text in pages.items():
        os.makedirs(os.path.dirname(os.path.join(folder, path)), exist_ok=True)
        with open(os.path.join(folder, path), "w", encoding="utf-8") as file:
            file.write(text)


def copy_linked(folder, pages):
    """Copies the files that the pages link to; a page elsewhere, such as an example's, brings its own along."""
    waiting, copied = [path for page, text in pages.items() for path in linked(page, text)], set(pages)
    while waiting:
        path = waiting.pop()
        if path not in copied:
            copied.add(path)
            os.makedirs(os.path.dirname(os.path.join(folder, path)), exist_ok=True)
            shutil.copyfile(os.path.join(ROOT, path), os.path.join(folder, path))
            waiting += linked(path, staged(path)) if path.endswith(".md") else []


def add_assets(folder):
    here = os.path.dirname(os.path.abspath(__file__))
    shutil.copytree(os.path.join(here, "assets"), os.path.join(folder, "assets"))
    katex = os.path.join(folder, "assets", "katex")
    shutil.copytree(os.path.realpath(os.path.join(KATEX, "fonts")), os.path.join(katex, "fonts"))
    for name in ("katex.min.css", "katex.min.js"):
        shutil.copyfile(os.path.join(KATEX, name), os.path.join(katex, name))


def main(*arguments):
    folder, pages = arguments[-1], texts()
    shutil.rmtree(folder, ignore_errors=True)
    if arguments[0] == "--docs":
        shutil.copytree(os.path.join(ROOT, "docs"), os.path.join(folder, "docs"))
        write(folder, {path: text for path, text in pages.items() if path.startswith("docs/")})
        return
    write(folder, pages)
    copy_linked(folder, pages)
    add_assets(folder)


if __name__ == "__main__":
    main(*sys.argv[1:])
