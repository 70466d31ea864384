#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Study files: their meaning, and refusals that name the file, the key, the value and the bound."""
import contextlib
import io
import json
import math
import os
import statistics
import unittest

from case import BASE, LIMITS, RESOLUTIONS, ROOT, SIGMAS, StudyTest, study

# pylint: disable=wrong-import-order
from landfall import schema
from landfall.errors import UsageError
from landfall.study import model, reader


def axis(**keys):
    return study({"key": "scan.noise.range_sigma_m", **keys})


class Cases(StudyTest):
    def read(self, tree):
        return reader.read_study(self.write(tree))

    def values(self, tree):
        read = self.read(tree)
        return [read.values(indices) for indices in read.cases()]

    def config(self, tree, stage, number=0):
        read = self.read(tree)
        return model.configuration(read, stage, list(read.cases())[number])

    def test_axes_are_crossed_and_the_last_varies_fastest(self):
        self.assertEqual(self.values(study(SIGMAS, RESOLUTIONS)),
                         [[s, r] for s in (0.01, 0.02, 0.05) for r in (0.1, 0.2)])

    def test_a_study_without_axes_is_one_case(self):
        self.assertEqual(self.values(study()), [[]])

    def test_linspace_and_logspace(self):
        self.assertEqual(self.values(axis(linspace=[0, 0.3, 4])), [[0], [0.1], [0.2], [0.3]])
        self.assertEqual(self.values(axis(logspace=[0.001, 10, 5])), [[0.001], [0.01], [0.1], [1], [10]])
        (first,), (middle,), (last,) = self.values(axis(logspace=[3, 0.1, 3]))
        self.assertEqual((first, last), (3, 0.1))
        self.assertAlmostEqual(middle, math.sqrt(0.3), 11)

    def test_whole_numbers_are_integers(self):
        tree = study({"key": "scan.detector.rows", "linspace": [8, 16, 3]})
        self.assertEqual(self.config(tree, "scan", 1)["detector"]["rows"], 12)
        self.assertIsInstance(self.config(tree, "scan", 1)["detector"]["rows"], int)

    def test_a_zip_goes_together(self):
        both = {"zip": [SIGMAS, {"key": "scan.noise.dropout_frac", "values": [0, 0.1, 0.2]}]}
        self.assertEqual(self.values(study(both, LIMITS))[:3], [[0.01, 0, 0.05], [0.01, 0, 0.1], [0.02, 0.1, 0.05]])

    def test_several_keys_of_one_axis_get_its_value(self):
        tree = study({"key": ["terrain.grid.resolution_m", "regrid.resolution_m"], "values": [0.1, 0.2]})
        self.assertEqual(self.config(tree, "terrain", 1)["grid"], {"half_width_m": 6, "resolution_m": 0.2})
        self.assertEqual(self.config(tree, "regrid", 1)["resolution_m"], 0.2)

    def test_scale_makes_a_vector(self):
        tree = study({"name": "velocity", "key": "scan.navigation_error.velocity_mps", "values": [0, 2],
                      "scale": [0.25, 0.25, 0.5]})
        self.assertEqual(self.values(tree), [[0], [2]])
        self.assertEqual(self.config(tree, "scan", 1)["navigation_error"], {"velocity_mps": [0.5, 0.5, 1]})

    def test_variants_and_indices(self):
        tree = study({"name": "kind", "variants": {"low": {"scan.trajectory.position_m.2": 40},
                                                   "flash": {"scan.scanner": {"type": "flash"}, "eval.quantile": 0.9}}})
        self.assertEqual(self.values(tree), [["low"], ["flash"]])
        self.assertEqual(self.config(tree, "scan", 0)["trajectory"]["position_m"], [0, 0, 40])
        self.assertEqual(self.config(tree, "scan", 1)["scanner"], {"type": "flash"})
        self.assertEqual(self.config(tree, "eval", 1)["quantile"], 0.9)
        self.assertEqual(self.config(tree, "scan", 1)["trajectory"], BASE["scan"]["trajectory"])

    def test_elements_of_arrays_that_are_defaults(self):
        """As --set does: the rest of the array is the default, here of the trajectory that a scan has by default."""
        tree = study({"key": "scan.trajectory.position_m.2", "values": [300, 400]})
        tree["base"]["scan"] = {key: value for key, value in BASE["scan"].items() if key != "trajectory"}
        self.assertEqual(self.config(tree, "scan", 0)["trajectory"], {"position_m": [0, 0, 300]})
        tree["axes"] = [{"key": "scan.navigation_error.velocity_mps.0", "values": [0.1]}]
        self.assertEqual(self.config(tree, "scan", 0)["navigation_error"], {"velocity_mps": [0.1, 0, 0]})
        tree["axes"][0]["key"] = "scan.trajectory.velocity_mps.3"
        with self.assertRaisesRegex(UsageError, r'"3" is not an index into \[0, 0, -23\]'):
            self.config(tree, "scan", 0)

    def test_objects_are_named_by_labels(self):
        tree = study({"key": "scan.scanner", "values": [BASE["scan"]["scanner"], {"type": "flash"}], "labels": ["FSM", "flash"]})
        self.assertEqual(self.values(tree), [["FSM"], ["flash"]])

    def test_a_stage_without_a_key_replaces_its_configuration(self):
        os.mkdir(self.path("other"))
        self.write({"scanner": {"type": "flash"}}, "other/flash.scan")
        tree = study({"name": "lidar", "variants": {"flash": {"scan": "other/flash.scan.json"}}})
        self.assertEqual(self.config(tree, "scan"), {"scanner": {"type": "flash"}})

    def test_a_configuration_may_be_a_list_that_is_merged(self):
        """As in a chain file: presets, files and objects; null removes a key."""
        self.write({"noise": {"range_sigma_m": 0.5, "dropout_frac": 0.1}}, "noisy.scan")
        parts = ["preset:paper", "noisy.scan.json", {"noise": {"dropout_frac": None}, "seed": 3}]
        tree = study({"name": "lidar", "variants": {"base": {"eval.quantile": 0.9}, "noisy": {"scan": parts[1:]}}})
        tree["base"]["scan"] = parts
        paper, scan = model.read_config("preset:paper", "scan", "."), self.config(tree, "scan")
        self.assertEqual(scan["noise"], {**paper.pop("noise"), "range_sigma_m": 0.5})
        self.assertEqual({key: scan[key] for key in ("seed", *paper)}, {**paper, "seed": 3})
        self.assertEqual(self.config(tree, "scan", 1), {"noise": {"range_sigma_m": 0.5}, "seed": 3})
        self.assertIn(self.path("noisy.scan.json"), self.read(tree).files)

    def test_list_is_an_old_name_of_values(self):
        with contextlib.redirect_stderr(io.StringIO()) as messages:
            old = self.values(study({"zip": [{"key": "scan.seed", "list": [1, 2]}, {"key": "eval.quantile", "list": [0.8, 0.9]}]}))
        self.assertEqual(old, [[1, 0.8], [2, 0.9]])
        self.assertEqual(messages.getvalue(), f'landfall study: warning: {self.path("tiny.json")}: /axes/0/zip/0/list: "list" is an old name; write "values"\n')

    def test_data_paths_are_relative_to_their_file(self):
        os.mkdir(self.path("data"))
        self.write({"trajectory": {"type": "table", "path": "way.csv"}}, "data/scan")
        self.write("", "data/way")
        os.rename(self.path("data/way.json"), self.path("data/way.csv"))
        tree = study(set={"scan.seed": 3})
        tree["base"]["scan"] = "data/scan.json"
        self.assertEqual(self.config(tree, "scan"),
                         {"trajectory": {"type": "table", "path": self.path("data/way.csv")}, "seed": 3})

    def test_a_byte_order_mark_is_skipped(self):
        """At the start of a study and of a file that it names; a position is counted without it."""
        self.write("\ufeff" + json.dumps({"seed": 7}), "marked.scan")
        with_mark = {"base": {"scan": "marked.scan.json"}, "title": "T"}
        read = reader.read_study(self.write("\ufeff" + json.dumps(with_mark)))
        self.assertEqual((read.title, read.base["scan"]), ("T", {"seed": 7}))
        with self.assertRaisesRegex(UsageError, "a NUL byte at line 1, column 3"):
            reader.read_study(self.write("\ufeff{}\0"))

    def test_comments_are_skipped(self):
        """As the tools do; what looks like a comment in a string is text, and a position is counted with comments."""
        self.write('// seven\n{"seed": 7 /* a\nprime */}', "remarks.scan")
        read = reader.read_study(self.write('{"base": {"scan": "remarks.scan.json"}, // see "there"\n "title": "a // b /* \\"c\\" */"}'))
        self.assertEqual((read.title, read.base["scan"]), ('a // b /* "c" */', {"seed": 7}))
        for text, place in (("/* {\n*/ [1 2]", "line 2 column 7"), ("{} /* open", "line 1 column 4"), ("{} / x", "line 1 column 4")):
            with self.assertRaisesRegex(UsageError, f"not JSON: .*{place}"):
                reader.read_study(self.write(text))

    def test_presets(self):
        tree = study({"name": "lidar", "variants": {"ours": {"scan.seed": 1}, "flash": {"scan": "preset:flash-256"}}})
        tree["base"]["terrain"] = "preset:paper"
        self.assertEqual(self.config(tree, "terrain")["patterns"][0]["type"], "ring")
        self.assertEqual(self.config(tree, "scan", 1)["detector"]["rows"], 256)

    def test_repeats_have_the_same_seeds_at_every_point(self):
        tree = study(RESOLUTIONS, repeat={"count": 3, "first_seed": 11, "seeds": ["scan.seed", "terrain.seed"]})
        self.assertEqual(self.values(tree), [[r, n] for r in (0.1, 0.2) for n in (1, 2, 3)])
        for number in range(6):
            for stage in ("scan", "terrain"):
                self.assertEqual([self.config(tree, stage, number)[key] for key in ("seed", "draw")], [11, 1 + number % 3])

    def test_a_seed_without_draws_counts(self):
        key = "terrain.features.0.seed"
        tree = study(set={"terrain.features": [{"type": "penitente_field", "seed": 1}]}, repeat={"count": 2, "first_seed": 11, "seeds": [key]})
        self.assertEqual([self.config(tree, "terrain", number)["features"][0]["seed"] for number in (0, 1)], [11, 12])

    def test_draws_depend_on_seed_key_and_repeat_only(self):
        key, other = "scan.navigation_error.velocity_mps", "scan.navigation_error.position_m"
        few = study(repeat={"count": 3, "draws": {key: {"normal": [0.1, 0.1, 0.2]}}})
        more = study(SIGMAS, repeat={"count": 5, "draws": {other: {"normal": [1, 1, 1]}, key: {"normal": [0.1, 0.1, 0.2]}}})
        for number in range(3):
            self.assertEqual(self.config(few, "scan", number)["navigation_error"]["velocity_mps"],
                             self.config(more, "scan", 5 + number)["navigation_error"]["velocity_mps"])
        self.assertEqual([a.name for a in self.read(few).axes()], ["repeat", key + ".0", key + ".1", key + ".2"])
        drawn = self.config(few, "scan", 2)["navigation_error"]["velocity_mps"]
        self.assertEqual(self.values(few)[2], [3, *drawn])

    def test_draws_have_their_distribution(self):
        """4,000 draws: mean and standard deviation are within 4 of their standard errors (exceeded with probability 1e-4 each)."""
        draws = {"scan.noise.range_bias_m": {"normal": 2}, "scan.noise.dropout_frac": {"uniform": [0.25, 0.5]}}
        rows = self.values(study(repeat={"count": 4000, "draws": draws}))
        normal, uniform = [row[1] for row in rows], [row[2] for row in rows]
        self.assertLess(abs(statistics.fmean(normal)), 4 * 2 / math.sqrt(4000))
        self.assertLess(abs(statistics.stdev(normal) - 2), 4 * 2 / math.sqrt(8000))
        self.assertTrue(0.25 < min(uniform) < 0.251 and 0.499 < max(uniform) < 0.5)
        self.assertLess(abs(statistics.fmean(uniform) - 0.375), 4 * 0.25 / math.sqrt(12 * 4000))
        self.assertGreater(min(abs(a - b) for a, b in zip(normal, normal[1:])), 0)

    def test_units_follow_from_names(self):
        tree = study(SIGMAS, {"key": "scan.laser.pulse_rate_hz", "values": [2000]}, {"key": "scan.detector.rows", "values": [8]},
                     {**LIMITS, "unit": "furlong", "label": "limit", "log": True})
        axes = self.read(tree).axes()
        self.assertEqual([(a.name, a.unit) for a in axes],
                         [("range_sigma_m", "m"), ("pulse_rate_hz", "Hz"), ("rows", ""), ("relative_elevation_m", "furlong")])
        self.assertEqual((axes[3].label, axes[3].log), ("limit", True))


