# SPDX-License-Identifier: GPL-3.0-or-later
# Decisions: D145
"""Reads a study file (schemas/study.schema.json, docs/user/studies/README.md)."""
import hashlib
import json
import os
import statistics
import sys

from landfall import schema
from landfall.errors import printable, UsageError
from landfall.numbers import unit_of
from landfall.schema import shown
from landfall.study.model import (assign, Axis, config_path, label_of, OPTIONAL_STAGES, plain_numbers, Point, read_config, stage_of, STAGES,
                                  Study, with_full_paths, without_unit)

KINDS = ("values", "linspace", "logspace", "variants", "zip")
RESERVED = ("case", "repeat", "pass")
MAX_CASES = 1_000_000


def read_study(path):
    """Throws UsageError, naming file, key, value and bound."""
    tree = schema.read_json(path)
    old = _renamed_lists(tree)
    schema.check_by(tree, path, "study")
    if old:
        print(printable(f"landfall study: warning: {path}: {old[0]}/list: \"list\" is an old name; write \"values\""), file=sys.stderr)
    return _Reader(path).study(tree)


def _renamed_lists(tree, where="/axes"):
    """Renames "list" of the axes of a study of version 0.2.0 to "values". The places of these axes."""
    axes = tree.get("axes", tree.get("zip")) if isinstance(tree, dict) else None
    found = []
    for number, axis in enumerate(axes if isinstance(axes, list) else []):
        place = f"{where}/{number}"
        if isinstance(axis, dict) and "list" in axis and "values" not in axis:
            axis["values"] = axis.pop("list")
            found.append(place)
        found += _renamed_lists(axis, f"{place}/zip")
    return found


