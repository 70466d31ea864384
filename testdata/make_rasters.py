#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the rasters of testdata/rasters.

usage: make_rasters.py [FOLDER]     FOLDER: testdata/rasters

Elevations are bilinear in the map's coordinates (X, Y from the middle of the raster, in the map's units), so that every
interpolation must return them, and multiples of the stored type's step, so that storing them needs no rounding.
testdata/README.md has the formula of each file. Relief sites are self-affine.
"""
import pathlib
import sys

import numpy as np
import raster_formats as formats

MOON_M, MARS_M, EUROPA_M = 1737400.0, 3396190.0, 1561500.0
MARS_DEGREES = "GEOGCS[\"Mars\",DATUM[\"Mars\",SPHEROID[\"Mars\",3396190,0]],PRIMEM[\"Reference_Meridian\",0],UNIT[\"degree\",0.0174532925199433]]"


def middle_transform(middle, shape, dx, x_row, y_column, dy):
    """The georeference of a raster whose middle is at `middle`."""
    rows, columns = shape
    return (middle[0] - dx * columns / 2 - x_row * rows / 2, dx, x_row, middle[1] - y_column * columns / 2 - dy * rows / 2, y_column, dy)


def bilinear(shape, dx, x_row, y_column, dy, terms):
    """z0 + a X + b Y + c X Y at the pixels' centres, X and Y from the raster's middle."""
    rows, columns = shape
    column, row = np.meshgrid(np.arange(columns) - (columns - 1) / 2, np.arange(rows) - (rows - 1) / 2)
    x, y = dx * column + x_row * row, y_column * column + dy * row
    z0, a, b, c = terms
    return z0 + a * x + b * y + c * x * y


def whole(values, dtype):
    """The values in the stored type, which must represent them within the rounding errors of their formula."""
    stored = np.round(values).astype(dtype)
    assert np.abs(stored - values).max() < 1e-6
    return stored


def holes(values, value, *pixels):
    """A copy with `value` at these (column, row)."""
    copy = values.copy()
    for column, row in pixels:
        copy[row, column] = value
    return copy


def self_affine(cells, posting_m, hurst, deviation_m, length_m, seed):
    """Gaussian relief, rms elevation difference `deviation_m` (L / `length_m`)^hurst, multiples of 2^-10 m.

    Waves of the power spectrum k^-(2 H + 2) on a periodic grid of four times the width, of which one corner is kept and then
    scaled to the deviation at `length_m`, a whole number of postings.
    """
    size = 4 * cells
    frequency = np.fft.fftfreq(size)
    k = np.hypot(frequency[None, :], frequency[:, None])
    k[0, 0] = np.inf
    noise = np.fft.fft2(np.random.RandomState(seed).standard_normal((size, size)))
    z = np.fft.ifft2(noise * k**-(hurst + 1)).real[:cells, :cells]
    lag = round(length_m / posting_m)
    assert abs(lag * posting_m - length_m) < 1e-9
    squares = np.concatenate([((z[:, lag:] - z[:, :-lag])**2).ravel(), ((z[lag:] - z[:-lag])**2).ravel()])
    z *= deviation_m / np.sqrt(squares.mean())
    return (np.round((z - z.mean()) * 1024) / 1024).astype(np.float32)


def plain_tiff(shape, dtype, keys, middle, cell, terms, **more):
    """A GeoTIFF of a bilinear ground; `cell` is (dx, x_row, y_column, dy)."""
    values = bilinear(shape, *cell, terms)
    values = values.astype(dtype) if np.dtype(dtype).kind == "f" else whole(values, dtype)
    return formats.tiff(values, keys, middle_transform(middle, shape, *cell), **more)


def scaled_int16():
    """Raw numbers n with elevations 0.5 n + 200 m; nodata -32768 refers to raw numbers."""
    shape, cell = (61, 81), (0.05, 0, 0, -0.05)
    raw = whole((bilinear(shape, *cell, (500, 100, -60, 400)) - 200) / 0.5, np.int16)
    raw = holes(raw, -32768, (25, 12), (26, 12), (55, 45))
    return formats.tiff(raw, formats.sphere(MOON_M), middle_transform((30, 0.5), shape, *cell), nodata="-32768", scale_offset=(0.5, 200))


def big_endian_raw():
    """A raster of longitudes 0 .. 360: the bytes of the raw file, and its VRT."""
    shape, cell = (36, 72), (5, 0, 0, -5)
    values = whole(bilinear(shape, *cell, (-1000, 20, 36, 0)), np.int16)
    transform = middle_transform((180, 0), shape, *cell)
    return values.astype(">i2").tobytes(), formats.raw_vrt(values, "mars_big_endian.img", MARS_DEGREES, transform)


def mosaic():
    """Two tiles and the VRT that puts them side by side."""
    shape, cell = (30, 40), (10, 0, 0, -10)
    values = whole(bilinear(shape, *cell, (700, 0.2, -0.4, 0)), np.int16)
    keys, transform = formats.utm(31), middle_transform((500000, 4000000), shape, *cell)
    tiles = {"tile_west.tif": 0, "tile_east.tif": 20}
    files = {name: formats.tiff(values[:, first:first + 20], keys, (transform[0] + 10 * first, *transform[1:]))
             for name, first in tiles.items()}
    return files | {"mosaic.vrt": formats.mosaic_vrt(shape, transform, "EPSG:32631", list(tiles.items()))}


def grid_with_holes():
    """netCDF, rows from south to north, NaN in two discs."""
    shape, cell = (31, 31), (1 / 3, 0, 0, 1 / 3)
    values = bilinear(shape, *cell, (-2000, 150, -90, 9))
    row, column = np.mgrid[:31, :31]
    hole = (np.hypot(row - 9, column - 8) < 4.5) | (np.hypot(row - 22, column - 20) < 5.5)
    degrees = (np.arange(31) - 15) / 3
    attributes = {"long_name": "elevation", "units": "m", "_FillValue": float("nan")}
    return formats.netcdf_grid(20 + degrees, 40 + degrees, np.where(hole, np.nan, values), attributes)


def bands():
    """Three bands, interleaved; the second has the ground, -inf is nodata."""
    shape, cell = (21, 25), (1, 0, 0, -1)
    ground = holes(bilinear(shape, *cell, (50, 2, -3, 0.25)), -np.inf, (3, 4), (20, 15))
    stack = np.stack([np.full(shape, 7.0), ground, np.full(shape, -7.0)], axis=2).astype(np.float32)
    return formats.tiff(stack, formats.utm(31), middle_transform((500000, 4000000), shape, *cell), nodata="-inf")


def dted_cell():
    """121 x 121 posts of 30 arc seconds, 9 .. 10 E, 43 .. 44 N, with depths below zero and a hole."""
    values = whole(bilinear((121, 121), 1, 0, 0, -1, (300, 5, 7, 0)), np.int16)
    return formats.dted(holes(values, -32767, (100, 20)), 9, 43)


def files():
    """{name: bytes} of all rasters."""
    square = (1, 0, 0, -1)
    made = {
        "latlon_scaled_int16.tif": scaled_int16(),
        "polar_stereographic.tif": plain_tiff((33, 33), np.float32, formats.polar_stereographic(MOON_M), (-53000, -51000),
                                              (2.5, 0, 0, -2.5), (-208, 0.125, -0.0625, 0.0078125)),
        "south_up.tif": plain_tiff((40, 50), np.float32, formats.equirectangular(MARS_M), (270000, -120000), (5, 0, 0, 5),
                                   (-4400, 0.25, -0.125, 0.015625)),
        "rotated.tif": plain_tiff((45, 45), np.float64, formats.utm(31), (500000, 4000000), (3, 4, 4, -3), (12, 0.5, 0.25, 0)),
        "nonsquare_int16.tif": plain_tiff((40, 50), np.int16, formats.utm(31), (500000, 4000000), (150, 0, 0, -225),
                                          (1500, 0.02, -0.04, 0)),
        "big_endian_int16.tif": plain_tiff((20, 30), np.int16, formats.utm(31), (500000, 4000000), square, (1, 300, -500, 0), order=">"),
        "float16.tif": plain_tiff((20, 20), np.float16, formats.utm(31), (500000, 4000000), (60, 0, 0, -60), (64, 0.125, -0.25, 0)),
        "three_bands_minus_inf.tif": bands(),
        "gmt_holes.grd": grid_with_holes(),
        "nodata_no_crs.asc": formats.ascii_grid(
            holes(bilinear((19, 23), *square, (100, 0.5, 0.75, -0.125)), -9999, (0, 0), (22, 18), (5, 9)), (1000, 2000), 1, "-9999.0"),
        "grey_8bit.png": formats.png(whole(bilinear((33, 33), *square, (112, 3, 4, 0)), np.uint8)),
        "vicar_int16.vic": formats.vicar(whole(bilinear((15, 21), *square, (-40, 700, 90, 0)), np.int16)),
        "cell.dt0": dted_cell(),
        "relief_europa_10m.tif": formats.tiff(self_affine(105, 10, 0.8, 2.13, 10, 13), formats.orthographic(EUROPA_M, -27.3, -32.5),
                                              middle_transform((0, 0), (105, 105), 10, 0, 0, -10)),
        "relief_moon_1m.tif": formats.tiff(self_affine(129, 1, 0.76, 0.88, 17, 6), formats.polar_stereographic(MOON_M),
                                           middle_transform((40000, 30000), (129, 129), *square)),
        **mosaic(),
    }
    made["nan_nodata_deflate.tif"] = formats.tiff(
        holes(bilinear((10, 12), *square, (6, 1, 2, 0)), np.nan, (2, 3), (9, 8)).astype(np.float32), formats.utm(31),
        middle_transform((500000, 4000000), (10, 12), *square), nodata="nan", compression=formats.DEFLATE)
    made["mars_big_endian.img"], made["mars_big_endian.vrt"] = big_endian_raw()
    return made


def main():
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).parent / "rasters"
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in files().items():
        (folder / name).write_bytes(content)


if __name__ == "__main__":
    main()
