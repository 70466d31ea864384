#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Wrong and damaged inputs that earlier versions took without a word; docs/quality/tests.md lists what the tools say now.

usage: hostile_test.py [--write]

--write puts the present answers into the page; review the difference.
"""
import json
import os
import re
import shutil
import sys
import unittest

import h5py
import numpy as np

from faults import page
from harness import DRAWS, HAZARD, INPUTS, REGRID, SCAN, TOOLS, MonteCarloTest, read_bytes, run, with_values, write_file

WRITES = "--write" in sys.argv


def value_at(name, index, value):
    def edit(file):
        file[name][index] = value
    return edit


def one_chunk(size):
    """A layer in a single chunk that is not stored."""
    return lambda file: file.create_dataset("wide", shape=(size, size), chunks=(size, size), dtype="f4", compression="gzip")


def crs_of(text):
    def edit(file):
        file["crs"].attrs["crs_wkt"] = text
    return edit


def on_edges(file):
    """Returns every 0.1 m, halfway between the centres of bins of 0.1 m."""
    points = file["points"]
    n = np.arange(points["x_est"].size)
    points["x_est"][:] = (n % 40 - 20 + 0.5) * 0.1
    points["y_est"][:] = (n // 40 % 40 - 20 + 0.5) * 0.1


STEP = "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,50,1,0,0,0\n5e-324,0,0,49,1,0,0,0\n0.05,0,0,50,1,0,0,0\n2,0,0,48,1,0,0,0\n"
LONG = "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n-1e308,0,0,50,1,0,0,0\n1e308,0,0,49,1,0,0,0\n"


def scan_config(**changes):
    return json.dumps(with_values(SCAN, **changes))


HAZARDS = "hazard-map FILE -c hazard.json -o out.h5"
EVAL = "dem-eval FILE -c eval.json --metrics out.json"
MERGE = "monte-carlo merge FILE b.h5 -o out.h5"
TRACE = "scan-sim --terrain terrain.h5 -c FILE -o out.h5"
# The fault; the command; the file that is changed, or the name of a text file; the change, or the text.
CASES = [
    ("a negative 1-sigma", HAZARDS, "dem.h5", value_at("z_sigma_rel", (50, 40), -0.05)),
    ("an infinite 1-sigma", HAZARDS, "dem.h5", value_at("z_sigma_rel", (50, 40), np.inf)),
    ("a bin with an elevation and no 1-sigma", HAZARDS, "dem.h5", value_at("z_sigma_rel", (50, 40), np.nan)),
    ("no 1-sigma in any bin", HAZARDS, "dem.h5", value_at("z_sigma_rel", slice(None), np.nan)),
    ("an infinite elevation", HAZARDS, "dem.h5", value_at("z_est", (50, 40), -np.inf)),
    ("an infinite true elevation", HAZARDS, "dem.h5", value_at("z_true", (50, 40), np.inf)),
    ("an infinite elevation of a terrain", HAZARDS, "terrain.h5", value_at("z", (50, 40), np.inf)),
    ("a negative 1-sigma", EVAL, "dem.h5", value_at("z_sigma_abs", (50, 40), -0.05)),
    ("a negative 1-sigma without common errors", EVAL, "dem.h5", value_at("z_sigma_rel", (50, 40), -1)),
    ("an infinite elevation of the true map", EVAL, "dem.h5", value_at("z_true_map", (50, 40), np.inf)),
    ("a negative number of returns", EVAL, "dem.h5", value_at("count", (50, 40), -1)),
    ("a layer of 25,000,000 values in one chunk", "landfall-info FILE", "dem.h5", one_chunk(5000)),
    ("a text as coordinate reference system", "landfall-export FILE -o out.tif", "dem.h5", crs_of("somewhere [")),
    ("a text as coordinate reference system", "terrain-gen --from FILE -o out.tif", "terrain.h5", crs_of("somewhere [")),
    ("returns on the edges of bins", "regrid FILE -c regrid.json -o out.h5", "scan.h5", on_edges),
    ("a step of 5e-324 s in a trajectory", TRACE, "step.json", scan_config(trajectory={"type": "table", "path": "step.csv"})),
    ("a step of 2e308 s in a trajectory", TRACE, "long.json", scan_config(trajectory={"type": "table", "path": "long.csv"})),
    ("a velocity with which the pose overflows", TRACE, "fast.json",
     scan_config(trajectory__velocity_mps=[1e308, 0, 0], trajectory__position_m=[1.7e308, 0, 50])),
    ("a lidar below the ground", TRACE, "below.json", scan_config(trajectory__position_m=[0.5, -0.3, -5])),
    ("a key with a NUL byte", TRACE, "nul.json", '{"seed\\u0000": 1}'),
    ("a seed that is not the run's", MERGE, "a.h5", value_at("draws/seed", 0, 99)),
    ("a seed that does not follow the one before", MERGE, "a.h5", value_at("draws/seed", 1, 99)),
    ("a number of a draw that does not follow the one before", MERGE, "a.h5", value_at("draws/draw", 1, 99)),
    ("a draw that passes 7 times", MERGE, "a.h5", value_at("draws/pass", 1, 7)),
    ("a requirement that passes 5 times", MERGE, "a.h5", value_at("draws/requirements.coverage.pass", 1, 5)),
    ("a site that is true_safe 3 times", MERGE, "a.h5", value_at("draws/site.true_safe", 1, 3)),
    ("more missed hazards than places judged safe", MERGE, "a.h5", value_at("state/safety_missed", slice(None), 1)),
    ("standard output", "regrid scan.h5 -c regrid.json -o -", None, None),
    ("a name of 256 bytes", "regrid scan.h5 -c regrid.json -o " + 253 * "n" + ".h5", None, None),
]


def shortened(text):
    return re.sub("n{100,}", "nn..nn", text)


class Hostile(MonteCarloTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        chain = cls.chain
        for name, text in (("step.csv", STEP), ("long.csv", LONG), ("hazard.json", json.dumps(HAZARD)), ("regrid.json", json.dumps(REGRID)),
                           ("mc.json", json.dumps({**DRAWS, "hazard": HAZARD}))):
            write_file(chain.path(name), text)
        shutil.copy(chain.config("dem-eval"), chain.path("eval.json"))
        for command in ("regrid scan.h5 --terrain terrain.h5 -c regrid.json --uncertainty --navigation-sigma velocity_mps=0.1 -O -o dem.h5",
                        f"monte-carlo {chain.source} --terrain terrain.h5 -c mc.json --draws 0:2 -o a.h5 --set draws=3",
                        f"monte-carlo {chain.source} --terrain terrain.h5 -c mc.json --draws 2:3 -o b.h5 --set draws=3"):
            result = run(*command.split(), cwd=chain.folder)
            if result.returncode != 0:
                raise AssertionError(result.stderr)
        cls.inputs = os.listdir(chain.folder)

    def setUp(self):
        super().setUp()
        for name in self.inputs:
            os.symlink(self.chain.path(name), self.path(name))

    def answer(self, command, source, change):
        """Exit code and message of a command on a changed file, which is called FILE in it."""
        name = source or ""
        if isinstance(change, str):
            self.config(change, name)
        elif source:
            name = os.path.basename(self.changed(self.chain.path(source), change))
        result = run(*command.replace("FILE", name).split(), cwd=self.folder)
        notes = [line.strip() for line in result.stdout.splitlines() if "not read" in line]
        return result.returncode, " ".join(result.stderr.splitlines() + notes)

    def test_answers(self):
        rows = ["| input | command | exit | answer |", "|---|---|---|---|"]
        for what, command, source, change in CASES:
            with self.subTest(f"{what}: {command}"):
                code, message = self.answer(command, source, change)
                self.assertIn(code, (0, 1, 2))
                self.assertNotEqual(message, "")
                rows.append(f"| {what} | `{shortened(command).split(' -c')[0].split(' -o')[0]}` | {code} | `{shortened(message)}` |")
            for name in ("out.h5", "out.tif", "out.json"):
                if os.path.exists(self.path(name)):
                    os.unlink(self.path(name))
        if WRITES:
            page.write(page.with_table(page.read(), page.HOSTILE, rows))
        self.assertEqual(page.parts(page.read(), page.HOSTILE)[1], rows, "if the new answers are right, run with --write")

    def test_a_bin_without_sigma_counts_as_not_measured(self):
        """An elevation of 50 m without a 1-sigma changes no probability that it has with none; a map without any sigma has none."""
        def layers(edit):
            self.succeed("hazard-map", self.changed(self.chain.dem, edit), "-c", self.path("hazard.json"), "-o", self.path("h.h5"), "-O")
            with h5py.File(self.path("h.h5")) as file:
                return {name: file[name][()] for name in ("safe", "p_safe", "p_touchdown") if name in file}
        whole = layers(lambda file: None)
        some = layers(value_at("z_sigma_rel", (50, 40), np.nan))
        def raise_bin(file):
            file["z_est"][50, 40] += 50
            file["z_sigma_rel"][50, 40] = np.nan
        raised = layers(raise_bin)
        bare = layers(value_at("z_sigma_rel", slice(None), np.nan))
        np.testing.assert_array_equal(some["safe"], whole["safe"])
        self.assertNotIn("p_safe", bare)
        np.testing.assert_array_equal(np.isnan(some["p_safe"]), np.isnan(whole["p_safe"]))
        self.assertGreater(np.count_nonzero(some["p_safe"] != whole["p_safe"]), 50)
        near = np.hypot(*np.meshgrid(np.arange(101) - 40, np.arange(101) - 50)) < 5
        self.assertTrue((raised["safe"][near] != 1).all())
        np.testing.assert_allclose(raised["p_safe"][near], some["p_safe"][near], atol=1e-3)

    def test_no_damage_of_stored_values_is_missed(self):
        """--compression 0: an inverted 16-bit word (0000 is FFFF to fletcher32), erased blocks."""
        path = self.path("plain.h5")
        self.succeed("hazard-map", self.chain.dem, "-c", self.path("hazard.json"), "--compression", "0", "-o", path)
        with h5py.File(path) as file:
            chunk = file["slope"].id.get_chunk_info(0)
            expected = file["slope"][()]
        sound = read_bytes(path)
        values = chunk.byte_offset + 7  # behind the headers of the stream and of its stored block
        words = [at for at in range(values, chunk.byte_offset + chunk.size - 8, 2) if sound[at:at + 2] in (b"\0\0", b"\xff\xff")]
        self.assertGreater(len(words), 100)
        damages = [(at, bytes(255 - byte for byte in sound[at:at + 2])) for at in words[::len(words) // 12]]
        damages += [(chunk.byte_offset + begin, fill * size) for begin in (0, 1024, 16384) for size in (64, 4096) for fill in (b"\0", b"\xff")]
        for at, new in damages:
            damaged = sound[:at] + new + sound[at + len(new):]
            if damaged == sound:
                continue
            with self.subTest(at=at, size=len(new)):
                self.write("damaged.h5", damaged)
                self.refuse(1, "landfall-export", self.path("damaged.h5"), "--layers", "slope", "-o", self.path("x.csv"), words=["damaged.h5", "slope"])
                with h5py.File(self.path("damaged.h5")) as file, self.assertRaises(OSError):
                    file["slope"][()]
        np.testing.assert_array_equal(np.isnan(expected).any(), True)

    def test_small_uncompressed_files_are_small(self):
        for name, bound in (("monte-carlo", 2_000_000), ("hazard-map", 1_500_000), ("scan-sim", 10_000_000)):
            path = self.path(name + ".h5")
            self.succeed(name, *self.chain.inputs(name), "--compression", "0", "-o", path)
            self.assertLess(os.path.getsize(path), bound)

    def test_standard_output_is_no_output(self):
        for name in TOOLS:
            self.refuse(2, name, *INPUTS[name], "-o", "-", words=["-o needs a file", "standard output"], cwd=self.folder)
        self.assertNotIn("-", os.listdir(self.folder))

    def test_longest_names(self):
        for size in (240, 255):
            name = (size - 3) * "n" + ".h5"
            self.succeed("regrid", self.chain.scan, "-c", self.path("regrid.json"), "-o", self.path(name))
            self.assertTrue(os.path.exists(self.path(name)))
        self.assertEqual([entry for entry in self.entries() if entry.endswith(".part")], [])


if __name__ == "__main__":
    unittest.main(argv=[argument for argument in sys.argv if argument != "--write"])
