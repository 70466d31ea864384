# SPDX-License-Identifier: GPL-3.0-or-later
"""Unusual environments: other locales and clocks, no home, no current folder, closed standard streams, libraries without their data."""
import json
import os
import shutil
import sqlite3
import subprocess
import sys

import numpy as np
import pyproj
import rasterio
from harness import clouds
from workshop import TASKS, Judge, Workshop, task

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "testdata"))
import foreign_rasters  # noqa: E402  # pylint: disable=wrong-import-position

FEET = 2263  # EPSG, US survey feet
FEET_AT = (1000000, 200000)
READERS = [
    task("points, GeoTIFF keys", "landfall-import --keep-noise {in}/feet.las --vertical-scale 1 -o {out}/a.h5", "a.h5"),
    task("points, WKT", "landfall-import --keep-noise {in}/wkt.las --vertical-scale 1 -o {out}/a.h5", "a.h5"),
    task("points, --crs", f"landfall-import {{in}}/feet.csv --crs EPSG:{FEET} --vertical-scale 1 -o {{out}}/a.h5", "a.h5"),
    task("points, units", "landfall-import {in}/units.csv -o {out}/a.h5", "a.h5"),
    *(task(f"raster, {name}", f"terrain-gen --from {{in}}/{name} --vertical-scale 1 --datum none -o {{out}}/a.h5", "a.h5")
      for name in ("feet.tif", "moon.tif", "km.nc", "feet.ers")),
    task("raster as a DEM", "landfall-import {in}/feet.tif --vertical-scale 1 -o {out}/a.h5", "a.h5"),
    *(task(f"polygon, {name}", f"dem-eval {{in}}/placed.h5 --set region={{\"shape\":\"polygon\",\"path\":\"{{in}}/{name}\"}} "
           "--set footprint_m=3 -o {out}/a.h5", "a.h5") for name in ("ring.geojson", "ring.gpkg")),
    *(task(f"export .{kind}", f"landfall-export {{in}}/{source}.h5 -o {{out}}/a.{kind}", f"a.{kind}")
      for source, kind in (("placed", "tif"), ("points", "las"))),
    *(one for one in TASKS if one.label in ("terrain-gen .tif", "terrain-gen of a .tif", "landfall-export .tif")),  # a local CRS
    task("landfall-info", "landfall-info {in}/placed.h5 --json"),
    task("comparison", "landfall-info --compare {in}/placed.h5 {in}/other.h5 --json"),
]


def raster(path, crs, driver="GTiff", at=FEET_AT):
    values = np.add.outer(np.arange(31.0), np.arange(31.0)).astype("f4")
    with rasterio.open(path, "w", driver=driver, width=31, height=31, count=1, dtype="float32", crs=rasterio.CRS.from_string(crs),
                       transform=rasterio.Affine(1, 0, at[0], 0, -1, at[1] + 31)) as file:
        file.write(values, 1)


class ReaderWorkshop(Workshop):
    """Also has files whose meaning depends on the data of PROJ, GDAL and UDUNITS."""

    def __init__(self, binaries):
        super().__init__(binaries, tasks=READERS)

    def path(self, name):
        return os.path.join(self.inputs, name)

    def write(self, name, content):
        with open(self.path(name), "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())

    def tool(self, line):
        subprocess.run([os.path.join(self.binaries, word) if i == 0 else word.replace("{in}", self.inputs)
                        for i, word in enumerate(line.split())], check=True, capture_output=True)

    def finish(self, process):
        run = super().finish(process)
        run.stderr = "".join(line for line in run.stderr.splitlines(keepends=True) if ": warning: " not in line)
        return run

    def make_inputs(self):
        super().make_inputs()
        self.make_points()
        self.make_rasters()
        for name, crs in (("placed", f"EPSG:{FEET}"), ("other", "EPSG:6539")):
            self.tool(f"landfall-import {{in}}/feet.tif --crs {crs} --vertical-scale 1 -o {{in}}/{name}.h5")
        self.tool("landfall-import {in}/feet.las --vertical-scale 1 -o {in}/points.h5")
        to_degrees = pyproj.Transformer.from_crs(FEET, 4326, always_xy=True)
        ring = [to_degrees.transform(FEET_AT[0] + x, FEET_AT[1] + y) for x, y in ((5, 5), (25, 5), (25, 25), (5, 25), (5, 5))]
        self.write("ring.geojson", json.dumps({"type": "Polygon", "coordinates": [ring]}))
        subprocess.run(["ogr2ogr", "-t_srs", f"EPSG:{FEET}", self.path("ring.gpkg"), self.path("ring.geojson")], check=True, capture_output=True)

    def make_points(self):
        keys = np.array([1, 1, 0, 3, 1024, 0, 1, 1, 3072, 0, 1, FEET, 4099, 0, 1, 9001], "<u2").tobytes()
        wkt = pyproj.CRS(FEET).to_wkt("WKT1_GDAL").encode() + b"\0"
        points, offset = clouds.las_points(60), (*FEET_AT, 0.0)
        self.write("feet.las", clouds.las(points, offset=offset, records=[clouds.las_vlr("LASF_Projection", 34735, keys)]))
        self.write("wkt.las", clouds.las(points, 6, 4, offset=offset, encoding=16, records=[clouds.las_vlr("LASF_Projection", 2112, wkt)]))
        rows = [f"{FEET_AT[0] + i},{FEET_AT[1] + i % 7},{i % 5}" for i in range(60)]
        self.write("feet.csv", "\n".join(["x,y,z", *rows, ""]))
        self.write("units.csv", "\n".join(["x [dam],y [dam],z [dam]", *rows, ""]))

    def make_rasters(self):
        raster(self.path("feet.tif"), f"EPSG:{FEET}")
        raster(self.path("feet.ers"), f"EPSG:{FEET}", "ERS")
        raster(self.path("moon.tif"), "+proj=stere +lat_0=-90 +R=1737400", at=(0, 0))
        unit = {"units": "dam"}
        foreign_rasters.netcdf(self.path("km.nc"), x_attributes=unit, y_attributes=unit)


def try_libraries(workshop):
    """Libraries without their data, or with data that they cannot use: the same result or a refusal, never another number."""
    folder = os.path.join(workshop.folder, "older")
    os.makedirs(folder, exist_ok=True)
    shutil.copy(os.path.join(pyproj.datadir.get_data_dir(), "proj.db"), folder)
    with sqlite3.connect(os.path.join(folder, "proj.db")) as database:
        database.execute("UPDATE metadata SET value = 0 WHERE key = 'DATABASE.LAYOUT.VERSION.MINOR'")
    database.close()
    for name in ("PROJ_LIB", "PROJ_DATA"):
        yield try_environment(workshop, f"{name} names a folder without proj.db", {name: "/nowhere"}, tasks=READERS)
        yield try_environment(workshop, f"{name} names a proj.db of another version", {name: folder}, tasks=READERS)
    yield try_environment(workshop, "PROJ_AUX_DB names no file", {"PROJ_AUX_DB": "/nowhere/aux.db"}, tasks=READERS)
    for name in ("GDAL_DATA", "GDAL_DRIVER_PATH", "UDUNITS2_XML_PATH"):
        yield try_environment(workshop, f"{name} names nothing", {name: "/nowhere"}, tasks=READERS)


def comma_locale(workshop):
    """Makes a locale with a decimal comma; None if the sources of locales are not installed."""
    folder = os.path.join(workshop.folder, "locale")
    os.makedirs(folder, exist_ok=True)
    made = subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", os.path.join(folder, "de_DE.UTF-8")], capture_output=True,
                          check=False)
    return {"LOCPATH": folder, "LC_ALL": "de_DE.UTF-8", "LANG": "de_DE.UTF-8"} if made.returncode == 0 else None


