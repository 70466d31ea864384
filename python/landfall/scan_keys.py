# SPDX-License-Identifier: GPL-3.0-or-later
"""The effects of the keys of a scan's configuration, as schemas/scan.schema.json says (lib/store/config/key_effects.h has the words)."""
import functools
import os

from landfall import schema, tools

EFFECTS = ("beam", "echo", "estimate")
SHARED = ("$schema", "$comment", "seed", "draw")  # no key of these moves anything by itself


@functools.cache
def scan_schema():
    return schema.read_json(os.path.join(tools.SHARE, "schemas", "scan.schema.json"))


def _alternatives(node):
    owner = schema.dereferenced(scan_schema(), node)
    return [found for option in owner["oneOf"] for found in _alternatives(option)] if "oneOf" in owner else [owner]


def effect_of(*path, scan=None):
    """The effect of a key: ("laser", "scan_time_s"), in this configuration if one is given. Of one that several scanners have the first
    of EFFECTS; of an unknown one that of the nearest known key above it."""
    if path[0] in SHARED:
        return "estimate"
    return "beam" if scan and _moves_beams_in(scan_schema()["properties"].get(path[0], {}), scan) else _effect_at(path)


@functools.cache
def _effect_at(path):
    return _effect(scan_schema(), "beam", path)


def _moves_beams_in(section, scan):
    """Whether another key has a value with which the keys of this section move the beams."""
    return any(functools.reduce(lambda part, key: part.get(key, {}), pointer.split("/")[1:], scan) == value
               for pointer, value in section.get("beam_with", {}).items())


def _effect(node, inherited, path):
    here = node.get("effect", inherited)
    found = [_effect(option["properties"][path[0]], here, path[1:]) for option in _alternatives(node) if path and path[0] in option.get("properties", {})]
    return min(found, key=EFFECTS.index, default=here)


def part(scan, effects, path=(), whole=None):
    """The keys of a configuration that have one of these effects."""
    kept, whole = {}, whole or scan
    for key, value in scan.items():
        if isinstance(value, dict) and value:
            inner = part(value, effects, (*path, key), whole)
            if inner:
                kept[key] = inner
        elif effect_of(*path, key, scan=whole) in effects:
            kept[key] = value
    return kept


def is_beam_drawn(scan):
    """Whether random numbers move the true beams: a key that draws such an error is on."""
    return any(_draws_beams(node, scan[section], "beam", _moves_beams_in(node, scan))
               for section, node in scan_schema()["properties"].items() if section in scan)


def _draws_beams(node, value, inherited, all_move=False):
    effect = "beam" if all_move else node.get("effect", inherited)
    if node.get("drawn") and effect == "beam" and value not in (0, [0, 0], [0, 0, 0]):
        return True
    if not isinstance(value, dict):
        return False
    return any(_draws_beams(inner, value[key], effect, all_move) for option in _alternatives(node) if _is_chosen(option, value)
               for key, inner in option.get("properties", {}).items() if key in value)


def _is_chosen(option, value):
    kind = option.get("properties", {}).get("type", {})
    return "const" not in kind or value.get("type") == kind["const"]
