#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes a schema whose sections are configurations of stages with the schemas of these, so that an editor finds unknown keys in them.

usage: composed_schema.py schemas/NAME.schema.json OUTPUT

A section is merged over defaults: required keys may be missing, and with "type" any alternative may be meant, except in lists, whose
elements are whole. The tools check sections themselves, by the schemas of the stages.
"""
import json
import os
import sys

STRICT = ("required", "minProperties")


def read(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def relaxed(node, stage, is_whole=False):
    """The schema of a part of a stage's configuration. Its definitions have names that begin with that of the stage."""
    if isinstance(node, list):
        return [relaxed(inner, stage, is_whole) for inner in node]
    if not isinstance(node, dict):
        return node
    kept = {}
    for word, inner in node.items():
        if word == "properties":
            kept[word] = {name: relaxed(value, stage, is_whole) for name, value in inner.items()}
        elif word == "$ref":
            kept[word] = inner.replace("#/definitions/", f"#/definitions/{stage}_")
        elif word not in STRICT or is_whole:
            kept["anyOf" if word == "oneOf" else word] = relaxed(inner, stage, is_whole or word == "items")
    return kept


def definitions_of(stage, folder):
    """{name: schema} of a stage, which has its name, and of what it refers to."""
    schema = read(os.path.join(folder, f"{stage}.schema.json"))
    inner = schema.pop("definitions", {})
    parts = {f"{stage}_{name}": relaxed(node, stage) for name, node in inner.items()}
    whole = relaxed({word: value for word, value in schema.items() if not word.startswith("$")}, stage)
    if stage == "terrain":  # a raster or mesh, which no configuration of terrain-gen names
        whole["properties"] |= read(os.path.join(folder, "chain.schema.json"))["properties"][stage]["oneOf"][0]["properties"]
    return {stage: whole, **parts}


def section(node, stage, root):
    """A section: a configuration, a name, a list of these, and null where it may be that."""
    node = {**(root["definitions"][node["$ref"].rsplit("/", 1)[1]] if "$ref" in node else {}), **node}
    name = {"type": "string", "minLength": 1}
    kinds = [{"$ref": f"#/definitions/{stage}"}, name, {"type": "array", "minItems": 1, "items": {"anyOf": [{"$ref": f"#/definitions/{stage}"}, name]}}]
    kinds += [{"type": "null"}] * ({"type": "null"} in node.get("oneOf", []))
    return {**{word: value for word, value in node.items() if word not in ("$ref", "oneOf")}, "anyOf": kinds}


def composed(path):
    folder, root = os.path.dirname(path), read(path)
    stages = [stage["name"] for stage in read(os.path.join(folder, "dictionary", "stages.json"))["stages"]]
    keys = root["properties"]
    sections = keys["base"]["properties"] if "base" in keys else keys
    found = [stage for stage in stages if stage in sections and sections[stage].get("type") != "integer"]  # the number of draws has the name of a stage
    for stage in found:
        sections[stage] = section(sections[stage], stage, root)
    for stage in found:
        root["definitions"] |= definitions_of(stage, folder)
    return root


if __name__ == "__main__":
    os.makedirs(os.path.dirname(sys.argv[2]), exist_ok=True)
    with open(sys.argv[2], "w", encoding="utf-8") as output:
        output.write(json.dumps(composed(sys.argv[1]), indent=1, ensure_ascii=False) + "\n")
