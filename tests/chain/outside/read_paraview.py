# SPDX-License-Identifier: GPL-3.0-or-later
"""usage: pvpython read_paraview.py READER FILE OUT.npz ...: writes points, bounds, number of cells and point data that ParaView reads."""
import sys

import numpy as np
from paraview import servermanager, simple
from vtk.util.numpy_support import vtk_to_numpy

READERS = {"ply": lambda file: simple.PLYReader(FileNames=[file]),
           "xdmf": lambda file: simple.XDMFReader(FileNames=[file]),
           "xdmf3": lambda file: simple.Xdmf3ReaderS(FileName=[file])}


def read(name, file):
    reader = READERS[name](file)
    reader.UpdatePipeline()
    data = servermanager.Fetch(reader)
    arrays = {"bounds": np.array(data.GetBounds()), "cells": np.array(data.GetNumberOfCells())}
    if hasattr(data, "GetPoints"):  # images have no points
        arrays["points"] = vtk_to_numpy(data.GetPoints().GetData())
    fields = data.GetPointData()
    for i in range(fields.GetNumberOfArrays()):
        arrays["field_" + fields.GetArrayName(i)] = vtk_to_numpy(fields.GetArray(i))
    return arrays


for argument in range(1, len(sys.argv), 3):
    np.savez(sys.argv[argument + 2], **read(*sys.argv[argument:argument + 2]))
