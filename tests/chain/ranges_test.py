#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""scan-sim --ranges-from: the errors of an earlier scan are drawn again."""
import json
import unittest

import h5py

from harness import ChainTest, columns, read_bytes, set_text


class RangesFrom(ChainTest):
    NO_LOSSES = ["--set", "noise.dead_pixel_frac=0", "--set", "noise.dropout_frac=0"]
    OTHER_ERRORS = ["--seed", "11", "--set", "noise.range_sigma_m=0.02", "--set", "noise.dropout_frac=0.2",
                    "--set", "navigation_error.velocity_mps=[0.1,0.2,0.3]"]

    def scan(self, output, *options):
        return self.succeed("scan-sim", *self.chain.inputs("scan-sim"), "-O", "-o", self.path(output), *options)

    def replay_arguments(self, source, output, *options):
        return ["scan-sim", "-c", self.chain.config("scan-sim"), "--ranges-from", self.path(source), "-O", "-o",
                self.path(output), *options]

    def test_equals_a_traced_run_byte_for_byte(self):
        """If the rows are those of the source, its true columns are copied instead of computed, with the same bytes."""
        no_losses = [*self.OTHER_ERRORS, *self.NO_LOSSES]
        for source_options in (self.NO_LOSSES, ["--keep-misses"], [*self.NO_LOSSES, "--keep-misses"],
                               [*self.NO_LOSSES, "--compression", "0"]):
            self.scan("source.h5", *source_options)
            for options in (self.OTHER_ERRORS, [*self.OTHER_ERRORS, "--keep-misses"], no_losses,
                            [*no_losses, "--keep-misses"], [*no_losses, "--float32"],
                            [*no_losses, "--compression", "3"]):
                self.scan("traced.h5", *options)
                for threads in (1, 2):
                    self.succeed(*self.replay_arguments("source.h5", "replayed.h5", *options, "-t", threads))
                    self.assertEqual(read_bytes(self.path("replayed.h5")), read_bytes(self.path("traced.h5")))

    def test_pulses_that_lack_pixels(self):
        """Rays that miss the terrain leave no row, so ranges are assigned by pixel and not by row."""
        wide = ["--set", "scanner.pattern.half_width_m=6", *self.NO_LOSSES]
        self.scan("source.h5", *wide)
        points = columns(self.path("source.h5"), "pulses")["point_count"]
        self.assertGreater(len(set(points) - {0}), 1)
        for options in ([], ["--keep-misses"]):
            self.scan("traced.h5", *wide, *options, "--seed", "3")
            self.succeed(*self.replay_arguments("source.h5", "replayed.h5", *wide, *options, "--seed", "3"))
            self.assertEqual(read_bytes(self.path("replayed.h5")), read_bytes(self.path("traced.h5")))

    def test_several_chunks_are_copied(self):
        more = ["--set", "laser.pulse_rate_hz=10000", "--set", "laser.scan_time_s=0.3", *self.NO_LOSSES]
        self.scan("source.h5", *more)
        self.scan("traced.h5", *more, "--seed", "3")
        self.succeed(*self.replay_arguments("source.h5", "replayed.h5", *more, "--seed", "3"))
        self.assertEqual(read_bytes(self.path("replayed.h5")), read_bytes(self.path("traced.h5")))

    def test_a_source_whose_columns_differ_in_length_is_refused(self):
        self.scan("source.h5", *self.NO_LOSSES)
        with h5py.File(self.path("source.h5")) as file:
            rows = file["points/x_true"].shape[0]
        for length in (rows - 1, 0, rows + 1):
            with h5py.File(self.path("source.h5"), "r+") as file:
                file["points/x_true"].resize((length,))
            self.refuse(1, *self.replay_arguments("source.h5", "out.h5", *self.NO_LOSSES),
                        words=["source.h5", "/points/x_true", f"{length} rows where {rows}"],
                        output=self.path("out.h5"))

    def test_ranges_that_no_ray_has_are_refused(self):
        for value in (-1, float("inf"), float("-inf")):
            self.scan("source.h5", *self.NO_LOSSES)
            with h5py.File(self.path("source.h5"), "a") as file:
                file["points/range_true"][1000] = value
            self.refuse(1, *self.replay_arguments("source.h5", "replayed.h5"), output=self.path("replayed.h5"),
                        words=[self.path("source.h5"), "/points/range_true[1000] is not a finite range >= 0"])

    def test_a_mismatch_names_the_key(self):
        self.scan("source.h5", *self.NO_LOSSES)
        for key, value in [("detector.subpixels", 2), ("detector.fill_factor", 0.5), ("detector.estimator", '"first"'),
                           ("detector.distortion.k1", 0.5), ("laser.pulse_rate_hz", 1234), ("mount.position_m", "[0,0,1]"),
                           ("scanner.pattern.columns", 7), ("trajectory.position_m", "[0,0,51]")]:
            self.refuse(2, *self.replay_arguments("source.h5", "out.h5", "--set", f"{key}={value}"),
                        words=["/" + key.replace(".", "/")], output=self.path("out.h5"))

    def test_a_different_table_of_pixels_is_refused(self):
        pixels = {"rows": 1, "columns": 2, "distribution": {"path": self.path("pixels.csv")}}
        table = ["--set", "detector=" + json.dumps(pixels)]
        with open(self.path("pixels.csv"), "w", encoding="utf-8") as file:
            file.write("row,column,u,v\n0,1,0.001,0\n0,0,-0.001,0.0005\n")
        self.scan("source.h5", *self.NO_LOSSES, *table)
        self.scan("traced.h5", *self.NO_LOSSES, *table, "--seed", "3")
        self.succeed(*self.replay_arguments("source.h5", "replayed.h5", *self.NO_LOSSES, *table, "--seed", "3"))
        self.assertEqual(read_bytes(self.path("replayed.h5")), read_bytes(self.path("traced.h5")))
        with open(self.path("pixels.csv"), "a", encoding="utf-8") as file:
            file.write("\n")  # the same pixels, but not the same file
        self.refuse(2, *self.replay_arguments("source.h5", "out.h5", *self.NO_LOSSES, *table), words=["pixels"],
                    output=self.path("out.h5"))

    def test_a_source_without_all_ranges_is_refused(self):
        self.scan("lossy.h5", "--set", "noise.dropout_frac=0.1")
        self.refuse(2, *self.replay_arguments("lossy.h5", "out.h5"), words=["--keep-misses"])
        self.scan("single.h5", *self.NO_LOSSES, "--float32")
        self.refuse(2, *self.replay_arguments("single.h5", "out.h5"), words=["single precision"])

    def test_a_source_with_a_malformed_configuration_is_refused(self):
        """A malformed error configuration in the source is refused, and the message names the source."""
        for key, value in [("pointing_error", 5), ("pointing_error", [1]), ("noise", 5), ("noise", {"dropout_frac": "0"})]:
            self.scan("source.h5", *self.NO_LOSSES)
            with h5py.File(self.path("source.h5"), "r+") as file:
                config = json.loads(file["provenance/config_json"].asstr()[()])
                set_text(file, "provenance/config_json", json.dumps(config | {key: value}))
            self.refuse(2, *self.replay_arguments("source.h5", "out.h5", *self.NO_LOSSES), words=["source.h5"],
                        output=self.path("out.h5"))

    def test_a_different_terrain_is_refused(self):
        self.scan("source.h5", *self.NO_LOSSES)
        self.succeed("terrain-gen", "-c", self.chain.config("terrain-gen"), "--set", "base.elevation_m=0.125", "-O",
                     "-o", self.path("other.h5"))
        self.refuse(2, *self.replay_arguments("source.h5", "out.h5", "--terrain", self.path("other.h5")),
                    words=["terrain"])


if __name__ == "__main__":
    unittest.main()
