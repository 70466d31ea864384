#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that units which LANDFALL_UNITY compiles together do not give one name two meanings in their unnamed namespaces.

usage: check_unity.py REPOSITORY

Which units share an object, and in which order, changes with each new file: so any two units of a library, of the tools, or of a
program of unit tests, are compared, and each with the constants, types and inline functions of its headers. Functions may share a name
where the numbers of their parameters differ, aliases where they are equal. A name that collides in another way is seen by the compiler
of preset release alone.
"""
import collections
import pathlib
import re
import sys

TARGET = re.compile(r"(?:landfall_library|landfall_plugin|landfall_unity_groups|landfall_gtest)\((\w+)(.*?)\)", re.S)
WORD = re.compile(r"[^\s)]+")
GLOB = re.compile(r"file\(GLOB (\w+) CONFIGURE_DEPENDS RELATIVE \S+ (\S+)\)\s*list\(REMOVE_ITEM \1 ([^)]*)\)")
INCLUDE = re.compile(r'^#include "([^"]+)"', re.M)
TEST = re.compile(r"TEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\s*\)|INSTANTIATE_TEST_SUITE_P\(\s*(\w+),\s*(\w+),")
HEADER_CONSTANT = re.compile(r"^inline constexpr \S+ (k\w+)", re.M)
HEADER_TYPE = re.compile(r"^(?:enum class|enum|struct|class) (\w+)(?: final)?(?: :[^;{]*)? \{", re.M)
HEADER_FUNCTION = re.compile(r"^inline [^=(]*?(\w+)\(", re.M)
FUNCTION = re.compile(r"(?:[^=(]|operator\W+)*\([^;]*\)[^;]*\{\}$")  # with its body
NOISE = re.compile(r"""//[^\n]*|/\*.*?\*/|^[ \t]*\#(?:\\\n|[^\n])*  # comments, preprocessor
                       |(?P<literal>R"(?P<mark>\w*)\(.*?\)(?P=mark)"|"(?:\\.|[^"\\\n])*"|(?<!\w)'(?:\\.|[^'\\\n])+')""", re.S | re.M | re.X)


def without_noise(text: str) -> str:
    """Without comments, preprocessor lines and the contents of literals."""
    return NOISE.sub(lambda match: '""' if match["literal"] else " ", text)


def count_to_bracket(text: str):
    """How many parts between commas `text` has up to the bracket that closes it, and what follows that."""
    depth, count = 0, 1
    for place, character in enumerate(text):
        depth += {"(": 1, "<": 1, "{": 1, ")": -1, ">": -1, "}": -1}.get(character, 0)
        if depth < 0:
            return count, text[place + 1:]
        count += depth == 0 and character == ","
    return count, ""


def complete_function(declaration: str) -> bool:
    """Whether it ends with the body of a function, not with that of a lambda among the arguments of a macro."""
    return declaration.count("(") == declaration.count(")") and bool(FUNCTION.match(declaration))


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
            if depth == 1 and (character == ";" or character == "}" and complete_function(declaration)):
                yield enclosing[-1] if enclosing else "", " ".join(declaration.split())
                declaration = ""


def meaning(text: str):
    """The name that a declaration introduces, and its kind with what tells it from others of that name."""
    if match := TEST.match(text):
        return "_".join(filter(None, match.groups())), ("test",)
    while match := re.match(r"template\s*<", text):
        text = count_to_bracket(text[match.end():])[1].strip()
    if match := re.match(r"(?:using|namespace) (\w+) =", text) or re.match(r"using .*?(\w+)$", text):
        return match[1], ("alias", text)
    if match := re.match(r"(?:enum class|enum|struct|class|union|concept) (\w+)", text):
        return match[1], ("type",)
    if match := re.match(r"[^={]*?(operator[^(]+|\w+)\s*\(", text):
        return match[1], ("function", count_to_bracket(text[match.end():])[0])
    return re.search(r"(\w+)(?: ?\[[^]]*\])* ?$", re.split("[={]", text)[0])[1], ("variable",)


