#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""landfall-info: its description of a file agrees with h5py and numpy."""
import json
import os
import re
import shutil
import signal
import subprocess
import unittest

import h5py
import numpy as np

from harness import TOOLS, ChainTest, attributes, read_bytes, run, set_text, tool, write_file

TETRAHEDRON = "v 0 0 0\nv 2 0 0\nv 0 3 0\nv 0 0 -4\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"


def close(a, b):
    return abs(a - b) <= 1e-12 * max(1.0, abs(a), abs(b))


class InfoTest(ChainTest):
    def info(self, *arguments):
        return self.succeed("landfall-info", *arguments).stdout

    def describe(self, *arguments):
        return json.loads(self.info("--json", *arguments))

    def check_entry(self, entry, dataset):
        """Compares the description of one layer or column with numpy."""
        values = dataset[...].astype(np.float64)
        finite = values[np.isfinite(values)]
        self.assertEqual(entry["shape"], list(dataset.shape))
        self.assertEqual(entry["type"], str(dataset.dtype.newbyteorder("=")))
        self.assertEqual(entry["count"], finite.size)
        self.assertEqual(entry["nan_count"], np.isnan(values).sum())
        self.assertEqual(entry["infinite_count"], np.isinf(values).sum())
        if not finite.size:
            self.assertEqual([entry[key] for key in ("min", "max", "mean", "std")], [None] * 4)
            return
        self.assertEqual((entry["min"], entry["max"]), (finite.min(), finite.max()))
        self.assertTrue(close(entry["mean"], finite.mean()), entry["name"])
        self.assertTrue(abs(entry["std"] - finite.std()) <= 1e-9 * max(1, finite.std()), entry["name"])
        if "flag_counts" in entry:
            masks = dataset.attrs.get("flag_masks")
            words = attributes(dataset)["flag_meanings"].split()
            flags = dataset.attrs["flag_values"] if masks is None else masks
            expected = {w: int((values.astype(int) & f != 0).sum() if masks is not None else (values == f).sum())
                        for w, f in zip(words, flags)}
            self.assertEqual(entry["flag_counts"], expected)

    def check_file(self, path):
        """Checks that the description has every dataset of the file and no other, and returns it."""
        description = self.describe(path)
        with h5py.File(path) as file:
            expected = {}
            def add(name, item):
                is_dimension = name in ("x", "y") or b"not a netCDF variable" in item.attrs.get("NAME", b"")
                if isinstance(item, h5py.Dataset) and item.ndim in (1, 2) and not is_dimension:
                    expected[name] = item
            file.visititems(add)
            found = {}
            for group, entries in description["datasets"].items():
                for entry in entries:
                    found[("" if group == "layers" else group + "/") + entry["name"]] = entry
            self.assertEqual(sorted(found), sorted(expected))
            for name, entry in found.items():
                self.check_entry(entry, expected[name])
                self.assertEqual(entry["unit"], attributes(expected[name]).get("units", ""))
                self.assertEqual(entry["long_name"], attributes(expected[name]).get("long_name", ""))
            self.assertEqual(description["file_id"], attributes(file)["file_id"])
            self.assertEqual(description["source"], attributes(file)["source"])
            self.assertEqual("landfall." + description["kind"], attributes(file)["format_name"])
            self.assertEqual(description["config"], json.loads(file["provenance/config_json"][()]))
            chain = json.loads(file["provenance/chain_json"][()])
            self.assertEqual(description["chain"][:-1], chain)
            self.assertEqual(description["chain"][-1]["file_id"], attributes(file)["file_id"])
        self.assertEqual(description["size_bytes"], os.path.getsize(path))
        return description

    def copy(self, path, name="copy.h5"):
        return shutil.copy(path, self.path(name))


