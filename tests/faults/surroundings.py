# SPDX-License-Identifier: GPL-3.0-or-later
"""Unusual environments: other locales and clocks, no home, no current folder, closed standard streams, libraries without their data."""
import json
import os
import shutil
import sqlite3
import struct
import subprocess
import sys

import numpy as np
import pyproj
import rasterio
from harness import clouds, write_file
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
RASTER = "terrain-gen --from {in}/%s --vertical-scale 1 --datum none -o {out}/a.h5"
DECIDED_BY_OPTIONS = [
    *(one for one in READERS if one.label in ("points, GeoTIFF keys", "raster, feet.tif", "polygon, ring.geojson", "export .tif")),
    task("points, keys of a CRS without a code", "landfall-import --keep-noise {in}/own.las --vertical-scale 1 -o {out}/a.h5", "a.h5"),
    *(task(f"raster, {name}", RASTER % name, "a.h5") for name in ("own.tif", "point.tif", "sidecar.png")),
    task("raster, heights in feet", "terrain-gen --from {in}/heights.tif --datum none -o {out}/a.h5", "a.h5"),
    *(task(f"raster, {name}", RASTER % name + " --horizontal-scale 1", "a.h5") for name in ("digits.asc", "rows.nc")),
]
# By each of them GDAL reads one of the files above as another one, or writes another one; the last group refuses instead.
OPTIONS = [
    {"GTIFF_POINT_GEO_IGNORE": "TRUE", "GTIFF_REPORT_COMPD_CS": "NO", "GTIFF_LINEAR_UNITS": "BROKEN", "GTIFF_IMPORT_FROM_EPSG": "NO",
     "AAIGRID_DATATYPE": "Int32", "GDAL_NETCDF_BOTTOMUP": "NO", "GDAL_TIFF_ENDIANNESS": "BIG", "GDAL_TIFF_DEFLATE_SUBCODEC": "ZLIB"},
    {"GTIFF_SRS_SOURCE": "EPSG", "GDAL_DISABLE_READDIR_ON_OPEN": "EMPTY_DIR", "OSR_ADD_TOWGS84_ON_IMPORT_FROM_EPSG": "YES",
     "OSR_DEFAULT_AXIS_MAPPING_STRATEGY": "AUTHORITY_COMPLIANT", "AAIGRID_DATATYPE": "Float64", "GDAL_NETCDF_IGNORE_XY_AXIS_NAME_CHECKS": "YES"},
    {"GDAL_GEOREF_SOURCES": "NONE", "GDAL_PAM_ENABLED": "NO", "GDAL_SKIP": "GTiff", "OGR_SKIP": "GeoJSON", "CPL_DEBUG": "ON"},
]


def raster(path, crs, driver="GTiff", at=FEET_AT, dtype="float32", **tags):
    values = np.add.outer(np.arange(31.0), np.arange(31.0)).astype(dtype)
    with rasterio.open(path, "w", driver=driver, width=31, height=31, count=1, dtype=dtype, crs=rasterio.CRS.from_user_input(crs),
                       transform=rasterio.Affine(1, 0, at[0], 0, -1, at[1] + 31)) as file:
        file.update_tags(**tags)
        file.write(values, 1)