def collide(one, other) -> bool:
    return one[0] != other[0] or (one != other if one[0] == "alias" else one == other)


def names_other(what) -> bool:
    """Whether it is a using-declaration, which gives a header's name no other meaning."""
    return what[0] == "alias" and "=" not in what[1]


def collisions(library: str, files, headers):
    known = collections.defaultdict(list)
    for header in headers:
        for name in HEADER_CONSTANT.findall(header.read_text()):
            known[name].append((header, ("variable",)))
        for name in HEADER_TYPE.findall(header.read_text()):
            known[name].append((header, ("type",)))
        for match in HEADER_FUNCTION.finditer(header.read_text()):
            known[match[1]].append((header, ("function", count_to_bracket(header.read_text()[match.end():])[0])))
    for file in files:
        for namespace, declaration in declarations(without_noise(file.read_text())):
            if declaration.startswith("static_assert"):
                continue
            name, what = meaning(declaration)
            # A header's constant is known by its name alone.
            for other, other_what in known[name] + known[namespace, name]:
                if other != file and collide(what, other_what) and not (other in headers and names_other(what)):
                    yield f"{library}: {name} stands in {other} and in {file}"
            known[namespace, name].append((file, what))


def shared_headers(folders, files):
    """The headers of the folders, and those of other folders of unit tests that the files include."""
    included = {folder.parent / name for folder in folders for file in files for name in INCLUDE.findall(file.read_text())}
    return sorted({*(header for folder in folders for header in folder.rglob("*.h")), *(header for header in included if header.exists())})


def lists_of(arguments: str):
    """The words of each list of a call."""
    lists, name = collections.defaultdict(list), ""
    for word in WORD.findall(arguments):
        if word.isupper():
            name = word
        else:
            lists[name].append(word)
    return lists


def units_of(folder: pathlib.Path, places):
    """The sources that are named, and those of the folders that are."""
    named = [folder / place for place in places]
    return [unit for place in named for unit in ([place] if place.suffix == ".cpp" else sorted(place.rglob("*.cpp")))]


def violations(root: pathlib.Path):
    taken = set()  # A source is of the first library that names it, and the plugins stand before them.
    libraries = {}
    lists = sorted(root.glob("lib/**/CMakeLists.txt"), key=lambda path: -len(path.parts))
    for list_file in [*lists, *sorted(root.glob("tests/unit/**/CMakeLists.txt"))]:
        text = re.sub(r"#.*", "", list_file.read_text()).replace("${CMAKE_SOURCE_DIR}", str(root.resolve()))
        for name, pattern, others in GLOB.findall(text):
            units = {str(unit.relative_to(list_file.parent)) for unit in list_file.parent.glob(pattern)}
            text = text.replace("${" + name + "}", " ".join(sorted(units - set(others.split()))))
        for library, arguments in TARGET.findall(text):
            words = lists_of(arguments)
            units = units_of(list_file.parent, [*words["FOLDERS"], *words["SOURCES"]])
            left_out = {*units_of(list_file.parent, words["EXCEPT"]), *(taken if words["FOLDERS"] else ())}
            units = [unit for unit in units if unit.resolve() not in {other.resolve() for other in left_out}]
            if root / "lib" in list_file.parents:
                taken.update(units)
                libraries[library] = units
            units += [unit for name in words["WITH"] for unit in libraries[name]]
            apart = units_of(list_file.parent, words["ALONE"] + words["KERNELS"])
            files = [unit for unit in units if unit not in apart]
            rooms = sorted({unit.parent for unit in files})
            yield from collisions(library, files, shared_headers(rooms, files))


def main():
    found = list(violations(pathlib.Path(sys.argv[1])))
    print("\n".join(found) if found else "units that are compiled together have names of their own")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