class Contents(InfoTest):
    def test_every_file_of_the_chain(self):
        for name in TOOLS:
            with self.subTest(name):
                description = self.check_file(self.chain.output(name))
                self.assertEqual(description["tool"], name)

    def test_the_grid_and_the_scan(self):
        with h5py.File(self.chain.dem) as file:
            x, y = file["x"][:], file["y"][:]
        grid = self.describe(self.chain.dem)["grid"]
        self.assertEqual((grid["columns"], grid["rows"], grid["resolution_m"]), (x.size, y.size, 0.1))
        self.assertEqual((grid["x_m"], grid["y_m"]), ([x[0], x[-1]], [y[0], y[-1]]))
        scan = self.describe(self.chain.scan)["scan"]
        with h5py.File(self.chain.scan) as file:
            t = file["pulses/t"][:]
            points = file["points"]
            self.assertEqual((scan["t_first_s"], scan["t_last_s"]), (t[0], t[-1]))
            self.assertEqual((scan["pulse_count"], scan["row_count"], scan["pixel_count"]),
                             (t.size, points["pulse"].size, 64))
            for name in ("return", "miss", "dropout", "dead", "false_return"):
                self.assertEqual(scan[name + "_count"], points.attrs[name + "_count"], name)
        self.assertEqual((scan["detector_rows"], scan["detector_columns"], scan["misses_kept"]), (8, 8, False))

    def test_a_scan_with_its_misses(self):
        path = self.path("all.h5")
        self.succeed("scan-sim", *self.chain.inputs("scan-sim"), "-o", path, "--keep-misses", "--float32")
        scan = self.check_file(path)["scan"]
        self.assertEqual((scan["row_count"], scan["misses_kept"]), (400 * 64, True))

    def test_a_scan_without_rows(self):
        path = self.copy(self.chain.scan)
        with h5py.File(path, "r+") as file:
            for column in file["points"].values():
                column.resize((0,))
        self.assertEqual(self.check_file(path)["scan"]["row_count"], 0)
        self.assertRegex(self.info(path), r"x_est +0 +0 +- +- +- +- m\n")

    def test_a_dem_without_a_valid_bin(self):
        dem, judged = self.changed(self.chain.dem, lambda f: f["z_est"].__setitem__(..., np.nan)), self.path("eval.h5")
        z = self.check_file(dem)["datasets"]["layers"][0]
        self.assertEqual((z["name"], z["count"], z["mean"]), ("z_est", 0, None))
        self.succeed("dem-eval", dem, "-o", judged, "--set", "region_radius_m=4")
        self.assertRegex(self.info(judged), r"hole_distance +the DEM has no valid bin +1 bin +FAIL")
        distance = {e["name"]: e for e in self.check_file(judged)["datasets"]["layers"]}["distance_to_valid"]
        self.assertEqual((distance["count"], distance["infinite_count"]), (0, 0))
        with h5py.File(judged) as file:
            self.assertTrue(np.isnan(file["distance_to_valid"]).all() and np.isnan(file["holes/max_distance_bins"]).all())

    def test_metrics_without_layers(self):
        path = self.path("metrics.h5")
        self.succeed("dem-eval", *self.chain.inputs("dem-eval"), "-o", path, "--metrics-only")
        description = self.check_file(path)
        self.assertNotIn("layers", description["datasets"])
        self.assertEqual(description["options"], {"metrics_only": True})
        self.assertIn('options {"metrics_only":true}', self.info(path))

    def test_the_verdict_is_that_of_dem_eval(self):
        arguments = self.chain.inputs("dem-eval")
        table = self.succeed("dem-eval", *arguments, "--metrics-only", "--table").stdout
        self.assertIn("FAIL", table)
        self.assertIn(table, self.info(self.chain.eval))
        self.assertEqual(self.describe(self.chain.eval)["metrics"], json.loads(read_bytes(self.chain.metrics)))

    def test_a_plan(self):
        path = self.path("plan.h5")
        table = self.succeed("scan-sim", "-c", self.chain.config("scan-sim"), "--plan", "--plan-radius", 3, "-o", path)
        self.check_file(path)
        self.assertIn(table.stdout, self.info(path))

    def test_features_by_kind(self):
        features = self.describe(self.chain.terrain)["features"]
        self.assertEqual(features, {"count": 3, "count_by_kind": {"cone": 1, "hemisphere": 1, "pyramid": 1}})
        self.assertIsNone(self.describe(self.chain.terrain, "--no-statistics")["features"]["count_by_kind"])

    def test_a_mesh(self):
        mesh, path = self.write("t.obj", TETRAHEDRON), self.path("mesh.h5")
        self.succeed("terrain-gen", "--from", mesh, "-o", path)
        description = self.check_file(path)
        with h5py.File(path) as file:
            v = file["mesh/vertices"][:]
        self.assertEqual(description["mesh"], {
            "vertex_count": 4, "triangle_count": 4,
            **{axis + "_m": [v[:, i].min(), v[:, i].max()] for i, axis in enumerate("xyz")}})
        self.assertIn("mesh        4 vertices, 4 triangles\n", self.info(path))

    def test_the_configuration_by_its_differences_from_the_defaults(self):
        text = self.info(self.chain.scan, "--no-statistics")
        self.assertIn("\n  noise.range_sigma_m = 0.01\n", text)
        self.assertNotIn("detector.subpixels", text)  # it has its default value
        path = self.path("spiral.h5")
        self.succeed("scan-sim", "--terrain", self.chain.terrain, "-o", path, "--set", 'scanner.type="flash"',
                     "--set", "laser.scan_time_s=0.001", "--set", "detector.rows=4", "--set", "detector.columns=4")
        changes = self.info(path, "--no-statistics").split("differs from the defaults\n")[1].split("\n\n")[0]
        self.assertEqual(changes.split("\n"), ["  detector.columns = 4", "  detector.rows = 4",
                                               "  laser.scan_time_s = 0.001", '  scanner.type = "flash"'])

    def test_the_configuration_alone_makes_the_file_again(self):
        config = self.info(self.chain.scan, "--config")
        self.assertEqual(json.loads(config), self.describe(self.chain.scan)["config"])
        path = self.path("again.h5")
        self.succeed("scan-sim", "-c", "-", "--terrain", self.chain.terrain, "-o", path, stdin=config)
        self.assertEqual(read_bytes(path), read_bytes(self.chain.scan))

    def test_the_chain_in_text(self):
        text = self.info(self.chain.eval, "--no-statistics")
        steps = TOOLS[:4]
        ids = [self.describe(self.chain.output(name), "--no-statistics")["file_id"][:12] for name in steps]
        for name, file_id in zip(steps, ids):
            self.assertRegex(text, rf"\n  {name} +\S+ +{file_id}")
        self.assertIn(f"from scan {ids[1]}, terrain {ids[0]}\n", text)

    def test_a_recorded_environment(self):
        path = self.path("t.h5")
        self.succeed("terrain-gen", "-c", self.chain.config("terrain-gen"), "-o", path, "--record-environment")
        self.assertEqual(self.describe(path)["environment"]["host"], os.uname().nodename)
        self.assertIn(os.uname().nodename, self.info(path))
        self.assertIsNone(self.describe(self.chain.terrain)["environment"])

    def test_tables_have_80_columns_and_no_text_is_cut_in_a_pipe(self):
        for name in TOOLS:
            text = self.info(self.chain.output(name))
            self.assertNotIn("...", text)
            for line in text.split("\n\n", 1)[1].split("\nconfiguration,")[0].split("\n"):
                self.assertLessEqual(len(line), 80, line)

    def test_threads_change_nothing(self):
        one = self.info("--json", "-t", 1, self.chain.scan)
        self.assertEqual(one, self.info("--json", "-t", 3, self.chain.scan))

    def test_several_files(self):
        paths = [self.chain.output(name) for name in TOOLS]
        many = self.describe(*paths)
        self.assertEqual(many, [self.describe(path) for path in paths])
        self.assertEqual(self.info(*paths), "\n".join(self.info(path) for path in paths))


