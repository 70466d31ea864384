# SPDX-License-Identifier: GPL-3.0-or-later
"""A study: its cases, and the configuration of each stage in each case."""
import copy
import itertools
import json
import math
import os
from dataclasses import dataclass, field

from landfall import dictionary, tools
from landfall.errors import ToolError, UsageError
from landfall.numbers import UNITS
from landfall.schema import default_at, read_json, shown, type_of

TOOLS = {name: stage["tool"] for name, stage in dictionary.stages().items()}
STAGES = tuple(TOOLS)
OPTIONAL_STAGES = tuple(name for name, stage in dictionary.stages().items() if stage.get("is_optional"))
# Keys of a distribution of draws.vary; what stands before one of them is the varied key, whose dots part no folders.
DISTRIBUTION = ("type", "mean", "sigma", "low", "high", "values")
VARY = "draws.vary."


@dataclass(frozen=True)
class Point:
    """One value of an axis: its entry in the table, and the keys that it sets."""

    value: object
    assignments: tuple  # of (key, value)


@dataclass(frozen=True)
class Axis:
    """A column of the table."""

    name: str
    label: str
    unit: str
    log: bool
    points: tuple
    role: str = "axis"  # or "repeat", or "drawn" for the values that a repeat draws

    def keys(self):
        """The keys that its points set, in order, each once."""
        return list(dict.fromkeys(key for point in self.points for key, _ in point.assignments))

    def is_numeric(self):
        return all(isinstance(point.value, (int, float)) and not isinstance(point.value, bool)
                   for point in self.points)


@dataclass(frozen=True)
class Study:
    """A study file that was read and checked. `dimensions` are crossed; the axes of one go together."""

    path: str
    name: str
    title: str
    base: dict  # stage: configuration, with the values of `set`; in the order of STAGES
    dimensions: tuple  # of tuples of Axis of one length
    options: dict  # stage: list of options
    plot: dict
    files: tuple = field(default=())  # all that it was read from
    description: str = ""
    traces: bool = False  # the draws of its runs trace their own rays

    def axes(self):
        return [axis for dimension in self.dimensions for axis in dimension]

    def case_count(self):
        return math.prod(len(dimension[0].points) for dimension in self.dimensions)

    def cases(self):
        """For each case the index into each dimension; the last dimension runs fastest."""
        return itertools.product(*(range(len(dimension[0].points)) for dimension in self.dimensions))

    def values(self, indices):
        """The case's entry in the column of each axis."""
        return [axis.points[index].value for dimension, index in zip(self.dimensions, indices) for axis in dimension]


def without_unit(name, unit):
    """The name without the unit that it ends in, for texts that give the unit separately: range_sigma_m -> range_sigma."""
    return name.rsplit("_", 1)[0] if unit not in ("", "1") and "_" in name and name.rsplit("_", 1)[1] in UNITS else name


def label_of(name, unit):
    """The label of an axis that has none: range_sigma_m -> range sigma."""
    return without_unit(name, unit).replace("_", " ")


# Configurations


def stage_of(key):
    return key.split(".", 1)[0]


def path_of(key):
    """The names by which the key "stage.a.b.0" is reached in its stage; of draws.vary.KEY.sigma they are vary, KEY and sigma."""
    if not key.startswith(VARY):
        return key.split(".")[1:]
    varied, _, last = key.removeprefix(VARY).rpartition(".")
    return ["vary", varied, last] if varied and last in DISTRIBUTION else ["vary", key.removeprefix(VARY)]


def assign(config, key, value):
    """The configuration with the value at the key "stage.a.b.0"; an array that only a default of the stage gives becomes a part of it.

    Throws KeyError, with the reason, if the configuration has no such key.
    """
    path = path_of(key)
    if not path:
        return copy.deepcopy(value)
    *folders, last = path
    node = config
    for depth, (folder, inner) in enumerate(zip(folders, path[1:])):
        if inner.isdigit() and isinstance(node, dict) and folder not in node:
            node[folder] = _default_array(stage_of(key), config, folders[:depth + 1])
        node = _child(node, folder)
    if isinstance(node, list):
        node[_index(node, last)] = copy.deepcopy(value)
    elif isinstance(node, dict):
        node[last] = copy.deepcopy(value)
    else:
        raise KeyError(f"\"{last}\" cannot be set in {shown(node)}")
    return config


def _default_array(stage, config, path):
    default = default_at(read_json(os.path.join(tools.SHARE, "schemas", f"{stage}.schema.json")), config, path)
    return copy.deepcopy(default) if isinstance(default, list) else {}


def _child(node, name):
    if isinstance(node, list):
        return node[_index(node, name)]
    if isinstance(node, dict):
        return node.setdefault(name, {})
    raise KeyError(f"\"{name}\" cannot be set in {shown(node)}")


def _index(node, text):
    if not text.isdigit() or int(text) >= len(node):
        raise KeyError(f"\"{text}\" is not an index into {shown(node)}")
    return int(text)


