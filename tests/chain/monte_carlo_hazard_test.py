#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""monte-carlo with hazards, and over several scans: each draw is the chain's, and the verdicts are those of its columns."""
import json
import os
import unittest

import numpy as np

import monte_carlo_test as base
from harness import HAZARD, Chain, columns, read_bytes, with_values

VARY = {"scan.noise.range_sigma_m": {"type": "uniform", "low": 0, "high": 0.1}}
OUTCOMES = {"known": (0, 1, 2, 3), "judged_safe": (1, 2), "missed": (2,)}


def draws_config(**values):
    return base.draws_config(draws=4, vary=VARY, hazard=HAZARD, metrics="verdict", **values)


class Hazards(base.DrawsTest):
    def hazards_of_draw(self, config, rows, draw):
        """Score and sites of hazard-map on the DEM of the draw, and its layer outcome."""
        self.chain_draw(config, draw, {key: rows[key][draw] for key in VARY})
        out = {name: self.path(name) for name in ("score.json", "sites.json", "h.h5")}
        self.succeed("hazard-map", self.path("d.h5"), "--terrain", self.chain.terrain, "-c", self.config(config["hazard"], "h.json"), "-O",
                     "--score", out["score.json"], "--sites", out["sites.json"], "-o", out["h.h5"])
        score, sites = (json.loads(read_bytes(out[name])) for name in ("score.json", "sites.json"))
        return score, sites["sites"], columns(out["h.h5"])["outcome"]

    def test_each_draw_is_that_of_the_chain(self):
        """Small holes are filled with the terrain's elevations, in some draws in the judged region."""
        config = draws_config(scan={"noise": {"dropout_frac": 0.3}})
        rows = self.draws(config)
        counts = {name: 0 for name in OUTCOMES}
        for draw in range(4):
            score, sites, outcome = self.hazards_of_draw(config, rows, draw)
            expected = {**base.flat(score, "score"), **base.flat({key: value for key, value in sites[0].items() if key != "rank"}, "site")}
            expected.pop("score.version")
            self.assertEqual({name for name in rows if name.split(".")[0] in ("score", "site")}, set(expected))
            for name, value in expected.items():
                np.testing.assert_array_equal(rows[name][draw], value, name)
            for name, values in OUTCOMES.items():
                counts[name] = counts[name] + np.isin(outcome, values)
        self.assertGreater(len(set(rows["score.missed_hazard_frac"])), 1)
        self.assertTrue(counts["missed"].any())
        layers = columns(self.path("draws.h5"))
        with np.errstate(invalid="ignore"):
            for name, layer in (("judged_safe", "p_judged_safe"), ("missed", "p_missed_hazard")):
                np.testing.assert_array_equal(layers[layer], (counts[name] / counts["known"]).astype(np.float32))
        verdict = self.verdict()["hazard"]
        self.assertEqual(verdict["draws_with_site"], 4)
        self.assertEqual(verdict["chosen_place_safe"]["passed"], int((rows["site.true_safe"] == 1).sum()))
        self.assertAlmostEqual(verdict["missed_hazard_frac_mean"], rows["score.missed_hazard_frac"].mean(), places=15)

    def test_metrics_do_not_change(self):
        for metrics in ("full", "verdict"):
            rows = self.draws({**draws_config(), "metrics": metrics})
            without = self.draws({**draws_config(), "metrics": metrics, "hazard": None})
            for name, values in without.items():
                np.testing.assert_array_equal(rows[name], values, name)

    def test_threads_and_parts(self):
        self.draws(draws_config(), "-t", 1, output="whole.h5")
        whole = read_bytes(self.path("whole.h5"))
        self.draws(draws_config(), "-t", 7)
        self.assertEqual(read_bytes(self.path("draws.h5")), whole)
        for part in ("0:1", "1:4"):
            self.draws(draws_config(), "--draws", part, output=f"{part[0]}.h5")
        self.succeed("monte-carlo", "merge", self.path("0.h5"), self.path("1.h5"), "-o", self.path("merged.h5"))
        self.assertEqual(read_bytes(self.path("merged.h5")), whole)

    def test_no_safe_place(self):
        rows = self.draws({**draws_config(), "hazard": with_values(HAZARD, limits__slope_deg=1e-3)})
        for name, values in rows.items():
            if name.startswith("site."):
                self.assertTrue(np.isnan(values).all(), name)
        verdict = self.verdict()["hazard"]
        self.assertEqual((verdict["draws_with_site"], verdict["chosen_place_safe"]["passed"]), (0, 0))

    def test_draws_with_nothing_to_judge_count(self):
        """A draw whose map has no place that can be judged has no site and no score, and the run of draws continues."""
        config = {**draws_config(), "hazard": with_values(HAZARD, region_radius_m=1)}
        config["vary"] = {**config.get("vary", {}), "scan.noise.dropout_frac": {"type": "list", "values": [0.05, 0.995, 0.05, 0.995]}}
        config["draws"] = 4
        rows = self.draws(config)
        known = sum(np.asarray(values) for name, values in rows.items() if name.startswith("score.counts.") and not name.endswith("unknown"))
        self.assertEqual(list(known > 0), [True, False, True, False])
        self.assertTrue((np.asarray(rows["score.counts.unknown"])[1::2] == np.max(known + rows["score.counts.unknown"])).all())
        self.assertTrue(np.isnan(rows["site.p_touchdown"][1::2]).all() and np.isnan(rows["score.missed_hazard_frac"][1::2]).all())
        self.assertEqual(self.verdict()["hazard"]["draws_with_site"], int(np.isfinite(rows["site.p_touchdown"]).sum()))

    def test_table_and_report(self):
        result = base.run("monte-carlo", *self.arguments(draws_config(), "draws.h5", "--table", "--report", self.path("draws.html")))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stdout, r"chosen_place_safe +\d of 4")
        page = read_bytes(self.path("draws.html")).decode()
        self.assertIn("chosen place truly safe", page)
        self.assertIn("p_missed_hazard", page)

    def test_bad_hazards(self):
        def refuse(hazard, *words):
            self.refuse(2, "monte-carlo", *self.arguments({**draws_config(), "hazard": hazard}, "no.h5"), words=["mc.json: /hazard", *words])
        refuse({"lander": {"legs": 5}}, "/lander/legs")
        refuse({"landers": 1}, "landers")
        refuse(with_values(HAZARD, lander__body_radius_m=5.2), "/lander/body_radius_m", "101 x 101")
        refuse(3)


