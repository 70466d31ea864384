# SPDX-License-Identifier: GPL-3.0-or-later
"""The keys of a configuration's schema as a page: path, type, unit, range, default, what the key says, what it changes.

Paths are written as --set takes them, and as the man pages write them: N is an array index, KEY a key of any name. An object that
several keys share is listed under the first of them; the others refer to it.
"""
import json
import os
import sys

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
sys.path.insert(0, os.path.join(ROOT, "python"))
# pylint: disable=wrong-import-position
from landfall import dictionary, scan_keys
from landfall.schema import read_json

FOLDER = "docs/reference/keys"
# The schemas, the pages of their keys and what reads them.
PAGES = {**{stage["schema"]: stage["tool"] for stage in dictionary.stages().values()},
         "chain": "landfall-run", "study": "study", "sensitivity": "sensitivity", "design": "design"}
ABOUT = {"study": ("a study", "../../user/studies/README.md"), "sensitivity": ("a sensitivity analysis", "../../user/studies/sensitivity.md"),
         "design": ("a search for a design", "../../user/studies/design.md"), "chain": ("`landfall run`", "../../user/landfall.md")}
# Units by the last part of a key's name; the longest that fits counts.
UNITS = {"m": "m", "km2": "km²", "nm": "N m", "mps": "m/s", "mps2": "m/s²", "rad": "rad", "radps": "rad/s", "radps2": "rad/s²", "deg": "degrees",
         "degps": "degrees/s", "s": "s", "hz": "Hz", "frac": "fraction", "bins": "bins", "J": "J", "kg": "kg", "kgm2": "kg m²", "pe": "photoelectrons",
         "ppm": "ppm", "per_m": "1/m", "m_per_sqrt_s": "m/√s", "mps_per_sqrt_s": "(m/s)/√s", "rad_per_sqrt_s": "rad/√s"}
EFFECTS = """
The effect of a key follows its description:

- *beam*: the true beams or what they hit; another value needs a new trace;
- *echo*: the echoes that a receiver sees, or which of them it reports;
- *estimate*: only what the lidar measures or the lander believes; a redraw (`--ranges-from`, `monte-carlo`) takes another value;
- *drawn*: the seed draws an error of this size;
- *sigma*: where `regrid --uncertainty` has the size of the error from:

| sigma | |
|---|---|
| *range* | the scan, as part of the range sigma |
| *given* | `--range-sigma` |
| *navigation* | `--navigation-sigma` |
| *never* | the 1-sigma maps leave the error out |
"""


class Key:
    """One meaning of a path: with the type `choice` of the object around it, if there are several types."""

    def __init__(self, path, choice, effect, is_required, node, root):
        self.path, self.choice, self.effect, self.is_required, self.node, self.root = path, choice, effect, is_required, resolved(node, root), root

    @property
    def type(self):
        return type_of(self.node, self.root)

    @property
    def unit(self):
        name = next((part for part in reversed(self.path.split(".")) if part not in ("N", "KEY")), "")
        parts = name.split("_")
        return next((UNITS["_".join(parts[start:])] for start in range(1, len(parts)) if "_".join(parts[start:]) in UNITS), "")

    @property
    def range(self):
        return range_of(self.node, self.root)

    @property
    def default(self):
        return "default " + text_of(self.node["default"]) if "default" in self.node else ""

    @property
    def description(self):
        return self.node.get("description", "").rstrip(".")

    def facts(self):
        unit = self.unit if "number" in self.type or "integer" in self.type else ""
        return ", ".join(filter(None, (self.type, unit, self.range, "required" if self.is_required else self.default)))


def text_of(value):
    """A value as JSON, whole floats without their .0."""
    return f"`{number_of(value) if isinstance(value, float) else json.dumps(value, ensure_ascii=False)}`"


def number_of(value):
    """A number as people write it: 64, 0.5, 1e9."""
    if abs(value) < 1e6:
        return f"{value:.15g}"
    mantissa, power = f"{value:.15e}".split("e+")
    short, whole = f"{mantissa.rstrip('0').rstrip('.')}e{int(power)}", str(int(value))
    return min(short, whole, key=len)


