#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rasters open no files but their own parts, unless --follow-links is given.

The file that must not be opened is a pipe, because opening it would block.
"""
import os
import struct
import unittest

import h5py
import numpy as np

from harness import ToolTest

SIZE = 9
VALUES = np.arange(SIZE * SIZE, dtype=">i2").reshape(SIZE, SIZE)
HEAD = f'<VRTDataset rasterXSize="{SIZE}" rasterYSize="{SIZE}">'
SOURCE = '<SimpleSource><SourceFilename relativeToVRT="{1}">{0}</SourceFilename><SourceBand>1</SourceBand></SimpleSource>'
RAW = ('<SourceFilename relativeToVRT="{1}">{0}</SourceFilename><ImageOffset>0</ImageOffset><PixelOffset>2</PixelOffset>'
       f'<LineOffset>{2 * SIZE}</LineOffset><ByteOrder>MSB</ByteOrder>')
PYTHON = ('<PixelFunctionType>f</PixelFunctionType><PixelFunctionLanguage>Python</PixelFunctionLanguage><PixelFunctionCode>'
          "<![CDATA[\nimport os\ndef f(*words, **more):\n    os.mkdir({0!r})\n]]></PixelFunctionCode>")
LABEL = """PDS_VERSION_ID = PDS3
RECORD_TYPE = FIXED_LENGTH
RECORD_BYTES = 18
FILE_RECORDS = 9
^IMAGE = "{}"
OBJECT = IMAGE
 LINES = 9
 LINE_SAMPLES = 9
 SAMPLE_TYPE = MSB_INTEGER
 SAMPLE_BITS = 16
 BANDS = 1
 BAND_STORAGE_TYPE = BAND_SEQUENTIAL
