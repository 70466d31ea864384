# SPDX-License-Identifier: GPL-3.0-or-later
"""Grids and meshes as xarray.Datasets. Only this module needs xarray."""
import h5py
import xarray
from xarray.core import indexing

from landfall import files

# Coordinates are found by name: libhdf5_hl, which follows the references between layers and coordinates, reads past its memory for some.
COORDINATES = ("x", "y", "crs")
# Dimensions of the datasets that have no coordinates.
MESH = {"vertices": ("vertex", "axis"), "triangles": ("triangle", "corner")}


class Source:
    """An open file. A copy of it, such as an unpickled one, opens the file again."""

    def __init__(self, path, formats, check=True, file=None):
        self.path, self.formats, self.check = path, formats, check
        self.file = file or files.open_screened(path, formats, check)

    def __reduce__(self):
        return Source, (self.path, self.formats, self.check)

    def close(self):
        self.file.close()


class Layer(xarray.backends.BackendArray):
    """A dataset that xarray reads on access."""

    def __init__(self, source, dataset):
        self.source, self.name, self.shape, self.dtype = source, dataset.name, dataset.shape, dataset.dtype

    def __getitem__(self, key):
        return indexing.explicit_indexing_adapter(key, self.shape, indexing.IndexingSupport.OUTER_1VECTOR, self._read)

    def _read(self, key):
        return files.read(self.source.file[self.name], key)


class Backend(xarray.backends.BackendEntrypoint):
    """The datasets at the root of a file, or those of its mesh."""

    open_dataset_parameters = ("filename_or_obj", "drop_variables")

    def open_dataset(self, filename_or_obj, *, drop_variables=()):
        source = filename_or_obj
        coordinates, layers = {}, {}
        for name, dataset in (source.file["mesh"] if "mesh" in source.file else source.file).items():
            if isinstance(dataset, h5py.Dataset) and name not in (drop_variables or ()):
                is_coordinate = name in COORDINATES and dataset.ndim < 2
                (coordinates if is_coordinate else layers)[name] = _variable(source, name, dataset)
        result = xarray.Dataset(layers, coordinates, files.attributes(source.file))
        result.encoding["source"] = source.path
        return result


def open_grid(source):
    result = xarray.open_dataset(source, engine=Backend)
    result.set_close(source.close)
    return result


def _variable(source, name, dataset):
    attributes, encoding = files.attributes(dataset), {}
    dimensions = _dimensions(name, dataset)
    if "_FillValue" in attributes:
        encoding["_FillValue"] = attributes.pop("_FillValue")
    if dataset.chunks:
        encoding["preferred_chunks"] = dict(zip(dimensions, dataset.chunks))
    data = indexing.LazilyIndexedArray(Layer(source, dataset)) if dataset.shape else files.read(dataset, ())
    return xarray.Variable(dimensions, data, attributes, encoding)


def _dimensions(name, dataset):
    if name in ("x", "y") and dataset.ndim == 1:
        return (name,)
    if name in MESH and dataset.ndim == 2:
        return MESH[name]
    shape = tuple(getattr(dataset.parent.get(axis), "shape", None) for axis in "yx")
    is_layer = dataset.ndim == 2 and shape == tuple((size,) for size in dataset.shape)
    return ("y", "x") if is_layer else tuple(f"{name}_{place}" for place in range(dataset.ndim))
