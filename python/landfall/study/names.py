# SPDX-License-Identifier: GPL-3.0-or-later
"""Names of cases by the values of their axes, "range noise 0.0167 m, repeat 3", and the texts of numbers and units."""
import math

from landfall.numbers import FEWEST_DIGITS, number, with_unit

MAX_VALUES = 3  # of an axis that a name lists
MAX_CASES = 3  # that are named one by one
MAX_DIGITS = 17


def titled(label, unit):
    """The label of an axis or a column with its unit in brackets."""
    return f"{label} [{unit}]" if unit not in ("", "1") else label


def digits_of(values):
    """The fewest digits, and no fewer than 3, by which all the numbers differ; 3 where some are no numbers."""
    if not all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in values):
        return FEWEST_DIGITS
    different = len(set(values))
    return next((digits for digits in range(FEWEST_DIGITS, MAX_DIGITS)
                 if len({number(value, digits) for value in values}) == different), MAX_DIGITS)


def counted(count, noun):
    return f"{count:,} {noun}" + ("" if count == 1 else "s")


class CaseNames:
    """Names of a study's cases: `axes` as in cases.json, `rows` with a value of each axis. What a repeat draws is not named."""

    def __init__(self, axes, rows):
        self._rows = rows
        self._named = [index for index, axis in enumerate(axes) if axis["role"] != "drawn"]
        self._axes = axes
        self._values = {index: list(dict.fromkeys(row[index] for row in rows)) for index in self._named}
        self._digits = {index: digits_of(values) for index, values in self._values.items()}

    def of(self, case):
        """The name of one case; "the only case" of a study that has no other."""
        row = self._rows[case]
        return self._printable(", ".join(self._part(index, [row[index]]) for index in self._named)) or "the only case"

    def of_cases(self, cases):
        """The name of several cases by what they have in common, by their numbers: "all cases", "range noise 0.0167 m", or some of their names."""
        cases = list(cases)
        if len(cases) == 1:
            return self.of(cases[0])
        if len(cases) == len(self._rows):
            return "all cases"
        if not self._is_product(cases):
            rest = f" and {counted(len(cases) - MAX_CASES, 'more case')}" if len(cases) > MAX_CASES else ""
            return "; ".join(map(self.of, cases[:MAX_CASES])) + rest
        parts = []
        for index in self._named:
            values = list(dict.fromkeys(self._rows[case][index] for case in cases))
            if len(values) < len(self._values[index]):
                parts.append(self._part(index, values))
        return self._printable(", ".join(parts))

    def _is_product(self, cases):
        """Whether the cases are all combinations of some values of each dimension."""
        dimensions = {}  # axes of a zip share one
        for index in self._named:
            dimensions.setdefault(self._axes[index].get("dimension", f"axis {index}"), []).append(index)
        return len(cases) == math.prod(len({tuple(self._rows[case][index] for index in members) for case in cases})
                                       for members in dimensions.values())

    def _part(self, index, values):
        """ "LABEL VALUE UNIT"."""
        axis, digits = self._axes[index], self._digits[index]
        if len(values) > MAX_VALUES:
            return f"{len(values)} values of {axis['label']}"
        texts = [*(number(value, digits) for value in values[:-1]), with_unit(values[-1], axis["unit"], digits)]
        return f"{axis['label']} " + " or ".join(texts)

    @staticmethod
    def _printable(text):
        return "".join(character if character.isprintable() else "?" for character in text)