def try_environment(workshop, what, changes, dropped=(), tasks=None):
    judge = Judge(workshop, what)
    environment = {key: value for key, value in os.environ.items() if key not in dropped} | changes
    for one in tasks or TASKS:
        judge.take(one, workshop.run(one, env=environment))
    return judge


def closing(*descriptors):
    def close():
        for descriptor in descriptors:
            os.close(descriptor)
    return close


def try_closed(workshop, what, *descriptors, verbose=False, tasks=None):
    """Closed standard streams: no file of the run may get their descriptor and be written to by mistake."""
    judge = Judge(workshop, what)
    for one in tasks or TASKS:
        workshop.prepare(one)
        process = subprocess.Popen([*workshop.command(one), *(["-v", "--progress"] if verbose else [])], stdin=subprocess.DEVNULL,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, preexec_fn=closing(*descriptors))
        run = workshop.finish(process)
        if run.code == 1 and 2 in descriptors:  # the message is lost
            run.stderr = f"{one.tool}: writing to standard output failed\n"
        if run.code == 0 and one.outputs:
            run.stdout = workshop.stdout[one]
        judge.take(one, run)
    return judge


def try_no_folder(workshop):
    """The current folder is removed; all paths are absolute."""
    judge = Judge(workshop, "the current folder was removed")
    for one in TASKS:
        gone = os.path.join(workshop.folder, "gone")
        os.mkdir(gone)
        def enter_and_remove(gone=gone):
            os.chdir(gone)
            os.rmdir(gone)
        workshop.prepare(one)
        process = subprocess.Popen(workshop.command(one), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   preexec_fn=enter_and_remove)
        judge.take(one, workshop.finish(process))
        shutil.rmtree(gone, ignore_errors=True)
    return judge


def try_surroundings(workshop, library):
    comma = comma_locale(workshop)
    if comma:
        yield try_environment(workshop, "a locale with a decimal comma (de_DE)", comma)
    yield try_environment(workshop, "another time zone (TZ)", {"TZ": "Pacific/Chatham"})
    for what, seconds in (("behind", -10**9), ("ahead", 10**9)):
        yield try_environment(workshop, f"a clock that is 30 years {what}", {"LD_PRELOAD": library, "FAULT_CLOCK": str(seconds)})
    yield try_environment(workshop, "no HOME, no TMPDIR, no PATH", {}, ("HOME", "TMPDIR", "PATH"))
    yield try_environment(workshop, "a TMPDIR that does not exist", {"TMPDIR": "/nowhere"})
    yield try_no_folder(workshop)
    yield try_closed(workshop, "standard input closed", 0)
    yield try_closed(workshop, "standard output closed", 1)
    yield try_closed(workshop, "standard error closed", 2)
    yield try_closed(workshop, "all three closed, with -v --progress", 0, 1, 2, verbose=True)
    readers = ReaderWorkshop(workshop.binaries)
    yield from try_libraries(readers)
    readers.remove()