# (study, words of the message). /x is the path of the key.
BAD = [
    ("{", ["not JSON"]),
    ('{"name": "a", "name": "b"}', ['"name"', "twice"]),
    ('{"set": {"scan.seed": NaN}}', ["NaN"]),
    ('{"set": {"scan.noise.range_sigma_m": 1e999}}', ["1e999"]),
    ("[]", ["[]", "is of type array, not object"]),
    ({"axis": []}, ["/axis", "unknown key; known: ", "axes"]),
    ("{}\0", ["not JSON: a NUL byte at line 1, column 3"]),
    ('{\n "title": "a\0b"}', ["not JSON: a NUL byte at line 2, column 13"]),
    ('{"title":\ufeff"a"}', ["not JSON: Expecting value: line 1 column 10"]),
    ({"name": "a b"}, ["/name", '"a b"', "does not match"]),
    ({"base": {"lidar": {}}}, ["/base/lidar", "unknown key", "terrain, scan, regrid, eval"]),
    ({"base": {"scan": 3}}, ["/base/scan", "3 is of type integer, not object or string or array"]),
    ({"base": {"scan": "nowhere.json"}}, ["/base/scan", "nowhere.json", "No such file"]),
    ({"base": {"scan": "preset:papr"}}, ["/base/scan", "presets/papr.scan.json: No such file"]),
    ({"set": {"lidar.seed": 1}}, ["/set/lidar.seed", "does not match"]),
    ({"set": {"scan.seed.x": 1}, "base": {"scan": {"seed": 4}}}, ["/set/scan.seed.x", '"x" cannot be set in 4']),
    ({"set": {"scan.a.3": 1}, "base": {"scan": {"a": [1, 2]}}}, ["/set/scan.a.3", '"3" is not an index into [1, 2]']),
    ({"set": {"scan": 3}}, ["/set/scan", "3 is not a configuration"]),
    ({"axes": [{"key": "scan.seed"}]}, ["/axes/0", "none of values, linspace"]),
    (axis(values=[1], linspace=[0, 1, 2]), ["/axes/0", "values and linspace"]),
    (axis(values=[]), ["/axes/0/values", "an array of 0 elements; expected at least 1"]),
    (axis(values=[1, 2, 1]), ["axis range_sigma_m", "value 1 twice"]),
    (axis(values=[1], label=3), ["/axes/0/label", "3 is of type integer, not string"]),
    (axis(values=[1], lable="x"), ["/axes/0/lable", "unknown key; known: ", "label"]),
    (axis(values=[1, 2], labels=["a"]), ["/axes/0/values", "2 entries and 1 labels"]),
    (axis(linspace=[0, 1, 2], labels=["a", "b"]), ["/axes/0/labels", "does not go with linspace"]),
    (axis(linspace=[0, 1]), ["/axes/0/linspace", "an array of 2 elements; expected 3"]),
    (axis(linspace=[0, 1, 2.5]), ["/axes/0/linspace/2", "2.5 is not an integer in [2, 1000000]"]),
    (axis(linspace=[0, 1, 1]), ["/axes/0/linspace/2", "1 is not an integer in [2, 1000000]"]),
    (axis(linspace=[0, 1, 1e300]), ["/axes/0/linspace/2", "1e+300 is not an integer in"]),
    (axis(linspace=[0, "1", 2]), ["/axes/0/linspace/1", '"1" is of type string, not number']),
    (axis(linspace=[2, 2, 3]), ["axis range_sigma_m", "value 2 twice"]),
    (axis(logspace=[0, 1, 3]), ["/axes/0/logspace", "0 is not above 0"]),
    (axis(values=[{"a": 1}]), ["/axes/0/values/0", "needs a name in \"labels\""]),
    (axis(values=["a"], scale=2), ["/axes/0/values/0", '"a" is not a number and cannot be scaled']),
    (study({"key": "noise.sigma", "values": [1]}), ["/axes/0/key", '"noise.sigma" does not match']),
    (study({"values": [1]}), ["/axes/0", 'needs the key "key"']),
    (study({"variants": {"a": {"scan.seed": 1}}}), ["/axes/0", 'needs the key "name"']),
    (study({"name": "kind", "variants": {}}), ["/axes/0/variants", "is empty"]),
    (study({"name": "kind", "key": "scan.seed", "variants": {"a": {"scan.seed": 1}}}), ["/axes/0/key", "does not go with variants"]),
    (study({"zip": [SIGMAS, RESOLUTIONS]}), ["/axes/0/zip", "different lengths: 3, 2"]),
    (study({"zip": [SIGMAS]}), ["/axes/0/zip", "an array of 1 elements; expected at least 2"]),
    (study({"name": "z", "zip": [SIGMAS, SIGMAS]}), ["/axes/0/name", "does not go with zip"]),
    (study({"zip": [SIGMAS, {"zip": [SIGMAS, LIMITS]}]}), ["/axes/0/zip/1", "a zip in a zip"]),
    (study(SIGMAS, SIGMAS), ["/axes", "two axes are named range_sigma_m"]),
    (study(SIGMAS, {**SIGMAS, "name": "other"}), ["axis other", "scan.noise.range_sigma_m overwrites"]),
    (study(SIGMAS, {"name": "noise", "key": "scan.noise", "values": [{}], "labels": ["none"]}),
     ["axis noise", "scan.noise overwrites scan.noise.range_sigma_m of the axis range_sigma_m"]),
    (study({**SIGMAS, "name": "case"}), ["/axes", "cannot be named case"]),
    (study({**SIGMAS, "name": "repeat"}), ["/axes", "cannot be named repeat"]),
    (study({"key": "scan.trajectory.position_m.5", "values": [1]}), ["axis position_m", '"5" is not an index into [0, 0, 50]']),
    (study(*({"name": f"a{i}", "key": f"scan.a{i}", "linspace": [0, 1, 1000]} for i in range(3))),
     ["/axes", "the number of cases, 1000000000, is not <= 1000000"]),
    (study(repeat={"count": 0}), ["/repeat/count", "0 is not in [1, 1000000]"]),
    (study(repeat={"count": 1e9}), ["/repeat/count", "1000000000.0 is not in [1, 1000000]"]),
    (study(repeat={"count": 2.5}), ["/repeat/count", "2.5 is of type number, not integer"]),
    (study(repeat={}), ["/repeat", 'needs the key "count"']),
    (study(repeat={"count": 2, "seeds": ["seed"]}), ["/repeat/seeds/0", '"seed" does not match']),
    (study(repeat={"count": 2, "draws": {"scan.x": {}}}), ["/repeat/draws/scan.x", "none of normal, uniform"]),
    (study(repeat={"count": 2, "draws": {"scan.x": {"normal": -1}}}), ["/repeat/draws/scan.x/normal", "-1 is not >= 0"]),
    (study(repeat={"count": 2, "draws": {"scan.x": {"uniform": [2, 1]}}}), ["/repeat/draws/scan.x/uniform", "[2, 1]"]),
    (study(set={"scan": ["preset:paper", 3]}), ["/set/scan/1: 3 is not a configuration"]),
    (study(set={"scan": ["paper"]}), ["/set/scan", "paper: No such file or directory; did you mean preset:paper?"]),
    (axis(list=[1], values=[2]), ["/axes/0/list", "unknown key"]),
    (study(options={"regrid": ["--fast"]}), ["/options/regrid/0", '"--fast" is not one of', "--corrected"]),
    (study(plot={"metrics": []}), ["/plot/metrics", "expected at least 1"]),
]
# Inputs that the tools refuse.
REFUSED = [
    (study({"key": "scan.noise.range_sigma", "values": [0.1]}), ["the first case: scan-sim: /scan/noise/range_sigma: "]),
    (study({"key": "scan.noise.dropout_frac", "values": [0.1, 1.5]}), ["dropout_frac = 1.5", "/noise/dropout_frac", "1.5"]),
    (study({"key": "scan.noise.dropout_frac", "linspace": [0, 2, 21]}), ["dropout_frac = 2", "/noise/dropout_frac"]),
    (study({"key": "terrain.grid.resolution_m", "values": [0.1, -1]}), ["resolution_m = -1", "terrain-gen", "/grid/resolution_m"]),
    (study(set={"eval.quantile": 2}), ["dem-eval", "/quantile: 2"]),
    (study(set={"regrid.method": "best"}), ["regrid", "/method"]),
]


