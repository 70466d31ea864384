#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tools, plugin, Python package, studies, schemas and module work from a prefix that is moved after cmake --install."""
import json
import os
import re
import shutil
import subprocess
import tempfile
import unittest

import h5py

BUILD, ROOT = os.environ["LANDFALL_BUILD"], os.environ["LANDFALL_ROOT"]


def execute(*command, **options):
    return subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=600, check=False, **options)


class Install(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="landfall-install-")
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        before, cls.prefix = os.path.join(cls.folder, "before"), os.path.join(cls.folder, "a prefix")
        result = execute("cmake", "--install", BUILD, "--prefix", before)
        if result.returncode:
            raise AssertionError(result.stdout + result.stderr)
        cls.compiled = [folder for folder, _, _ in os.walk(before) if folder.endswith("__pycache__")]
        os.rename(before, cls.prefix)
        cls.share = os.path.join(cls.prefix, "share", "landfall")

    def succeed(self, *command, **options):
        result = execute(*command, **options)
        self.assertEqual(result.returncode, 0, f"{command}\n{result.stdout}{result.stderr}")
        return result.stdout

    def tool(self, name):
        return os.path.join(self.prefix, "bin", name)

    def path(self, name):
        return os.path.join(self.folder, name)

    def test_the_chain_and_a_plot_of_its_dem(self):
        self.succeed(self.tool("terrain-gen"), "-o", self.path("t.h5"), "-O", "--set",
                     'grid={"half_width_m":8,"resolution_m":0.1}')
        self.succeed(self.tool("scan-sim"), "--terrain", self.path("t.h5"), "-o", self.path("s.h5"), "-O",
                     "--set", "laser.scan_time_s=0.05", "--set", "scanner.pattern.half_width_m=5")
        self.succeed(self.tool("regrid"), self.path("s.h5"), "--terrain", self.path("t.h5"), "-o",
                     self.path("d.h5"), "-O", "--set", "half_width_m=6")
        with h5py.File(self.path("d.h5")) as file:
            self.assertGreater((file["count"][()] > 0).mean(), 0.05)
        self.succeed(self.tool("landfall"), "plot", "dem", self.path("d.h5"), "-o", self.path("d.png"))
        self.assertGreater(os.path.getsize(self.path("d.png")), 1000)

    def copy_without_plugins(self, name, prefix):
        libraries = os.path.join(prefix, "lib", "landfall")
        for source, folder in ((self.tool(name), os.path.join(prefix, "bin")),
                               (os.path.join(self.prefix, "lib", "landfall", "liblandfall.so"), libraries)):
            os.makedirs(folder, exist_ok=True)
            shutil.copy(source, folder)

    def test_the_plugin_is_found(self):
        with open(self.path("dem.asc"), "w", encoding="ascii") as file:
            file.write("ncols 21\nnrows 21\nxllcorner 0\nyllcorner 0\ncellsize 1\n" + ("5 " * 21 + "\n") * 21)
        site = ["--from", self.path("dem.asc"), "--half-width", "5", "--resolution", "0.5", "--horizontal-scale", "1"]
        self.succeed(self.tool("terrain-gen"), *site, "-o", self.path("site.h5"))
        bare = self.path("bare")  # without the plugin, the message names the paths that were searched
        self.copy_without_plugins("terrain-gen", bare)
        result = execute(os.path.join(bare, "bin", "terrain-gen"), *site, "-o", self.path("none.h5"))
        if result.returncode:  # it succeeds if the same version is installed in the prefix of this build
            self.assertTrue(result.stderr.startswith(f"terrain-gen: {self.path('dem.asc')}: rasters need the plugin landfall-gdal.so, "),
                            result.stderr)
            self.assertIn(os.path.join(bare, "lib", "landfall", "landfall-gdal.so"), result.stderr)

    def test_the_plugin_of_opencl_is_found(self):
        """It loads, or the OpenCL library is missing, or has no device."""
        result = execute(self.tool("landfall-info"), "--devices", "--json")
        if result.returncode:
            self.assertRegex(result.stderr, r"\Alandfall-info: (OpenCL: there is no device|cannot load the OpenCL plugin: libOpenCL\.so\.1: )")
        else:
            self.assertIn("name", json.loads(result.stdout)["devices"][0])
        bare = self.path("bare_info")
        self.copy_without_plugins("landfall-info", bare)
        result = execute(os.path.join(bare, "bin", "landfall-info"), "--devices")
        if result.returncode:  # it succeeds if the same version is installed in the prefix of this build
            self.assertTrue(result.stderr.startswith("landfall-info: OpenCL devices need the plugin landfall-opencl.so, "), result.stderr)

    def test_scripts_find_schemas_and_studies(self):
        self.assertIn("range_sigma_m", self.succeed(self.tool("landfall"), "study", "list", "noise", cwd=self.folder))
        self.succeed("make", "-C", self.share, "-f", "Makefile.studies", "-n", "example-2",
                     "BIN=" + self.path("nowhere"), "RUNS=" + self.path("runs"))
        installed, own = (sorted(os.listdir(os.path.join(folder, "schemas", "dictionary"))) for folder in (self.share, ROOT))
        self.assertEqual(installed, own)
        for name in os.listdir(os.path.join(ROOT, "schemas")):
            if name == "dictionary":
                continue
            with open(os.path.join(self.share, "schemas", name), encoding="utf-8") as file:
                schema = json.load(file)
            self.assertIn("$id", schema)
            if name in ("chain.schema.json", "study.schema.json"):
                self.assertIn("noise", schema["definitions"]["scan"]["properties"], name)
        self.assertFalse(os.path.exists(os.path.join(self.share, "scripts")))
        self.assertEqual(self.compiled, [])

    def test_a_study_and_its_report(self):
        study = {"base": {"terrain": {"grid": {"half_width_m": 4, "resolution_m": 0.1}},
                          "scan": {"laser": {"scan_time_s": 0.02}, "scanner": {"pattern": {"rows": 20, "columns": 20, "half_width_m": 3}}},
                          "regrid": {"half_width_m": 2, "resolution_m": 0.1}, "eval": {"region_radius_m": 1.5}},
                 "axes": [{"key": "scan.noise.range_sigma_m", "values": [0.01, 0.02]}]}
        with open(self.path("tiny.json"), "w", encoding="utf-8") as file:
            json.dump(study, file)
        self.succeed("make", "-C", os.path.relpath(self.share, self.folder), "-f", "Makefile.studies", "study",
                     "STUDY=" + self.path("tiny.json"), "BIN=../../bin", "RUNS=" + self.path("runs"), cwd=self.folder)
        self.assertTrue(os.path.exists(self.path("runs/studies/tiny/report.html")))

    def test_python_imports_the_package(self):
        program = "import landfall; print(landfall.run('landfall-info'))"
        environment = os.environ | {"PYTHONPATH": os.path.join(self.prefix, "lib", "python3", "dist-packages"), "PATH": "/usr/bin:/bin"}
        result = execute("/usr/bin/python3", "-c", program, env=environment)
        self.assertIn("landfall.errors.ToolError: landfall-info: ", result.stderr)

    def test_links_of_the_pages_are_valid(self):
        doc = os.path.join(self.prefix, "share", "doc", "landfall")
        broken = []
        for folder, _, files in os.walk(doc):
            for name in filter(lambda name: name.endswith(".md"), files):
                with open(os.path.join(folder, name), encoding="utf-8") as file:
                    text = re.sub(r"`[^`\n]*`", "", file.read())  # code may look like a link
                links = re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", text)
                broken += [(name, link) for link in links if not self.is_valid(doc, folder, link)]
        self.assertEqual(broken, [])

    def is_valid(self, doc, folder, link):
        """Pages and images must be installed; other files are elsewhere in the prefix, or only in the repository."""
        target = os.path.normpath(os.path.join(folder, link))
        relative = os.path.relpath(target, doc)
        return os.path.exists(target) or not relative.startswith("docs") and os.path.exists(os.path.join(ROOT, relative))

    def test_find_package_checks_the_version(self):
        source = self.path("host")
        os.makedirs(source, exist_ok=True)
        with open(os.path.join(source, "CMakeLists.txt"), "w", encoding="utf-8") as file:
            file.write("cmake_minimum_required(VERSION 3.25)\nproject(host CXX)\n"
                       "find_package(landfall ${WANTED} REQUIRED)\nget_target_property(x landfall::lidar TYPE)\n")
        configure = ["cmake", "-S", source, "-DCMAKE_PREFIX_PATH=" + self.prefix,
                     "-DCMAKE_CXX_COMPILER=" + os.environ["LANDFALL_CXX"]]
        self.succeed(*configure, "-B", self.path("b1"), "-DWANTED=0.3")
        for wanted in ["0.2", "0.4", "1.0"]:
            result = execute(*configure, "-B", self.path("b" + wanted), "-DWANTED=" + wanted)
            self.assertNotEqual(result.returncode, 0, wanted)
            self.assertIn(f'compatible with requested version "{wanted}"', " ".join(result.stderr.split()))


if __name__ == "__main__":
    unittest.main()
