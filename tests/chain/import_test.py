#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""terrain-gen --from: a raster imported by options alone, and a terrain exported as a GeoTIFF for GDAL and GMT."""
import json
import os
import resource
import socket
import struct
import subprocess
import unittest

import h5py
import numpy as np

from harness import ToolTest, read_bytes, run

CONE = ["--set", 'features=[{"type":"cone","radius_m":3,"height_m":10}]', "--set",
        'base={"type":"plane","slope_x":0.1,"slope_y":-0.05}']
UTM = "EPSG:32631"


def gdal(*arguments):
    return subprocess.run(arguments, capture_output=True, text=True, check=True).stdout


class ImportTest(ToolTest):
    def raster(self, name="raster.asc", size=21, cell=2.0, corner=(500000, 4000000)):
        """An Esri grid without a CRS; z = 100 + 2 column + 3 row."""
        path = self.path(name)
        row, col = np.mgrid[0:size, 0:size]
        with open(path, "w", encoding="ascii") as file:
            file.write(f"ncols {size}\nnrows {size}\nxllcorner {corner[0]}\nyllcorner {corner[1]}\ncellsize {cell}\n")
            np.savetxt(file, 100 + 2 * col + 3 * row, "%d")
        return path

    def projected(self, name="raster.tif", **values):
        path = self.path(name)
        gdal("gdal_translate", "-q", "-a_srs", UTM, self.raster(**values), path)
        return path

    def config_of(self, *arguments):
        return json.loads(self.succeed("terrain-gen", *arguments, "--print-config").stdout)

    def nodes(self, path):
        with h5py.File(path) as file:
            return file["x"][()], file["y"][()], file["z"][()]


class Options(ImportTest):
    def test_options_give_the_same_terrain_as_a_configuration(self):
        path = self.projected()
        options = ["--from", path, "--center", "500020,4000023", "--half-width", "10", "--resolution", "0.5",
                   "--interpolation", "bilinear", "--datum", "none", "--vertical-scale", "1.5", "--band", "1"]
        config = {"base": {"type": "dem", "path": path, "center": [500020, 4000023], "interpolation": "bilinear",
                           "datum": "none", "vertical_scale": 1.5, "band": 1},
                  "grid": {"half_width_m": 10, "resolution_m": 0.5}}
        self.assertEqual(self.config_of(*options), self.config_of("-c", self.config(config)))
        self.succeed("terrain-gen", *options, "-o", self.path("a.h5"))
        self.succeed("terrain-gen", "-o", self.path("b.h5"), *options[2:], *options[:2])
        self.succeed("terrain-gen", "-c", self.config(config), "-o", self.path("c.h5"))
        self.assertEqual(read_bytes(self.path("a.h5")), read_bytes(self.path("c.h5")))
        self.assertEqual(read_bytes(self.path("b.h5")), read_bytes(self.path("c.h5")))

    def test_other_options_set_their_keys(self):
        path = self.raster()
        base = self.config_of("--from", path, "--center-pixel", "3,4.5", "--horizontal-scale", "2", "--half-width",
                              "1", "--resolution", "1")["base"]
        self.assertEqual((base["center_pixel"], base["horizontal_scale_m"]), ([3, 4.5], 2))

    def test_set_overrides_and_extends_the_options(self):
        path = self.projected()
        config = self.config_of("--from", path, "--half-width", "10", "--resolution", "1", "--set",
                                "grid.half_width_m=8", "--set", 'base.datum="none"', *CONE[:2])
        self.assertEqual(config["grid"]["half_width_m"], 8)
        self.assertEqual(config["base"]["datum"], "none")
        self.assertEqual(len(config["features"]), 1)

    def test_the_size_defaults_to_that_of_the_raster(self):
        path = self.projected()
        grid = lambda *options: self.config_of("--from", path, *options)["grid"]
        self.assertEqual(grid(), {"half_width_m": 20, "resolution_m": 2})
        self.assertEqual(grid("--resolution", "0.5"), {"half_width_m": 20, "resolution_m": 0.5})
        self.assertEqual(grid("--resolution", "3"), {"half_width_m": 18, "resolution_m": 3})
        self.assertEqual(grid("--half-width", "10"), {"half_width_m": 10, "resolution_m": 2})
        self.assertEqual(grid("--half-width", "9"), {"half_width_m": 9, "resolution_m": 1.8})
        self.assertEqual(grid("--center-pixel", "4,10"), {"half_width_m": 8, "resolution_m": 2})
        self.assertEqual(grid("--set", "grid.resolution_m=4"), {"half_width_m": 20, "resolution_m": 4})
        self.refuse(2, "terrain-gen", "--from", path, "--resolution", "0.001", "--check", words=["--half-width"])
        self.refuse(1, "terrain-gen", "--from", path, "--center", "0,0", "--check", words=["another center"])
        # Without --from the options only set the keys of the configuration.
        self.assertEqual(self.config_of("--half-width", "3", "--resolution", "1")["grid"],
                         {"half_width_m": 3, "resolution_m": 1})

    def test_unusual_paths_and_negative_coordinates(self):
        self.projected(name="a: b,c.tif")
        self.succeed("terrain-gen", "--from", self.path("a: b,c.tif"), "-o", self.path("site 1.h5"))
        layer = f'NETCDF:"{self.path("site 1.h5")}":z'
        self.succeed("terrain-gen", "--from", layer, "-o", self.path("again.h5"), "--interpolation", "nearest")
        np.testing.assert_array_equal(self.nodes(self.path("again.h5"))[2], self.nodes(self.path("site 1.h5"))[2])
        west = self.projected(name="west.tif", corner=(-140, 30), cell=0.001)
        for center in (["--center", "-139.99,30.0105"], ["--center=-139.99,30.0105"]):
            self.assertEqual(self.config_of("--from", west, *center, "--half-width", "0.001", "--resolution",
                                            "0.0005")["base"]["center"], [-139.99, 30.0105])

    def test_a_tag_that_cannot_be_read_is_not_ignored(self):
        """GDAL would ignore the tag, which here holds a scale of 2."""
        path = self.path("scaled.tif")
        gdal("gdal_translate", "-q", "-a_srs", UTM, "-a_scale", "2", self.raster(), path)
        with open(path, "r+b") as file:
            data = file.read()
            first, = struct.unpack_from("<I", data, 4)
            count, = struct.unpack_from("<H", data, first)
            entry = next(at for at in range(first + 2, first + 2 + 12 * count, 12) if struct.unpack_from("<H", data, at) == (42112,))
            file.seek(entry + 8)
            file.write(struct.pack("<I", len(data) + 1000))  # past the end of the file
        output = self.path("t.h5")
        self.refuse(1, "terrain-gen", "--from", path, "-o", output, words=[path, "cannot be read as a whole", "GDALMetadata"], output=output)

    def test_check_writes_nothing(self):
        self.succeed("terrain-gen", "--from", self.projected(), "--check", "-o", self.path("out.h5"))
        self.assertNotIn("out.h5", self.entries())


