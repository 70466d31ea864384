#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The plan of a study: each stage occurs once, only changed files are written, and scans that differ in errors share a truth."""
import json
import os
import re
import subprocess
import unittest

from case import BASE, BIN, LIMITS, RESOLUTIONS, SIGMAS, StudyTest, read, study

# pylint: disable=wrong-import-order
from landfall.study import rules


class Stages(StudyTest):
    def test_each_stage_once(self):
        self.assertEqual(self.counts(study(SIGMAS, RESOLUTIONS, LIMITS)), [1, 1, 3, 6, 12])
        self.assertEqual(self.counts(study(LIMITS, RESOLUTIONS)), [1, 0, 1, 2, 4])
        self.assertEqual(self.counts(study()), [1, 0, 1, 1, 1])

    def test_equal_values_are_one_stage(self):
        """An axis with the value of the base, and 2.0 instead of 2."""
        tree = study({"name": "a", "variants": {"x": {"scan.seed": 2}, "y": {"scan.seed": 2.0}}})
        self.assertEqual(self.counts(tree), [1, 0, 1, 1, 1])
        self.assertEqual(len(self.graph(tree).cases), 2)

    def test_terrains_are_not_mixed(self):
        tree = study({"key": "terrain.base", "values": [{"type": "plane"}, {"type": "plane", "slope_x": 0.1}], "labels": ["a", "b"]},
                     SIGMAS)
        self.assertEqual(self.counts(tree), [2, 2, 6, 6, 6])
        graph = self.graph(tree)
        for scan in graph.scan.values():
            self.assertIs(scan.truth.upstream, scan.upstream)

    def test_errors_share_a_truth(self):
        for key, values in (("noise.range_bias_m", [0, 1]), ("noise.dropout_frac", [0, 0.5]), ("seed", [1, 2]),
                            ("navigation_error.position_m", [[0, 0, 0], [0, 0, 1]]),
                            ("pointing_error.time_stamp_bias_s", [0, 0.1])):
            self.assertEqual(self.counts(study({"key": "scan." + key, "values": values}))[:3], [1, 1, 2], key)

    def test_the_disk_that_truths_take_is_told(self):
        """40 bytes of each ray: 400 pixels, 20,000 and 40,000 pulses."""
        tree = study({"key": "scan.noise.range_bias_m", "values": [0, 1]}, {"key": "scan.laser.scan_time_s", "values": [20, 40]})
        tree["set"] = {"scan.detector.rows": 16, "scan.detector.columns": 25, "scan.laser.pulse_rate_hz": 1000}
        graph = self.graph(tree)
        self.assertEqual(rules.disk_text(graph, {"scan"}), "on the disk: 2 truths, about 960 MB, until study-clean; KEEP=scan")
        self.assertEqual(rules.disk_text(self.graph(study()), set()), "on the disk: no scans and DEMs (KEEP names files to keep)")
        self.assertEqual(rules.rays_of({}), 40000 * 18 * 18)
        self.write(tree)
        printed = self.sweep("plan", self.path("tiny.json"), "--out", self.out(), "--bin", BIN).stdout
        self.assertIn("\non the disk: 2 truths, about 960 MB, until study-clean; no scans and DEMs (KEEP names files to keep)\n", printed)

    def test_keys_that_move_the_true_beams_share_no_truth(self):
        for key, values in (("detector.rows", [8, 9]), ("laser.scan_time_s", [0.1, 0.2]), ("mount.position_m", [[0, 0, 0], [0, 0, 1]]),
                            ("trajectory.velocity_mps", [[0, 0, 0], [0, 0, -1]]), ("scanner.incidence_deg", [0, 45]),
                            ("pointing_error.jitter_sigma_rad", [0, 0.1]), ("pointing_error.jitter_time_s", [0, 0.1]),
                            ("pointing_error.mirror_time_bias_s", [0, 1e-5]),
                            ("pointing_error.misalignment_rpy_rad", [[0, 0, 0], [0, 0, 0.1]])):
            self.assertEqual(self.counts(study({"key": "scan." + key, "values": values}))[:3], [1, 0, 2], key)

    def test_a_scan_with_a_receiver_is_traced_for_itself(self):
        for axis in ({"key": "scan.receiver.type", "values": ["none", "peak", "centroid"]},
                     {"key": "scan.receiver.timer_step_s", "values": [0, 1e-9, 2e-9]}, {"key": "scan.seed", "values": [1, 2, 3]}):
            tree = study(axis)
            tree["set"] = {"scan.receiver": {"type": "peak"}, "scan.link": {"reference_pe": 400, "reference_range_m": 500}}
            self.assertEqual(self.counts(tree)[:3], [1, 0, 3], axis["key"])
        self.assertEqual(self.counts(study({"key": "scan.receiver.timer_step_s", "values": [0, 1e-9]}))[:3], [1, 1, 2])

    def test_seeds_that_move_the_true_beams(self):
        seeds = {"key": "scan.seed", "values": [1, 2, 3]}
        prisms = {"type": "risley", "encoder_sigma_rad": 0.001}
        for more, truths in (({"scan.pointing_error": {"jitter_sigma_rad": 1e-4}}, 0),
                             ({"scan.pointing_error": {"jitter_sigma_rad": [0, 1e-4]}}, 0),
                             ({"scan.pointing_error": {"jitter_sigma_rad": [0, 0]}}, 1),
                             ({"scan.pointing_error.mirror_time_sigma_s": 1e-6}, 0), ({"scan.pointing_error.mirror_time_bias_s": 1e-6}, 1),
                             ({"scan.scanner": {"type": "polygon", "facet_tilt_sigma_rad": 1e-4}}, 0),
                             ({"scan.scanner": {"type": "polygon", "facet_tilt_rad": [1e-4] * 48}}, 1),
                             ({"scan.scanner": prisms}, 0), ({"scan.scanner": {**prisms, "encoder_sigma_rad": 0}}, 1),
                             ({"scan.scanner.encoder_sigma_rad": 0.001}, 1)):
            self.assertEqual(self.counts(study(seeds, set=more))[1], truths, more)
        jittered = study(seeds, SIGMAS, set={"scan.pointing_error": {"jitter_sigma_rad": 1e-4}})
        self.assertEqual(self.counts(jittered)[:3], [1, 3, 9])
        graph = self.graph(jittered)
        self.assertEqual(sorted(json.loads(graph.configs["scan", stage.config_id])["seed"] for stage in graph.truth.values()), [1, 2, 3])

    def test_a_truth_has_no_errors(self):
        graph = self.graph(study(SIGMAS, set={"scan.navigation_error": {"position_m": [0, 0, 1]}, "scan.seed": 4,
                                              "scan.pointing_error": {"misalignment_rpy_rad": [0, 0, 1], "time_stamp_bias_s": 1}}))
        (truth,) = graph.truth.values()
        self.assertEqual(json.loads(graph.configs["scan", truth.config_id]),
                         {**BASE["scan"], "pointing_error": {"misalignment_rpy_rad": [0, 0, 1]}})


