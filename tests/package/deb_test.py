#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The Debian packages: lintian accepts them, two runs of cpack give the same bytes, and they work in a minimal Debian 12."""
import glob
import hashlib
import os
import re
import shutil
import subprocess
import tempfile
import unittest
import urllib.error
import urllib.request

BUILD, ROOT = os.environ["LANDFALL_BUILD"], os.environ["LANDFALL_ROOT"]
MIRROR = os.environ.get("DEBIAN_MIRROR", "http://deb.debian.org/debian")


def is_release():
    with open(os.path.join(BUILD, "CMakeCache.txt"), encoding="utf-8") as file:
        return "CMAKE_BUILD_TYPE:STRING=Release\n" in file.read()


def mirror_answers():
    try:
        with urllib.request.urlopen(MIRROR + "/dists/bookworm/Release", timeout=20) as answer:
            return answer.status == 200
    except (OSError, urllib.error.URLError):
        return False


def fingerprints(folder):
    found = {}
    for path in glob.glob(os.path.join(folder, "*.deb")):
        with open(path, "rb") as file:
            found[os.path.basename(path)] = hashlib.sha256(file.read()).hexdigest()
    return found


@unittest.skipUnless(shutil.which("dpkg-shlibdeps") and shutil.which("cpack"), "dpkg-dev and cpack are not installed")
class Deb(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="landfall-packages-")
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.pack("first")

    @classmethod
    def pack(cls, name):
        path = os.path.join(cls.folder, name)
        result = subprocess.run(["cpack", "-G", "DEB", "--config", os.path.join(BUILD, "CPackConfig.cmake"), "-B", path],
                                env=os.environ | {"SOURCE_DATE_EPOCH": "1780000000"}, capture_output=True, text=True,
                                check=False)
        if result.returncode:
            raise AssertionError(result.stdout + result.stderr)
        shutil.rmtree(os.path.join(path, "_CPack_Packages"))
        return path

    def path(self, package):
        return glob.glob(os.path.join(self.folder, "first", package + "_*.deb"))[0]

    def contents(self, package):
        lines = subprocess.run(["dpkg-deb", "-c", self.path(package)], capture_output=True, text=True, check=True).stdout
        return {line.split(maxsplit=5)[5].split(" -> ")[0]: line.split(maxsplit=2)[:2] for line in lines.splitlines()}

    def test_two_runs_give_the_same_bytes(self):
        self.assertEqual(fingerprints(os.path.join(self.folder, "first")), fingerprints(self.pack("second")))

    def test_each_package_has_its_files(self):
        tools, module = self.contents("landfall"), self.contents("landfall-dev")
        for file in ["bin/terrain-gen", *(f"lib/landfall/{name}.so" for name in ("liblandfall", "landfall-gdal", "landfall-opencl")),
                     "share/landfall/schemas/scan.schema.json",
                     "share/landfall/python/commands/plot_dem.py", "share/landfall/Makefile.studies", "share/doc/landfall/README.md",
                     "share/doc/landfall/docs/user/lidar/README.md", "share/doc/landfall/docs/user/errors.md",
                     "share/doc/landfall/docs/reference/keys/scan-sim.md", "share/doc/landfall/changelog.gz"]:
            self.assertIn("./usr/" + file, tools)
        for file in ["include/landfall/lidar.h", "lib/liblandfall-lidar.a", "lib/cmake/landfall/landfallConfig.cmake"]:
            self.assertIn("./usr/" + file, module)
        self.assertFalse({name for name in set(tools) & set(module) if not name.endswith("/")})
        links = {"./usr/lib/python3/dist-packages/landfall",
                 *(f"./usr/share/landfall/python/commands/{name}" for name in os.listdir(os.path.join(ROOT, "python", "commands")))}
        for name, (mode, owner) in (tools | module).items():
            self.assertEqual(owner, "root/root", name)
            self.assertIn(mode, ["lrwxrwxrwx"] if name in links else ["drwxr-xr-x", "-rwxr-xr-x", "-rw-r--r--"], name)
        depends = subprocess.run(["dpkg-deb", "-f", self.path("landfall"), "Depends"], capture_output=True, text=True, check=True).stdout
        names = re.findall(r"(?:^|, )([\w.+-]+)(?= |,|$)", depends)
        self.assertEqual([names.count(name) for name in ("python3", "libc6", "libgdal32", "libtbb12")], [1] * 4, depends)

    def test_python_imports_the_package_and_finds_the_tools(self):
        unpacked = os.path.join(self.folder, "unpacked")
        subprocess.run(["dpkg", "-x", self.path("landfall"), unpacked], check=True)
        program = """import landfall
terrain = landfall.run("terrain-gen", {"grid": {"half_width_m": 1, "resolution_m": 0.5}}, output="t.h5")
print(landfall.__file__, terrain.z.shape, terrain.z.attrs["units"], terrain.crs.attrs["crs_wkt"][:6])"""
        result = subprocess.run(["/usr/bin/python3", "-c", program], capture_output=True, text=True, check=False, cwd=self.folder,
                                env={"PATH": "/usr/bin:/bin", "PYTHONPATH": os.path.join(unpacked, "usr/lib/python3/dist-packages")})
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stdout.split(maxsplit=1),
                         [f"{unpacked}/usr/lib/python3/dist-packages/landfall/__init__.py", "(5, 5) m ENGCRS\n"])

    def test_python_bytecode_is_made_and_removed(self):
        scripts = os.path.join(self.folder, "scripts")
        subprocess.run(["dpkg", "-e", self.path("landfall"), scripts], check=True)
        for name, words in (("postinst", "py3compile -p landfall /usr/share/landfall/python"), ("prerm", "py3clean -p landfall")):
            with open(os.path.join(scripts, name), encoding="utf-8") as file:
                self.assertIn(words, file.read())
            self.assertEqual(subprocess.run(["sh", "-n", os.path.join(scripts, name)], check=False).returncode, 0)

    @unittest.skipUnless(shutil.which("lintian"), "lintian is not installed")
    @unittest.skipUnless(is_release(), "only a release build has the flags of a package")
    def test_lintian_accepts_the_packages(self):
        result = subprocess.run(["lintian", "--allow-root", "--fail-on=error,warning", "--tag-display-limit=0",
                                 self.path("landfall"), self.path("landfall-dev")],
                                capture_output=True, text=True, check=False)
        self.assertEqual((result.returncode, result.stdout), (0, ""), result.stderr)

    @unittest.skipUnless(os.environ.get("LANDFALL_TEST_CHROOT"), "takes minutes: LANDFALL_TEST_CHROOT=1 runs it")
    @unittest.skipUnless(os.geteuid() == 0 and shutil.which("debootstrap"), "needs root and debootstrap")
    def test_packages_work_in_a_minimal_debian_and_in_containers(self):
        if not mirror_answers():
            self.skipTest(f"no Debian mirror at {MIRROR}")
        for script in ("test-deb", "test-container"):
            with self.subTest(script):
                result = subprocess.run([os.path.join(ROOT, "scripts", script), os.path.join(self.folder, "first")],
                                        capture_output=True, text=True, check=False)
                print(result.stdout)
                self.assertEqual(result.returncode, 0, result.stdout + result.stderr)

    def test_the_recipes_of_both_containers_install_the_same(self):
        """Up to the folder of the package."""
        def commands(name):
            with open(os.path.join(ROOT, "packaging", name), encoding="utf-8") as file:
                text = file.read().replace("\\\n", " ").replace("&&", "\n")
            found = re.findall(r"^[ \w=]*apt-get .*|^ *rm .*", text.replace("RUN ", "\n"), re.MULTILINE)
            return [" ".join(line.split()).replace("/opt/", "/tmp/") for line in found]

        self.assertEqual(len(commands("Containerfile")), 3)
        self.assertEqual(commands("Containerfile"), commands("landfall.def"))


if __name__ == "__main__":
    unittest.main()
