#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Valid HDF5 that was made to deceive: landfall.open and every plot command refuse an edited file with one landfall.Error, or read it.

An edit replaces, adds, moves or deletes an object or an attribute through h5py, which removes the seal. LANDFALL_TEST_LONG=1 tries 500 edits
of the attributes that link layers to coordinates, and 3,000 of anything, of which 300 through each plot command; LANDFALL_TEST_SEED chooses
others.
"""
import collections
import contextlib
import os
import random
import shutil
import sys
import unittest

import h5py
import numpy as np
from harness import ChainTest, read_bytes, run
from python_test import IS_LONG, PLOTS, SEED, EachKind, landfall, open_all, outcomes_of

HOSTILE = os.path.join(os.environ["LANDFALL_ROOT"], "..", "shared", "data", "hostile-4")
SCALES = ("CLASS", "NAME", "REFERENCE_LIST", "DIMENSION_LIST", "DIMENSION_LABELS")
LINKS, ANYTHING, FIGURES = (500, 3000, 300) if IS_LONG else (40, 60, 3)
USER = np.dtype([("dataset", h5py.ref_dtype), ("dimension", "i4")])
HIDING = np.dtype([("number", "i4"), ("text", h5py.string_dtype())])
TYPES = (np.dtype("i4"), np.dtype("f8"), np.dtype("f4"), np.dtype("u1"), np.dtype("i8"), np.dtype("c16"), np.dtype(bool), np.dtype("S1"), np.dtype("S16"),
         np.dtype("S64"), h5py.string_dtype(), h5py.ref_dtype, h5py.regionref_dtype, h5py.vlen_dtype(h5py.ref_dtype), h5py.vlen_dtype("f8"),
         h5py.vlen_dtype(h5py.string_dtype()), USER, HIDING, np.dtype([("a", "f8"), ("b", "f8", (3,))]), np.dtype(("f8", (4,))), np.dtype("V7"),
         h5py.enum_dtype({"A": 1, "B": 2}), np.dtype(">f8"), np.dtype("f2"))
SHAPES = ((), (), (0,), (1,), (2,), (3,), (5,), (40,), (2, 2), (1, 2, 3), None)


def low_level(dtype):
    """The HDF5 type of a dtype, also of one that h5py's own functions do not make."""
    return h5py.h5t.py_create(np.dtype(dtype), logical=True)


def values_of(choose, file, dtype, shape):
    """Values for an attribute or a dataset; None where only zeros can be written."""
    datasets = []
    file.visititems(lambda _, item: datasets.append(item) if isinstance(item, h5py.Dataset) else None)
    references = [item.ref for item in datasets] + [h5py.Reference()]
    count = int(np.prod(shape))
    if dtype == h5py.ref_dtype:
        return np.array([choose.choice(references) for _ in range(count)], dtype=dtype).reshape(shape)
    if dtype == USER:
        return np.array([(choose.choice(references), choose.randrange(-2, 5)) for _ in range(count)], dtype=dtype).reshape(shape)
    if dtype == h5py.vlen_dtype(h5py.ref_dtype):
        values = np.empty(count, dtype=object)
        for index in range(count):
            values[index] = np.array([choose.choice(references) for _ in range(choose.randrange(4))], dtype=h5py.ref_dtype)
        return values.reshape(shape)
    if dtype == h5py.string_dtype():
        return np.array([choose.choice(("", "DIMENSION_SCALE", "x", "landfall.dem", "{}", "a" * 300)) for _ in range(count)], dtype=object).reshape(shape)
    if dtype.kind == "S":
        return np.array([choose.choice((b"DIMENSION_SCALE", b"x", b"", b"\xff" * 70)) for _ in range(count)], dtype=dtype).reshape(shape)
    if dtype.kind in "iuf" and dtype.subdtype is None:
        return np.array([choose.choice((0, 1, 2, 7, 100, 6e4, float("nan"), float("inf")) if dtype.kind == "f" else (0, 1, 2, 7, 100)) for _ in range(count)],
                        dtype=dtype).reshape(shape)
    return None


def space_of(shape):
    return h5py.h5s.create(h5py.h5s.NULL) if shape is None else h5py.h5s.create_simple(shape) if shape else h5py.h5s.create(h5py.h5s.SCALAR)


def write_attribute(choose, file, item, name):
    dtype, shape = choose.choice(TYPES), choose.choice(SHAPES)
    if name in item.attrs:
        del item.attrs[name]
    attribute = h5py.h5a.create(item.id, name.encode(), low_level(dtype), space_of(shape))
    values = None if shape is None else values_of(choose, file, dtype, shape)
    if values is not None:
        attribute.write(np.asarray(values), mtype=low_level(dtype))
    return f"{item.name}: {name} = {dtype} {shape}"


