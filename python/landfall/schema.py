# SPDX-License-Identifier: GPL-3.0-or-later
"""Strict JSON with comments: a reader that rejects duplicate keys, NaN and infinity, and a check against a JSON schema.

It supports the keywords of draft-07 that schemas/study.schema.json uses; any other keyword raises AssertionError. The sections of an installed
schema have "anyOf" with the schemas of the stages (cmake/composed_schema.py): for editors, because the tools check these themselves.
"""
import codecs
import json
import os
import re

from landfall import tools
from landfall.errors import UsageError

MAX_BYTES = 64 << 20  # of a configuration, as in lib/store/config/json_source.cpp
STRING_OR_COMMENT = re.compile(r'"(?:[^"\\]|\\.)*"|//[^\n]*|/\*.*?\*/', re.DOTALL)
TYPES = {"object": dict, "array": list, "string": str, "boolean": bool, "null": type(None)}
WORDS = {"$schema", "$id", "title", "description", "default", "definitions", "type", "properties", "additionalProperties",
         "required", "propertyNames", "minProperties", "items", "minItems", "maxItems", "uniqueItems", "enum", "minimum",
         "maximum", "minLength", "pattern", "$ref", "anyOf"}


def read_json(path):
    """The file's value. Rejects duplicate keys, NaN, infinity and NUL bytes; skips comments and a byte order mark at the start."""
    try:
        with open(path, "rb") as file:
            data = file.read(MAX_BYTES + 1)
        if len(data) > MAX_BYTES:
            raise UsageError(f"{path}: is larger than {MAX_BYTES >> 20} MiB, the limit of a configuration")
        data = data.removeprefix(codecs.BOM_UTF8)
        _reject_nul(data)
        return json.loads(STRING_OR_COMMENT.sub(_blank, data.decode()), object_pairs_hook=_unique, parse_constant=_no_constant, parse_float=_finite,
                          parse_int=_whole)
    except OSError as error:
        raise UsageError(f"{path}: {error.strerror}") from error
    except (ValueError, RecursionError) as error:
        raise UsageError(f"{path}: not JSON: {error}") from error


def read_checked(path, kind):
    """The tree of a file that schemas/KIND.schema.json describes. Throws UsageError, naming file, key and value."""
    tree = read_json(path)
    check_by(tree, path, kind)
    return tree


def check_by(tree, path, kind):
    """Throws UsageError unless the tree of a file is one that schemas/KIND.schema.json describes."""
    check(tree, read_json(os.path.join(tools.SHARE, "schemas", f"{kind}.schema.json")), path)


def check(value, schema, path):
    """Throws UsageError at the first value of file `path` that violates the schema."""
    _Checker(schema, path).check(value, schema, "")


def default_at(root, config, path):
    """The default that a schema gives at a path of names in a configuration; None without one. Where objects have a "type", that of the
    configuration, or of the default, decides."""
    schema, default = root, config
    for name in path:
        choice = _chosen(root, schema, default)
        schema = choice.get("properties", {}).get(name)
        if schema is None:
            return None
        known = isinstance(default, dict) and name in default
        default = default[name] if known else schema.get("default", dereferenced(root, schema).get("default"))
    return default


def dereferenced(root, schema):
    """The schema that a "$ref" refers to; another one as it is."""
    return dereferenced(root, root["definitions"][schema["$ref"].rsplit("/", 1)[1]]) if "$ref" in schema else schema


def _chosen(root, schema, value):
    """The alternative of `oneOf` for a value."""
    owner = dereferenced(root, schema)
    kind = (value or {}).get("type") or (owner.get("default") or {}).get("type") if isinstance(value, (dict, type(None))) else None
    for option in owner.get("oneOf", []):
        choice = dereferenced(root, option)
        if "oneOf" in choice or choice.get("properties", {}).get("type", {}).get("const") == kind:
            return _chosen(root, choice, value) if "oneOf" in choice else choice
    return owner


def shown(value):
    """A value as a message shows it."""
    text = json.dumps(value)
    return text if len(text) <= 60 else text[:57] + "..."


def type_of(value):
    """The name of a value's JSON type."""
    if _is(value, "number"):
        return "integer" if isinstance(value, int) else "number"
    return next(name for name, kind in TYPES.items() if isinstance(value, kind))


def _reject_nul(data):
    at = data.find(b"\0")
    if at >= 0:
        line_start = data.rfind(b"\n", 0, at) + 1
        raise ValueError(f"a NUL byte at line {data.count(10, 0, at) + 1}, column {at - line_start + 1}")


