# SPDX-License-Identifier: GPL-3.0-or-later
"""Rasters read without GDAL: numpy on the bytes, and where a site's nodes lie in them."""
import re
import struct
import subprocess
import zlib

import numpy as np
from PIL import Image

TIFF_TYPES = {1: "B", 2: "c", 3: "H", 4: "I", 6: "b", 8: "h", 9: "i", 11: "f", 12: "d"}


def tiff_tags(data):
    """The first directory's tags, as tuples, and the byte order."""
    order = "<" if data[:2] == b"II" else ">"
    offset, = struct.unpack_from(order + "I", data, 4)
    tags = {}
    for i in range(struct.unpack_from(order + "H", data, offset)[0]):
        tag, kind, count = struct.unpack_from(order + "HHI", data, offset + 2 + 12 * i)
        letter = TIFF_TYPES.get(kind)
        if letter is None:
            continue
        form = f"{order}{count}{letter}"
        place = offset + 10 + 12 * i
        if struct.calcsize(form) > 4:
            place, = struct.unpack_from(order + "I", data, place)
        tags[tag] = struct.unpack_from(form, data, place)
    return order, tags


def tiff(path):
    """All bands, (rows, columns) or (rows, columns, bands), of a TIFF in strips: plain or deflate."""
    with open(path, "rb") as file:
        data = file.read()
    order, tags = tiff_tags(data)
    cols, rows = tags[256][0], tags[257][0]
    bands = tags.get(277, (1,))[0]
    kind = {1: "u", 2: "i", 3: "f"}[tags.get(339, (1,))[0]]
    sample = np.dtype(f"{order}{kind}{tags[258][0] // 8}")
    pieces = [data[begin:begin + size] for begin, size in zip(tags[273], tags[279])]
    if tags.get(259, (1,))[0] in (8, 32946):
        pieces = [zlib.decompress(piece) for piece in pieces]
    else:
        assert tags.get(259, (1,))[0] == 1
    values = np.frombuffer(b"".join(pieces), sample)[:rows * cols * bands]
    return values.reshape(rows, cols, bands).squeeze().astype(float)


def pillow(path):
    with Image.open(path) as image:
        return np.asarray(image).astype(float)


def ascii_grid(path):
    header, numbers = {}, []
    with open(path, encoding="ascii") as file:
        for line in file:
            words = line.split()
            if words and words[0][0].isalpha():
                header[words[0].lower()] = float(words[1])
            else:
                numbers += map(float, words)
    values = np.float32(numbers).astype(float).reshape(int(header["nrows"]), int(header["ncols"]))
    return np.where(values == header.get("nodata_value", np.inf), np.nan, values)


def raw(path, kind, shape, offset=0):
    return np.fromfile(path, kind, int(np.prod(shape)), offset=offset).astype(float).reshape(shape)


def vicar(path):
    with open(path, "rb") as file:
        label = file.read(300).decode("ascii").split()
    words = dict(word.split("=") for word in label if "=" in word)
    return raw(path, ">i2", (int(words["NL"]), int(words["NS"])), int(words["LBLSIZE"]))


def gmt_grid(path):
    """A netCDF grid as ncdump tells it; rows from the north, as in every raster here."""
    text = subprocess.run(["ncdump", "-p", "9,17", "-v", "z,lat", path], capture_output=True, text=True,
                          check=True).stdout
    data = text.split("data:")[1]
    lat, z = (np.array([float(word.strip(" \n}").replace("_", "nan").replace("NaNf", "nan"))
                        for word in re.search(rf" {name} =([^;]*);", data).group(1).split(",")])
              for name in ("lat", "z"))
    return np.float32(z).astype(float).reshape(len(lat), -1)[np.argsort(-lat)]


class Cells:
    """Pixels of a plain raster: `dx` by `dy` metres, the site's centre on the pixel `center`."""

    def __init__(self, center, dx, dy=None):
        self.center, self.dx, self.dy = center, dx, dy or dx

    def pixels(self, x, y):
        return self.center[0] + x / self.dx, self.center[1] - y / self.dy


def obj_facets(path):
    """(facets, 3 corners, xyz) of a Wavefront OBJ of triangles."""
    points, facets = [], []
    with open(path, encoding="ascii") as file:
        for words in (line.split() for line in file):
            if words and words[0] == "v":
                points.append([float(word) for word in words[1:4]])
            elif words and words[0] == "f":
                facets.append([int(word.split("/")[0]) - 1 for word in words[1:]])
    return np.array(points)[np.array(facets)]


class Degrees:
    """Pixels of `step` degrees on a sphere, the first pixel's centre at `first`; the site is the orthographic
    view (Snyder 1987, eq. 20-14, 20-15) from above `center`, all (longitude, latitude)."""

    def __init__(self, center, radius, step, first, cols):
        self.center, self.radius, self.step, self.first, self.cols = center, radius, step, first, cols

    def pixels(self, x, y):
        lon0, lat0 = np.radians(self.center)
        rho = np.hypot(x, y)
        c = np.arcsin(rho / self.radius)
        ratio = np.where(rho == 0, 0, y / np.where(rho == 0, 1, rho))
        lat = np.arcsin(np.cos(c) * np.sin(lat0) + ratio * np.sin(c) * np.cos(lat0))
        lon = lon0 + np.arctan2(x * np.sin(c), rho * np.cos(lat0) * np.cos(c) - y * np.sin(lat0) * np.sin(c)
                                + (rho == 0))
        col = (np.degrees(lon) - self.first[0]) / self.step % self.cols
        return col, (self.first[1] - np.degrees(lat)) / self.step


def nearest_nodes(values, pixels, x, y):
    """The elevation of each node, (y, x), and where the nearest pixel is beyond doubt."""
    col, row = pixels.pixels(*np.meshgrid(x, y))
    sure = (np.abs(col % 1 - 0.5) > 1e-6) & (np.abs(row % 1 - 0.5) > 1e-6)
    return values[np.floor(row + 0.5).astype(int), np.floor(col + 0.5).astype(int)], sure
