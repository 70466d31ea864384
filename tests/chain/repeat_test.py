#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Equal input, seed and version give equal bytes, at any number of threads."""
import unittest

import h5py

from harness import TOOLS, ChainTest, columns, read_bytes


class Repeat(ChainTest):
    def test_the_same_bytes_again_and_with_1_2_and_7_threads(self):
        for name in TOOLS:
            for threads in (0, 1, 2, 7):
                output, metrics = self.path("out.h5"), self.path("metrics.json")
                extra = ["--metrics", metrics] if name == "dem-eval" else []
                self.succeed(name, *self.chain.inputs(name), "-o", output, "-O", "-t", threads, *extra)
                self.assertEqual(read_bytes(output), read_bytes(self.chain.output(name)), f"{name} -t {threads}")
                if extra:
                    self.assertEqual(read_bytes(metrics), read_bytes(self.chain.metrics))

    def test_a_scan_in_batches_of_any_size_at_1_2_and_7_threads(self):
        values = ["--set", "laser.pulse_rate_hz=10000", "--set", "laser.scan_time_s=0.3"]  # 192,000 points
        for options in ([], ["--keep-misses"], ["--float32"], ["--compression", "0"], ["--compression", "6"]):
            outputs = set()
            for threads, points in ((1, 16384), (2, 16384), (7, 16384), (7, 1), (2, 100), (1, 70000), (2, 1 << 24)):
                self.succeed("scan-sim", *self.chain.inputs("scan-sim"), *values, *options, "-o", self.path("s.h5"),
                             "-O", "-t", threads, "--batch-points", points)
                outputs.add(read_bytes(self.path("s.h5")))
            self.assertEqual(len(outputs), 1, options)

    def test_a_map_by_every_method_at_1_2_and_7_threads(self):
        for method in ("bilinear_nearest", "bilinear4", "mean", "min", "max", "median"):
            files = []
            for threads in (1, 2, 7):
                files.append(self.path(f"{threads}.h5"))
                self.succeed("regrid", *self.chain.inputs("regrid"), "--method", method, "-o", files[-1], "-O", "-t",
                             threads)
            self.assertEqual(len({read_bytes(file) for file in files}), 1, method)

    def test_the_seed_changes_the_noise_and_nothing_else(self):
        self.succeed("scan-sim", *self.chain.inputs("scan-sim"), "--seed", "8", "-o", self.path("other.h5"),
                     "--set", "noise.dead_pixel_frac=0", "--set", "noise.dropout_frac=0")
        self.succeed("scan-sim", *self.chain.inputs("scan-sim"), "--seed", "9", "-o", self.path("third.h5"),
                     "--set", "noise.dead_pixel_frac=0", "--set", "noise.dropout_frac=0")
        one, two = (columns(self.path(name), "points") for name in ("other.h5", "third.h5"))
        self.assertEqual(one["range_true"].tobytes(), two["range_true"].tobytes())
        self.assertFalse((one["range_measured"] == two["range_measured"]).any())

    def test_the_draws_do_not_depend_on_other_errors(self):
        """The range noise is the same with and without dropouts and dead pixels."""
        self.succeed("scan-sim", *self.chain.inputs("scan-sim"), "--keep-misses", "-o", self.path("some.h5"))
        self.succeed("scan-sim", *self.chain.inputs("scan-sim"), "--keep-misses", "-o", self.path("all.h5"),
                     "--set", "noise.dead_pixel_frac=0", "--set", "noise.dropout_frac=0")
        some, every = (columns(self.path(name), "points") for name in ("some.h5", "all.h5"))
        returned = some["status"] == 0
        self.assertLess(returned.sum(), len(returned))
        self.assertTrue((some["range_measured"] == every["range_measured"])[returned].all())

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
