#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Equal input, seed and version give equal bytes, at any number of threads."""
import json
import os
import unittest

import h5py

from errors_test import SCAN as ALL_ERRORS
from harness import DRAWS, HAZARD, SCAN, TERRAIN, TOOLS, ChainTest, columns, read_bytes, with_values, write_file
from harness.draws import DISPERSED, FRACTAL
from mesh_test import off_text, rolling_terrain_with_a_roof

FEATURES = {"grid": TERRAIN["grid"], "base": {"type": "fractal"}, "features": TERRAIN["features"], "patterns": [
    {"type": "ring", "count": 5, "radius_m": 3, "feature": {"type": "rock", "diameter_m": 1}}],
    "albedo": {"ground": {"type": "patches", "albedo": 0.9, "albedo_between": 0.2, "cover_frac": 0.4, "longest_wavelength_m": 4}}}
SIGMAS = "--uncertainty --corrected --navigation-sigma position_m=0.1 --navigation-sigma rpy_rad=0.001"
# A sequential test that ends long before the last draw.
TESTED = {"stop": {"type": "sprt", "p0": 0.9, "p1": 0.1}, "metrics": "verdict"}
DRAWS_CONFIG = "monte-carlo source.h5 --terrain terrain.h5 -c monte-carlo.json --set draws=9 -o OUT/d.h5"
OPTIONS = ("-t 1", "-t 2", "-t 7")
DRAWS_OPTIONS = ("-t 1", "-t 2", "-t 3", "-t 16")  # as many draws at a time
BATCHES = (*OPTIONS, "-t 7 --batch-points 1", "-t 2 --batch-points 100", "-t 1 --batch-points 70000", "-t 2 --batch-points 16777216")
# A scan of 192,000 points.
MANY = "scan-sim --terrain terrain.h5 -c scan-sim.json --set laser.pulse_rate_hz=10000 --set laser.scan_time_s=0.3 -o OUT/s.h5"
ERRORS = "scan-sim --terrain terrain.h5 -c errors.json -o OUT/s.h5"
# Commands in the folder of the chain's files, which write into the folder OUT, and the options that change none of their bytes.
COMMANDS = [
    ("terrain-gen -c features.json -o OUT/t.h5", OPTIONS),
    ("terrain-gen --from mesh.off -o OUT/t.h5", OPTIONS),
    *((MANY + more, BATCHES[::step]) for more, step in (("", 1), (" --keep-misses", 1), (" --float32", 3), (" --compression 0", 3), (" --compression 6", 3))),
    *((ERRORS + more, BATCHES) for more in ("", " --keep-misses")),
    ("scan-sim --terrain mesh.h5 -c scan-sim.json --set noise.incidence_sigma_rad=1e-4 -o OUT/s.h5", OPTIONS),
    ("scan-sim --plan --plan-radius 5 --plan-resolution 0.1 -c scan-sim.json -o OUT/p.h5", OPTIONS),
    *((f"regrid scan.h5 --terrain terrain.h5 -c regrid.json --method {method} -o OUT/d.h5", OPTIONS)
      for method in ("bilinear_nearest", "bilinear4", "mean", "min", "max", "median")),
    ("regrid scan.h5 --terrain mesh.h5 --same-frame -c regrid.json -o OUT/d.h5", OPTIONS),
    (f"regrid scan.h5 --terrain terrain.h5 -c regrid.json {SIGMAS} -o OUT/d.h5", OPTIONS),
    *((f"hazard-map dem.h5 -c {method}.json -o OUT/h.h5 --sites OUT/a.json --score OUT/b.json --report OUT/h.html", OPTIONS)
      for method in ("contact", "plane", "range_difference", "lmeds")),
    *((DRAWS_CONFIG + more, DRAWS_OPTIONS)
      for more in (" --set metrics=full", " --set metrics=verdict", " --set metrics=verdict -c hazard.json", " -c tested.json")),
    ("monte-carlo -c traced.json -o OUT/d.h5", DRAWS_OPTIONS),
    *((f"landfall-export {source} -o OUT/a.{kind}", OPTIONS)
      for source, kind in (("eval.h5 --layers all", "tif"), ("scan.h5", "png"), ("dem.h5", "png"), ("scan.h5", "csv"),
                           ("scan.h5 --max-points 2000", "html"))),
    ("landfall-import points.csv -o OUT/s.h5 -q", OPTIONS),
]


