# SPDX-License-Identifier: GPL-3.0-or-later
"""Rasters as other tools write them, each with a peculiarity that readers get wrong: made anew for each test, because the
versions of the libraries that write them change their bytes.

The ground of all is z = GX x + GY y in metres from the middle, unless a function says otherwise.
"""
import h5py
import netCDF4
import numpy as np

import raster_formats as formats

GX, GY = 0.1, 0.04
POSTING_M = 5.0
COLS, ROWS = 41, 31


def offsets(count, posting=POSTING_M):
    return posting * (np.arange(count) - (count - 1) / 2)


def plane(x_m, y_m):
    return GX * np.asarray(x_m)[None, :] + GY * np.asarray(y_m)[:, None]


def netcdf(path, *, x=None, y=None, z=None, x_attributes=None, y_attributes=None, z_attributes=None, crs=None, transposed=False,
           coordinate_type="f8", packed=None, z_type="f8", fill=None, names=("x", "y"), spacing_m=1.0):
    """z(y, x) with one-dimensional coordinates. `packed`: scale and offset of int16 coordinates; `spacing_m`: metres per unit of
    x and y, for the values of z."""
    x = offsets(COLS) if x is None else np.asarray(x)
    y = offsets(ROWS) if y is None else np.asarray(y)
    z = plane(spacing_m * (x - (x[0] + x[-1]) / 2), spacing_m * (y - (y[0] + y[-1]) / 2)) if z is None else z
    with netCDF4.Dataset(path, "w") as file:
        for name, values, attributes in ((names[0], x, x_attributes), (names[1], y, y_attributes)):
            file.createDimension(name, len(values))
            variable = file.createVariable(name, "i2" if packed else coordinate_type, (name,))
            variable.set_auto_maskandscale(False)
            if packed:
                variable.scale_factor, variable.add_offset = packed
                values = np.round((values - packed[1]) / packed[0])
            variable[:] = values
            variable.setncatts(attributes or {})
        layer = file.createVariable("z", z_type, names if transposed else names[::-1], fill_value=fill)
        layer.set_auto_maskandscale(False)
        layer.setncatts(z_attributes or {})
        if crs is not None:
            layer.grid_mapping = "crs"
            file.createVariable("crs", "i4").setncatts(crs)
        layer[:] = z.T if transposed else z
    return path


def hdf5(path, *, scales=True, attributes=None, x=None, y=None, z=None):
    """z(y, x) of an HDF5 file with dimension scales, as h5py and MATLAB users make them."""
    x = offsets(COLS) if x is None else np.asarray(x)
    y = offsets(ROWS) if y is None else np.asarray(y)
    with h5py.File(path, "w") as file:
        file["z"] = plane(x, y) if z is None else z
        file["x"], file["y"] = x, y
        for name in "xy":
            file[name].attrs["units"] = "m"
        file["z"].attrs.update(attributes or {})
        if scales:
            for name, axis in (("y", 0), ("x", 1)):
                file[name].make_scale(name)
                file["z"].dims[axis].attach_scale(file[name])
    return path


def geotiff(path, keys, transform, values, nodata=None):
    with open(path, "wb") as file:
        file.write(formats.tiff(values, keys, transform, nodata))
    return path


PDS3 = """PDS_VERSION_ID = PDS3
RECORD_TYPE = FIXED_LENGTH
RECORD_BYTES = {record}
FILE_RECORDS = {rows}
^IMAGE = "{image}"
OBJECT = IMAGE
  LINES = {rows}
  LINE_SAMPLES = {cols}
  SAMPLE_TYPE = PC_REAL
  SAMPLE_BITS = 32
{lines}
  BANDS = 1
  BAND_STORAGE_TYPE = BAND_SEQUENTIAL
END_OBJECT = IMAGE
OBJECT = IMAGE_MAP_PROJECTION
  MAP_PROJECTION_TYPE = "SIMPLE CYLINDRICAL"
  A_AXIS_RADIUS = 1737.4 <KM>
  B_AXIS_RADIUS = 1737.4 <KM>
  C_AXIS_RADIUS = 1737.4 <KM>
  CENTER_LATITUDE = 0 <DEG>
  CENTER_LONGITUDE = 0 <DEG>
  LINE_FIRST_PIXEL = 1
  LINE_LAST_PIXEL = {rows}
  SAMPLE_FIRST_PIXEL = 1
  SAMPLE_LAST_PIXEL = {cols}
  MAP_RESOLUTION = 256 <PIX/DEG>
  MAP_SCALE = 118.4505876 <METERS/PIXEL>
  LINE_PROJECTION_OFFSET = 15
  SAMPLE_PROJECTION_OFFSET = 15
END_OBJECT = IMAGE_MAP_PROJECTION
END
"""
PDS3_POSTING_M = 118.4505876


def pds3(folder, lines, values):
    """A label and an image beside it around longitude and latitude 0 of the Moon; `lines` go into the IMAGE object."""
    rows, cols = values.shape
    with open(f"{folder}/moon.img", "wb") as file:
        file.write(values.astype("<f4").tobytes())
    with open(f"{folder}/moon.lbl", "w", encoding="ascii") as file:
        file.write(PDS3.format(record=4 * cols, rows=rows, cols=cols, image="moon.img", lines=lines))
    return f"{folder}/moon.lbl"