def _blank(found):
    """A comment as blanks, so that the parser's messages give the right place; a string as it is."""
    text = found.group()
    return text if text.startswith('"') else re.sub(r"[^\n]", " ", text)


def _unique(pairs):
    result = {}
    for key, value in pairs:
        if key in result:
            raise ValueError(f"the key \"{key}\" is given twice")
        result[key] = value
    return result


def _no_constant(text):
    raise ValueError(f"{text} is not a number")


def _finite(text):
    value = float(text)
    if value in (float("inf"), float("-inf")):
        raise ValueError(f"{text} is too large for a number")
    return value


def _whole(text):
    """An integer that a double can hold, as every number of a configuration is used as one somewhere."""
    if len(text.lstrip("-")) > 300:
        raise ValueError(f"{text[:20]}... is too large for a number")
    return int(text)


def _is(value, name):
    if name == "number":
        return isinstance(value, (int, float)) and not isinstance(value, bool)
    if name == "integer":
        return _is(value, "number") and value == int(value)
    return isinstance(value, TYPES[name])


class _Checker:
    def __init__(self, root, path):
        self.root, self.path = root, path

    def fail(self, where, what):
        raise UsageError(f"{self.path}: {where or '/'}: {what}")

    def check(self, value, schema, where):
        unknown = set(schema) - WORDS
        if unknown:
            raise AssertionError(f"schema: {sorted(unknown)} not supported")
        if "$ref" in schema:
            self.check(value, self.root["definitions"][schema["$ref"].rsplit("/", 1)[1]], where)
        self.check_type(value, schema, where)
        if value not in schema.get("enum", [value]):
            self.fail(where, f"{shown(value)} is not one of {', '.join(map(shown, schema['enum']))}")
        if isinstance(value, str):
            self.check_text(value, schema, where)
        if _is(value, "number"):
            self.check_bounds(value, schema, where)
        if isinstance(value, dict):
            self.check_object(value, schema, where)
        if isinstance(value, list):
            self.check_array(value, schema, where)

    def check_type(self, value, schema, where):
        expected = schema.get("type")
        names = [expected] if isinstance(expected, str) else expected
        if names and not any(_is(value, name) for name in names):
            self.fail(where, f"{shown(value)} is of type {type_of(value)}, not {' or '.join(names)}")

    def check_text(self, value, schema, where):
        if not value and schema.get("minLength", 0) > 0:
            self.fail(where, "is empty")
        if "pattern" in schema and not re.search(schema["pattern"].replace("$", r"\Z"), value):
            self.fail(where, f"{shown(value)} does not match {schema['pattern']}")

    def check_bounds(self, value, schema, where):
        minimum, maximum = schema.get("minimum"), schema.get("maximum")
        if (minimum is None or value >= minimum) and (maximum is None or value <= maximum):
            return
        both = f"in [{minimum}, {maximum}]"
        self.fail(where, f"{shown(value)} is not {f'>= {minimum}' if maximum is None else f'<= {maximum}' if minimum is None else both}")

    def check_object(self, value, schema, where):
        properties, other = schema.get("properties", {}), schema.get("additionalProperties", {})
        for key in schema.get("required", []):
            if key not in value:
                self.fail(where, f"needs the key \"{key}\"")
        if len(value) < schema.get("minProperties", 0):
            self.fail(where, "is empty")
        for key, inner in value.items():
            if "propertyNames" in schema:
                self.check(key, schema["propertyNames"], f"{where}/{key}")
            if key not in properties and other is False:
                known = ", ".join(properties)
                self.fail(f"{where}/{key}", f"unknown key; known: {known}")
            self.check(inner, properties.get(key, other), f"{where}/{key}")

    def check_array(self, value, schema, where):
        minimum, maximum = schema.get("minItems", 0), schema.get("maxItems", len(value))
        if not minimum <= len(value) <= maximum:
            expected = maximum if minimum == maximum else f"at least {minimum}" if len(value) < minimum else f"at most {maximum}"
            self.fail(where, f"an array of {len(value)} elements; expected {expected}")
        if schema.get("uniqueItems") and len({json.dumps(entry) for entry in value}) < len(value):
            self.fail(where, f"{shown(value)} has a duplicate element")
        for index, entry in enumerate(value):
            self.check(entry, schema.get("items", {}), f"{where}/{index}")
