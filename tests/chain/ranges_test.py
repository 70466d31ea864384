#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""scan-sim --ranges-from draws the errors of an earlier scan again. redraw_keys_test.py changes all keys, receiver_test.py has echoes."""
import json
import unittest

import h5py

from errors_test import SCAN as ALL_ERRORS
from errors_test import scan_config
from harness import SCAN, ChainTest, columns, read_bytes, set_text, with_values
from mesh_test import off_text, rolling_terrain_with_a_roof

NO_LOSSES = ["--set", "noise.dead_pixel_frac=0", "--set", "noise.dropout_frac=0"]
OTHER = ["--seed", "11", "--set", "noise.range_sigma_m=0.02", "--set", "noise.dropout_frac=0.2",
         "--set", "navigation_error.velocity_mps=[0.1,0.2,0.3]"]
LOSSLESS = with_values(SCAN, noise__dead_pixel_frac=0, noise__dropout_frac=0)
WIDE = with_values(LOSSLESS, scanner__pattern__half_width_m=6)
FALSE = scan_config(["pointing_error.jitter_sigma_rad", "pointing_error.mirror_time_sigma_s", "noise.dropout_frac",
                     "noise.dead_pixel_frac"])
KEPT = ([], ["--keep-misses"])
# {name: (configuration, options of the source, options of the redraw)}; a redraw of noise by incidence needs the terrain.
REDRAWS = {
    # If the rows are those of the source, its true columns are copied instead of computed, with the same bytes.
    "errors": (SCAN, (NO_LOSSES, ["--keep-misses"], [*NO_LOSSES, "--keep-misses"], [*NO_LOSSES, "--compression", "0"]),
               (OTHER, [*OTHER, "--keep-misses"], [*OTHER, *NO_LOSSES], [*OTHER, *NO_LOSSES, "--keep-misses", "-t", "1"],
                [*OTHER, *NO_LOSSES, "--float32"], [*OTHER, *NO_LOSSES, "--compression", "3"])),
    # Rays that miss the terrain leave no row, so ranges are assigned by pixel and not by row.
    "pulses that lack pixels": (WIDE, ([],), [[*kept, "--seed", "3"] for kept in KEPT]),
    "several chunks": (with_values(LOSSLESS, laser={"pulse_rate_hz": 10000, "scan_time_s": 0.3}), ([],), (["--seed", "3"],)),
    "all errors": (ALL_ERRORS, (["--keep-misses"],), (
        [], ["--keep-misses"], ["--set", "noise.false_return_frac=0.3", "--keep-misses"],
        ["--set", "noise.false_return_frac=0", "--keep-misses"],
        ["--set", "pointing_error.time_stamp_bias_s=0", "--set", "navigation_error.random_walk={}"])),
    "without false returns": (FALSE, KEPT, [[*kept, "--seed", "12", "--set", "noise.false_return_frac=0"] for kept in KEPT]),
    "with false returns": (with_values(FALSE, noise__false_return_frac=0), KEPT,
                           [[*kept, "--seed", "12", "--set", "noise.false_return_frac=0.1"] for kept in KEPT]),
    "mesh": (with_values(SCAN, noise={}), ([],), (["--set", "noise.range_sigma_m=0.02", "--set", "noise.incidence_sigma_rad=1e-3"],)),
    "risley": ({**LOSSLESS, "scanner": {"type": "risley", "wedge_deg": [2, 2], "encoder_sigma_rad": 1e-3}}, ([],),
               (["--set", "noise.range_sigma_m=0.02"],)),
    "tilts that are not drawn": ({**LOSSLESS, "scanner": {"type": "polygon", "facet_tilt_rad": [1e-4] * 48}}, (["--keep-misses"],),
                                 (["--seed", "9"],)),
}


