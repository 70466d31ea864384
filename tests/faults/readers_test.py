#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Readers whose libraries do not find their data: the same result, or one message that names the variable."""
import io
import os
import struct
import sys
import unittest

import h5py
import numpy as np

sys.dont_write_bytecode = True
# pylint: disable=wrong-import-position
import surroundings
from harness import ToolTest, clouds, read_bytes


class Libraries(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.workshop = surroundings.ReaderWorkshop(os.environ["LANDFALL_BIN"])
        cls.addClassCleanup(cls.workshop.remove)

    def test_no_number_changes(self):
        refused = {}
        for judge in surroundings.try_libraries(self.workshop):
            self.assertEqual(judge.broken, [])
            variable = judge.fault.split()[0]
            refused[variable] = refused.get(variable, 0) + judge.counts["refused"]
            for message in judge.messages:
                self.assertIn(f"unset {variable}=", message)
        # Each of the variables is looked at by some reader; the others need no file of GDAL_DATA.
        self.assertEqual({name for name, count in refused.items() if count},
                         {"PROJ_LIB", "PROJ_DATA", "PROJ_AUX_DB", "UDUNITS2_XML_PATH"})


    def test_options_of_gdal_change_nothing(self):
        for judge in surroundings.try_options(self.workshop):
            self.assertEqual((judge.broken, judge.counts["refused"]), ([], 0), judge.messages)

    def test_keys_of_a_crs_without_a_code_have_its_unit(self):
        def extent(label):
            whole = next(files for one, files in self.workshop.whole.items() if one.label == label)
            with h5py.File(io.BytesIO(whole["a.h5"])) as file:
                return np.ptp(file["points/x_est" if "points" in file else "x"])
        for own, coded in (("points, keys of a CRS without a code", "points, GeoTIFF keys"), ("raster, own.tif", "raster, feet.tif")):
            self.assertAlmostEqual(extent(own) / extent(coded), 1, delta=1e-5)  # feet of two kinds


class UnknownCodes(ToolTest):
    """A code that PROJ's database lacks, as that of an older EPSG: GDAL takes a local CRS in metres."""
    CODES = {1: "the code of its CRS is not in PROJ's database", 29999: "the code of its CRS is not in PROJ's database",
             5703: "its CRS, NAVD88 height, is one of heights alone"}

    def check(self, content, name, tool, *arguments):
        key = struct.pack("<HHHH", 3072, 0, 1, surroundings.FEET)
        self.assertEqual(content.count(key), 1)
        for code, fault in self.CODES.items():
            path = self.write(name, content.replace(key, key[:6] + struct.pack("<H", code)))
            self.refuse(1, tool, *arguments, path, "-o", self.path("out.h5"), output=self.path("out.h5"),
                        words=[f"{path}: {fault}: give the CRS (--crs)"])
            self.succeed(tool, *arguments, path, "-O", "-o", self.path("other.h5"), "--crs", f"EPSG:{surroundings.FEET}", "--vertical-scale", 1)

    def test_points(self):
        keys = struct.pack("<12H", 1, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, surroundings.FEET)
        self.check(clouds.las(clouds.las_points(60), offset=(*surroundings.FEET_AT, 0.0),
                              records=[clouds.las_vlr("LASF_Projection", 34735, keys)]), "a.las", "landfall-import", "--keep-noise")

    def test_rasters(self):
        surroundings.raster(self.path("feet.tif"), f"EPSG:{surroundings.FEET}")
        content = read_bytes(self.path("feet.tif"))
        self.check(content, "a.tif", "landfall-import")
        self.check(content, "b.tif", "terrain-gen", "--datum", "none", "--from")


if __name__ == "__main__":
    unittest.main()
