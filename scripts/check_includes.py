#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that includes go downwards only, and that third-party libraries are included only where it is allowed.

usage: check_includes.py REPOSITORY
"""
import pathlib
import re
import sys

# A wing may include itself and those before it.
WINGS = ("base", "chain", "formats", "store", "app")
# Within a wing, a room may include itself and rooms of lower levels, but no other room of its own level. The core of `base` is one room
# in four folders.
LEVELS = {
    "base/core": 0,
    "base/dictionary": 1, "base/geometry": 1, "base/raster": 1, "base/output": 1, "base/returns": 1, "base/units": 1,
    "chain/terrain": 0, "chain/lidar/detector": 0, "chain/lidar/scanner": 0, "chain/lidar/trajectory": 0, "chain/lidar/error_models": 0,
    "chain/lidar/receiver": 0, "chain/opencl": 0,
    "chain/ray": 1,
    "chain/lidar/simulation": 2, "chain/gridding": 2, "chain/evaluation": 2, "chain/hazards": 2,
    "chain/draws": 3, "chain/likeness": 3,
    "formats/picture": 0, "formats/mesh": 0, "formats/gdal": 0,
    "formats/points": 1,
    "store/hdf5": 0,
    "store/config": 1, "store/files": 1,
    "app/exports": 0, "app/host": 0, "app/report": 0,
    "app/runs": 1,
    "app/cli": 2,
    "app/python": 3,
}
SAME = {"base/text": "base/core", "base/numerics": "base/core", "base/memory": "base/core"}

# Header pattern -> rooms that may include it. Headers that are not listed may be included anywhere.
ONLY_IN = {
    r"CGAL/": {"chain/ray", "chain/gridding"},
    r"boost/(?!numeric/odeint/|math/)": {"chain/ray"},
    r"boost/math/": {"chain/terrain", "chain/draws", "chain/lidar/receiver"},
    r"boost/numeric/odeint/": {"chain/lidar/trajectory"},
    r"(gdal|ogr|cpl_|vrt)": {"formats/gdal"},
    r"CL/": {"chain/opencl"},
    r"(hdf5\.h|hdf5_hl\.h|H5)": {"store/hdf5", "store/files"},
    r"libdeflate": {"store/hdf5"},
    r"zlib": {"store/hdf5"},
    r"png\.h": {"formats/picture"},
    # base/core: a header that several rooms share
    r"nlohmann/": {"base/core", "store/config", "store/files", "app/runs", "app/cli", "app/host", "app/python", "app/report"},
    r"CLI/": {"app/cli"},
    r"(iostream|fstream|chrono|ctime)$": {"store/config", "store/files", "formats/mesh", "base/core", "base/output", "app/cli"},
}

INCLUDE = re.compile(r'^\s*#\s*include\s+[<"]([^>"]+)[>"]')


def room_of(path: str):
    """The room of a header or of a folder of lib; None for a header of another library."""
    parts = path.split("/")
    for count in (3, 2):
        room = "/".join(parts[:count])
        if (room := SAME.get(room, room)) in LEVELS:
            return room
    return None


def violations(lib: pathlib.Path):
    for file in sorted(lib.rglob("*")):
        if file.suffix not in (".h", ".cpp", ".in"):
            continue
        room = room_of(file.relative_to(lib).as_posix())
        if room is None:
            yield f"{file}: its room has no level in check_includes.py"
            continue
        for number, line in enumerate(file.read_text().splitlines(), 1):
            match = INCLUDE.match(line)
            if match:
                for problem in problems_of(room, match.group(1)):
                    yield f"{file}:{number}: {problem}"


def problems_of(room: str, header: str):
    target = room_of(header)
    if target and target != room:
        own, other = (WINGS.index(name.split("/")[0]) for name in (room, target))
        if own < other or (own == other and LEVELS[target] >= LEVELS[room]):
            yield f"{room} includes {header}, of a room above or beside it"
    for pattern, allowed in ONLY_IN.items():
        if re.match(pattern, header) and room not in allowed:
            yield f"{room} includes {header}; only {', '.join(sorted(allowed))} may"


def main():
    found = list(violations(pathlib.Path(sys.argv[1]) / "lib"))
    print("\n".join(found) if found else "includes go downwards only")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