def objects_in(file):
    """The paths of all objects, the root among them."""
    names = ["/"]
    file.visit(names.append)
    return sorted(names)


def edit_links(choose, file):
    """An edit of an attribute that links layers to coordinates."""
    name = choose.choice([path for path in objects_in(file) if isinstance(file[path], h5py.Dataset)] + ["x", "y"] * 3 * ("x" in file and "y" in file))
    return write_attribute(choose, file, file[name], choose.choice(SCALES))


def edit_anything(choose, file):
    """An edit of an attribute or of an object."""
    if choose.random() < 0.25:
        return edit_links(choose, file)
    item = file[choose.choice(objects_in(file))]
    if choose.random() < 0.35:
        return write_attribute(choose, file, item, choose.choice([*item.attrs, *file.attrs, "units", "_FillValue", "long_name"]))
    if item.name == "/":
        item = file[choose.choice(objects_in(file)[1:])]
    name = item.name
    what = choose.choice(("delete", "replace", "replace", "replace", "grow", "group", "type", "move", "cycle", "copy", "text"))
    shape = getattr(item, "shape", None) or ()
    if what == "cycle":
        file[f"{name if isinstance(item, h5py.Group) else ''}/again"] = file["/"]
    elif what == "move":
        file.move(name, choose.choice(("/moved", "/provenance/moved", f"{name}_")))
    elif what == "copy":
        file.copy(choose.choice(objects_in(file)[1:]), "/copied" if choose.random() < 0.5 else f"{name}_copied")
    else:
        kept = {key: value for key, value in item.attrs.items() if key not in SCALES} if choose.random() < 0.5 else {}
        del item, file[name]
        if what in ("replace", "grow"):
            dtype = choose.choice(TYPES)
            shape = shape if choose.random() < 0.5 else choose.choice(SHAPES)
            shape = tuple(size + 1 for size in shape) if what == "grow" and shape else shape
            made = h5py.Dataset(h5py.h5d.create(file.id, name.encode(), low_level(dtype), space_of(shape)))
            values = values_of(choose, file, dtype, shape) if shape is not None and np.prod(shape) < 500 else None
            if values is not None:
                made.id.write(h5py.h5s.ALL, h5py.h5s.ALL, np.asarray(values), mtype=low_level(dtype))
            what += f" by {dtype} {shape}"
        elif what == "group":
            made = file.create_group(name)
        elif what == "text":
            made = file.create_dataset(name, data=choose.choice(("", "[]", "{}", "null", "{\"a\": 1}", "text")))
        elif what == "type":
            file[name] = choose.choice(TYPES[:10])
            made = file[name]
        else:
            return f"{name}: delete"
        with contextlib.suppress(Exception):
            made.attrs.update(kept)
    return f"{name}: {what}"


class ScaleAttributes(ChainTest):
    """The check of the attributes that libhdf5_hl reads into memory of the size that they should have."""

    def check(self, change):
        return run("landfall-info", "--check", self.changed(self.chain.dem, change))

    def test_other_types_and_shapes_are_refused(self):
        reference, text, lists = h5py.ref_dtype, h5py.string_dtype(), h5py.vlen_dtype(h5py.ref_dtype)
        no_texts = [("i4", ()), ("f8", (3,)), ("S2", (2,)), ("S16", None), (reference, (1,))]
        wrong = {"CLASS": no_texts, "NAME": [*no_texts, (text, ())],
                 "REFERENCE_LIST": [("i4", ()), (text, ()), (reference, (2,)), (USER, ()), (USER, (2, 2)), (USER, None), ([("dataset", reference)], (2,)),
                                    ([("dimension", "i4"), ("dataset", reference)], (2,)), ([("dataset", h5py.regionref_dtype), ("dimension", "i4")], (2,))],
                 "DIMENSION_LIST": [("i4", ()), (text, ()), (reference, (2,)), (lists, (1,)), (lists, (3,)), (lists, ()), (lists, (1, 2)), (lists, None),
                                    (h5py.vlen_dtype("i8"), (2,)), (h5py.vlen_dtype(h5py.regionref_dtype), (2,))],
                 "DIMENSION_LABELS": [("i4", ()), (text, ()), ("S90", (2,)), (text, (1,)), (text, (3,))]}
        for name, dtype, shape in ((name, *form) for name, forms in wrong.items() for form in forms):
            def change(file, name=name, dtype=dtype, shape=shape):
                item = file["z_est" if name.startswith("DIMENSION") else "x"]
                if name in item.attrs:
                    del item.attrs[name]
                h5py.h5a.create(item.id, name.encode(), low_level(dtype), space_of(shape))
            with self.subTest(name=name, dtype=dtype, shape=shape):
                result = self.check(change)
                self.assertEqual((result.returncode, result.stdout), (1, ""))
                self.assertRegex(result.stderr, rf"\Alandfall-info: [^\n]*changed.h5: /(x|z_est): its attribute {name} is not [^\n]*\n\Z")

    def test_what_other_programs_write_is_accepted(self):
        def change(file):
            file["rows"] = np.arange(3)
            file["rows"].make_scale("rows")
            file["extra"] = np.zeros((3, 4))
            file["extra"].dims[0].attach_scale(file["rows"])
            file["extra"].dims[0].label = "row"
            file["table"] = np.zeros(3)
            file["table"].attrs.update({"CLASS": np.bytes_("TABLE"), "VERSION": "1.0"})
            file["count"].attrs["NAME"] = ["a", "b"]  # of no dimension scale
            del file["z_true"]  # what it was linked to keeps a reference to it
        result = self.check(change)
        self.assertEqual((result.returncode, result.stderr), (0, ""))


