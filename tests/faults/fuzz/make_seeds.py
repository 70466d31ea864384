#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the first inputs of the fuzzers to FOLDER/config, table, mesh, cloud and hdf5, one per file, named by its hash.

usage: make_seeds.py FOLDER
       make_seeds.py --words FILE      the dictionary of the configurations

The configurations come from studies/, from the alternatives of the schemas and from docs/; the other inputs are written here.
The head of each fuzz_*.cpp describes the format of its inputs.
"""
import hashlib
import importlib.util
import itertools
import json
import pathlib
import re
import shlex
import struct
import sys

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[3]
TOOLS = {"terrain-gen": "t", "scan-sim": "s", "regrid": "r", "dem-eval": "e", "hazard-map": "h", "monte-carlo": "m"}
SCHEMAS = {"terrain": "t", "scan": "s", "regrid": "r", "eval": "e", "hazard": "h", "draws": "m"}


def schema(name: str):
    return json.loads((ROOT / "schemas" / f"{name}.schema.json").read_text())


class Examples:
    """Values that a schema accepts: each alternative once, with the smallest allowed values of other keys."""

    def __init__(self, root):
        self.root = root

    def resolve(self, part):
        while "$ref" in part:
            target = self.root
            for key in part["$ref"].lstrip("#/").split("/"):
                target = target[key]
            part = target
        return part

    def of(self, part, depth=0):
        part = self.resolve(part)
        if depth > 8:
            return []
        if "oneOf" in part:
            return [value for option in part["oneOf"] for value in self.of(option, depth + 1)]
        if "const" in part:
            return [part["const"]]
        if "enum" in part:
            return list(part["enum"])
        if part.get("type") == "object":
            return self.objects(part, depth)
        if part.get("type") == "array":
            items = self.of(part.get("items", {"type": "number"}), depth + 1)
            return [[item] * max(part.get("minItems", 1), 1) for item in items]
        if part.get("type") == "string":
            return ["file.csv"]
        if part.get("type") == "boolean":
            return [True]
        return [part.get("default", max(part.get("minimum", 1), 1))]

    def objects(self, part, depth):
        whole = {}
        alternatives = {}
        for key, value in part.get("properties", {}).items():
            if key == "$schema":
                continue
            values = self.of(value, depth + 1)
            if not values:
                continue
            whole[key] = values[0]
            alternatives[key] = values[1:]
        required = {key: whole[key] for key in part.get("required", []) if key in whole}
        yield_all = [required, whole]
        for key, values in alternatives.items():
            yield_all += [required | {key: value} for value in values]
        return yield_all


def config(letter: str, value, *assignments: str) -> bytes:
    text = value if isinstance(value, str) else json.dumps(value)
    return "\0".join([letter + text, *assignments]).encode()


def configs():
    for name, letter in SCHEMAS.items():
        for value in Examples(schema(name)).of(schema(name)):
            yield config(letter, value)
    for path in sorted((ROOT / "studies").rglob("*.json")):
        kind = path.name.split(".")[-2]
        letter = {"terrain": "t", "scan": "s", "regrid": "r", "evaluation": "e", "hazard": "h"}.get(kind)
        if letter:
            yield config(letter, path.read_text())
    for page in sorted((ROOT / "docs").rglob("*.md")):
        yield from page_configs(page.read_text())
    yield from receivers()
    yield config("i", {}, "site.tif", "10,20", "", "1", "bicubic", "none", "1.5", "", "60", "0.5")
    yield config("i", {"grid": {"half_width_m": 5}}, "site.tif", "", "3,4", "", "", "", "", "2", "", "1", "seed=3")
    yield config("i", {}, "site.obj")
    yield config("i", {"grid": 5}, *[""] * 8, "60")
    for letter, key in itertools.product("srtehm", ["seed", "x" * 3000, "seed.x", "seed=" + "x" * 3000]):
        yield config(letter, {}, key if "=" in key else key + "=1")
    yield config("u", {"uncertainty": {"range_sigma_m": 0.02}}, "velocity_mps=0.3,0.3,0.7", "position_m=1")


def receivers():
    """A scan with each type of receiver, and with either form of the link."""
    measured = {"reference_pe": 200, "reference_range_m": 500, "background_pe": 2}
    design = {"pulse_energy_J": 1e-5, "wavelength_m": 1.064e-6, "aperture_m": 0.1, "efficiency": 0.2}
    kinds = schema("scan")["properties"]["receiver"]["properties"]["type"]["enum"]
    for kind, link in itertools.product(kinds, (measured, design)):
        receiver = {"type": kind, "pulse_fwhm_s": 2e-9, "returns": "all", "max_returns": 3, "jitter_sigma_s": 1e-11,
                    "pixel_offset_sigma_m": 0.01, "clock_scale_ppm": 5, "timer_step_s": 1e-10, "walk_correction": True,
                    "dead_time_s": 1e-8, "threshold_pe": 10, "fraction": 0.4, "photon_noise": False}
        beam = {"profile": "top_hat", "divergence_rad": 0.01, "offset_rad": [1e-3, 0]}
        yield config("s", {"beam": beam, "surface": {"albedo": 0.3}, "link": link, "receiver": receiver,
                           "detector": {"rows": 2, "columns": 2, "subpixels": 3}})


def page_configs(text: str):
    """The --set assignments and the JSON in the commands of a page."""
    for command in re.findall(r"^(?:\$ )?((?:terrain-gen|scan-sim|regrid|dem-eval|hazard-map|monte-carlo)\b(?:[^\n]*\\\n)*[^\n]*)", text, re.M):
        try:
            words = shlex.split(command.replace("\\\n", " "))
        except ValueError:
            continue
        values = [b for a, b in itertools.pairwise(words) if a == "--set"]
        if values and words[0] in TOOLS:
            yield config(TOOLS[words[0]], {}, *values)


def tables():
    head = "t_s,x_m,y_m,z_m"
    yield f"t{head},qw,qx,qy,qz\n0,0,0,100,1,0,0,0\n1,1,2,90,0.7071,0,0,0.7071\n2,2,3,80,0,0,0,1\n"
    yield f"t{head},roll_deg,pitch_deg,yaw_deg\n# a remark\n\n0,0,0,100,1,2,3\n0.5,1,2,90,4,5,6\n"
    yield f"t{head},vx_mps,vy_mps,vz_mps,mrp_1,mrp_2,mrp_3\n0,0,0,100,1,2,3,0.1,0.2,0.3\n1,1,2,90,1,2,3,-1,0,0\n"
    yield f"t\ufeff{head},qw,qx,qy,qz,other\r\n-1,0,0,100,1,0,0,0,x\r\n1e3,1,2,90,1,0,0,0,y\r\n"
    yield f"t{head},qw,qx,qy,qz\n0,0,0,{'x' * 3000},1,0,0,0\n"
    yield "st_s,angle_1_rad,angle_2_rad\n0,0,0\n0.5,0.1,-0.2\n2,0.3,0\n"
    yield "pt_s,x_m,y_m\n0,0,0\n0.5,10,-20\n1,0,0\n"
    yield "drow,column,u,v\n" + "".join(f"{i // 3},{i % 3},{0.01 * (i % 3)},{0.01 * (i // 3)}\n" for i in range(6))


def meshes():
    yield b"ov 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1 # top\nf 1 2 3\nf -3/1 -1//2 -2/1/1\nusemtl x\n"
    yield b"ov 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nf 1 2 3 \\\n 4 5\n"
    yield b"fOFF\n# plain\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n1 1 1\n3 0 1 2 255 0 0\n3 1 3 2\n"
    yield b"fCOFF\n3 1 3\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n0 1 0 1 1 1 1\n3 0 1 2\n"
    yield b"ssolid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n"
    facet = struct.pack("<12fH", 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0)
    yield b"s" + b"binary".ljust(80) + struct.pack("<I", 2) + facet + facet
    head = "ply\nformat {} 1.0\ncomment x\nelement vertex 4\nproperty {} x\nproperty {} y\nproperty {} z\nproperty uchar red\n"
    tail = "element face 2\nproperty list uchar {} vertex_indices\nelement edge 1\nproperty list ushort short v\nend_header\n"
    yield b"p" + (head.format("ascii", *["float"] * 3) + tail.format("int")).encode() + (
        b"0 0 0 255\n1 0 0 255\n0 1 0 255\n1 1 1 255\n3 0 1 2\n3 1 3 2\n1 0\n")
    for order, name in (("<", "binary_little_endian"), (">", "binary_big_endian")):
        for real, code in (("double", "d"), ("float", "f")):
            body = b"".join(struct.pack(order + "3" + code + "B", *p, 7)
                            for p in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 1)))
            body += struct.pack(order + "B3iB3iHh", 3, 0, 1, 2, 3, 1, 3, 2, 1, 0)
            yield b"p" + (head.format(name, *[real] * 3) + tail.format("int")).encode() + body


def clouds():
    """Small files of every format, by the writers of the tests."""
    spec = importlib.util.spec_from_file_location("clouds", ROOT / "tests" / "harness" / "clouds.py")
    write = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(write)
    points = write.las_points(3)
    keys = struct.pack("<8H", 1, 1, 0, 1, 3072, 0, 1, 32632)
    for minor, fmt in ((0, 0), (1, 1), (2, 3), (3, 4), (4, 6), (4, 10)):
        yield b"n" + write.las(points, fmt, minor, extra=minor, records=[write.las_vlr("LASF_Projection", 34735, keys)])
    table = np.zeros(4, [("x", "f4"), ("y", "f4"), ("z", "f4"), ("intensity", "u1"), ("gps_time", "f8")])
    table["x"] = range(4)
    for form in ("ascii", "binary", "binary_compressed"):
        yield b"n" + write.pcd(table, form)
    for form in ("ascii", "binary_little_endian", "binary_big_endian"):
        yield b"n" + write.ply(table, form, faces=1)
    yield "nx,y,z,t\n1,2,3,4\n5,6,7,8\n"
    yield "c1;2;3;4\r\n5;6;7;8\r\n"
    yield "n# a b\n//X Y Z\n1 2 3\n\n4\t5 6\n"
    yield "n2\n1 2 3 4\n5 6 7 8\n"
    yield "n1.0 2.0 3.0 4.0 0.0 1 2 7 3 0 0.5\n"
    yield "n# x [mm] y [mm] z [ft]\n1,5;NA;3\n"
    yield "n,lon,lat,H,timestamp\n1,2,3,4,noon\n"
    yield "n" + 2 * "1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n5 6 7 1\n1 2 3 0.5\n"
    for words, order in itertools.product((10, 12, 14), "<>"):
        head = struct.pack(order + "i", 4 * words).ljust(4 * words) + struct.pack(order + "ii", -9000008, 8 * words).ljust(4 * words)
        yield b"n" + head + struct.pack(f"{order}{words}i", *range(words))


def hdf5_files():
    """Each file with each of its readers, unchanged and with one edit of each kind."""
    for file, reader in itertools.product(range(9), range(6)):
        yield bytes([file, reader])
        for edit in range(15):
            yield bytes([file, reader, edit, 3 + edit, 1, 2, 5, 1, 9, 0, 1])


def encoded(seed) -> bytes:
    return seed.encode() if isinstance(seed, str) else seed


def words(node, found: set):
    if isinstance(node, dict):
        for key, value in node.items():
            if key in ("description", "title", "$id", "$schema"):
                continue
            if key == "properties":
                found.update(value)
            if key in ("const", "default") or key == "enum":
                found.update(v for v in (value if isinstance(value, list) else [value]) if isinstance(v, str))
            words(value, found)
    elif isinstance(node, list):
        for value in node:
            words(value, found)


def dictionary() -> str:
    found = set()
    for name in SCHEMAS:
        words(schema(name), found)
    quoted = [f'"\\"{word}\\""' for word in sorted(found)]
    plain = [f'"{word}"' for word in ("null", "true", "false", "{}", "[]", "[1,2]", "[0,0,0]", ":", ",", "1e300", "-1", "\\x00")]
    return "\n".join(["# Made by make_seeds.py --words of the schemas.", *quoted, *plain]) + "\n"


def main():
    if sys.argv[1] == "--words":
        pathlib.Path(sys.argv[2]).write_text(dictionary())
        return
    for name, seeds in (("config", configs()), ("table", tables()), ("mesh", meshes()), ("cloud", clouds()), ("hdf5", hdf5_files())):
        folder = pathlib.Path(sys.argv[1]) / name
        folder.mkdir(parents=True, exist_ok=True)
        for seed in map(encoded, seeds):
            (folder / hashlib.sha256(seed).hexdigest()[:16]).write_bytes(seed)


if __name__ == "__main__":
    main()