def plain_numbers(value):
    """The value with 3.0 as 3: a key that wants an integer takes it, and equal values have equal hashes."""
    if isinstance(value, float) and value.is_integer() and abs(value) < 2 ** 53:
        return int(value)
    if isinstance(value, list):
        return [plain_numbers(entry) for entry in value]
    if isinstance(value, dict):
        return {key: plain_numbers(entry) for key, entry in value.items()}
    return value


def with_paths(value, changed):
    """The value with every "path", a text, as changed() gives it."""
    if isinstance(value, list):
        return [with_paths(entry, changed) for entry in value]
    if not isinstance(value, dict):
        return value
    return {key: changed(entry) if key == "path" and isinstance(entry, str) else with_paths(entry, changed) for key, entry in value.items()}


def with_full_paths(value, folder):
    """The value with every "path" of a file that exists, seen from the folder, made absolute."""
    def full_path(path):
        full = os.path.abspath(os.path.join(folder, path))
        return full if os.path.isfile(full) else path
    return with_paths(value, full_path)


def config_path(name, stage, folder):
    """The file of a configuration that is given by its name in `folder`, or as preset:NAME."""
    if name.startswith("preset:"):
        return os.path.join(tools.SHARE, "studies", "presets", f"{name.removeprefix('preset:')}.{stage}.json")
    return os.path.join(folder, name)


def merged(base, changes):
    """The merge of RFC 7396: objects are merged, null removes a key, any other value replaces the earlier one."""
    if not isinstance(changes, dict):
        return changes
    result = dict(base) if isinstance(base, dict) else {}
    for key, value in changes.items():
        result.pop(key, None) if value is None else result.update({key: merged(result.get(key), value)})
    return result


def read_config(given, stage, folder, where=""):
    """A stage's configuration, given as an object, by a name (config_path) or as a list of these, which are merged in order. Throws UsageError, naming
    the file, or for an object `where` it is."""
    config = {}
    for number, part in enumerate(given if isinstance(given, list) else [given]):
        place = f"{where}/{number}" if isinstance(given, list) else where
        part, part_folder, part_place = _read_part(part, stage, folder, place)
        part = plain_numbers(with_full_paths(part, os.path.abspath(part_folder)))
        if stage == "terrain" and isinstance(part.get("from"), str):
            part |= {"from": with_full_paths({"path": part["from"]}, os.path.abspath(part_folder))["path"]}
        config = merged(config, part) if isinstance(given, list) else part
    return imported_terrain(config, where if isinstance(given, list) else part_place) if stage == "terrain" and {"from", "center"} & config.keys() else config


def _read_part(part, stage, folder, place):
    """(object, the folder that its paths are seen from, its place for messages)."""
    if isinstance(part, dict):
        return part, folder, place
    if not isinstance(part, str):
        raise UsageError(f"{place}: {shown(part)} is not a configuration (an object, the name of a file or preset:NAME)")
    path = config_path(part, stage, folder)
    if not os.path.exists(path) and os.path.exists(config_path(f"preset:{part}", stage, folder)):
        raise UsageError(f"{path}: No such file or directory; did you mean preset:{part}?")
    config = read_json(path)
    if not isinstance(config, dict):
        raise UsageError(f"{path}: {shown(config)} is of type {type_of(config)}, not object")
    return config, os.path.dirname(os.path.abspath(path)), f"{path}: "


def imported_terrain(config, where):
    """The configuration, with all defaults, of a terrain that names its raster or mesh and its site by "from" and "center", as a chain file does.
    Throws UsageError with the message of terrain-gen."""
    source, center = config.get("from"), config.get("center")
    if not isinstance(source, str) or not source:
        raise UsageError(f"{where}/from: " + ("is needed by /center" if source is None else f"{shown(source)} is not the name of a raster or mesh"))
    words = ["--from", source]
    if center is not None:
        if not isinstance(center, list) or len(center) != 2:
            raise UsageError(f"{where}/center: {shown(center)} is not an array of 2 numbers")
        words.append(f"--center={center[0]},{center[1]}")
    rest = {key: value for key, value in config.items() if key not in ("from", "center")}
    try:
        return resolved("terrain", rest, where, words)
    except ToolError as error:
        raise UsageError(str(error)) from error


def resolved(stage, config, where="", words=()):
    """A configuration with all defaults. Throws ToolError with the tool's message, which names `where` the configuration is."""
    with tools.naming_input(where):
        return json.loads(tools.run_tool(tools.find(TOOLS[stage]), "-c", "-", *words, "--print-config", "-q", input=json.dumps(config)).stdout)


def configuration(study, stage, indices, repeated=True):
    """A stage's configuration at a point of the study; unless `repeated`, without the keys that a repeat sets."""
    config = copy.deepcopy(study.base[stage])
    for dimension, index in zip(study.dimensions, indices):
        for axis in dimension:
            if axis.role == "repeat" and not repeated:
                continue
            for key, value in axis.points[index].assignments:
                if stage_of(key) == stage:
                    try:
                        config = assign(config, key, value)
                    except KeyError as error:
                        raise UsageError(f"{study.path}: axis {axis.name}: {key} = {shown(value)}: {error.args[0]}") from error
    return config