class Plans(StudyTest):
    def rules(self, name="tiny"):
        """{target: prerequisites} of the stages in study.mk, without $O/."""
        rules = {}
        for line in read(self.out("study.mk", study_name=name)).decode().splitlines():
            match = re.fullmatch(r"(\$O/(?:terrain|truth|scan|dem|metrics|shared)/\S+(?: \$O/\S+)*?) ?&?: (.*)", line)
            if match:
                for target in match[1].split():
                    rules[target[3:]] = [word[3:] for word in match[2].split() if word.startswith("$O/")]
        return rules

    def test_a_configuration_for_each_stage_input(self):
        self.plan(study(SIGMAS, RESOLUTIONS, LIMITS))
        self.assertEqual([len(self.files("config", tool)) for tool in ("terrain", "scan", "regrid", "eval")], [1, 4, 2, 2])
        self.assertEqual(len(json.loads(read(self.out("cases.json")))["cases"]), 12)

    def test_written_only_when_changed(self):
        folder = self.plan(study(SIGMAS, RESOLUTIONS))
        times = self.times(folder)
        self.plan(study(SIGMAS, RESOLUTIONS))
        self.assertEqual({name: time for name, time in self.times(folder).items() if name != "study.mk"},
                         {name: time for name, time in times.items() if name != "study.mk"})
        self.plan(study({**SIGMAS, "values": [0.01, 0.02, 0.05, 0.07]}, RESOLUTIONS))
        later = self.times(folder)
        changed = {name for name in later if later[name] != times.get(name)}
        self.assertEqual({name for name in changed if name.startswith("config/")},
                         {name for name in later if name.startswith("config/")} - set(times))
        self.assertEqual(len([name for name in changed if name.startswith("config/")]), 1)
        self.assertIn("cases.json", changed)
        self.assertNotIn("tools.txt", changed)

    @staticmethod
    def times(folder):
        return {os.path.relpath(os.path.join(top, name), folder): os.stat(os.path.join(top, name)).st_mtime_ns
                for top, _, names in os.walk(folder) for name in names}

    def test_names_depend_on_all_inputs_of_a_stage(self):
        self.plan(study(SIGMAS), name="a")
        first = self.rules("a")
        self.plan(study({**SIGMAS, "values": [0.01, 0.03]}, set={"eval.quantile": 0.9}), name="b")
        second = self.rules("b")
        self.assertEqual({name for name in first if name.startswith(("terrain/", "truth/"))},
                         {name for name in second if name.startswith(("terrain/", "truth/"))})
        self.assertFalse({name for name in first if name.startswith("metrics/")} & set(second))

    def test_files_that_are_read_once_are_made_by_their_reader(self):
        self.plan(study(SIGMAS))
        self.assertEqual(sorted(name.split("/")[0] for name in self.rules()), ["metrics"] * 3 + ["terrain", "truth"])
        self.plan(study(SIGMAS, RESOLUTIONS, LIMITS))
        names = sorted(re.sub(r"[0-9a-f]{16}", "*", name) for name in self.rules())
        self.assertEqual(names, ["metrics/*.json"] * 12 + ["shared/*.dem.h5"] * 6 + ["shared/*.scan.h5"] * 3 +
                         ["terrain/*.h5", "truth/*.h5"])

    def test_keep_names_files(self):
        self.plan(study(SIGMAS), "--keep", "scan,dem")
        names = [name.split("/")[0] for name in self.rules()]
        self.assertEqual([names.count(kind) for kind in ("scan", "dem", "metrics")], [3, 3, 3])
        self.plan(study(SIGMAS), "--keep", "all")
        self.assertEqual(sum(line.startswith("$O/metrics/") and " $O/eval/" in line and " &:" in line for line in
                             read(self.out("study.mk")).decode().splitlines()), 3)

    def test_many_shared_scans_have_one_recipe_each(self):
        many = {"key": "scan.noise.range_sigma_m", "linspace": [0.01, 0.17, rules.MAX_SHARED + 1]}
        self.plan(study(many, RESOLUTIONS, LIMITS))
        text = read(self.out("study.mk")).decode()
        self.assertEqual((text.count("$(call stage,metrics,"), text.count("shared/")), (17, 0))
        self.assertEqual(len([name for name in self.rules() if name.startswith("metrics/")]), 17 * 4)

    def test_data_files_are_prerequisites(self):
        with open(self.path("mask.h5"), "w", encoding="utf-8") as file:
            file.write("x")
        self.plan(study(SIGMAS, set={"eval.region": {"shape": "mask", "path": "mask.h5"}}), "--no-check")
        lines = read(self.out("study.mk")).decode().splitlines()
        self.assertEqual(sum(line.startswith("$O/metrics/") and self.path("mask.h5") in line for line in lines), 3)

    def test_the_raster_that_a_terrain_names_is_one(self):
        for name, words in [("g.h5", ["--set", "grid.half_width_m=30", "--set", "grid.resolution_m=1"]), ("g.tif", ["--from", self.path("g.h5")])]:
            subprocess.run([os.path.join(BIN, "terrain-gen"), *words, "-o", self.path(name)], check=True)
        tree = study(SIGMAS)
        tree["base"]["terrain"] |= {"from": "g.tif", "center": [3, 2]}
        self.plan(tree, "--no-check")
        lines = read(self.out("study.mk")).decode().splitlines()
        self.assertEqual(sum(line.startswith("$O/terrain/") and self.path("g.tif") in line for line in lines), 1)

    def test_names_that_make_cannot_handle(self):
        with open(self.path("my mask.h5"), "w", encoding="utf-8") as file:
            file.write("x")
        path = self.write(study(set={"eval.region": {"shape": "mask", "path": "my mask.h5"}}))
        message = self.sweep("plan", path, "--out", self.out(), "--bin", BIN, "--no-check", code=2).stderr
        self.assertIn("my mask.h5", message)
        self.assertIn("a b", self.sweep("plan", self.write(study()), "--out", self.path("a b"), "--bin", BIN, code=2).stderr)

    def test_five_thousand_cases(self):
        """50 x 100 draws: each is a scan from the same truth, and each target occurs once. bench/ measures the time."""
        many = {"key": "scan.noise.range_sigma_m", "linspace": [0.001, 0.05, 50]}
        draws = {"scan.navigation_error.velocity_mps": {"normal": [0.1, 0.1, 0.1]}}
        self.plan(study(many, repeat={"count": 100, "draws": draws}))
        rules = self.rules()
        self.assertEqual(len([name for name in rules if name.startswith("metrics/")]), 5000)
        self.assertEqual(len(rules), 5002)
        self.assertEqual(len(json.loads(read(self.out("cases.json")))["cases"]), 5000)
        recipes = self.make("-n", "study-results").stdout
        self.assertEqual(recipes.count("studies/runners/run-stage"), 5002)

    COST = (r"cost: about (\S+) s with {} at a time, by the first case \((.*)\); a stage needs up to \d+ MB of memory")

    def test_cost(self):
        """The seconds of the first case's stages, times their numbers."""
        printed = self.sweep("cost", self.write(study(SIGMAS, RESOLUTIONS)), "--bin", BIN).stdout
        found = re.fullmatch(r"tiny: 6 cases; " + self.COST.format("1 stage") + r"; on the disk: 1 truth, .*\n", printed)
        self.assertTrue(found, printed)
        stages = re.findall(r"(\d+) x (\w+) (\S+) s", found[2])
        self.assertEqual([(kind, int(count)) for count, kind, _ in stages], [("terrain", 1), ("truth", 1), ("scan", 3), ("regrid", 6), ("eval", 6)])
        self.assertAlmostEqual(float(found[1]), sum(int(count) * float(seconds) for count, _, seconds in stages), delta=1)
        self.assertIn("--jobs 0: is not >= 1", self.sweep("cost", "noise", "-j", 0, code=2).stderr)
        wrong = self.write(study(set={"eval.quantile": 2}), "wrong")
        self.assertRegex(self.sweep("cost", wrong, "--bin", BIN).stdout, r"\Awrong: 1 case; cost: unknown, because the first case fails: dem-eval: .*/quantile: 2 is not")

    def test_a_large_study_shows_its_cost_before_it_starts(self):
        tree = study(SIGMAS, RESOLUTIONS, LIMITS, repeat={"count": 3})
        self.write(tree)
        self.assertNotIn("cost: ", self.make("study-status", runs="status").stdout, "a question costs nothing")
        lines = self.make_plan(tree, "-j2")
        self.assertRegex("\n".join(lines), self.COST.format("2 stages"))
        self.assertEqual(os.listdir(self.out("scratch")), [])
        os.utime(self.write(tree))
        self.assertNotIn("cost: ", "".join(self.make_plan(tree, "-j2")), "the second plan")
        self.assertRegex("\n".join(self.make_plan(study(SIGMAS), "-j2", study_name="small")), r"\ncost: 11 stages; landfall study cost \S+small.json tries the first case\n")

    def make_plan(self, tree, *options, study_name="tiny"):
        self.write(tree, study_name)
        return self.make("study-plan", *options, study_name=study_name).stdout.splitlines()

    def test_list_and_show(self):
        path = self.write(study(SIGMAS, LIMITS))
        lines = self.sweep("list", path).stdout.splitlines()
        self.assertEqual(lines[0].split("\t"), ["case", "range_sigma_m", "relative_elevation_m"])
        self.assertEqual(lines[4].split("\t"), ["3", "0.02", "0.1"])
        self.assertEqual(len(lines), 7)
        self.assertIn('"range_sigma_m": 0.02', self.sweep("show", path, 3).stdout)


if __name__ == "__main__":
    unittest.main()