class Pairs(base.DrawsTest):
    CONFIG = base.draws_config(draws=3, vary=VARY, metrics="verdict")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.other = Chain(**cls.CHANGES, seed=91, trajectory__position_m=[0.4, -0.2, 49])

    @classmethod
    def tearDownClass(cls):
        cls.other.remove()
        super().tearDownClass()

    def pairs(self):
        return ["--pair", f"{self.chain.scan}:{self.chain.terrain}", "--pair", f"{self.other.scan}:{self.other.terrain}"]

    def over_pairs(self, config, output, *options):
        self.succeed("monte-carlo", *self.pairs(), "-c", self.config(config, "mc.json"), "-o", self.path(output), "-O", *options)
        return columns(self.path(output), "draws")

    def test_rows_and_verdicts_are_those_of_each(self):
        config = {**self.CONFIG, "hazard": HAZARD}
        rows = self.over_pairs(config, "both.h5")
        both = self.verdict("both.h5")
        self.assertEqual(list(rows["pair"]), [0, 0, 0, 1, 1, 1])
        self.assertNotIn("p_invalid", columns(self.path("both.h5")))
        for pair, chain in enumerate((self.chain, self.other)):
            alone = self.draws({**config, "layers": False}, scan=chain.scan, output="alone.h5")
            for name, values in alone.items():
                np.testing.assert_array_equal(rows[name][3 * pair:3 * pair + 3], values, name)
            verdict = self.verdict("alone.h5")
            self.assertEqual(both["pairs"][pair], {"pair": pair, "rates": verdict["rates"], "hazard": verdict["hazard"]})
        self.assertIn("for these terrains", both["note"])
        for pooled, *each in zip(both["rates"], *(pair["rates"] for pair in both["pairs"])):
            for key in ("passed", "draws"):
                self.assertEqual(pooled[key], sum(rate[key] for rate in each))

    def test_one_pair_gives_draws_with_maps(self):
        self.draws(self.CONFIG)
        self.succeed("monte-carlo", *self.pairs()[:2], "-c", self.path("mc.json"), "-o", self.path("pair.h5"))
        self.assertEqual(read_bytes(self.path("pair.h5")), read_bytes(self.path("draws.h5")))

    def test_parts_and_state(self):
        self.over_pairs(self.CONFIG, "whole.h5")
        whole = read_bytes(self.path("whole.h5"))
        for first, end in ((0, 2), (2, 4), (4, 6)):
            self.over_pairs(self.CONFIG, f"{first}.h5", "--draws", f"{first}:{end}")
        self.succeed("monte-carlo", "merge", *(self.path(f"{first}.h5") for first in (4, 0, 2)), "-o", self.path("merged.h5"))
        self.assertEqual(read_bytes(self.path("merged.h5")), whole)
        self.over_pairs(self.CONFIG, "begin.h5", "--draws", "0:4")
        os.replace(self.path("begin.h5"), self.path(".again.h5.state"))
        result = base.run("monte-carlo", *self.pairs(), "-c", self.path("mc.json"), "-o", self.path("again.h5"), "-v")
        self.assertIn("resumes after 4 draws", result.stderr)
        self.assertEqual(read_bytes(self.path("again.h5")), whole)
        self.refuse(2, "monte-carlo", *self.pairs(), "-c", self.path("mc.json"), "-o", self.path("no.h5"), "--draws", "0:7", words=["6 draws"])

    def test_table_and_report(self):
        result = base.run("monte-carlo", *self.pairs(), "-c", self.config(self.CONFIG, "mc.json"), "-o", self.path("both.h5"), "--table",
                          "--report", self.path("both.html"))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stdout, r"(?s)pair 0\n.*pair 1\n.*all pairs, for these terrains\n.*all +\d of 6")
        self.assertIn("all pairs, for these terrains", read_bytes(self.path("both.html")).decode())

    def test_refusals(self):
        out = ["-c", self.config(self.CONFIG, "mc.json"), "-o", self.path("no.h5")]
        self.refuse(2, "monte-carlo", "--pair", self.chain.scan, *out, words=["--pair", "SCAN:TERRAIN"])
        self.refuse(2, "monte-carlo", self.chain.scan, *self.pairs(), *out, words=["--pair", "omit"])
        self.refuse(2, "monte-carlo", *self.pairs(), "--terrain", self.chain.terrain, *out, words=["--pair", "omit --terrain"])
        self.refuse(2, "monte-carlo", *self.pairs(), *out, "--set", 'stop={"type":"sprt"}', words=["mc.json: /stop", "--pair gives 2"])
        self.refuse(2, "monte-carlo", *self.pairs(), *out, "--set", "sigma=true", words=["/sigma", "/layers"])
        self.refuse(1, "monte-carlo", *self.pairs()[:2], "--pair", f"{self.other.scan}:{self.path('none.h5')}", *out, words=["none.h5"])


if __name__ == "__main__":
    unittest.main()