class RangesFrom(ChainTest):
    def scan(self, output, *options):
        return self.succeed("scan-sim", *self.chain.inputs("scan-sim"), "-O", "-o", self.path(output), *options)

    def replay_arguments(self, source, output, *options):
        return ["scan-sim", "-c", self.chain.config("scan-sim"), "--ranges-from", self.path(source), "-O", "-o",
                self.path(output), *options]

    def check_redraw(self, arguments, terrain, what):
        self.succeed("scan-sim", *arguments, *terrain, "-O", "-o", self.path("traced.h5"))
        needs_terrain = any("incidence" in word for word in arguments) or "errors" in what or "false" in what
        self.succeed("scan-sim", *arguments, *(terrain if needs_terrain else []), "--ranges-from", self.path("source.h5"),
                     "-O", "-o", self.path("replayed.h5"))
        self.assertEqual(read_bytes(self.path("replayed.h5")), read_bytes(self.path("traced.h5")), f"{what} {arguments}")

    def test_each_equals_a_traced_scan_byte_for_byte(self):
        self.succeed("terrain-gen", "--from", self.config(off_text(*rolling_terrain_with_a_roof()), "mesh.off"), "-o", self.path("mesh.h5"))
        for name, (config, sources, redraws) in REDRAWS.items():
            terrain = ["--terrain", self.path("mesh.h5") if name == "mesh" else self.chain.terrain]
            for source in sources:
                self.succeed("scan-sim", "-c", self.config(config), *terrain, *source, "-O", "-o", self.path("source.h5"))
                if name == "pulses that lack pixels":
                    self.assertGreater(len(set(columns(self.path("source.h5"), "pulses")["point_count"]) - {0}), 1)
                for options in redraws:
                    self.check_redraw(["-c", self.config(config), *options], terrain, f"{name} {source}")

    def test_a_redraw_of_noise_by_incidence_needs_the_terrain(self):
        self.succeed("scan-sim", "-c", self.config(ALL_ERRORS), "--terrain", self.chain.terrain, "--keep-misses",
                     "-o", self.path("source.h5"))
        self.refuse(2, "scan-sim", "-c", self.config(ALL_ERRORS), "--ranges-from", self.path("source.h5"), "-o", self.path("out.h5"),
                    words=["--terrain", "/noise/incidence_sigma_rad"], output=self.path("out.h5"))

    def test_a_source_whose_columns_differ_in_length_is_refused(self):
        self.scan("source.h5", *NO_LOSSES)
        with h5py.File(self.path("source.h5")) as file:
            rows = file["points/x_true"].shape[0]
        for length in (rows - 1, 0, rows + 1):
            with h5py.File(self.path("source.h5"), "r+") as file:
                file["points/x_true"].resize((length,))
            self.refuse(1, *self.replay_arguments("source.h5", "out.h5", *NO_LOSSES),
                        words=["source.h5", "/points/x_true", f"{length} rows where {rows}"],
                        output=self.path("out.h5"))

    def test_ranges_that_no_ray_has_are_refused(self):
        for value in (-1, float("inf"), float("-inf")):
            self.scan("source.h5", *NO_LOSSES)
            with h5py.File(self.path("source.h5"), "a") as file:
                file["points/range_true"][1000] = value
            self.refuse(1, *self.replay_arguments("source.h5", "replayed.h5"), output=self.path("replayed.h5"),
                        words=[self.path("source.h5"), "/points/range_true[1000] is not a finite range >= 0"])

    def test_a_different_table_of_pixels_is_refused(self):
        pixels = {"rows": 1, "columns": 2, "distribution": {"path": self.path("pixels.csv")}}
        table = ["--set", "detector=" + json.dumps(pixels)]
        self.write("pixels.csv", "row,column,u,v\n0,1,0.001,0\n0,0,-0.001,0.0005\n")
        self.scan("source.h5", *NO_LOSSES, *table)
        self.scan("traced.h5", *NO_LOSSES, *table, "--seed", "3")
        self.succeed(*self.replay_arguments("source.h5", "replayed.h5", *NO_LOSSES, *table, "--seed", "3"))
        self.assertEqual(read_bytes(self.path("replayed.h5")), read_bytes(self.path("traced.h5")))
        with open(self.path("pixels.csv"), "a", encoding="utf-8") as file:
            file.write("\n")  # the same pixels, but not the same file
        self.refuse(2, *self.replay_arguments("source.h5", "out.h5", *NO_LOSSES, *table), words=["pixels"],
                    output=self.path("out.h5"))

    def test_a_source_without_all_ranges_is_refused(self):
        self.scan("lossy.h5", "--set", "noise.dropout_frac=0.1")
        self.refuse(2, *self.replay_arguments("lossy.h5", "out.h5"), words=["--keep-misses"])
        self.scan("single.h5", *NO_LOSSES, "--float32")
        self.refuse(2, *self.replay_arguments("single.h5", "out.h5"), words=["single precision"])

    def test_a_source_with_a_malformed_configuration_is_refused(self):
        """A malformed error configuration in the source is refused, and the message names the source."""
        for key, value in [("pointing_error", 5), ("pointing_error", [1]), ("noise", 5), ("noise", {"dropout_frac": "0"})]:
            self.scan("source.h5", *NO_LOSSES)
            with h5py.File(self.path("source.h5"), "r+") as file:
                config = json.loads(file["provenance/config_json"].asstr()[()])
                set_text(file, "provenance/config_json", json.dumps(config | {key: value}))
            self.refuse(2, *self.replay_arguments("source.h5", "out.h5", *NO_LOSSES), words=["source.h5"],
                        output=self.path("out.h5"))

    def test_a_different_terrain_is_refused(self):
        self.scan("source.h5", *NO_LOSSES)
        self.succeed("terrain-gen", "-c", self.chain.config("terrain-gen"), "--set", "base.elevation_m=0.125", "-O",
                     "-o", self.path("other.h5"))
        self.refuse(2, *self.replay_arguments("source.h5", "out.h5", "--terrain", self.path("other.h5")),
                    words=["terrain"])


if __name__ == "__main__":
    unittest.main()