class _Reader:
    def __init__(self, path):
        self.path = path
        self.folder = os.path.dirname(os.path.abspath(path))
        self.files = [path]

    def fail(self, where, what):
        raise UsageError(f"{self.path}: {where}: {what}")

    def study(self, tree):
        name = tree.get("name") or os.path.splitext(os.path.basename(self.path))[0]
        dimensions = [self.dimension(axis, f"/axes/{i}") for i, axis in enumerate(tree.get("axes", []))]
        if "repeat" in tree:
            dimensions.append(self.repeat(tree["repeat"]))
        study = Study(self.path, name, tree.get("title", name), self.base(tree), tuple(dimensions),
                      tree.get("options", {}), tree.get("plot", {}), tuple(self.files), tree.get("description", ""), tree.get("trace_draws", False))
        if study.traces and "draws" not in study.base:
            self.fail("/trace_draws", "needs draws: give \"draws\" in \"base\"")
        self.check_columns(study)
        self.check_keys(study)
        if study.case_count() > MAX_CASES:
            self.fail("/axes", f"the number of cases, {study.case_count()}, is not <= {MAX_CASES}")
        return study

    def base(self, tree):
        given = tree.get("base", {})
        base = {stage: self.config(given.get(stage, {}), stage, f"/base/{stage}")
                for stage in STAGES if stage in given or stage not in OPTIONAL_STAGES}
        for key, value in tree.get("set", {}).items():
            stage = stage_of(key)
            self.check_stage(base, key, f"/set/{key}")
            try:
                base[stage] = assign(base[stage], key, self.value(key, value, f"/set/{key}"))
            except KeyError as error:
                self.fail(f"/set/{key}", f"{shown(value)}: {error.args[0]}")
        return base

    def check_stage(self, base, key, where):
        if stage_of(key) not in base:
            self.fail(where, f"{key}: this study has no stage {stage_of(key)}; add it to \"base\", {{}} for the tool's defaults")

    def config(self, value, stage, where):
        """A configuration given as an object, by its file's name, as preset:NAME or as a list of these."""
        folder = os.path.dirname(self.path)
        for part in value if isinstance(value, list) else [value]:
            if isinstance(part, str):
                self.files.append(config_path(part, stage, folder))
        try:
            return read_config(value, stage, folder, f"{self.path}: {where}")
        except UsageError as error:
            if str(error).startswith(f"{printable(self.path)}: "):
                raise
            return self.fail(where, str(error))

    def value(self, key, value, where):
        """A value as a configuration holds it: of a stage alone, its whole configuration."""
        if "." not in key:
            if not isinstance(value, (dict, str, list)):
                self.fail(where, f"{shown(value)} is not a configuration (an object, the name of a file or a list of these)")
            return self.config(value, key, where)
        last = key.rsplit(".", 1)[1]
        return plain_numbers(with_full_paths({last: value}, self.folder)[last])

    def dimension(self, tree, where):
        kinds = [kind for kind in KINDS if kind in tree]
        if len(kinds) != 1:
            self.fail(where, f"has {' and '.join(kinds) or 'none'} of {', '.join(KINDS)}; exactly one is needed")
        if kinds != ["zip"]:
            return (self.axis(tree, kinds[0], where),)
        self.allow(tree, {"zip"}, "zip", where)
        axes = []
        for index, inner in enumerate(tree["zip"]):
            if "zip" in inner:
                self.fail(f"{where}/zip/{index}", "a zip in a zip")
            axes.extend(self.dimension(inner, f"{where}/zip/{index}"))
        lengths = [len(axis.points) for axis in axes]
        if len(set(lengths)) > 1:
            self.fail(f"{where}/zip", f"axes of different lengths: {', '.join(map(str, lengths))}")
        return tuple(axes)

    def allow(self, tree, keys, kind, where):
        for key in tree:
            if key not in keys:
                self.fail(f"{where}/{key}", f"does not go with {kind}")

    def axis(self, tree, kind, where):
        common = {"name", "label", "unit", "log", kind}
        if kind == "variants":
            self.allow(tree, common, kind, where)
            if "name" not in tree:
                self.fail(where, "needs the key \"name\": variants have no key to be named by")
            return self.named(tree, tree["name"], self.variants(tree["variants"], f"{where}/variants"))
        self.allow(tree, common | {"key", "scale"} | ({"labels"} if kind == "values" else set()), kind, where)
        if "key" not in tree:
            self.fail(where, "needs the key \"key\"")
        keys = [tree["key"]] if isinstance(tree["key"], str) else tree["key"]
        values = tree["values"] if kind == "values" else self.spaced(tree[kind], kind, f"{where}/{kind}")
        points = [self.point(tree, keys, index, value, f"{where}/{kind}") for index, value in enumerate(values)]
        name = next(part for part in reversed(keys[0].split(".")) if not part.isdigit())
        return self.named(tree, tree.get("name", name), points, "" if "scale" in tree else unit_of(name))

    def named(self, tree, name, points, key_unit=""):
        """An axis; its unit is the given one, else that of its name, else that of its key."""
        unit = tree.get("unit", unit_of(name) or key_unit)
        axis = Axis(name, tree.get("label", label_of(name, unit)), unit, tree.get("log", False), tuple(points))
        if name in RESERVED:
            self.fail("/axes", f"an axis cannot be named {name}")
        seen = set()
        for point in points:
            text = json.dumps(point.value)
            if text in seen:
                self.fail(f"axis {name}", f"has the value {text} twice")
            seen.add(text)
        return axis

    def variants(self, tree, where):
        return [Point(label, tuple((key, self.value(key, value, f"{where}/{label}/{key}"))
                                   for key, value in assignments.items()))
                for label, assignments in tree.items()]

    def spaced(self, numbers, kind, where):
        first, last, count = numbers
        if count != int(count) or not 2 <= count <= MAX_CASES:
            self.fail(f"{where}/2", f"{shown(count)} is not an integer in [2, {MAX_CASES}]")
        if kind == "logspace" and not (first > 0 and last > 0):
            self.fail(where, f"{shown(min(first, last))} is not above 0")
        steps = [step / (int(count) - 1) for step in range(int(count))]
        if kind == "linspace":
            values = [first + (last - first) * step for step in steps]
        else:
            values = [first * (last / first) ** step for step in steps]
        return [_rounded(value) for value in [first, *values[1:-1], last]]

    def point(self, tree, keys, index, value, where):
        labels, scale = tree.get("labels"), tree.get("scale")
        if labels is not None and len(labels) != len(tree["values"]):
            self.fail(where, f"{len(tree['values'])} entries and {len(labels)} labels")
        if labels is None and isinstance(value, dict):
            self.fail(f"{where}/{index}", "an object needs a name in \"labels\"")
        if scale is not None and (isinstance(value, bool) or not isinstance(value, (int, float))):
            self.fail(f"{where}/{index}", f"{shown(value)} is not a number and cannot be scaled")
        shown_value = labels[index] if labels else value if not isinstance(value, list) else json.dumps(value)
        return Point(plain_numbers(shown_value),
                     tuple((key, self.value(key, _scaled(value, scale), f"{where}/{index}")) for key in keys))

    def repeat(self, tree):
        count, first = int(tree["count"]), int(tree.get("first_seed", 1))
        seeds, draws = tree.get("seeds", ["scan.seed"]), tree.get("draws", {})
        for key, draw in draws.items():
            self.check_draw(draw, f"/repeat/draws/{key}")
        drawn = [{key: _drawn(draw, first, key, repeat) for key, draw in draws.items()} for repeat in range(1, count + 1)]
        repeats = [Point(repeat, (*(pair for key in seeds for pair in _random_numbers(key, first, repeat)), *drawn[repeat - 1].items()))
                   for repeat in range(1, count + 1)]
        axes = [Axis("repeat", "repeat", "", False, tuple(repeats), "repeat")]
        for key in draws:
            axes.extend(_draw_columns(key, [values[key] for values in drawn]))
        return tuple(axes)

    def check_draw(self, draw, where):
        if len(draw) != 1:
            self.fail(where, f"has {' and '.join(draw) or 'none'} of normal, uniform; exactly one is needed")
        if "uniform" in draw and draw["uniform"][0] > draw["uniform"][1]:
            self.fail(f"{where}/uniform", f"{shown(draw['uniform'])}: the lowest value is above the highest")

    def check_columns(self, study):
        names = set()
        for axis in study.axes():
            if axis.name in names:
                self.fail("/axes", f"two axes are named {axis.name}; give one another \"name\"")
            names.add(axis.name)

    def check_keys(self, study):
        """No axis may undo what an earlier one has set."""
        earlier = {}
        for axis in study.axes():
            for key in axis.keys():
                self.check_stage(study.base, key, f"axis {axis.name}")
                for other, name in earlier.items():
                    if name != axis.name and (other == key or other.startswith(key + ".")):
                        self.fail(f"axis {axis.name}", f"{key} overwrites {other} of the axis {name}")
            earlier.update((key, axis.name) for key in axis.keys())


