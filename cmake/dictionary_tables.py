#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes a file of schemas/dictionary as constant tables of C++.

usage: dictionary_tables.py NAME.json OUTPUT.h

A list of objects becomes a struct and an array of it: "fail_flags": [{"name": .., "bit": ..}] makes kFailFlags of FailFlag and, where
each has an own name that is an identifier, LANDFALL_FAIL_FLAGS(X), which is X(name) for each. Text is a const char*, "#rrggbb" a
std::uint32_t; a key that an entry lacks is empty or 0; a list of texts is one text, separated by spaces. A number becomes a constant.
"""
import json
import os
import re
import sys

COLOR = re.compile("#[0-9a-f]{6}")


def camel(key):
    return "".join(word.capitalize() for word in key.split("_"))


def typed(value):
    """(C++ type, literal) of a value; None for one that is left out."""
    if isinstance(value, bool):
        return "bool", str(value).lower()
    if isinstance(value, (int, float)):
        return type(value).__name__.replace("float", "double"), repr(value)
    if isinstance(value, str):
        return ("std::uint32_t", "0x" + value[1:]) if COLOR.fullmatch(value) else ("const char*", json.dumps(value, ensure_ascii=False))
    if all(isinstance(text, str) for text in value) and not all(map(COLOR.fullmatch, value)):
        return "const char*", json.dumps(" ".join(value), ensure_ascii=False)
    if all(isinstance(color, str) for color in value):
        return f"std::array<std::uint32_t, {len(value)}>", "{" + ", ".join("0x" + color[1:] for color in value) + "}"
    return None


def table(key, rows):
    members = {}
    for row in rows:
        members.update({name: typed(value)[0] for name, value in row.items() if typed(value)})
    plural = camel(key)
    struct = re.sub("(?<=ss)es$|(?<!s)s$", "", plural)
    yield f"struct {struct} {{"
    for name, kind in members.items():
        yield f"  {kind} {name} = " + ('"";' if kind == "const char*" else "{};")
    yield f"}};\n\ninline constexpr std::array<{struct}, {len(rows)}> k{plural} = {{{{"
    for row in rows:
        yield "    {" + ", ".join(f".{name} = {typed(row[name])[1]}" for name in members if name in row) + "},"
    yield "}};\n"
    names = [row.get("name", "") for row in rows]
    if len(set(names)) == len(names) and all(map(str.isidentifier, names)):
        yield f"#define LANDFALL_{key.upper()}(X) " + " ".join(f"X({name})" for name in names) + "\n"


def header(tree):
    yield "// SPDX-License-Identifier: GPL-3.0-or-later\n// Made by cmake/dictionary_tables.py.\n#pragma once\n"
    yield "#include <array>\n#include <cstdint>\n\nnamespace landfall::dictionary {\n"
    for key, value in tree.items():
        if isinstance(value, list):
            yield from table(key, value)
        elif isinstance(value, (int, float)):
            yield f"inline constexpr {typed(value)[0]} k{camel(key)} = {typed(value)[1]};\n"
    yield "}  // namespace landfall::dictionary"


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8") as source:
        lines = list(header(json.load(source)))
    os.makedirs(os.path.dirname(sys.argv[2]), exist_ok=True)
    with open(sys.argv[2], "w", encoding="utf-8") as output:
        output.write("\n".join(lines) + "\n")
