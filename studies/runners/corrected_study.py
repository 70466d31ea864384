#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How much of a DEM's elevation error z_corrected removes (docs/user/uncertainty.md).

DEM.h5 is of features on flat ground at z = 0, made with --terrain and --corrected. Judges it with z_est, then with z_corrected in
its place, and writes corrected.csv into the output folder: e_z where the terrain is above the ground, and dem-eval's verdict.
"""
import csv
import json
import os
import shutil
import sys
import tempfile

import h5py
import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..", "python"))
from landfall import command, files, tools  # pylint: disable=wrong-import-position
from landfall.errors import DataError  # pylint: disable=wrong-import-position


def parse(arguments):
    parser = command.Parser(prog="corrected_study.py", description=__doc__)
    parser.add_argument("dem", metavar="DEM.h5")
    parser.add_argument("-o", "--output", metavar="DIR", required=True)
    parser.add_argument("--bin", metavar="DIR", default="build/release/bin", help="where the tools are")
    parser.add_argument("--config", metavar="EVAL.json", help="dem-eval's configuration")
    options = parser.parse_args(arguments)
    tools.BIN = options.bin
    return options


def error_statistics(path):
    """e_z of the bins on the features, metres."""
    with files.open_landfall(path, "landfall.dem") as file:
        z_true, z_est = file["z_true"][()], file["z_est"][()]
    with np.errstate(invalid="ignore"):
        e_z = (z_true - z_est)[z_true > 0]
    e_z = e_z[np.isfinite(e_z)]
    return {"bins": e_z.size, "rms_m": round(float(np.sqrt(np.mean(e_z ** 2))), 5),
            "min_m": round(float(e_z.min()), 4), "max_m": round(float(e_z.max()), 4)}


def verdict(path, options, folder):
    metrics = os.path.join(folder, "metrics.json")
    config = ["-c", options.config] if options.config else []
    tools.run_tool(os.path.join(options.bin, "dem-eval"), path, *config, "--metrics-only", "-O", "-o",
                   os.path.join(folder, "eval.h5"), "--metrics", metrics)
    with open(metrics, encoding="utf-8") as file:
        z = json.load(file)["accuracy"]["relative"]["z"]
    return {"failing_footprints": z["violation_count"], "largest_relative_m": round(z["max_m"], 4)}


def corrected_copy(path, folder):
    """The same DEM with z_corrected under the name of z_est."""
    copy = os.path.join(folder, "corrected.h5")
    shutil.copyfile(path, copy)
    with h5py.File(copy, "r+") as file:
        if "z_corrected" not in file:
            raise DataError(f"{path}: no layer z_corrected; make it with regrid --corrected")
        file["z_est"][...] = file["z_corrected"][()]
    return copy


def main(arguments):
    options = parse(arguments)
    os.makedirs(options.output, exist_ok=True)
    rows = []
    with tempfile.TemporaryDirectory(prefix="landfall-corrected-", dir=options.output) as folder:
        for name, path in (("z_est", options.dem), ("z_corrected", corrected_copy(options.dem, folder))):
            rows.append({"elevation": name, **error_statistics(path), **verdict(path, options, folder)})
    with open(os.path.join(options.output, "corrected.csv"), "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, fieldnames=list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


if __name__ == "__main__":
    command.run(main)
