#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""HDF5 files that refer to other files, or declare more data than they hold: each reader refuses them and opens no other file.

The file that must not be opened is a pipe, because opening it would block.
"""
import json
import os
import pathlib
import random
import re
import shutil
import struct
import subprocess
import tempfile
import threading
import unittest
import zlib

import h5py
import numpy as np

from harness import SANITIZED, SCAN, TOOLS, Chain, ChainTest, read_bytes, run, set_text, tool, with_values

GIB = 1 << 30


def stored_chunks(item, unread=("/features", "/holes")):
    """Address and size of each chunk of a dataset, by default of those whose statistics landfall-info shows."""
    if not isinstance(item, h5py.Dataset) or not item.chunks or item.name.startswith(unread):
        return []
    chunks = [item.id.get_chunk_info(i) for i in range(item.id.get_num_chunks())]
    return [(chunk.byte_offset, chunk.size) for chunk in chunks]


def seal_begin(content):
    """The size of a file before its seal (lib/store/hdf5/guard/file_seal.h)."""
    return int.from_bytes(content[-56:-48], "little") if content.endswith(b"landfall seal 1\n") else len(content)


def metadata_places(path):
    """Offsets of all bytes before the seal that are not chunks."""
    chunks = []
    with h5py.File(path) as file:
        file.visititems(lambda _, item: chunks.extend(stored_chunks(item, ())))
    is_chunk = np.zeros(seal_begin(read_bytes(path)), bool)
    for begin, count in chunks:
        is_chunk[begin:begin + count] = True
    return np.flatnonzero(~is_chunk).tolist()


def flip(path, at, bit):
    """Changes a bit of a file in place."""
    with open(path, "r+b") as file:
        file.seek(at)
        byte = file.read(1)[0]
        file.seek(at)
        file.write(bytes([byte ^ bit]))


def measured(name, *arguments):
    """Runs a tool: exit code, stderr and peak memory in kB. Kills it after 10 s."""
    with tempfile.TemporaryFile("w+") as stderr:
        with subprocess.Popen([tool(name), *map(str, arguments)], stdout=subprocess.DEVNULL, stderr=stderr) as process:
            timer = threading.Timer(10 if not SANITIZED else 300, process.kill)
            timer.start()
            _, status, usage = os.wait4(process.pid, 0)
            timer.cancel()
            process.returncode = os.waitstatus_to_exitcode(status)
        stderr.seek(0)
        return process.returncode, stderr.read(), usage.ru_maxrss


def external_link(file, name, target):
    del file[name]
    file[name] = h5py.ExternalLink(target, "/z")


def soft_link(file, name, _target):
    file.move(name, "/elsewhere")
    file[name] = h5py.SoftLink("/elsewhere")


def virtual(file, name, target):
    shape, dtype = file[name].shape, file[name].dtype
    del file[name]
    layout = h5py.VirtualLayout(shape, dtype)
    layout[...] = h5py.VirtualSource(target, "z", shape)
    file.create_virtual_dataset(name, layout)


def external_values(file, name, target):
    shape, dtype = file[name].shape, file[name].dtype
    del file[name]
    file.create_dataset(name, shape, dtype, external=[(target, 0, h5py.h5f.UNLIMITED)])


def external_group(file, name, target):
    """The dataset is reached through a group of another file."""
    file["group"] = h5py.ExternalLink(target, "/")
    del file[name]
    file[name] = h5py.SoftLink("/group/z")


def with_paths(tree, path):
    """The JSON with every file name replaced by `path`, and with `path` added to every object."""
    if isinstance(tree, list):
        return [with_paths(entry, path) for entry in tree]
    if isinstance(tree, dict):
        return {"path": path, "table": path, "file": path, **{key: with_paths(value, path) for key, value in tree.items()}}
    return path if isinstance(tree, str) and tree.endswith((".h5", ".csv", ".json", ".tif")) else tree


# {kind of reference to another file: words of the message}.
REFERENCES = {external_link: ["is a link to another file, ", ":/z", "one file"], soft_link: ["is a soft link, to /elsewhere"],
        virtual: ["is a virtual dataset, of "], external_values: ["stores its values in another file, "],
        external_group: ["is a link to another file, "]}


class ForeignHdf5(ChainTest):
    def setUp(self):
        super().setUp()
        self.target = self.path("target.h5")
        os.mkfifo(self.target)

    def copy(self, source, name):
        return shutil.copy(source, self.path(name))

    def changed(self, source, change, name):
        return super().changed(source, lambda file: change(file, name, self.target))

    def test_no_kind_of_reference_is_followed(self):
        for change, words in REFERENCES.items():
            path = self.changed(self.chain.terrain, change, "z")
            self.refuse(1, "landfall-info", path, words=[path + ": /", *words])
            if change in (external_link, virtual, external_values):
                self.refuse(1, "landfall-info", path, words=[": /z ", self.target])

    def test_no_reader_follows_a_link(self):
        out = self.path("out.h5")
        scan, regrid, judge = (self.chain.config(name) for name in ("scan-sim", "regrid", "dem-eval"))
        terrain = self.changed(self.chain.terrain, external_link, "z")
        readers = [("scan-sim", "--terrain", terrain, "-c", scan), ("terrain-gen", "--from", terrain),
                   ("regrid", self.chain.scan, "-c", regrid, "--terrain", terrain)]
        for name, *arguments in readers:
            output = self.path("out.tif") if name == "terrain-gen" else out
            self.refuse(1, name, *arguments, "-o", output, words=["/z is a link to another file"], output=output)
        points = self.changed(self.chain.scan, external_link, "points/x_est")
        self.refuse(1, "regrid", points, "-c", regrid, "-o", out, words=["/points/x_est is a link to another"])
        self.refuse(1, "scan-sim", "--terrain", self.chain.terrain, "-c", scan, "--ranges-from", points, "-o", out,
                    words=["/points/x_est is a link to another"])
        self.refuse(1, "landfall-export", points, "-o", self.path("out.las"), words=["/points/x_est is a link"])
        dem = self.changed(self.chain.dem, external_link, "z_est")
        self.refuse(1, "dem-eval", dem, "-c", judge, "-o", out, words=["/z_est is a link to another"])
        mask = self.changed(self.chain.eval, external_link, "in_region")
        self.refuse(1, "dem-eval", self.chain.dem, "-o", out, "--set",
                    f'region={{"shape":"mask","path":"{mask}","layer":"in_region"}}', words=["/in_region is a link"])

    def test_no_table_follows_a_link(self):
        path, columns = self.path("table.h5"), ["t_s", "x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"]
        with h5py.File(path, "w") as file:
            for name in columns[:-1]:
                file[name] = np.ones(3)
            file["qz"] = h5py.ExternalLink(self.target, "/qz")
        config = self.config(with_values(SCAN, trajectory={"type": "table", "path": path}))
        self.refuse(1, "scan-sim", "--terrain", self.chain.terrain, "-c", config, "-o", self.path("out.h5"),
                    words=[path + ": /qz is a link to another file"])

    def test_recorded_names_are_not_opened(self):
        """The configuration, the inputs and the chain in each file refer to a pipe."""
        def poisoned(source, **keys):
            path = self.copy(source, os.path.basename(source))
            with h5py.File(path, "a") as file:
                texts = file["provenance"]
                for name in ("inputs_json", "chain_json"):
                    set_text(texts, name, json.dumps(with_paths(json.loads(texts[name].asstr()[()]), self.target)))
                set_text(texts, "config_json", json.dumps({**json.loads(texts["config_json"].asstr()[()]), **keys}))
            return path
        terrain = poisoned(self.chain.terrain, base=[{"type": "dem", "path": self.target}])
        scan = poisoned(self.chain.scan, trajectory={"type": "table", "path": self.target})
        dem = poisoned(self.chain.dem)
        judged = poisoned(self.chain.eval, region={"shape": "mask", "path": self.target, "layer": "in_region"})
        run = lambda name, *arguments: self.succeed(name, *arguments, "-c", self.chain.config(name), "-o", self.path("out.h5"), "-O")
        run("scan-sim", "--terrain", terrain)
        run("regrid", scan, "--terrain", self.chain.terrain)
        run("dem-eval", dem, "--report", self.path("report.html"))
        for path in (terrain, scan, dem, judged):
            self.succeed("landfall-info", path)
            self.succeed("landfall-export", path, "-o", self.path("out.csv"), "-O")

    def test_a_filter_loads_no_plug_in(self):
        """32001 is the filter of Blosc; the folder of plug-ins holds a pipe."""
        path, plugins = self.copy(self.chain.terrain, "blosc.h5"), self.path("plugins")
        os.mkdir(plugins)
        os.mkfifo(os.path.join(plugins, "libblosc.so"))
        with h5py.File(path, "a") as file:
            properties = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
            properties.set_chunk((4,))
            properties.set_filter(32001, h5py.h5z.FLAG_OPTIONAL, (2,))
            h5py.h5d.create(file.id, b"extra", h5py.h5t.IEEE_F64LE, h5py.h5s.create_simple((8,)), properties)
        self.refuse(1, "landfall-info", path, env={**os.environ, "HDF5_PLUGIN_PATH": plugins},
                    words=["/extra is stored by filter 32001", "does not load plug-ins"])

    def test_declared_sizes_cost_nothing(self):
        claims = {"a gigantic layer": ({"shape": (1 << 20, 1 << 20), "chunks": (256, 256)}, "declares more values"),
                  "a gigantic column": ({"shape": (1 << 40,), "chunks": (65536,)}, "declares more values"),
                  "a gigantic text": ({"shape": (), "dtype": f"S{GIB}"}, "declares more values"),
                  "a crowd of chunks": ({"shape": (1 << 20,), "chunks": (1,)}, "more than 2^16 chunks"),
                  "a gigantic chunk": ({"shape": (1 << 14, 1 << 14), "chunks": (1 << 14, 1 << 14)}, "chunks of 2048 MiB")}
        for name, (shape, words) in claims.items():
            path = self.copy(self.chain.dem, "claims.h5")
            with h5py.File(path, "a") as file:
                file.create_dataset(name, **{"dtype": "f8", **shape})
            self.refuse(1, "landfall-info", path, words=[f"/{name} ", words])

    def test_files_are_opened_only_by_code_that_checks_them(self):
        """Only the code that checks a file opens it: h5_reading.cpp for HDF5 and file_guard.cpp for rasters. memory_file.cpp opens the file that it
        has just written, to add to it; point_crs.cpp opens a TIFF of
        one pixel that it has made in memory, so that GDAL reads the CRS of a LAS file from it; polygon_file.cpp opens local files by a few drivers,
        none of which follows references."""
        callers = {}
        for top in ("lib", "tools"):
            for path in pathlib.Path(os.environ["LANDFALL_ROOT"], top).rglob("*.cpp"):
                for call in re.findall(r"\b(H5Fopen|H5Dread|GDALOpenEx|GDALOpen|GDALDataset::Open)\(", path.read_text()):
                    callers.setdefault(call, set()).add(path.name)
        self.assertEqual(callers, {"H5Fopen": {"h5_reading.cpp", "memory_file.cpp"}, "H5Dread": {"h5_reading.cpp"},
                                  "GDALDataset::Open": {"file_guard.cpp", "point_crs.cpp", "polygon_file.cpp"}})

    def test_a_chunk_of_too_few_bytes_is_damaged(self):
        """HDF5 1.10 would read the missing bytes from beyond the memory of the chunk."""
        def shorten(source, name, dataset, **form):
            path = self.copy(source, name)
            with h5py.File(path, "a") as file:
                values, attributes = file[dataset][()], dict(file[dataset].attrs)
                del file[dataset]
                made = file.create_dataset(dataset, data=values, chunks=values.shape, **form)
                made.attrs.update(attributes)
                made.id.write_direct_chunk((0,) * values.ndim, zlib.compress(b"12345678"))
            return path
        big_endian = {"dtype": ">f8", "compression": 1}
        terrain = shorten(self.chain.terrain, "terrain.h5", "z", **big_endian)
        scan = shorten(self.chain.scan, "scan.h5", "points/z_est", **big_endian)
        dem = shorten(self.chain.dem, "dem.h5", "z_est", **big_endian)
        out = ["-o", self.path("out.h5")]
        for name, *arguments in [("scan-sim", "--terrain", terrain, *out), ("regrid", scan, *out), ("dem-eval", dem, *out),
                                 ("landfall-info", terrain), ("landfall-info", scan), ("landfall-info", dem),
                                 ("landfall-export", dem, "-o", self.path("out.tif"))]:
            with self.subTest([name, *arguments]):
                self.refuse(1, name, *arguments, words=["is damaged"], output=out[1])

    def test_a_flipped_bit_in_a_value_is_noticed(self):
        """Without compression, 40 bits of each file: refused by the checksum of zlib, or without effect on any value, as a bit of the padding
        behind zeros at the end of a chunk."""
        def contents(path):
            found = {}
            with h5py.File(path) as file:
                file.visititems(lambda name, item: found.update({name: item[()].tobytes()}) if stored_chunks(item) else None)
            return found
        for name in TOOLS:
            path = self.path(name + ".h5")
            self.succeed(name, *self.chain.inputs(name), "--compression", "0", "-o", path)
            places, values = [], random.Random(name)
            with h5py.File(path) as file:
                file.visititems(lambda _, item: places.extend(stored_chunks(item)))
            known, refused = contents(path), 0
            for number in range(40):
                start, size = values.choice(places)
                at, bit = start + values.randrange(size), 1 << values.randrange(8)
                flip(path, at, bit)
                with self.subTest(name=name, number=number, at=at):
                    if run("landfall-info", path).returncode == 0:
                        self.assertEqual(contents(path), known)
                    else:
                        self.refuse(1, "landfall-info", path, words=["is corrupt"])
                        refused += 1
                flip(path, at, bit)
            self.assertGreater(refused, 25, name)

    def test_damaged_metadata_end_in_one_message(self):
        """One flipped bit, with and without the seal that shows it, through every tool that reads the kind."""
        runs = 5000 if os.environ.get("LANDFALL_TEST_LONG") else 120
        out = self.path("out")
        self.succeed("scan-sim", "--plan", "-c", self.chain.config("scan-sim"), "-o", self.path("plan.h5"))
        mesh = self.config("v 0 0 0\nv 9 0 0\nv 0 9 1\nf 1 2 3\n", "m.obj")
        self.succeed("terrain-gen", "--from", mesh, "-o", self.path("mesh.h5"))
        ranges = Chain(noise__dead_pixel_frac=0, noise__dropout_frac=0)
        self.addCleanup(ranges.remove)
        scan, regrid, judge = (["-c", self.chain.config(name), "-o", out, "-O"] for name in ("scan-sim", "regrid", "dem-eval"))
        readers = {self.chain.terrain: [["scan-sim", *scan, "--terrain"]],
                   self.path("mesh.h5"): [["scan-sim", *scan, "--terrain"]],
                   ranges.scan: [["regrid", *regrid], ["scan-sim", "--terrain", ranges.terrain, "-c", ranges.config("scan-sim"),
                                                       "-o", out, "-O", "--ranges-from"]],
                   self.chain.dem: [["dem-eval", *judge]], self.chain.eval: [], self.path("plan.h5"): []}
        contents = {source: read_bytes(source) for source in readers}
        places = {source: metadata_places(source) for source in readers}
        choose, damaged, largest_kb = random.Random(runs), self.path("damaged.h5"), 0
        for number in range(runs):
            source = list(readers)[number % len(readers)]
            is_sealed = choose.random() < 0.25
            content = bytearray(contents[source][:None if is_sealed else seal_begin(contents[source])])
            at, bit = choose.choice(places[source]), choose.randrange(8)
            content[at] ^= 1 << bit
            self.write(damaged, content)
            name, *arguments = choose.choice([*readers[source], ["landfall-info"], ["landfall-export", "-o", out + ".csv", "-O"]])
            with self.subTest(source=os.path.basename(source), name=name, at=at, bit=bit, is_sealed=is_sealed):
                code, message, peak_kb = measured(name, *arguments, damaged)
                self.assertIn(code, (1,) if is_sealed else (0, 1, 2), message)
                if code:
                    self.assertIn(f"\n{name}: ", "\n" + message)
                largest_kb = max(largest_kb, peak_kb)
        self.assertLess(largest_kb, 500_000)
        self.assertEqual([entry for entry in self.entries() if entry.endswith(".part")], [])

    def test_a_damaged_heap_is_refused(self):
        """Texts of variable length lie in heaps; HDF5 1.10 crashes on the index of an object that a heap does not hold."""
        path = self.copy(self.chain.terrain, "heap.h5")
        with h5py.File(path, "a") as file:
            for name in ("title", "source", "format_name", "file_id"):
                text = file.attrs[name].decode()
                del file.attrs[name]
                file.attrs[name] = text
        content, values = read_bytes(path), random.Random(1)
        first = content.index(b"GCOL")
        for at in range(first, first + 195, 3):
            damaged = bytearray(content)
            damaged[at] ^= 1 << values.randrange(8)
            self.write("damaged.h5", damaged)
            with self.subTest(at=at - first):
                code, message, _ = measured("landfall-info", self.path("damaged.h5"))
                self.assertIn(code, (0, 1), message)

    def test_the_size_of_a_chunk_costs_nothing(self):
        """The index of the chunks says 4 GB."""
        path = self.copy(self.chain.terrain, "size.h5")
        with h5py.File(path, "a") as file:
            file.attrs["remark"] = "without a seal"
            size = file["z"].id.get_chunk_info(0).size
        content = bytearray(read_bytes(path))
        at = content.index(b"TREE\x01\x00")
        while int.from_bytes(content[at + 24:at + 28], "little") != size:
            at = content.index(b"TREE\x01\x00", at + 1)
        content[at + 27] = 0xfa
        self.write(path, content)
        for name, *arguments in [("landfall-info", path), ("scan-sim", "-o", self.path("out.h5"), "--terrain", path)]:
            code, message, peak_kb = measured(name, *arguments)
            self.assertEqual((code, message), (1, f"{name}: {path}: /z cannot be read: it is damaged\n"))
            self.assertLess(peak_kb, 100_000)

    def test_the_shape_of_a_chunk_costs_nothing(self):
        """A chunk of 121 x 121 values says that it has 200 MB: more than deflate can hold in what is stored."""
        path = self.path("shape.h5")
        with h5py.File(self.chain.terrain) as file:
            rows, columns = file["z"].chunks
        content = bytearray(read_bytes(self.chain.terrain)[:seal_begin(read_bytes(self.chain.terrain))])
        at = content.index(struct.pack("<III", rows, columns, 8))
        content[at:at + 4] = struct.pack("<I", 200_000_000 // (8 * columns))
        self.write(path, content)
        code, message, peak_kb = measured("landfall-info", path)
        self.assertEqual((code, message), (1, f"landfall-info: {path}: /z cannot be read: it is damaged\n"))
        self.assertLess(peak_kb, 100_000)

    def test_a_file_that_another_program_changed_is_read(self):
        """It has no seal any more."""
        path = self.copy(self.chain.dem, "changed.h5")
        self.assertLess(seal_begin(read_bytes(path)), os.path.getsize(path))
        with h5py.File(path, "a") as file:
            file.attrs["remark"] = "mine"
        self.assertEqual(seal_begin(read_bytes(path)), os.path.getsize(path))
        self.succeed("landfall-info", path)

    def test_unusual_but_valid_files_are_read(self):
        """A hard link, a group that contains itself, and a layer of fill values only."""
        path = self.copy(self.chain.dem, "whole.h5")
        with h5py.File(path, "a") as file:
            file["again"] = file["z_est"]
            circle = file.create_group("circle")
            circle["circle"] = circle
            file.create_dataset("empty", file["z_est"].shape, "f8", chunks=(64, 64), fillvalue=np.nan)
        self.succeed("landfall-info", path)


if __name__ == "__main__":
    unittest.main()
