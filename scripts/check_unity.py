#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that units which LANDFALL_UNITY compiles together do not give one name two meanings in their unnamed namespaces.

usage: check_unity.py REPOSITORY

Which units share an object changes with each new file: so any two units of a library are compared, and each with the constants
of the library's headers. Functions may share a name where their parameters differ, aliases where they are equal. A name that
collides in another way is seen by the compiler of preset release alone.
"""
import collections
import pathlib
import re
import sys

LIBRARY = re.compile(r"landfall_library\((\w+)\s+UNITY\b(.*?)\)", re.S)
HEADER_CONSTANT = re.compile(r"^inline constexpr \S+ (k\w+)", re.M)
FUNCTION = re.compile(r"(?:[^=(]|operator\W+)*\([^;]*\)[^;]*\{\}$")  # with its body
NOISE = re.compile(r"""//[^\n]*|/\*.*?\*/|^[ \t]*\#(?:\\\n|[^\n])*  # comments, preprocessor
                       |(?P<literal>R"(?P<mark>\w*)\(.*?\)(?P=mark)"|"(?:\\.|[^"\\\n])*"|(?<!\w)'(?:\\.|[^'\\\n])+')""", re.S | re.M | re.X)


def without_noise(text: str) -> str:
    """Without comments, preprocessor lines and the contents of literals."""
    return NOISE.sub(lambda match: '""' if match["literal"] else " ", text)


def split(text: str):
    """The parts of `text` between commas, up to the bracket that closes it, and what follows that."""
    depth, parts = 0, [""]
    for place, character in enumerate(text):
        depth += {"(": 1, "<": 1, "{": 1, ")": -1, ">": -1, "}": -1}.get(character, 0)
        if depth < 0:
            return parts, text[place + 1:]
        if depth == 0 and character == ",":
            parts.append("")
        else:
            parts[-1] += character
    return parts, ""


def declarations(text: str):
    """(enclosing namespace, declaration) of the unnamed namespaces, with {} for what stands in braces."""
    for opening in re.finditer(r"\bnamespace\s*\{", text):
        enclosing = re.findall(r"\bnamespace\s+([\w:]+)\s*\{", text[:opening.start()])
        depth, declaration = 1, ""
        for character in text[opening.end():]:
            depth += {"{": 1, "}": -1}.get(character, 0)
            if depth == 0:
                break
            if depth == 1 and character != ";" or depth == 2 and character == "{":
                declaration += character
            if depth == 1 and (character == ";" or character == "}" and FUNCTION.match(declaration)):
                yield enclosing[-1], " ".join(declaration.split())
                declaration = ""


def meaning(text: str):
    """The name that a declaration introduces, and its kind with what tells it from others of that name."""
    types = []
    while match := re.match(r"template\s*<", text):
        names, text = split(text[match.end():])
        types += [re.search(r"(\w+)\s*(?:=.*)?$", name)[1] for name in names]
        text = text.strip()
    if match := re.match(r"using (?:.*::)?(\w+)(?: =|$)", text):
        return match[1], ("alias", text)
    if match := re.match(r"(?:enum class|enum|struct|class|union|concept) (\w+)", text):
        return match[1], ("type",)
    if match := re.match(r"[^={]*?(operator[^(]+|\w+)\s*\(", text):
        of_parameters = [re.sub(r"(?<=[\w&*>]) ?\b\w+$", "", part.split("=")[0].strip()) for part in split(text[match.end():])[0]]
        for place, name in enumerate(types):
            of_parameters = [re.sub(rf"\b{name}\b", f"<{place}>", part) for part in of_parameters]
        return match[1], ("function", tuple(of_parameters))
    return re.search(r"(\w+)(?: ?\[[^]]*\])* ?$", re.split("[={]", text)[0])[1], ("variable",)


def collide(one, other) -> bool:
    if one[0] != other[0]:
        return True
    return one != other if one[0] == "alias" else one == other


def collisions(library: str, files, headers):
    known = collections.defaultdict(list)
    for header in headers:
        for name in HEADER_CONSTANT.findall(header.read_text()):
            known[name].append((header, ("variable",)))
    for file in files:
        for namespace, declaration in declarations(without_noise(file.read_text())):
            if declaration.startswith("static_assert"):
                continue
            name, what = meaning(declaration)
            # A header's constant is known by its name alone.
            for other, other_what in known[name] + known[namespace, name]:
                if other != file and collide(what, other_what):
                    yield f"{library}: {name} stands in {other} and in {file}"
            known[namespace, name].append((file, what))


def violations(root: pathlib.Path):
    for list_file in sorted(root.glob("lib/*/CMakeLists.txt")):
        for library, arguments in LIBRARY.findall(re.sub(r"#.*", "", list_file.read_text())):
            sources, alone = re.search(r"SOURCES\b(.*?)\bLINKS", arguments, re.S), re.search(r"ALONE\b([\w\s./]*)", arguments)
            together = [name for name in sources[1].split() if name.endswith(".cpp") and name not in (alone[1].split() if alone else [])]
            yield from collisions(library, [list_file.parent / name for name in together], sorted(list_file.parent.rglob("*.h")))


def main():
    found = list(violations(pathlib.Path(sys.argv[1])))
    print("\n".join(found) if found else "units that are compiled together have names of their own")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
