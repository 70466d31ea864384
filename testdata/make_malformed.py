#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the malformed rasters and meshes of testdata/malformed. Each has one defect, after which it is named.

usage: make_malformed.py [FOLDER]     FOLDER: testdata/malformed
"""
import pathlib
import struct
import sys

import make_meshes
import make_rasters
import numpy as np
import raster_formats as formats
from raster_formats import TAG_BYTE_COUNTS, TAG_COMPRESSION, TAG_HEIGHT, TAG_OFFSETS, TAG_ROWS_PER_STRIP, TAG_WIDTH

TAG_TILE_WIDTH, TAG_TILE_HEIGHT, TAG_TILE_OFFSETS, TAG_TILE_BYTE_COUNTS = 322, 323, 324, 325
GROUND = np.add.outer(np.arange(20), np.arange(20)).astype(np.uint8)


def changed_tiff(changes, removed=(), data=None):
    """A TIFF of 20 x 20 bytes with some tags changed."""
    tags = {tag: value for tag, value in (formats.tiff_tags(GROUND) | changes).items() if tag not in removed}
    return formats.tiff_of(tags, [GROUND.tobytes() if data is None else data])


def tiled_tiff(width, height, offset, count):
    """A TIFF of 20 x 20 bytes in tiles, which all have the same offset."""
    tiles = -(-20 // width) * -(-20 // height)
    tags = {TAG_TILE_WIDTH: ("I", [width]), TAG_TILE_HEIGHT: ("I", [height]), TAG_TILE_OFFSETS: ("I", [offset] * tiles),
            TAG_TILE_BYTE_COUNTS: ("I", [count] * tiles)}
    kept = {tag: value for tag, value in formats.tiff_tags(GROUND).items() if tag != TAG_ROWS_PER_STRIP}
    whole = formats.tiff_of(kept | tags | {TAG_OFFSETS: ("I", [8]), TAG_BYTE_COUNTS: ("I", [8])}, [])
    return without_tags(whole, (TAG_OFFSETS, TAG_BYTE_COUNTS))


def without_tags(tiff, removed):
    """The file without these entries of its little-endian directory; all other offsets stay the same."""
    count, = struct.unpack_from("<H", tiff, 8)
    entries = [tiff[10 + 12 * i:22 + 12 * i] for i in range(count)]
    kept = [entry for entry in entries if struct.unpack("<H", entry[:2])[0] not in removed]
    directory = struct.pack("<H", len(kept)) + b"".join(kept) + b"\0" * 4
    return tiff[:8] + directory.ljust(2 + 12 * count + 4, b"\0") + tiff[14 + 12 * count:]


def bigtiff_header():
    """A BigTIFF of 10^5 x 10^5 bytes whose lists of strips lie beyond the end of the file."""
    def entry(tag, kind, count, value):
        return struct.pack("<HHQQ", tag, kind, count, value)
    entries = [entry(256, 4, 1, 100000), entry(257, 4, 1, 100000), entry(258, 3, 1, 8), entry(259, 3, 1, 1), entry(262, 3, 1, 1),
               entry(273, 16, 100000, 4096), entry(277, 3, 1, 1), entry(278, 4, 1, 1), entry(279, 16, 100000, 10**6)]
    return b"II" + struct.pack("<HHHQ", 43, 8, 0, 16) + struct.pack("<Q", len(entries)) + b"".join(entries) + b"\0" * 8


def hdf5_cut():
    """Only the superblock of an HDF5 file that declares 10,000 bytes."""
    return (b"\x89HDF\r\n\x1a\n" + struct.pack("<8BHHI", 0, 0, 0, 0, 0, 8, 8, 0, 4, 16, 0) +
            struct.pack("<4Q", 0, 2**64 - 1, 10000, 2**64 - 1) + struct.pack("<QQII16s", 0, 96, 0, 0, b""))


def damaged(data, begin, replacement):
    return data[:begin] + replacement + data[begin + len(replacement):]


def rasters():
    deflated = formats.tiff(GROUND, compression=formats.DEFLATE)
    keys = formats.tiff(GROUND, formats.utm(31), (0, 1, 0, 0, 0, -1))
    grid, cell = make_rasters.grid_with_holes(), make_rasters.dted_cell()
    png, vicar = formats.png(GROUND), formats.vicar(GROUND.astype(np.int16))
    ascii_grid = formats.ascii_grid(GROUND, (0, 0), 1)
    column = 12 + 2 * 121
    return {
        "empty.tif": b"",
        "tiff_truncated.tif": formats.tiff(GROUND)[:-200],
        "tiff_damaged_deflate.tif": damaged(deflated, len(deflated) - 200, b"\xff" * 100).replace(b"\x78\x01", b"\x07\x01"),
        "tiff_damaged_tags.tif": damaged(keys, 10, b"\xff" * 24),
        "tiff_directory_beyond_end.tif": damaged(formats.tiff(GROUND), 4, struct.pack("<I", 10**6)),
        "tiff_no_columns.tif": changed_tiff({TAG_WIDTH: ("I", [0])}),
        "tiff_strip_beyond_end.tif": changed_tiff({TAG_OFFSETS: ("I", [10**6])}),
        "tiff_tile_beyond_end.tif": tiled_tiff(16, 16, 10**6, 256),
        "tiff_huge_tile.tif": tiled_tiff(16, 16, 300, 2**28),
        "tiff_huge_blocks.tif": tiled_tiff(2**31, 16, 300, 256),
        "tiff_huge_image.tif": changed_tiff({TAG_WIDTH: ("I", [12000000]), TAG_HEIGHT: ("I", [12000000]), TAG_ROWS_PER_STRIP: ("I", [1])}),
        "tiff_wide.tif": changed_tiff({TAG_WIDTH: ("I", [2**31])}),
        "tiff_one_column.tif": changed_tiff({TAG_WIDTH: ("I", [1]), TAG_HEIGHT: ("I", [16777215]), TAG_ROWS_PER_STRIP: ("I", [1])}),
        "tiff_unknown_compression.tif": changed_tiff({TAG_COMPRESSION: ("H", [65000])}),
        "tiff_one_pixel.tif": formats.tiff(GROUND[:1, :1]),
        "tiff_one_row.tif": formats.tiff(GROUND[:1]),
        "tiff_all_holes.tif": formats.tiff(np.full((20, 20), np.nan, np.float32)),
        "bigtiff_header_only.tif": bigtiff_header(),
        "netcdf_header_cut.nc": grid[:100],
        "netcdf_truncated.nc": grid[:-2000],
        "hdf5_truncated.h5": hdf5_cut(),
        "vrt_missing_source.vrt": formats.mosaic_vrt((20, 20), (0, 1, 0, 20, 0, -1), "EPSG:32631", [("none_west.tif", 0), ("none_east.tif", 10)]),
        "vrt_cut.vrt": formats.mosaic_vrt((20, 20), (0, 1, 0, 20, 0, -1), "EPSG:32631", [("a.tif", 0)])[:300],
        "dted_truncated.dt0": cell[:3428 + 2 * column],
        "dted_no_columns.dt0": cell[:3428],
        "ascii_too_few.asc": ascii_grid[:-100],
        "ascii_huge.asc": ascii_grid.replace(b"ncols 20\nnrows 20", b"ncols 2000000000\nnrows 2000000000"),
        "png_truncated.png": png[:-200],
        "png_damaged.png": damaged(png, 60, b"\xff" * 50),
        "vicar_truncated.vic": vicar[:-200],
        "raw_no_header.img": b"".join(struct.pack(">h", 7 * i % 1000) for i in range(400)),
    }


def mesh_files():
    vertices, facets = make_meshes.boulder()[0][:4], np.array([(0, 1, 2), (0, 2, 3)])
    obj = b"v 0 0 0\nv 1 0 0\nv 0 1 0\n"
    binary = make_meshes.ply(vertices, facets, "<")
    text, stl = make_meshes.ply(vertices, facets, ""), make_meshes.stl_binary(vertices, facets).replace(b"solid", b"stone", 1)
    off = make_meshes.off(vertices, facets)
    return {
        "empty.obj": b"",
        "obj_no_facet.obj": obj,
        "obj_vertex_beyond_end.obj": obj + b"f 1 2 4\n",
        "obj_vertex_zero.obj": obj + b"f 0 1 2\n",
        "obj_word.obj": obj + b"v 0 0 x\nf 1 2 3\n",
        "obj_nan.obj": obj + b"v nan 0 0\nf 1 2 4\n",
        "obj_no_area.obj": obj + b"f 1 1 2\n",
        "ply_truncated.ply": binary[:-5],
        "ply_header_cut.ply": binary[:100],
        "ply_huge_count.ply": binary.replace(b"face 2", b"face 999999999999"),
        "ply_huge_list.ply": text.replace(b"list uchar", b"list int").replace(b"-1 3 ", b"-1 2000000000 ", 1),
        "ply_no_z.ply": text.replace(b"double z", b"double w"),
        "ply_unknown_format.ply": text.replace(b"format ascii", b"format ebcdic"),
        "off_truncated.off": off[:-30],
        "off_huge_count.off": b"OFF\n4000000000000 1 0\n0 0 0\n",
        "off_negative_count.off": b"OFF\n-1 1 0\n",
        "stl_truncated.stl": stl[:-30],
        "stl_huge_count.stl": damaged(stl, 80, b"\xff" * 4),
        "stl_ascii_cut.stl": make_meshes.stl_ascii(vertices, facets)[:150],
        "stl_of_another_format.stl": off,
    }


def files():
    """{name: bytes} of all malformed files."""
    return rasters() | mesh_files()


def main():
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).parent / "malformed"
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in files().items():
        (folder / name).write_bytes(content)


if __name__ == "__main__":
    main()