def resolved(node, root):
    """The node with what its $ref names; the node's own words go before."""
    while "$ref" in node:
        target = root["definitions"][node["$ref"].rsplit("/", 1)[1]]
        node = {**target, **{word: value for word, value in node.items() if word != "$ref"}}
    return node


def type_of(node, root):
    node = resolved(node, root)
    if "enum" in node:
        return "one of " + ", ".join(map(text_of, node["enum"]))
    if "const" in node:
        return text_of(node["const"])
    if "oneOf" in node:
        return " or ".join(dict.fromkeys(type_of(option, root) for option in node["oneOf"]))
    kinds = node.get("type", "any value")
    return " or ".join(array_of(node, root) if kind == "array" else {"string": "text", "null": "`null`"}.get(kind, kind)
                       for kind in ([kinds] if isinstance(kinds, str) else kinds))


def array_of(node, root):
    inner = resolved(node.get("items", {}), root)
    of = inner["type"] + "s" if isinstance(inner.get("type"), str) and "enum" not in inner else "objects" if "oneOf" in inner else "values"
    minimum, maximum = node.get("minItems"), node.get("maxItems")
    count = f"{minimum} " if minimum is not None and minimum == maximum else ""
    return f"array of {count}{of.replace('strings', 'texts')}"


def range_of(node, root):
    """The bounds of a number, of the numbers of an array, or of the alternatives, where they are the same."""
    node = resolved(node, root)
    if "oneOf" in node:
        found = {range_of(option, root) for option in node["oneOf"]} - {""}
        return found.pop() if len(found) == 1 else ""
    if "items" in node:
        return range_of(node["items"], root)
    bounds = [f"{words} {number_of(node[word])}" for word, words in
              (("minimum", "at least"), ("exclusiveMinimum", "above"), ("maximum", "at most"), ("exclusiveMaximum", "below")) if word in node]
    return " and ".join(bounds)


def type_name(node, root):
    """The constant "type" of an object, "" without one."""
    return resolved(node.get("properties", {}).get("type", {}), root).get("const", "")


class Walk:
    """All keys of a schema, parents first."""

    def __init__(self, root):
        self.root, self.keys, self.places, self.same, self.walked = root, [], {}, {}, set()
        self.walk("", "", "beam", root)

    def walk(self, path, choice, effect, node):
        """Adds the keys below a node; those of a definition only at the path where it occurs first. `effect` is that of the object around."""
        if "$ref" in node and self.is_known(node["$ref"], path, choice):
            return
        node = resolved(node, self.root)
        effect = node.get("effect", effect)
        for option in node.get("oneOf", ()):
            self.walk(path, choice, effect, option)
        if "items" in node:
            has_index = "oneOf" not in node and self.has_keys(resolved(node["items"], self.root))
            self.walk(f"{path}.N" if has_index else path, choice, effect, node["items"])
        if isinstance(node.get("additionalProperties"), dict):
            self.walk(f"{path}.KEY", choice, effect, node["additionalProperties"])
        own = type_name(node, self.root) or choice
        for key, inner in node.get("properties", {}).items():
            below = f"{path}.{key}".lstrip(".")
            own_effect = "estimate" if below in scan_keys.SHARED else resolved(inner, self.root).get("effect", effect)
            self.keys.append(Key(below, own, own_effect, key in node.get("required", ()), inner, self.root))
            self.walk(below, own, own_effect, inner)

    def is_known(self, name, path, choice):
        """Whether the keys of the definition are listed elsewhere, which is then noted, or here already."""
        if (name, path, choice) in self.walked:
            return True
        if self.places.get(name, path) != path and self.has_keys(resolved({"$ref": name}, self.root)):
            self.same.setdefault(path, set()).add(self.places[name])
            return True
        self.places.setdefault(name, path)
        self.walked.add((name, path, choice))
        return False

    def has_keys(self, node, depth=0):
        node = resolved(node, self.root)
        inner = [*node.get("oneOf", ()), *([node["items"]] if "items" in node else ()), *([node["additionalProperties"]] if isinstance(node.get("additionalProperties"), dict) else ())]
        return "properties" in node or depth < 4 and any(self.has_keys(option, depth + 1) for option in inner)