def _rounded(value):
    """The number to 12 digits: 0.3 and not 0.30000000000000004."""
    return plain_numbers(float(f"{value:.12g}"))


def _scaled(value, scale):
    if scale is None:
        return value
    return [value * factor for factor in scale] if isinstance(scale, list) else value * scale


def _random_numbers(key, first_seed, repeat):
    """The assignments that give a repeat random numbers of its own: of a terrain or a scan by its draw; other seeds have no draws."""
    if key in ("scan.seed", "terrain.seed"):
        return (key, first_seed), (key.removesuffix("seed") + "draw", repeat)
    return ((key, first_seed + repeat - 1),)


def _uniform(first_seed, key, component, repeat):
    """A number in (0, 1) that depends on nothing but the arguments."""
    digest = hashlib.sha256(f"{first_seed}/{key}/{component}/{repeat}".encode()).digest()
    return ((int.from_bytes(digest[:8], "big") >> 11) + 0.5) / 2 ** 53


def _drawn(draw, first_seed, key, repeat):
    if "uniform" in draw:
        low, high = draw["uniform"]
        return _rounded(low + (high - low) * _uniform(first_seed, key, 0, repeat))
    sigmas = draw["normal"] if isinstance(draw["normal"], list) else [draw["normal"]]
    normal = statistics.NormalDist()
    values = [_rounded(sigma * normal.inv_cdf(_uniform(first_seed, key, component, repeat)))
              for component, sigma in enumerate(sigmas)]
    return values if isinstance(draw["normal"], list) else values[0]


def _draw_columns(key, values):
    """Columns that show what was drawn and set nothing: the repeat's own points do."""
    unit = unit_of(key)
    label = without_unit(key, unit)
    if not isinstance(values[0], list):
        return [Axis(key, label, unit, False, tuple(Point(value, ()) for value in values), "drawn")]
    return [Axis(f"{key}.{i}", f"{label}.{i}", unit, False, tuple(Point(value[i], ()) for value in values), "drawn")
            for i in range(len(values[0]))]