class Export(ImportTest):
    def made(self, *arguments, name="t.h5"):
        self.succeed("terrain-gen", "-o", self.path(name), "--set", "grid.half_width_m=30", *arguments)
        return self.path(name)

    def values(self, tif):
        """The output of gdalinfo, and all pixels; row 0 is the northernmost."""
        gdal("gdal_translate", "-q", "-of", "ENVI", tif, self.path("raw"))
        info = json.loads(gdal("gdalinfo", "-json", tif))
        cols, rows = info["size"]
        return info, np.fromfile(self.path("raw"), "<f8").reshape(rows, cols)

    def test_writes_a_cloud_optimized_geotiff_of_the_same_nodes(self):
        for compression in ("1", "0"):
            terrain, tif = self.made(*CONE, "-O"), self.path(f"t{compression}.tif")
            self.succeed("terrain-gen", "--from", terrain, "-o", tif, "--compression", compression)
            x, y, z = self.nodes(terrain)
            info, values = self.values(tif)
            np.testing.assert_array_equal(values, z[::-1])
            self.assertEqual(info["metadata"]["IMAGE_STRUCTURE"]["LAYOUT"], "COG")
            band, = info["bands"]
            self.assertEqual((band["type"], band["noDataValue"], band["block"]), ("Float64", "NaN", [512, 512]))
            self.assertEqual([level["size"] for level in band["overviews"]], [[601, 601], [301, 301]])
            np.testing.assert_allclose(info["geoTransform"], [x[0] - 0.025, 0.05, 0, y[-1] + 0.025, 0, -0.05],
                                       atol=1e-12)
            self.assertIn("landfall site frame", info["coordinateSystem"]["wkt"])
            value = gdal("gdallocationinfo", "-valonly", "-geoloc", tif, repr(x[700]), repr(y[900]))
            self.assertEqual(float(value), z[900, 700])
            # Each pixel of the first overview is the mean of 2 x 2 nodes, or of fewer at the edges.
            gdal("gdal_translate", "-q", "-of", "ENVI", "-outsize", "601", "601", "-r", "nearest", tif,
                 self.path("raw"))
            half = np.fromfile(self.path("raw"), "<f8").reshape(601, 601)
            self.assertAlmostEqual(half[0, 0], z[::-1][:1, :1].mean(), delta=0.02)
            self.assertAlmostEqual(half[300, 200], z[::-1][599:601, 399:401].mean(), delta=0.02)
        self.assertEqual([name for name in self.entries() if ".tif." in name], [])

    def test_a_configuration_is_exported_directly(self):
        """The GeoTIFF of a configuration equals that of its terrain.h5, byte for byte, at any number of threads."""
        terrain = self.made(*CONE)
        self.succeed("terrain-gen", "--from", terrain, "--check")
        self.succeed("terrain-gen", "--from", terrain, "-o", self.path("a.TIFF"), "-t", "1")
        self.made(*CONE, "-t", "2", name="b.tif")
        self.assertEqual(read_bytes(self.path("a.TIFF")), read_bytes(self.path("b.tif")))

    def test_an_exported_terrain_is_imported_unchanged(self):
        tif = self.path("t.tif")
        for source in ([], ["--from", self.projected(size=41)]):
            terrain = self.made(*source, *([] if source else CONE), "--set", "grid.resolution_m=0.25", "-O")
            self.succeed("terrain-gen", "--from", terrain, "-o", tif, "-O")
            x, _, z = self.nodes(terrain)
            for method, tolerance in [("nearest", 0), ("bilinear", 1e-9), ("bicubic", 1e-9)]:
                self.succeed("terrain-gen", "--from", tif, "-o", self.path("back.h5"), "-O", "--datum", "none",
                             "--interpolation", method)
                back_x, _, back = self.nodes(self.path("back.h5"))
                np.testing.assert_array_equal(back_x, x)
                np.testing.assert_allclose(back, z, rtol=0, atol=tolerance)
        self.assertIn("WGS 84", gdal("gdalinfo", tif))  # the CRS of the imported raster

    def test_holes_stay_holes(self):
        raster = self.path("holes.asc")
        with open(raster, "w", encoding="ascii") as file:
            file.write("ncols 9\nnrows 9\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value -1\n")
            file.write("5 5 5 5 5 5 5 5 5\n" * 3 + "5 5 -1 -1 5 5 5 5 5\n" + "5 5 5 5 5 5 5 5 5\n" * 5)
        self.succeed("terrain-gen", "--from", raster, "--horizontal-scale", "1", "--interpolation", "nearest", "-o",
                     self.path("h.tif"), "--datum", "none")
        _, values = self.values(self.path("h.tif"))
        self.assertEqual(np.argwhere(np.isnan(values)).tolist(), [[3, 2], [3, 3]])

    def test_a_full_disk_is_reported(self):
        terrain = self.made("--set", 'base={"type":"fractal"}', "--set", "grid.resolution_m=0.1")
        self.succeed("terrain-gen", "--from", terrain, "-o", self.path("all.tif"))
        size = os.path.getsize(self.path("all.tif"))
        for part in (0.01, 0.3, 0.7, 0.95, 1 - 1 / size):
            limit = int(part * size)
            result = run("terrain-gen", "--from", terrain, "-o", self.path("out.tif"),
                         preexec_fn=lambda limit=limit: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
            self.assertEqual(result.returncode, 1, f"{part}: {result.stderr}")
            self.check_message("terrain-gen", result.stderr, ["out.tif"])
            self.assertEqual(self.entries(), ["all.tif", "t.h5"])


class Network(ImportTest):
    def test_a_file_opens_no_network_connection(self):
        """A VRT and a WMS description name a server on this machine, which receives no connection."""
        with socket.socket() as server:
            server.bind(("127.0.0.1", 0))
            server.listen()
            server.settimeout(0.2)
            url = f"http://127.0.0.1:{server.getsockname()[1]}/a.tif"
            source = ('<VRTDataset rasterXSize="9" rasterYSize="9"><GeoTransform>0,1,0,9,0,-1</GeoTransform>'
                      '<VRTRasterBand dataType="Byte" band="1"><SimpleSource><SourceFilename>/vsicurl/{}'
                      '</SourceFilename></SimpleSource></VRTRasterBand></VRTDataset>')
            service = ('<GDAL_WMS><Service name="TMS"><ServerUrl>{}</ServerUrl></Service><DataWindow>'
                       '<UpperLeftX>0</UpperLeftX><UpperLeftY>9</UpperLeftY><LowerRightX>9</LowerRightX>'
                       '<LowerRightY>0</LowerRightY><SizeX>9</SizeX><SizeY>9</SizeY></DataWindow></GDAL_WMS>')
            for name, text in [("remote.vrt", source), ("remote.xml", service)]:
                path = self.config(text.format(url), name)
                for follow in ([], ["--follow-links"]):
                    self.refuse(1, "terrain-gen", "--from", path, "--horizontal-scale", "1", "-o", self.path("x.h5"),
                                *follow, words=[name])
                with self.assertRaises(socket.timeout):
                    server.accept()


if __name__ == "__main__":
    unittest.main()
