#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Names of cases by the values of their axes, in the plan, in logs and in the order of metrics."""
import itertools
import os
import sys
import unittest

sys.path.insert(0, os.path.join(os.environ["LANDFALL_ROOT"], "python"))
# pylint: disable=wrong-import-position
from landfall.study import model, names


def axis(label, dimension, unit="", role="axis", numeric=True):
    return {"name": label, "label": label, "unit": unit, "role": role, "numeric": numeric, "dimension": dimension}


class Numbers(unittest.TestCase):
    def test_as_few_digits_as_tell_values_apart(self):
        for values, digits in (([0.005, 0.016666666666666666, 0.05], 3), ([1.0001, 1.0002], 5), ([1, 2], 3), (["a", "b"], 3),
                               ([0.1, 0.1 + 2e-17], 17), ([1 / 3, 0.3333333333333], 14), ([1234.1, 1234.2], 5)):
            self.assertEqual(names.digits_of(values), digits, values)

    def test_texts(self):
        for value, digits, text in ((0.016666666666666666, 3, "0.0167"), (4000, 3, "4,000"), (1234.56, 3, "1,235"), (1234.56, 6, "1,234.56"),
                                    (1234.5, 6, "1,234.5"), (1e8, 3, "1e+08"), (0, 3, "0"), (-0.25, 3, "-0.25"), ("FSM", 3, "FSM"), (True, 3, "True")):
            self.assertEqual(names.number(value, digits), text)
        self.assertEqual([names.with_unit(1, "bins"), names.with_unit(2, "bins"), names.with_unit(2, "1")], ["1 bin", "2 bins", "2"])

    def test_a_label_has_no_unit_where_the_unit_is_beside_it(self):
        for name, unit, label in (("range_sigma_m", "m", "range sigma"), ("pulse_rate_hz", "Hz", "pulse rate"), ("dropout_frac", "1", "dropout frac"),
                                  ("rows", "", "rows"), ("lines_px", "px", "lines"), ("range_sigma_m", "", "range sigma m")):
            self.assertEqual(model.label_of(name, unit), label)


class Cases(unittest.TestCase):
    """2 x 2 x 3 cases, with what each repeat draws."""

    def setUp(self):
        axes = [axis("noise", 0, "m"), axis("lines", 1), axis("kind", 1, numeric=False), axis("repeat", 2, role="repeat"), axis("x", 2, role="drawn")]
        rows = [[noise, lines, {7: "FSM", 9: "flash"}[lines], repeat, 0.1 * repeat, "metrics/a.json"]
                for noise, lines, repeat in itertools.product((0, 1 / 60), (7, 9), (1, 2, 3))]
        self.names = names.CaseNames(axes, rows)

    def test_one_case(self):
        self.assertEqual(self.names.of(8), "noise 0.0167 m, lines 7, kind FSM, repeat 3")
        self.assertEqual(names.CaseNames([], [["metrics/a.json"]]).of(0), "the only case")

    def test_what_cases_have_in_common(self):
        for cases, name in ((range(12), "all cases"), (range(6, 12), "noise 0.0167 m"), ([3, 4, 5, 9, 10, 11], "lines 9, kind flash"), ([2, 8], "lines 7, kind FSM, repeat 3"),
                            ([0, 1, 6, 7], "lines 7, kind FSM, repeat 1 or 2"), ([5], "noise 0 m, lines 9, kind flash, repeat 3")):
            self.assertEqual(self.names.of_cases(cases), name)

    def test_cases_that_have_nothing_in_common(self):
        """Each value of each axis, and not all cases."""
        self.assertEqual(self.names.of_cases([0, 4, 11]),
                         "noise 0 m, lines 7, kind FSM, repeat 1; noise 0 m, lines 9, kind flash, repeat 2; noise 0.0167 m, lines 9, kind flash, repeat 3")
        self.assertRegex(self.names.of_cases([0, 1, 2, 3, 4]), "; noise 0 m, lines 7, kind FSM, repeat 3 and 2 more cases$")

    def test_many_values(self):
        by_seed = names.CaseNames([axis("seed", 0), axis("noise", 1)], [[seed, noise] for seed in range(10) for noise in (0, 1)])
        self.assertEqual(by_seed.of_cases(range(0, 8, 2)), "4 values of seed, noise 0")

    def test_a_name_is_one_line(self):
        self.assertEqual(names.CaseNames([axis("a\nb", 0)], [[1], [2]]).of(0), "a?b 1")


if __name__ == "__main__":
    unittest.main()