def keys_of(kind):
    return Walk(read_json(os.path.join(ROOT, "schemas", f"{kind}.schema.json")))


def effect_of(kind, key):
    """A sentence: the effect of a key of a scan, and the sigma that covers its error; "" for other keys."""
    if kind != "scan" or key.path.startswith("$"):
        return ""
    return f" Effect: {key.effect}" + (", drawn" if key.node.get("drawn") else "") + (f", sigma: {key.node['sigma']}" if "sigma" in key.node else "") + "."


def quoted(words):
    return ", ".join(f"`{word}`" for word in words)


def type_entry(keys):
    """The lines of a "type": what each of its values means."""
    meanings = {key.choice: key.description for key in keys}
    if not any(meanings.values()):
        return ["What it is; decides which keys it has: " + quoted(meanings) + "."]
    return ["What it is; decides which keys it has:", "", *(f"- `{choice}`: {text or 'as its name says'}" for choice, text in meanings.items()), "", ""]


def meaning_lines(kind, keys):
    """Each meaning of a path, with the types for which it holds where there are several."""
    meanings = {}
    for key in keys:
        meanings.setdefault((key.description, key.facts(), effect_of(kind, key)), []).append(key.choice)
    for (description, facts, effect), choices in meanings.items():
        types = quoted(dict.fromkeys(filter(None, choices)))
        yield from (f"{description}." + (f" With type {types}." if types else "") + f" *{facts}*.{effect}", "")


def entry(kind, path, keys, same):
    """The section of a path."""
    is_type = path.endswith(".type") and keys[0].choice
    lines = [f"{'###' if '.' in path else '##'} `{path}`", "", *(type_entry(keys) if is_type else meaning_lines(kind, keys))]
    if is_type:
        lines[-1] = (lines[-1] + effect_of(kind, keys[0])).strip()
    others = sorted((same.get(path, set()) | same.get(path + ".N", set())) - {path, path + ".N"})
    return [*lines, *([""] if lines[-1] else []), *([f"Its keys are those of {quoted(others)}.", ""] if others else [])]


def page(kind):
    """The text of a schema's page."""
    found = keys_of(kind)
    who, link = ABOUT.get(kind, (f"`{PAGES[kind]}`", f"../../user/{PAGES[kind]}.md"))
    lines = [f"# Keys of {PAGES[kind]}", "", f"Every key of the configuration of [{who}]({link}), from `schemas/{kind}.schema.json`: meaning, then type, unit, range",
             "and default, or that it is required. `N` is an array index, `KEY` a key of any name.", ""]
    lines += [*EFFECTS.strip().split("\n"), ""] if kind == "scan" else []
    by_path = {}
    for key in found.keys:
        by_path.setdefault(key.path, []).append(key)
    for path, keys in by_path.items():
        lines += entry(kind, path, keys, found.same)
    return "\n".join(lines).rstrip() + "\n"


def index():
    """The text of the folder's README.md."""
    lines = ["# Configuration keys", "", "Every key of every configuration: meaning, unit, range, default and effect. The pages are made from `schemas/`.", "", "| keys of | sections |", "|---|---|"]
    for kind, name in PAGES.items():
        parts = [part for part in keys_of(kind).root["properties"] if not part.startswith("$")]
        lines.append(f"| [{name}]({name}.md) | " + ", ".join(f"[{part}]({name}.md#{part})" for part in parts) + " |")
    return "\n".join(lines) + "\n"


def texts():
    """{path of a page: its text}."""
    return {f"{FOLDER}/README.md": index()} | {f"{FOLDER}/{name}.md": page(kind) for kind, name in PAGES.items()}