@unittest.skipUnless(os.path.isdir(HOSTILE), "needs the files of shared/data/hostile-4")
class HostileLinks(unittest.TestCase):
    def test_files_that_crashed_python_are_refused(self):
        files = (("DIMENSION_LIST", "terrain-int.h5"), ("NAME", "terrain-x-NAME-arr.h5"))
        for (name, _), (what, text) in zip(files, outcomes_of([lambda path=path: open_all(os.path.join(HOSTILE, path), "terrain") for _, path in files])):
            self.assertEqual(what, "refused", text)
            self.assertIn(name, text)


class EditedFiles(EachKind):
    def edited(self, choose, kind, edit):
        """Edits a copy of a file of this kind. Returns the edit in words; None where h5py refuses it."""
        shutil.copy(self.files[kind], self.damaged)
        try:
            with h5py.File(self.damaged, "a") as file:
                return edit(choose, file)
        except (KeyError, OSError, RuntimeError, TypeError, ValueError):
            return None

    def edits(self, count, edit, kinds):
        """`count` edits in words, each with the kind of the file and its content."""
        choose, number = random.Random(f"{SEED} {edit.__name__} {kinds}"), 0
        while number < count:
            kind = kinds[number % len(kinds)]
            what = self.edited(choose, kind, edit)
            if what:
                number += 1
                yield what, kind, read_bytes(self.damaged)

    def expect_no_crash(self, found, outcomes):
        outcomes[found[0]] += 1
        self.assertIn(found[0], ("right", "refused"), found[1])
        if found[0] == "refused":
            self.assertRegex(found[1], r"\A[^\n]*damaged\.h5[^\n]*\Z")

    def open_each(self, count, edit):
        outcomes, edits = collections.Counter(), list(self.edits(count, edit, list(self.files)))
        for (what, kind, _), found in zip(edits, outcomes_of([self.reader(kind, content) for _, kind, content in edits])):
            with self.subTest(kind=kind, edit=what):
                self.expect_no_crash(found, outcomes)
        print(f"{count} edits: {dict(outcomes)}", file=sys.stderr)
        self.assertGreater(outcomes["refused"], count // 20)

    def test_attributes_that_link_layers_to_coordinates(self):
        self.open_each(LINKS, edit_links)

    def test_a_table_with_other_units_and_names_is_printed(self):
        for value in (np.arange(3), ["a", "b"], h5py.Empty("f8"), "\x1b[31m", "\u202em"):
            shutil.copy(self.files["scan"], self.damaged)
            with h5py.File(self.damaged, "a") as file:
                file["points/z_est"].attrs.update({"units": value, "long_name": value})
            with self.subTest(value=value), landfall.open(self.damaged) as table:
                self.assertRegex(repr(table), r"(?m)^  z_est +float64  ")
                self.assertNotRegex(repr(table), "[\x1b\u202e]")

    def test_objects_and_attributes(self):
        self.open_each(ANYTHING, edit_anything)

    def test_plot_commands(self):
        tried = [(*edit, plot) for kind, plots in PLOTS.items() for edit in self.edits(FIGURES, edit_anything, [kind]) for plot in plots]
        outcomes = collections.defaultdict(collections.Counter)
        for (what, kind, _, plot), found in zip(tried, outcomes_of([self.reader(kind, content, plot) for _, kind, content, plot in tried])):
            with self.subTest(kind=kind, plot=plot.__name__, edit=what):
                self.expect_no_crash(found, outcomes[kind])
        for kind, found in outcomes.items():
            print(f"{FIGURES} edits of {kind}: {dict(found)}", file=sys.stderr)


if __name__ == "__main__":
    unittest.main()