END_OBJECT = IMAGE
END
"""
OVERVIEWS = '<PAMDataset><Metadata domain="OVERVIEWS"><MDI key="OVERVIEW_FILE">{}</MDI></Metadata></PAMDataset>'


def vrt(content, subclass="", data_type="Int16"):
    return f'{HEAD}<VRTRasterBand dataType="{data_type}" band="1"{subclass}>{content}</VRTRasterBand></VRTDataset>'


def raw_vrt(name, relative=1):
    return vrt(RAW.format(name, relative), ' subClass="VRTRawRasterBand"')


class Rasters(ToolTest):
    def setUp(self):
        super().setUp()
        os.mkdir(self.path("data"))
        self.out = self.path("out.h5")

    def write(self, name, content):
        return super().write("data/" + name, content)

    def pipe(self, name="data/secret.img"):
        os.mkfifo(self.path(name))
        return self.path(name)

    def grid(self, name="tile.asc"):
        rows = "\n".join(" ".join(map(str, row)) for row in VALUES)
        return self.write(name, f"ncols {SIZE}\nnrows {SIZE}\nxllcorner 0\nyllcorner 0\ncellsize 1\n{rows}\n")

    def arguments(self, path, *more):
        return ["--from", path, "--horizontal-scale", "1", "--interpolation", "nearest", "--datum", "none", "-o", self.out,
                "-O", *more]

    def assert_loads(self, path, *more, **options):
        self.succeed("terrain-gen", *self.arguments(path, *more), **options)
        with h5py.File(self.out) as file:
            np.testing.assert_array_equal(file["z"][()][::-1], VALUES)

    def assert_refused(self, path, *words, **options):
        self.refuse(1, "terrain-gen", *self.arguments(path), words=words or ["refers to another file", "--follow-links"],
                    output=self.out, **options)

    def test_a_vrt_opens_no_other_file(self):
        pipe = self.pipe()
        os.symlink(pipe, self.path("data/link.img"))
        os.mkdir(self.path("far"))
        os.mkfifo(self.path("far/link.tif"))
        os.symlink(self.path("far/link.tif"), self.path("data/link.1.tif"))
        for name, text in {"relative": vrt(SOURCE.format("secret.img", 1)), "absolute": vrt(SOURCE.format(pipe, 0)),
                           "upwards": vrt(SOURCE.format("../data/secret.img", 1)), "raw": raw_vrt("secret.img"),
                           "link": raw_vrt("link.1.tif"), "nested": vrt(SOURCE.format("nested.1.vrt", 1)),
                           "nested.1": vrt(SOURCE.format("secret.img", 1)),
                           "zipped": vrt(SOURCE.format(f"/vsizip/{pipe}/a.tif", 0)),
                           "part": vrt(SOURCE.format(f"/vsisubfile/0_100,{pipe}", 0)),
                           "layer": vrt(SOURCE.format(f'NETCDF:"{pipe}":z', 0)),
                           "layer5": vrt(SOURCE.format(f'HDF5:"{pipe}"://z', 0))}.items():
            with self.subTest(name):
                self.assert_refused(self.write(name + ".vrt", text), name + ".vrt: ")
        self.assert_refused(self.path("data/relative.vrt"))
        self.assert_refused(vrt(SOURCE.format(pipe, 0)))

    def test_standard_input_and_memory_are_refused_as_sources(self):
        read, write = os.pipe()  # reading from it would block
        self.addCleanup(os.close, read)
        self.addCleanup(os.close, write)
        for name in ("/vsistdin/", "/vsistdin?buffer_limit=10", "MEM:::DATAPOINTER=4096,PIXELS=9,LINES=9"):
            path = self.write("source.vrt", vrt(SOURCE.format(name, 0)))
            for follow in ([], ["--follow-links"]):
                result = self.start(read, *self.arguments(path, *follow))
                self.assertEqual(result.returncode, 1, result.stderr)
                self.check_message("terrain-gen", result.stderr, ["source.vrt: "])

    def start(self, stdin, *arguments):
        import subprocess  # pylint: disable=import-outside-toplevel
        from harness import tool  # pylint: disable=import-outside-toplevel
        return subprocess.run([tool("terrain-gen"), *arguments], stdin=stdin, capture_output=True, text=True, timeout=60,
                              check=False)

    def test_sources_are_followed_on_request(self):
        self.grid()
        self.write("values.bin", VALUES.tobytes())
        for name, text in {"mosaic.vrt": vrt(SOURCE.format("tile.asc", 1)), "outer.vrt": vrt(SOURCE.format("mosaic.vrt", 1)),
                           "raw.vrt": raw_vrt("values.bin")}.items():
            path = self.write(name, text)
            self.assert_refused(path)
            self.assert_loads(path, "--follow-links")
            os.remove(self.out)

    def test_parts_of_a_raster_are_read(self):
        """A detached image, a header in a separate file, a member of an archive, and a VRT of raw values with its own name."""
        self.write("product.img", VALUES.tobytes())
        self.assert_loads(self.write("PRODUCT.LBL", LABEL.format("product.img")))
        self.write("terrain.hdr", "ENVI\nsamples = 9\nlines = 9\nbands = 1\ndata type = 2\ninterleave = bsq\nbyte order = 1\n")
        self.assert_loads(self.write("terrain.dat", VALUES.tobytes()))
        self.write("own.bin", VALUES.tobytes())
        self.assert_loads(self.write("own.vrt", raw_vrt("own.bin")))
        import zipfile  # pylint: disable=import-outside-toplevel
        with zipfile.ZipFile(self.path("data/a.zip"), "w") as archive:
            archive.write(self.grid(), "tile.asc")
        self.assert_loads(f"/vsizip/{self.path('data/a.zip')}/tile.asc")

    def test_a_label_opens_no_other_file(self):
        self.pipe()
        self.assert_refused(self.write("label.lbl", LABEL.format("SECRET.IMG")), "label.lbl: ")
        self.assert_refused(self.write("label.lbl", LABEL.format("secret.img")))

    def test_overviews_in_other_files_are_ignored(self):
        """An output exists, so that terrain-gen asks GDAL for all files of the raster."""
        pipe = self.pipe()
        self.write("../out.h5", "old")
        for name in (pipe, f'HDF5:&quot;{pipe}&quot;://z'):
            self.write("tile.asc.aux.xml", OVERVIEWS.format(name))
            self.assert_loads(self.grid())
        path = self.path("data/layer.h5")
        with h5py.File(path, "w") as file:
            file["z"] = VALUES
        self.write("layer.h5.aux.xml", OVERVIEWS.format(name))
        self.assert_loads(path)

    def test_python_in_a_raster_does_not_run(self):
        hacked = self.path("hacked")
        path = self.write("python.vrt", vrt(PYTHON.format(hacked), ' subClass="VRTDerivedRasterBand"'))
        for follow in ([], ["--follow-links"]):
            self.refuse(1, "terrain-gen", *self.arguments(path, *follow), words=["python.vrt: "],
                        env={**os.environ, "GDAL_VRT_ENABLE_PYTHON": "YES"})
        self.assertFalse(os.path.exists(hacked))

    def test_only_formats_of_rasters_are_opened(self):
        for name, text in {"service.xml": "<GDAL_WMS><Service name='TMS'><ServerUrl>http://127.0.0.1:9/</ServerUrl></Service></GDAL_WMS>",
                           "index.gti": "<GDALTileIndexDataset><IndexDataset>secret.img</IndexDataset></GDALTileIndexDataset>"}.items():
            self.assert_refused(self.write(name, text), name + ": is ", "raster format" if name == "index.gti" else "in the format WMS (")

    def test_formats_that_gdal_knows_and_terrain_gen_does_not_read_are_named(self):
        cards = ["SIMPLE  =                    T", "BITPIX  =                   16", "NAXIS   =                    2",
                 "NAXIS1  =                    2", "NAXIS2  =                    2", "END"]
        pixels = bytes(16)
        for name, format_name, content in (
                ("a.fits", "FITS (Flexible Image Transport System)", "".join(card.ljust(80) for card in cards).ljust(2880).encode() + bytes(2880)),
                ("a.pgm", "PNM (Portable Pixmap Format (netpbm))", b"P5\n4 4\n255\n" + pixels),
                ("a.gif", "GIF (Graphics Interchange Format (.gif))", b"GIF89a" + struct.pack("<HHBBB", 4, 4, 0, 0, 0) + pixels),
                ("a.bmp", "BMP (MS Windows Device Independent Bitmap)",
                 b"BM" + struct.pack("<IIIIiiHHIIiiII", 118, 0, 54, 40, 4, 4, 1, 8, 0, 0, 0, 0, 0, 0) + pixels)):
            self.assert_refused(self.write(name, content), f"{name}: is in the format {format_name}, which terrain-gen does not read; convert it")

    def test_a_usgs_dem_that_lacks_columns_is_truncated(self):
        corners = (-241200, 176400, -241200, 180000, -237600, 180000, -237600, 176400)
        head = (" " * 144 + "     1     1     0     0").ljust(528) + "     3     2     4" + "".join(f"{value:24.12e}" for value in corners)
        head = (head + f"{0:24.12e}{1127:24.12e}{0:24.12e}     0{3:12.6e}{3:12.6e}{1:12.6e}     1     1").ljust(1024)
        profile = f"     1     1  1201     1{-241200:24.12e}{176400:24.12e}{0:24.12e}{0:24.12e}{127:24.12e}".ljust(144) + "     1" * 146
        self.assert_refused(self.write("cut.dem", head + profile.ljust(1024)),
                            "cut.dem: holds 1 of about 1201 columns between the corners of a USGS DEM: it is truncated or damaged")

    def test_references_of_an_hdf5_raster_are_refused(self):
        target, path = self.pipe(), self.path("data/layers.h5")
        layout = h5py.VirtualLayout((SIZE, SIZE), "f8")
        layout[...] = h5py.VirtualSource(target, "z", (SIZE, SIZE))
        with h5py.File(path, "w") as file:
            file.create_virtual_dataset("z", layout)
        for name in (f'NETCDF:"{path}":z', f'HDF5:"{path}"://z', path):
            self.assert_refused(name, path + ": /z is a virtual dataset, of " + target)

    def test_a_declared_size_costs_nothing(self):
        """A header declares 10^6 x 10^6 pixels, but the file holds 64 bytes."""
        path = self.write("huge.hdr", "ENVI\nsamples = 1000000\nlines = 1000000\nbands = 1\ndata type = 5\ninterleave = bsq\n")
        self.assert_refused(self.write("huge.dat", b"\0" * 64), "huge.dat: ")
        self.assertTrue(os.path.exists(path))


if __name__ == "__main__":
    unittest.main()