class OtherForms(InfoTest):
    """Layers as other programs write them: other types, chunks and byte orders."""

    def rewritten(self, **options):
        path = self.copy(self.chain.dem)
        rng = np.random.default_rng(3)
        with h5py.File(path, "r+") as file:
            shape = file["z_est"].shape
            values = rng.normal(5, 2, shape)
            values[rng.random(shape) < 0.1] = np.nan
            values[3, 4] = np.inf
            values[7, 1:3] = -np.inf
            del file["z_est"]
            file.create_dataset("z_est", data=values.astype(options.pop("dtype", "f8")), **options)
        return path

    def test_numbers_do_not_depend_on_the_form(self):
        for options in ({}, {"chunks": (7, 13)}, {"chunks": (101, 101), "compression": "gzip"}, {"dtype": ">f4"},
                        {"chunks": (64, 64), "shuffle": True, "compression": "gzip"}, {"dtype": "f4"},
                        {"dtype": ">f8", "chunks": (50, 30), "fletcher32": True}):
            with self.subTest(**options):
                self.check_file(self.rewritten(**options))

    def test_unsigned_and_tiny_and_unwritten_layers(self):
        path = self.copy(self.chain.dem)
        with h5py.File(path, "r+") as file:
            file.create_dataset("shade", data=np.arange(101 * 101, dtype="u1").reshape(101, 101))
            file.create_dataset("long", data=np.arange(200_000, dtype="i8") - 70_000)
            file.create_dataset("wide", data=np.ones((2, 150_000)))
            file.create_dataset("one", data=np.array([-3.5], dtype="f4"))
            file.create_dataset("empty", shape=(0,), maxshape=(None,), dtype="f8", chunks=(8,))
            file.create_dataset("unwritten", shape=(300, 300), dtype="f4", chunks=(100, 100), fillvalue=2.5)
        self.check_file(path)

    def test_large_offsets_keep_their_spread(self):
        values = 1e8 + np.random.default_rng(1).normal(0, 1, 300_000)
        path = self.changed(self.chain.dem, lambda f: f.create_dataset("far", data=values, chunks=(65536,)))
        entry = {e["name"]: e for e in self.describe(path)["datasets"]["layers"]}["far"]
        self.assertTrue(abs(entry["std"] - values.std()) < 1e-6)


