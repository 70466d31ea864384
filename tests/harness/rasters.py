# SPDX-License-Identifier: GPL-3.0-or-later
"""A writer of elevation models, by GDAL in this process: to start one of its programs takes longer."""
import numpy as np
import rasterio
from rasterio.transform import from_bounds


def geotiff(path, values, corner, cell=1.0, crs="EPSG:32632", kind="float64", nodata=None):
    """Writes `values`, from north to south, whose south-western corner is given; returns the path."""
    (rows, cols), (west, south) = values.shape, corner
    with rasterio.open(path, "w", driver="GTiff", width=cols, height=rows, count=1, dtype=kind, crs=crs, nodata=nodata,
                       transform=from_bounds(west, south, west + cell * cols, south + cell * rows, cols, rows)) as file:
        file.write((np.rint(values) if kind.startswith("int") else values).astype(kind), 1)
    return path