class BadStudies(StudyTest):
    def refused(self, tree, words, *options):
        path = self.write(tree)
        message = self.sweep("plan", path, "--out", self.out(), "--bin", BIN_FOLDER, *options, code=2).stderr
        self.assertRegex(message, r"\Alandfall study: [^\n]+\n\Z", tree)
        for word in [path, *words]:
            self.assertIn(word, message)
        self.assertFalse(os.path.exists(self.out()), tree)

    def test_each_message(self):
        for tree, words in BAD:
            with self.subTest(words=words):
                path = self.write(tree)
                with self.assertRaises(UsageError) as context:
                    read = reader.read_study(path)
                    for indices in read.cases():
                        for stage in read.base:
                            model.configuration(read, stage, indices)
                for word in [path, *words]:
                    self.assertIn(word, str(context.exception))

    def test_a_refusal_is_one_line_and_writes_nothing(self):
        for tree, words in (BAD[0], BAD[5], BAD[-1]):
            self.refused(tree, words)

    def test_values_that_a_tool_refuses(self):
        for tree, words in REFUSED:
            with self.subTest(words=words):
                self.refused(tree, words)

    def test_deep_nesting_is_refused(self):
        self.refused('{"set": {"scan.x": ' + "[" * 100000 + "]" * 100000 + "}}", ["not JSON"])

    def test_no_tools(self):
        message = self.sweep("plan", self.write(study()), "--out", self.out(), "--bin", self.path("nowhere"), code=1).stderr
        self.assertIn("nowhere/terrain-gen", message)

    def test_options(self):
        for arguments, word in (["frob"], "frob"), (["plan"], "required"), (["show", self.write(study()), "7"], "case 7"), \
                (["plan", self.write(study()), "--out", self.out(), "--bin", BIN_FOLDER, "--keep", "all,scans"], "'scans'"):
            self.assertIn(word, self.sweep(*arguments, code=2).stderr)

    def test_the_schema_agrees_with_jsonschema(self):
        """jsonschema accepts and refuses the same studies as our schema check, without the checks that follow it."""
        try:
            import jsonschema
        except ImportError:
            self.skipTest("python3-jsonschema is not installed")
        study_schema = schema.read_json(os.path.join(ROOT, "schemas", "study.schema.json"))
        validator = jsonschema.Draft7Validator(study_schema)
        checked = 0
        for tree, words in BAD:
            if isinstance(tree, str):
                continue
            try:
                schema.check(json.loads(json.dumps(tree)), study_schema, "x")
                ours = True
            except UsageError:
                ours = False
            self.assertEqual(validator.is_valid(json.loads(json.dumps(tree))), ours, words)
            checked += not ours
        self.assertGreater(checked, 20)


BIN_FOLDER = os.environ["LANDFALL_BIN"]

if __name__ == "__main__":
    unittest.main()