class Refusals(InfoTest):
    def refused(self, path, *words):
        for arguments in ([path], [path, "--json"], [path, "--no-statistics"]):
            self.refuse(1, "landfall-info", *arguments, words=[path, *words])

    def test_files_that_are_not_of_landfall(self):
        self.refused(self.path("nowhere.h5"), "no such file")
        self.refused(self.folder, "is a directory")
        os.mkfifo(self.path("fifo"))
        self.refused(self.path("fifo"), "not a regular file")
        self.refused("/dev/null", "not a regular file")
        self.refused(self.config("{}"), "is not an HDF5 file")
        with h5py.File(self.path("other.h5"), "w") as file:
            file["x"] = np.arange(3)
        self.refused(self.path("other.h5"), "is not a landfall file")
        os.remove(self.path("other.h5"))

    def test_damaged_files(self):
        self.refused(self.changed(self.chain.scan, lambda f: f.attrs.__delitem__("complete")), "is incomplete")
        self.refused(self.changed(self.chain.scan, lambda f: f.attrs.__setitem__("format_version", "2.0")), "2.0")
        path = self.copy(self.chain.scan)
        os.truncate(path, os.path.getsize(path) // 2)
        self.refused(path, "is truncated or damaged")
        self.refused(self.changed(self.chain.scan, lambda f: f.__delitem__("pulses")), "pulses")

    def test_a_corrupt_chunk_is_named(self):
        path = self.copy(self.chain.scan)
        with h5py.File(path) as file:
            chunk = file["points/z_true"].id.get_chunk_info(0)
        with open(path, "r+b") as file:
            file.seek(chunk.byte_offset)
            file.write(b"\0" * chunk.size)
        self.refuse(1, "landfall-info", path, words=[path, "/points/z_true", "corrupt"])
        self.info(path, "--no-statistics")

    def test_invalid_metrics(self):
        def change(file):
            del file["metrics_json"]
            file["metrics_json"] = '{"pass": 3}'
        path = self.changed(self.chain.eval, change)
        self.refuse(1, "landfall-info", path, words=[path, "metrics_json"])

    def test_an_evaluation_with_an_invalid_configuration(self):
        """The configuration must be valid, because the table of verdicts shows its limits."""
        for key, value in [("limits", {}), ("limits", 7), ("quantile", 2), ("region", {"shape": "square"})]:
            def change(file):
                config = {**json.loads(file["provenance/config_json"][()]), key: value}
                del file["provenance/config_json"]
                file["provenance/config_json"] = json.dumps(config)
            path = self.changed(self.chain.eval, change)
            self.refuse(1, "landfall-info", path, words=[path, "/provenance/config_json is not a configuration of dem-eval"])
            self.assertEqual(self.describe(path)["config"][key], value)

    def test_control_characters_do_not_reach_the_terminal(self):
        hostile, shown = "a\x1b[2Jb\nc\u202ed\u009b\x07", "a\\u001b[2Jb\\u000ac\\u202ed\\u009b\\u0007"

        def spoil(file):
            for attribute in ("title", "source"):
                file.attrs[attribute] = hostile
            for attribute in ("units", "long_name"):
                file["z_est"].attrs[attribute] = hostile
            file["z_est" + hostile] = file["count"][()]
            file["provenance"]["environment_json"] = json.dumps({hostile: hostile})
            config = json.loads(file["provenance/config_json"][()])
            set_text(file["provenance"], "config_json", json.dumps({**config, hostile: hostile}))
        path = self.changed(self.chain.dem, spoil)
        for options in ([], ["--no-statistics"], ["--config"], ["--json"]):
            text = self.info(path, *options)
            self.assertEqual(sorted(set(re.findall("[\x00-\x1f\x7f-\x9f\u202e]", text))), ["\n"], options)
        self.assertIn(f"({shown})", self.info(path).split("\n")[0])
        self.assertEqual(self.describe(path)["title"], hostile)  # escapes of JSON
        self.refuse(1, "landfall-info", self.path("no" + hostile.replace("/", "")), words=["/no" + shown + ": no such file"])

    def test_a_unit_of_any_length_is_cut(self):
        path = self.changed(self.chain.dem, lambda f: f["z_est"].attrs.__setitem__("units", "m" * 5000))
        self.assertLess(max(map(len, self.info(path).split("\n"))), 130)

    def test_the_check_prints_nothing_or_a_line_for_each_refused_file(self):
        paths = [self.chain.output(name) for name in TOOLS]
        self.assertEqual(self.info("--check", *paths), "")
        unfinished = self.changed(self.chain.dem, lambda f: f.attrs.__setitem__("complete", 0))
        flipped = self.copy(self.chain.eval, "flipped.h5")
        with open(flipped, "r+b") as file:
            file.seek(-70, os.SEEK_END)
            file.write(b"?")
        result = run("landfall-info", "--check", self.chain.dem, unfinished, flipped, self.path("none.h5"))
        self.assertEqual((result.returncode, result.stdout), (1, ""))
        self.assertEqual(result.stderr.splitlines(), [
            f"landfall-info: {unfinished}: is incomplete (attribute complete is not 1)",
            f"landfall-info: {flipped}: is an HDF5 file that is truncated or damaged, or still open elsewhere; make it again, or close it there",
            f"landfall-info: {self.path('none.h5')}: no such file"])
        self.refuse(1, "landfall-info", "--check", self.chain.metrics, words=["is not an HDF5 file"])

    def test_the_check_takes_the_results_of_a_study(self):
        path = self.path("results.h5")
        with h5py.File(path, "w") as file:
            file.attrs.update({"format_name": "landfall.results", "format_version": 1})
        self.refuse(1, "landfall-info", "--check", path, words=["is incomplete"])
        with h5py.File(path, "a") as file:
            file.attrs["complete"] = 1
        self.succeed("landfall-info", "--check", path)

    def test_a_seal_is_added_where_it_is_missing(self):
        path = self.copy(self.chain.dem, "changed.h5")
        self.succeed("landfall-info", "--seal", path)
        self.assertEqual(read_bytes(path), read_bytes(self.chain.dem))
        with h5py.File(path, "a") as file:
            file.attrs["remark"] = "changed"
        unsealed = read_bytes(path)
        self.succeed("landfall-info", "--seal", path)
        sealed = read_bytes(path)
        self.assertTrue(sealed.startswith(unsealed) and sealed.endswith(b"landfall seal 1\n"))
        self.succeed("landfall-info", "--check", path)
        at = sealed.index(b"changed")
        write_file(path, sealed[:at] + b"C" + sealed[at + 1:])
        self.refuse(1, "landfall-info", "--seal", path, words=["truncated or damaged"])
        unfinished = self.changed(self.chain.dem, lambda f: f.attrs.__setitem__("complete", 0))
        self.refuse(1, "landfall-info", "--seal", unfinished, words=["is incomplete"])
        self.refuse(1, "landfall-info", "--seal", self.chain.metrics, words=["is not an HDF5 file"])

    def test_a_bad_file_does_not_hide_the_others(self):
        result = run("landfall-info", self.chain.dem, self.path("nowhere.h5"), self.chain.terrain)
        self.assertEqual(result.returncode, 1)
        self.check_message("landfall-info", result.stderr, ["nowhere.h5: no such file"])
        self.assertEqual(result.stdout, self.info(self.chain.dem, self.chain.terrain))

    def test_a_closed_pipe_ends_it_silently(self):
        reading, writing = os.pipe()
        os.close(reading)
        result = subprocess.run([tool("landfall-info"), self.chain.dem], stdout=writing, stderr=subprocess.PIPE, timeout=60,
                                check=False)
        os.close(writing)
        self.assertEqual((result.returncode, result.stderr), (-signal.SIGPIPE, b""))

    def test_usage(self):
        for option in ("--json", "--config", "--no-statistics", "--devices"):
            self.refuse(2, "landfall-info", "--check", self.chain.dem, option, words=["--check"])
            self.refuse(2, "landfall-info", "--seal", self.chain.dem, option, words=["omit"])
        self.assertEqual(self.entries(), [])


if __name__ == "__main__":
    unittest.main()