class Repeat(ChainTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        chain = cls.chain
        configs = {"features": FEATURES, "errors": ALL_ERRORS, "hazard": {"hazard": HAZARD}, "tested": TESTED, "traced": {
            **DRAWS, "draws": 5, "scan": SCAN, "terrain": FRACTAL, "terrain_seed": "each", "vary": DISPERSED}}
        for method in ("contact", "plane", "range_difference", "lmeds"):
            configs[method] = with_values(HAZARD, z_sigma_m=0.02, method=method, limits__roughness_m=0.1)
        texts = {**{name + ".json": json.dumps(config) for name, config in configs.items()},
                 "mesh.off": off_text(*rolling_terrain_with_a_roof()),
                 "points.csv": "x,y,z\n" + "".join(f"{i % 173 / 7:.3f},{i % 97 / 5:.3f},{i % 13 / 3:.3f}\n" for i in range(30000))}
        for name, text in texts.items():
            write_file(chain.path(name), text)
        chain.make("terrain-gen", ["--from", chain.path("mesh.off"), "-o", chain.path("mesh.h5")])
        assert os.path.exists(chain.source)

    def written(self, command, options):
        """The bytes of the files that a command writes."""
        tool, *words = command.replace("OUT", self.folder).split()
        self.succeed(tool, *words, *options.split(), "-O", cwd=self.chain.folder)
        return {name: read_bytes(self.path(name)) for name in self.entries()}

    def test_each_command_writes_the_same_bytes_with_any_threads_and_batches(self):
        for command, variants in COMMANDS:
            with self.subTest(command):
                first = self.written(command, variants[0])
                for options in variants[1:]:
                    self.assertEqual(self.written(command, options), first, options)
                for name in first:
                    os.remove(self.path(name))

    def test_the_chain_again_and_at_the_default_of_threads(self):
        for name in TOOLS:
            for threads in (0, 2):
                output, metrics = self.path("out.h5"), self.path("metrics.json")
                extra = ["--metrics", metrics] if name == "dem-eval" else []
                self.succeed(name, *self.chain.inputs(name), "-o", output, "-O", "-t", threads, *extra)
                self.assertEqual(read_bytes(output), read_bytes(self.chain.output(name)), f"{name} -t {threads}")
                if extra:
                    self.assertEqual(read_bytes(metrics), read_bytes(self.chain.metrics))

    def test_the_seed_changes_the_noise_and_nothing_else(self):
        self.succeed("scan-sim", *self.chain.inputs("scan-sim"), "--seed", "8", "-o", self.path("other.h5"),
                     "--set", "noise.dead_pixel_frac=0", "--set", "noise.dropout_frac=0")
        self.succeed("scan-sim", *self.chain.inputs("scan-sim"), "--seed", "9", "-o", self.path("third.h5"),
                     "--set", "noise.dead_pixel_frac=0", "--set", "noise.dropout_frac=0")
        one, two = (columns(self.path(name), "points") for name in ("other.h5", "third.h5"))
        self.assertEqual(one["range_true"].tobytes(), two["range_true"].tobytes())
        self.assertFalse((one["range_measured"] == two["range_measured"]).any())

    def test_file_ids_follow_config_and_inputs(self):
        def file_id(path):
            with h5py.File(path) as file:
                return file.attrs["file_id"]
        ids = {file_id(self.chain.output(name)) for name in TOOLS}
        self.assertEqual(len(ids), len(TOOLS))
        self.succeed("terrain-gen", *self.chain.inputs("terrain-gen"), "-o", self.path("t.h5"), "--set",
                     "base.elevation_m=0.3")
        self.assertNotEqual(file_id(self.path("t.h5")), file_id(self.chain.terrain))
        self.succeed("scan-sim", "--terrain", self.path("t.h5"), "-c", self.chain.config("scan-sim"), "-o",
                     self.path("s.h5"))
        self.assertNotEqual(file_id(self.path("s.h5")), file_id(self.chain.scan))


if __name__ == "__main__":
    unittest.main()
