#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Inputs that monte-carlo refuses: each message names file, place and bound; nothing is written and nothing is lost."""
import json
import unittest

import h5py
import numpy as np

from harness import EVAL, REGRID, MonteCarloTest, as_of_0_2_0, read_bytes

DROPOUT = "scan.noise.dropout_frac"
BIAS = "scan.noise.range_bias_m"


class FaultsTest(MonteCarloTest):
    def arguments(self, *options, scan=None, terrain=None, **values):
        config = {"draws": 3, "regrid": {**REGRID, "resolution_m": 0.2}, "eval": EVAL, **values}
        return [scan or self.chain.scan, "--terrain", terrain or self.chain.terrain, "-c", self.config(config, "mc.json"), *options]

    def refuse_run(self, code, words, *options, **values):
        """With an old output and the state of an earlier run, which must stay as they are."""
        kept = {name: self.config("old " + name, name) for name in ("draws.h5", ".draws.h5.state")}
        self.refuse(code, "monte-carlo", *self.arguments("-O", "-o", kept["draws.h5"], *options, **values), words=words)
        for name, path in kept.items():
            self.assertEqual(read_bytes(path), f"old {name}".encode(), words)

    def edited(self, source, edit, name="edited.h5"):
        return self.changed(source, edit, name)


class Samples(FaultsTest):
    def test_a_table_of_too_many_draws(self):
        self.refuse_run(1, ["samples.csv", "100001 rows", "at most 100000 draws"], "--samples",
                             self.config(BIAS + "\n" + 100001 * "0\n", "samples.csv"))

    def test_tables_in_hdf5(self):
        for code, words, columns in [
                (1, ["row 2", BIAS, "is not a finite number"], {BIAS: [0, np.nan]}),
                (1, [BIAS], {DROPOUT: [0, 0], BIAS: [0, 0, 0]}),
                (1, ["no row"], {BIAS: np.zeros(0)}),
                (1, [BIAS], {BIAS: np.zeros((2, 2))}),
                (1, ["no row"], {})]:
            with self.subTest(words):
                with h5py.File(self.path("samples.h5"), "w") as file:
                    for name, values in columns.items():
                        file[name] = values
                self.refuse_run(code, ["samples.h5", *words], "--samples", self.path("samples.h5"))


class Inputs(FaultsTest):
    def test_true_ranges(self):
        def change(value):
            def edit(file):
                file["points/range_true"][5] = value
            return edit
        for value in (-1.0, np.inf):  # NaN is a miss
            self.refuse_run(1, ["edited.h5: /points/range_true[5] is not a finite range >= 0"], scan=self.edited(self.chain.scan, change(value)))


class EditedParts(FaultsTest):
    """Parts with values that monte-carlo never writes."""

    def setUp(self):
        super().setUp()
        self.parts = [self.path("a.h5"), self.path("b.h5")]
        for span, path in zip(("0:2", "2:3"), self.parts):
            self.succeed("monte-carlo", *self.arguments("--draws", span, "-o", path))

    def refuse_part(self, words, edit, code=1):
        with self.subTest(words):
            part = self.edited(self.parts[0], edit)
            self.refuse(code, "monte-carlo", "merge", part, self.parts[1], "-o", self.path("out.h5"), words=["edited.h5", *words],
                        output=self.path("out.h5"))

    def test_sums(self):
        for name, value, words in [("invalid", 3, "3 is not in [0, 2]"), ("fail_rel_z", -1, "-1 is not in [0, 2]"),
                                   ("count", 2**62, "is not in [0, 4503599627370496]"), ("e_z_count", 2**31 - 1, "is not in [0, 2]"),
                                   ("e_map_sum", -2**63, "is not in [-140737488355328, 140737488355328]"),
                                   ("e_z_squares_high", 2**63 - 1, "is not in [0, 536870912]"), ("e_map_squares_high", -1, "-1 is not in")]:
            def edit(file, name=name, value=value):
                file["state"][name][7] = value
            self.refuse_part([f"/state/{name}", words], edit)

    def test_columns(self):
        def first(value):
            def edit(file):
                file["draws"].attrs["first_draw"] = value
            return edit
        for value in (-1, np.nan, 1e300, 2**17):
            self.refuse_part(["first_draw is not in [0, 131072)"], first(value))
        self.refuse_part(["first_draw"], lambda file: file["draws"].attrs.pop("first_draw"))

        def remove(name):
            return lambda file: file.__delitem__(name)
        self.refuse_part(["/draws", "requirements.coverage.pass"], remove("draws/requirements.coverage.pass"))
        self.refuse_part(["seed"], remove("draws/seed"))
        self.refuse_part(["e_z_sum"], remove("state/e_z_sum"))
        self.refuse_part(["z_true_map"], remove("z_true_map"))

        def shorten(file):
            del file["draws/pass"]
            file["draws/pass"] = np.zeros(1, np.int8)
        self.refuse_part(["pass"], shorten)

    def test_no_history(self):
        self.refuse_part(["does not say how it was made: /provenance is missing"], lambda file: file.__delitem__("provenance"))

    def test_other_columns(self):
        def remove(file):
            name = next(name for name in file["draws"] if not name.startswith("requirements") and name not in ("seed", "draw", "pass"))
            del file["draws"][name]
        part = self.edited(self.parts[0], remove)
        self.refuse(1, "monte-carlo", "merge", part, self.parts[1], "-o", self.path("out.h5"), words=["its columns or its grid are not those of"])


class OldDraws(FaultsTest):
    WORDS = ["version 0.2.0", "other random numbers"]

    def test_read_and_compared(self):
        self.succeed("monte-carlo", *self.arguments("-o", self.path("new.h5")))
        old = self.edited(self.path("new.h5"), as_of_0_2_0, "old.h5")
        self.assertIn("/draws (3)", self.succeed("landfall-info", old).stdout)
        for a, b in ((old, self.path("new.h5")), (self.path("new.h5"), old)):
            found = json.loads(self.succeed("landfall-info", "--compare", a, b, "--json").stdout)
            self.assertEqual(found["draws"], {"a": 3, "b": 3, "common": 1})  # draw 0 of the seed
            self.assertEqual({pair["both"] + pair["only_a"] + pair["only_b"] + pair["neither"] for pair in found["pairs"]}, {0, 1})  # 0: not judged
        self.assertEqual(json.loads(self.succeed("landfall-info", "--compare", old, old, "--json").stdout)["draws"]["common"], 3)

    def test_not_continued(self):
        self.succeed("monte-carlo", *self.arguments("-o", self.path("draws.h5")))
        state = self.edited(self.path("draws.h5"), as_of_0_2_0, ".again.h5.state")
        before = read_bytes(state)
        self.refuse(2, "monte-carlo", *self.arguments("-o", self.path("again.h5")), words=[".again.h5.state", *self.WORDS, "remove the file"],
                    output=self.path("again.h5"))
        self.assertEqual(read_bytes(state), before)


if __name__ == "__main__":
    unittest.main()
