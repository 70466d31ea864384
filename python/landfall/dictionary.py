# SPDX-License-Identifier: GPL-3.0-or-later
"""The words of requirements, layers, maps and metrics that all tools share (schemas/dictionary)."""
import functools
import os
import re
from dataclasses import dataclass

from landfall import schema, tools

# Results of the user's own requirements, in metrics.json and score.json: the columns of each begin with its path.
_OWN = r"((?:score\.)?own_requirements\.([^.]+))"
OWN_PASS, OWN_METRIC, OWN_NUMBER = (re.compile(_OWN + end) for end in (r"\.pass", r"\.metric", r"\.(?:value|limit)"))


def own_paths(columns):
    """{name: path of its columns} of the user's own requirements; of one name that both files have, the score's has the path as name."""
    paths = {}
    for found in filter(None, map(OWN_PASS.fullmatch, columns)):
        paths[found[1] if found[2] in paths else found[2]] = found[1]
    return paths


@functools.cache
def table(name):
    return schema.read_json(os.path.join(tools.SHARE, "schemas", "dictionary", f"{name}.json"))


def stages():
    """{name: row} of the stages of a study, in their order."""
    return {stage["name"]: stage for stage in table("stages")["stages"] if "study" in stage["part_of"]}


@dataclass(frozen=True)
class Requirement:
    """`value`: its metric, empty for a sum of two; `worst`: the metrics of which the largest uses up eval.limits.`worst_limit`."""

    name: str
    measured: str
    unit: str
    at_least: bool
    value: str
    worst: list
    worst_limit: str
    text: str
    limit: str = ""
    footprints: str = ""

    @property
    def _unit(self):
        return next(unit for unit in table("requirements")["units"] if unit["name"] == self.unit)

    @property
    def words(self):
        return self.name.replace("_", " ")

    @property
    def bound(self):
        return "at least" if self.at_least else "at most"

    @property
    def measured_in(self):
        """The measured quantity and its unit; footprints say it themselves."""
        name = self._unit["shown"]
        return self.measured if name in self.measured else f"{self.measured} ({name})"

    @property
    def factor(self):
        return self._unit["factor"]

    @property
    def is_whole(self):
        return self._unit.get("is_whole", False)

    @property
    def stored_unit(self):
        """That of its value in files."""
        return self._unit["stored"]


@functools.cache
def requirements():
    """{name: Requirement} in the order of metrics.json."""
    return {entry["name"]: Requirement(**entry) for entry in table("requirements")["requirements"]}


def fail_bit(name):
    """The bit of a flag of the layer `fail`."""
    return next(flag["bit"] for flag in table("requirements")["fail_flags"] if flag["name"] == name)


def layers(file):
    """The rows of the layers of a kind of file ("dem", "evaluation", ...), in the order of the dictionary."""
    return [layer for layer in table("layers")["layers"] if layer["file"] == file]


def layer_limit(name):
    """The key of eval.limits that the scale of a layer of an evaluation shows; None of most."""
    return next(layer.get("limit") for layer in layers("evaluation") if layer["name"] == name)


def place_classes(layer):
    """{value: (name, colour)} of `safe` or `outcome`, from the worst to the best."""
    return {entry["value"]: (entry["name"], entry["color"]) for entry in table("maps")["place_classes"] if entry["layer"] == layer}
