#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the meshes of testdata/meshes: one closed boulder in each format that terrain-gen reads.

usage: make_meshes.py [FOLDER]     FOLDER: testdata/meshes

Coordinates are multiples of 2^-10 m, which float32 represents exactly, so that all files have the same facets.
"""
import pathlib
import struct
import sys

import numpy as np

SUBDIVISIONS = 2


def icosahedron():
    golden = (1 + 5**0.5) / 2
    points = [(-1, golden, 0), (1, golden, 0), (-1, -golden, 0), (1, -golden, 0), (0, -1, golden), (0, 1, golden),
              (0, -1, -golden), (0, 1, -golden), (golden, 0, -1), (golden, 0, 1), (-golden, 0, -1), (-golden, 0, 1)]
    facets = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6), (7, 1, 8),
              (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    return [np.array(p) / np.hypot(1, golden) for p in points], facets


def subdivided(points, facets):
    """Splits each facet into four; the new corners are on the unit sphere."""
    points, middles, result = list(points), {}, []

    def middle(a, b):
        edge = min(a, b), max(a, b)
        if edge not in middles:
            point = points[a] + points[b]
            middles[edge] = len(points)
            points.append(point / np.linalg.norm(point))
        return middles[edge]

    for a, b, c in facets:
        ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
        result += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
    return points, result


def boulder():
    """A sphere of 12 m, flattened to 0.7, with bumps and a dent: (vertices, facets). Facets are oriented outwards."""
    points, facets = icosahedron()
    for _ in range(SUBDIVISIONS):
        points, facets = subdivided(points, facets)
    p = np.array(points)
    bumps = 0.08 * np.sin(5 * p[:, 0] + 1) * np.cos(4 * p[:, 1]) + 0.05 * np.sin(9 * p[:, 2] + 3 * p[:, 0])
    dent = 0.25 * np.exp(-((p - [0.36, 0.48, 0.8])**2).sum(axis=1) / 0.1)
    p = 12 * p * (1 + bumps - dent)[:, None] * [1, 0.9, 0.7]
    return np.round(p * 1024) / 1024, np.array(facets)


def obj(vertices, facets):
    """Wavefront OBJ with a comment, a missing material library, texture indices, an unused vertex, and half of the indices negative."""
    lines = ["# a boulder", "mtllib missing.mtl", "o boulder", *(f"v {x} {y} {z}" for x, y, z in vertices), "v 99 99 99", "vt 0 0", "usemtl stone"]
    for i, facet in enumerate(facets):
        corners = facet + 1 if i % 2 == 0 else facet - len(vertices) - 1
        lines.append("f " + " ".join(f"{corner}/1" for corner in corners))
    return ("\r\n".join(lines) + "\r\n").encode()


def off(vertices, facets):
    return ("\n".join(["OFF", "# a boulder", f"{len(vertices)} {len(facets)} 0", *(f"{x} {y} {z}" for x, y, z in vertices),
                       *(f"3 {a} {b} {c} 128 128 128" for a, b, c in facets)]) + "\n").encode()


def ply(vertices, facets, order):
    """PLY; `order` is "" for text, "<" or ">" for binary. Vertices and faces have a property that is not used."""
    name = {"": "ascii", "<": "binary_little_endian", ">": "binary_big_endian"}[order]
    real = {"": "double", "<": "float", ">": "double"}[order]
    head = (f"ply\nformat {name} 1.0\ncomment a boulder\nelement vertex {len(vertices)}\nproperty {real} x\nproperty {real} y\n"
            f"property {real} z\nproperty uchar grey\nelement face {len(facets)}\nproperty short part\n"
            "property list uchar int vertex_indices\nend_header\n").encode()
    if not order:
        lines = [f"{x} {y} {z} 128" for x, y, z in vertices] + [f"-1 3 {a} {b} {c}" for a, b, c in facets]
        return head + ("\n".join(lines) + "\n").encode()
    letter = {"float": "f", "double": "d"}[real]
    return (head + b"".join(struct.pack(f"{order}3{letter}B", *p, 128) for p in vertices) +
            b"".join(struct.pack(f"{order}hB3i", -1, 3, *facet) for facet in facets))


def stl_ascii(vertices, facets):
    lines = ["solid boulder"]
    for corners in vertices[facets]:
        lines += ["facet normal 0 0 0", "outer loop", *("vertex %r %r %r" % tuple(map(float, p)) for p in corners), "endloop", "endfacet"]
    return ("\n".join([*lines, "endsolid boulder"]) + "\n").encode()


def stl_binary(vertices, facets):
    """A binary STL whose header begins with "solid", as some programs write it."""
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *corners.ravel(), 0) for corners in vertices[facets])
    return b"solid boulder, binary".ljust(80) + struct.pack("<I", len(facets)) + body


def files():
    """{name: bytes} of all meshes."""
    mesh = boulder()
    return {"boulder.obj": obj(*mesh), "boulder.off": off(*mesh), "boulder_ascii.ply": ply(*mesh, ""),
            "boulder_little_endian.ply": ply(*mesh, "<"), "boulder_big_endian.ply": ply(*mesh, ">"),
            "boulder_ascii.stl": stl_ascii(*mesh), "boulder_binary.stl": stl_binary(*mesh)}


def main():
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).parent / "meshes"
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in files().items():
        (folder / name).write_bytes(content)


if __name__ == "__main__":
    main()
