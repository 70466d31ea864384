# SPDX-License-Identifier: GPL-3.0-or-later
"""Readers of rasters that do not use GDAL, and the pixel coordinates of a site's nodes."""
import re
import struct
import subprocess
import zlib

import numpy as np
from PIL import Image

TIFF_TYPES = {1: "B", 2: "c", 3: "H", 4: "I", 6: "b", 8: "h", 9: "i", 11: "f", 12: "d"}


def tiff_tags(data):
    """The byte order, and the tags of the first directory as tuples."""
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
    """All bands of a TIFF in strips, uncompressed or deflate, as (rows, columns) or (rows, columns, bands)."""
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
    """A netCDF grid as ncdump prints it; the first row is the northernmost, as for all readers here."""
    text = subprocess.run(["ncdump", "-p", "9,17", "-v", "z,lat", path], capture_output=True, text=True,
                          check=True).stdout
    data = text.split("data:")[1]
    lat, z = (np.array([float(word.strip(" \n}").replace("_", "nan").replace("NaNf", "nan"))
                        for word in re.search(rf" {name} =([^;]*);", data).group(1).split(",")])
              for name in ("lat", "z"))
    return np.float32(z).astype(float).reshape(len(lat), -1)[np.argsort(-lat)]


class Cells:
    """A raster aligned with the axes: pixels of `dx` by `dy` metres; `center` is the site's centre in pixels."""

    def __init__(self, center, dx, dy=None):
        self.center, self.dx, self.dy = center, dx, dy or dx

    def pixels(self, x, y):
        return self.center[0] + x / self.dx, self.center[1] - y / self.dy


class Rotated:
    """A rotated raster: `dx` and `dy` are metres per (column, row) in x and y; `center` is the site's centre in pixels."""

    def __init__(self, center, dx, dy):
        self.center, self.inverse = center, np.linalg.inv([dx, dy])

    def pixels(self, x, y):
        return (self.center[0] + self.inverse[0][0] * x + self.inverse[0][1] * y,
                self.center[1] + self.inverse[1][0] * x + self.inverse[1][1] * y)


def obj_facets(path):
    """The facets, (facet, corner, xyz), of a Wavefront OBJ of triangles."""
    points, facets = [], []
    with open(path, encoding="ascii") as file:
        for words in (line.split() for line in file):
            if words and words[0] == "v":
                points.append([float(word) for word in words[1:4]])
            elif words and words[0] == "f":
                numbers = [int(word.split("/")[0]) for word in words[1:]]
                facets.append([number - 1 if number > 0 else len(points) + number for number in numbers])
    return np.array(points)[np.array(facets)]


def dted(path):
    """The posts of a DTED cell: after 3,428 bytes of headers, one record per meridian, from south to north."""
    with open(path, "rb") as file:
        data = file.read()
    lines, posts = int(data[47:51]), int(data[51:55])
    records = np.frombuffer(data, np.uint8, offset=3428).reshape(lines, 12 + 2 * posts)
    raw = np.ascontiguousarray(records[:, 8:-4]).view(">u2").astype(int)
    heights = np.where(raw & 0x8000, -(raw & 0x7fff), raw).T[::-1].astype(float)
    return np.where(heights == -32767, np.nan, heights)


class Degrees:
    """A raster of `step` degrees; `first` is the centre of its first pixel. The site is the orthographic view from above `center`:
    a node lies where a line parallel to the centre's normal meets the ellipsoid. Both are (longitude, latitude)."""

    def __init__(self, center, radius, step, first, cols, flattening=0):
        self.center, self.radius, self.step, self.first, self.cols = center, radius, step, first, cols
        self.flattening = flattening

    def pixels(self, x, y):
        lon0, lat0 = np.radians(self.center)
        shape = (1 - self.flattening)**2
        up = np.array([np.cos(lat0) * np.cos(lon0), np.cos(lat0) * np.sin(lon0), np.sin(lat0)])
        east = np.array([-np.sin(lon0), np.cos(lon0), 0])
        north = np.cross(up, east)
        origin = self.radius * up * [1, 1, shape] / np.sqrt(np.cos(lat0)**2 + shape * np.sin(lat0)**2)
        flat = origin + x[..., None] * east + y[..., None] * north
        # Solve |(X, Y, Z / (1 - f))| = radius for h, where (X, Y, Z) = flat + h up.
        weight = np.array([1, 1, 1 / shape])
        a, b, c = (up * up * weight).sum(), (flat * up * weight).sum(-1), (flat * flat * weight).sum(-1) - self.radius**2
        place = flat + ((-b + np.sqrt(b * b - a * c)) / a)[..., None] * up
        lon = np.arctan2(place[..., 1], place[..., 0])
        lat = np.arctan2(place[..., 2], shape * np.hypot(place[..., 0], place[..., 1]))
        col = (np.degrees(lon) - self.first[0]) / self.step % self.cols
        return col, (self.first[1] - np.degrees(lat)) / self.step


def nearest_nodes(values, pixels, x, y):
    """The elevation of each node, (y, x), and a mask of the nodes whose nearest pixel does not depend on rounding."""
    col, row = pixels.pixels(*np.meshgrid(x, y))
    sure = (np.abs(col % 1 - 0.5) > 1e-6) & (np.abs(row % 1 - 0.5) > 1e-6)
    return values[np.floor(row + 0.5).astype(int), np.floor(col + 0.5).astype(int)], sure