class ReaderWorkshop(Workshop):
    """Also has files whose meaning depends on the data of PROJ, GDAL and UDUNITS, or on options of GDAL."""
    rounds = 1

    def __init__(self, binaries):
        super().__init__(binaries, tasks=[*READERS, *DECIDED_BY_OPTIONS[4:]])

    def path(self, name):
        return os.path.join(self.inputs, name)

    def write(self, name, content):
        write_file(self.path(name), content)

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
        self.make_files_decided_by_options()
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

    def make_files_decided_by_options(self):
        own = "+proj=tmerc +lat_0=40 +lon_0=-74 +x_0=300000 +y_0=0 +datum=NAD83 +units=ft"
        raster(self.path("own.tif"), own, at=(984250, 0))
        raster(self.path("point.tif"), f"EPSG:{FEET}", AREA_OR_POINT="Point")
        raster(self.path("heights.tif"), f"EPSG:{FEET}+6360")
        raster(self.path("sidecar.png"), f"EPSG:{FEET}", "PNG", dtype="uint8")
        foreign_rasters.netcdf(self.path("rows.nc"), y=foreign_rasters.offsets(31)[::-1])
        rows = [" ".join(f"{1.23456789012 * (x + 2 * y):.11f}" for x in range(31)) for y in range(31)]
        self.write("digits.asc", "\n".join(["ncols 31", "nrows 31", "xllcorner 100", "yllcorner 200", "cellsize 1", *rows, ""]))
        numbers = (-74.0, 40.0, 984250.0, 0.0, 1.0)
        keys = [1024, 0, 1, 1, 2048, 0, 1, 4269, 3072, 0, 1, 32767, 3074, 0, 1, 32767, 3075, 0, 1, 1, 3076, 0, 1, 9003,
                *(word for i, key in enumerate((3080, 3081, 3082, 3083, 3092)) for word in (key, 34736, 1, i))]
        self.write("own.las", clouds.las(clouds.las_points(60), offset=(984250.0, 0.0, 0.0), records=[
            clouds.las_vlr("LASF_Projection", 34735, np.array([1, 1, 0, len(keys) // 4, *keys], "<u2").tobytes()),
            clouds.las_vlr("LASF_Projection", 34736, struct.pack("<5d", *numbers))]))


def try_libraries(workshop):
    """Libraries without their data, or with data that they cannot use: the same result or a refusal, never another number."""
    folder = os.path.join(workshop.folder, "older")
    os.makedirs(folder, exist_ok=True)
    shutil.copy(os.path.join(pyproj.datadir.get_data_dir(), "proj.db"), folder)
    with sqlite3.connect(os.path.join(folder, "proj.db")) as database:
        database.execute("UPDATE metadata SET value = 0 WHERE key = 'DATABASE.LAYOUT.VERSION.MINOR'")
    database.close()
    yield try_environment(workshop, "PROJ_LIB names a folder without proj.db", {"PROJ_LIB": "/nowhere"}, tasks=READERS)
    yield try_environment(workshop, "PROJ_DATA names a proj.db of another version", {"PROJ_DATA": folder}, tasks=READERS)
    yield try_environment(workshop, "PROJ_AUX_DB names no file", {"PROJ_AUX_DB": "/nowhere/aux.db"}, tasks=READERS)
    yield try_environment(workshop, "UDUNITS2_XML_PATH names nothing", {"UDUNITS2_XML_PATH": "/nowhere"}, tasks=READERS)
    yield try_environment(workshop, "GDAL_DATA and GDAL_DRIVER_PATH name nothing", {"GDAL_DATA": "/nowhere", "GDAL_DRIVER_PATH": "/nowhere"}, tasks=READERS)


def try_options(workshop):
    """Options of GDAL, in the environment or in its configuration file: the same result."""
    for options in OPTIONS:
        yield try_environment(workshop, f"{', '.join(options)}", options, tasks=DECIDED_BY_OPTIONS)
    folder = os.path.join(workshop.folder, "home")
    os.makedirs(os.path.join(folder, ".gdal"), exist_ok=True)
    write_file(os.path.join(folder, ".gdal", "gdalrc"), "[configoptions]\nGTIFF_POINT_GEO_IGNORE=TRUE\n")
    point = [one for one in DECIDED_BY_OPTIONS if "point.tif" in one.label]
    yield try_environment(workshop, "a configuration file of GDAL in HOME", {"HOME": folder}, tasks=point)
    yield try_environment(workshop, "GDAL_CONFIG_FILE", {"GDAL_CONFIG_FILE": os.path.join(folder, ".gdal", "gdalrc")}, tasks=point)


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
    for what, seconds in (("is 30 years behind", -10**9), ("is 30 years ahead", 10**9), ("jumps by 60 years forth and back", f"~{10**9}")):
        yield try_environment(workshop, f"a clock that {what}", {"LD_PRELOAD": library, "FAULT_CLOCK": str(seconds)})
    yield try_environment(workshop, "no HOME, no TMPDIR, no PATH", {}, ("HOME", "TMPDIR", "PATH"))
    yield try_environment(workshop, "a TMPDIR that does not exist", {"TMPDIR": "/nowhere"})
    yield try_no_folder(workshop)
    yield try_closed(workshop, "standard input closed", 0)
    yield try_closed(workshop, "standard output closed", 1)
    yield try_closed(workshop, "standard error closed", 2)
    yield try_closed(workshop, "all three closed, with -v --progress", 0, 1, 2, verbose=True)
    readers = ReaderWorkshop(workshop.binaries)
    yield from try_libraries(readers)
    yield from try_options(readers)
    readers.remove()
