# SPDX-License-Identifier: GPL-3.0-or-later
"""Puts the templates, styles and scripts of lib/app/report/web together, one self-contained HTML template for each report.

usage: web.py WEB_FOLDER OUTPUT_FOLDER PAGE...

Writes PAGE.html of each page. The build calls this for the reports of the tools; it needs nothing but Python.
"""
import base64
import hashlib
import os
import re
import sys

PAGES = ("evaluation", "hazards", "draws", "cloud", "comparison", "study", "answers")

IMPORT = re.compile(r'^import \{([^{}]*)\} from "\./([\w-]+\.js)";\n', re.MULTILINE)
EXPORT = re.compile(r"^export (?=(?:async function|function|class|const|let) )", re.MULTILINE)
DECLARATION = re.compile(r"^(export )?(?:async function|function\*?|class|const|let|var) (\w+)?", re.MULTILINE)
# A module is joined by its lines, so that these have one form; an inline script must not contain the last two.
UNSUPPORTED = re.compile(r"^import\b.*|^export\b.*|\bimport *[.(]|</script|<!--", re.MULTILINE)
PLACE = re.compile(r"@(\w+)@")


class Module:
    """A script with its imports, {module: names}, and its declarations. Throws ValueError if it cannot be joined."""

    def __init__(self, folder, name):
        self.name = name
        text = read(os.path.join(folder, name))
        self.imports = {match[2]: [word.strip() for word in match[1].split(",")] for match in IMPORT.finditer(text)}
        self.text = EXPORT.sub("", IMPORT.sub("", text))
        refused = UNSUPPORTED.search(self.text)
        if refused:
            raise ValueError(f"{name}: {refused[0]!r} cannot be joined: only lines such as 'import {{a, b}} from \"./other.js\";' and "
                             "'export function f() {' are allowed")
        found = DECLARATION.findall(text)
        self.declared = [word for _, word in found]
        self.exported = [word for is_exported, word in found if is_exported]
        if "" in self.declared:
            raise ValueError(f"{name}: a declaration at the top level must begin with a name")


def modules_of(folder, entry):
    """The modules that a module needs, each after those that it imports. Throws ValueError on a cycle or an import without its export."""
    order = {}

    def add(name, path):
        if name in path:
            raise ValueError(f"modules import each other: {' -> '.join([*path[path.index(name):], name])}")
        if name in order:
            return order[name]
        module = Module(folder, name)
        for source, names in module.imports.items():
            exported = add(source, [*path, name]).exported
            for word in names:
                if word not in exported:
                    raise ValueError(f"{name}: {source} does not export {word!r}")
        order[name] = module
        return module

    add(entry, [])
    return list(order.values())


def program(folder, page):
    """The scripts of a page as one, whose top-level names are all in one scope. Throws ValueError if two modules have the same name."""
    modules = modules_of(folder, page + ".js")
    owner = {}
    for module in modules:
        for word in module.declared:
            if owner.setdefault(word, module.name) != module.name:
                raise ValueError(f"{module.name} and {owner[word]} both declare {word!r}, which the page {page} joins in one scope")
    return '\n"use strict";\n' + "".join(module.text for module in modules)


def check(folder, pages=PAGES):
    """Throws ValueError if a module belongs to no page, or exports a name that no module imports."""
    modules = {module.name: module for page in pages for module in modules_of(folder, page + ".js")}
    for name in sorted(os.listdir(folder)):
        if name.endswith(".js") and name not in modules:
            raise ValueError(f"{name}: no page needs it")
    imported = {(source, word) for module in modules.values() for source, names in module.imports.items() for word in names}
    for name, module in modules.items():
        for word in module.exported:
            if (name, word) not in imported:
                raise ValueError(f"{name}: no module imports {word!r}, which it exports")


def template(folder, page):
    """page.html with the styles, the script and, from PAGE.html if there is one, the sections of a page. Other places, @NAME@, are left."""
    def part(name):
        path = os.path.join(folder, page + name)
        return read(path) if os.path.exists(path) else None
    elements = {"style": "\n" + read(os.path.join(folder, "report.css")) + (part(".css") or ""), "program": program(folder, page)}
    parts = {}
    for name, text in elements.items():
        place = PLACE.search(text)
        if place:
            raise ValueError(f"{page}: {place[0]} in the {name} would be replaced")
        # The source of the content security policy that admits the inline script or style with this text, and no other.
        digest = base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
        parts |= {name: text, name + "_source": f"'sha256-{digest}'"}
    sections = part(".html")
    return filled(read(os.path.join(folder, "page.html")), {**parts, **({} if sections is None else {"sections": sections})})


def filled(text, parts):
    """The text with each @NAME@ replaced by its part, if it has one."""
    return PLACE.sub(lambda match: parts.get(match[1], match[0]), text)


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def main(folder, output, *pages):
    try:
        check(folder)
        os.makedirs(output, exist_ok=True)
        for page in pages:
            with open(os.path.join(output, page + ".html"), "w", encoding="utf-8") as file:
                file.write(template(folder, page))
    except (OSError, ValueError) as error:
        sys.exit(f"web.py: {error}")


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
