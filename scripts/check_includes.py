#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that includes go downwards only, and that third-party libraries are included only where it is allowed.

usage: check_includes.py REPOSITORY
"""
import pathlib
import re
import sys

# A folder may include itself and folders of lower levels, but no other folder of its own level.
LEVELS = {
    "base": 0,
    "dictionary": 1, "geometry": 1, "raster": 1, "output": 1, "returns": 1, "units": 1,
    "picture": 2, "terrain": 2, "detector": 2, "scanner": 2, "trajectory": 2, "error_models": 2, "receiver": 2, "hdf5": 2,
    "ray": 3, "meshio": 3,
    "imports": 4, "opencl": 4, "simulation": 4, "gridding": 4, "evaluation": 4, "hazards": 4,
    "campaign": 5,
    "config": 6, "files": 6,
    "scene": 7, "exports": 7, "host": 7, "report": 7,
    "runs": 8,
    "cli": 9,
}

# Header pattern -> folders or subfolders that may include it. Headers that are not listed may be included anywhere.
ONLY_IN = {
    r"CGAL/": {"ray", "gridding"},
    r"boost/(?!numeric/odeint/|math/)": {"ray"},
    r"boost/math/": {"terrain", "campaign", "receiver"},
    r"boost/numeric/odeint/": {"trajectory"},
    r"(gdal|ogr|cpl_|vrt)": {"terrain/gdal"},
    r"CL/": {"opencl"},
    r"(hdf5\.h|hdf5_hl\.h|H5)": {"hdf5", "files"},
    r"libdeflate": {"hdf5"},
    r"zlib": {"hdf5"},
    r"png\.h": {"picture"},
    r"nlohmann/": {"base", "config", "files", "runs", "cli", "host", "report"},  # base: a header that several folders share
    r"CLI/": {"cli"},
    r"(iostream|fstream|chrono|ctime)$": {"config", "files", "meshio", "output", "cli"},
}

INCLUDE = re.compile(r'^\s*#\s*include\s+[<"]([^>"]+)[>"]')


def violations(lib: pathlib.Path):
    for file in sorted(lib.rglob("*")):
        if file.suffix not in (".h", ".cpp", ".in"):
            continue
        subfolder = file.relative_to(lib).parent.as_posix()
        folder = subfolder.split("/")[0]
        if folder not in LEVELS:
            yield f"{file}: folder {folder} has no level in check_includes.py"
            continue
        for number, line in enumerate(file.read_text().splitlines(), 1):
            match = INCLUDE.match(line)
            if match:
                for problem in problems_of(folder, subfolder, match.group(1)):
                    yield f"{file}:{number}: {problem}"


def problems_of(folder: str, subfolder: str, header: str):
    target = header.split("/")[0]
    if target in LEVELS and target != folder and LEVELS[target] >= LEVELS[folder]:
        yield f"{folder} (level {LEVELS[folder]}) includes {header} (level {LEVELS[target]})"
    for pattern, allowed in ONLY_IN.items():
        if re.match(pattern, header) and not {folder, subfolder} & allowed:
            yield f"{subfolder} includes {header}; only {', '.join(sorted(allowed))} may"


def main():
    found = list(violations(pathlib.Path(sys.argv[1]) / "lib"))
    print("\n".join(found) if found else "includes go downwards only")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
