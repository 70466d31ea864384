# SPDX-License-Identifier: GPL-3.0-or-later
"""Mesh terrains through the four tools: against numpy over all facets, and the same bytes at any number of threads."""
import json
import os
import unittest

import h5py
import numpy as np

from harness import EVAL, REGRID, SCAN, ToolTest, attributes, read_bytes, with_values
from oracle import surface
from raster_readers import obj_facets

DATA = os.environ.get("LANDFALL_DATA", os.path.join(os.environ["LANDFALL_ROOT"], "..", "shared", "data"))
BOULDER = os.path.join(os.environ["LANDFALL_ROOT"], "testdata", "meshes", "boulder.obj")
ITOKAWA = os.path.join(DATA, "mesh", "itokawa_49152f.obj")

# Twice the size, rotated by 90 degrees about the vertical, and shifted; placed() does the same in numpy.
PLACEMENT = {"scale_m": 2, "rotate_rpy_deg": [0, 0, 90], "translate_m": [0.5, -0.25, 0.125]}


def placed(points):
    return 2 * np.stack([-points[:, 1], points[:, 0], points[:, 2]], axis=1) + [0.5, -0.25, 0.125]


def rolling_terrain_with_a_roof():
    """An irregular sheet of 41 x 41 vertices, and a slab that overhangs it."""
    random = np.random.default_rng(5)
    x, y = np.meshgrid(np.linspace(-4, 4, 41), np.linspace(-4, 4, 41))
    x[:, 1:-1] += random.uniform(-0.06, 0.06, (41, 39))
    y[1:-1] += random.uniform(-0.06, 0.06, (39, 41))
    z = 0.2 * np.sin(2 * x) * np.cos(1.5 * y) + random.uniform(-0.01, 0.01, x.shape)
    vertices = [np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)]
    faces = []
    for row in range(40):
        for col in range(40):
            a = 41 * row + col
            faces += [[a, a + 1, a + 41], [a + 1, a + 42, a + 41]]
    corners = np.array([[i & 1, i >> 1 & 1, i >> 2] for i in range(8)]) * [1.2, 0.9, 0.2] + [0.3, -0.6, 0.7]
    vertices.append(corners)
    for quad in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]:
        faces.append([1681 + i for i in quad])
    return np.concatenate(vertices), faces


def off_text(vertices, faces):
    lines = ["OFF", f"{len(vertices)} {len(faces)} 0"]
    lines += [" ".join(repr(float(c)) for c in v) for v in vertices]
    lines += [" ".join(map(str, [len(f), *f])) for f in faces]
    return "\n".join(lines) + "\n"


def fans(faces):
    return np.array([[f[0], f[i], f[i + 1]] for f in faces for i in range(1, len(f) - 1)])


def ranges_from(origin, directions, corners):
    """Ranges of rays from one origin to their first hits on triangles (F, 3, 3); NaN for misses."""
    a, b, c = (corners[:, i] - origin for i in range(3))
    normals = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)])
    volume = np.einsum("ij,ij->i", a, np.cross(b, c))
    ranges = np.empty(len(directions))
    for begin in range(0, len(directions), 100):
        u, v, w = (directions[begin:begin + 100] @ n.T for n in normals)
        inside = ((u >= 0) & (v >= 0) & (w >= 0)) | ((u <= 0) & (v <= 0) & (w <= 0))
        with np.errstate(all="ignore"):
            t = np.where(inside, volume / (u + v + w), np.inf)
        ranges[begin:begin + 100] = np.where(t >= 0, t, np.inf).min(axis=1)
    ranges[np.isinf(ranges)] = np.nan
    return ranges


def flash(rows, pitch, position, **values):
    return {"detector": {"rows": rows, "columns": rows, "ifov_rad": pitch},
            "laser": {"pulse_rate_hz": 1, "scan_time_s": 1}, "scanner": {"type": "flash"},
            "trajectory": {"type": "constant_velocity", "position_m": position, "velocity_mps": [0, 0, 0]}, **values}


def flash_directions(rows, pitch):
    """Directions of the pixels in order, the top row towards +y, for the nominal mount without roll."""
    u = (np.arange(rows) - (rows - 1) / 2) * pitch
    d = np.array([[ub, va, -1] for va in u[::-1] for ub in u])
    return d / np.linalg.norm(d, axis=1)[:, None]


def facets_of(path):
    """The facets, (facet, corner, xyz), of an OBJ or of a binary PLY as terrain-gen writes it."""
    if path.endswith(".obj"):
        return obj_facets(path)
    data = read_bytes(path)
    head, body = data.split(b"end_header\n", 1)
    words = [line.split() for line in head.decode("ascii").splitlines()]
    assert words[:2] == [["ply"], ["format", "binary_little_endian", "1.0"]], words
    count = {line[1]: int(line[2]) for line in words if line[0] == "element"}
    points = np.frombuffer(body, "<f8", 3 * count["vertex"]).reshape(-1, 3)
    facets = np.frombuffer(body[points.nbytes:], [("n", "u1"), ("corners", "<i4", 3)])
    assert len(facets) == count["face"] and (facets["n"] == 3).all()
    return points[facets["corners"]]


def grid_facets(x, y, z):
    """The triangles of a terrain's grid: each cell is split along the diagonal from lower right to upper left."""
    points = np.stack([*np.meshgrid(x, y), z], axis=2)
    low, right, up, far = points[:-1, :-1], points[:-1, 1:], points[1:, :-1], points[1:, 1:]
    cells = np.stack([np.stack([low, right, up], axis=2), np.stack([right, far, up], axis=2)], axis=2)
    facets = cells.reshape(-1, 3, 3)
    return facets[~np.isnan(facets).any(axis=(1, 2))]


class MeshTest(ToolTest):
    def terrain(self, vertices, faces, **placement):
        mesh = self.write("mesh.off", off_text(vertices, faces))
        config = self.config({"mesh": {"path": mesh, **placement}}, "terrain.json")
        summary = self.succeed("terrain-gen", "-c", config, "-o", self.path("terrain.h5"), "--json")
        return self.path("terrain.h5"), json.loads(summary.stdout)

    def scan(self, terrain, config, output, *arguments):
        path = self.config(config, "scan.json")
        self.succeed("scan-sim", "-c", path, "--terrain", terrain, "-o", self.path(output), *arguments)
        return h5py.File(self.path(output), "r")

    def test_chain(self):
        vertices, faces = rolling_terrain_with_a_roof()
        terrain, summary = self.terrain(vertices, faces, **PLACEMENT)
        ground = surface.Mesh(placed(vertices), fans(faces))
        self.assertEqual([summary[k] for k in ["vertex_count", "triangle_count", "welded_vertex_count"]],
                         [1689, 3212, 0])
        with h5py.File(terrain) as file:
            np.testing.assert_allclose(file["mesh/vertices"][:], placed(vertices), atol=1e-15)
            np.testing.assert_array_equal(file["mesh/triangles"][:], fans(faces))
            self.assertEqual(file["mesh/triangles"].dtype, np.int32)
            self.assertEqual(attributes(file["mesh/vertices"])["units"], "m")
            self.assertIn("DEM frame", attributes(file["mesh/vertices"])["long_name"])
        quiet = with_values(SCAN, noise={}, navigation_error={})
        for name, config in [("scan", quiet), ("noisy", SCAN)]:
            self.scan(terrain, config, name + ".h5", "--keep-misses").close()
        for name in ["scan", "noisy"]:
            self.succeed("regrid", self.path(name + ".h5"), "-c", self.config(REGRID, "regrid.json"), "--terrain", terrain,
                         "-o", self.path(name + "_dem.h5"))
            self.succeed("dem-eval", self.path(name + "_dem.h5"), "-c", self.config(EVAL, "eval.json"), "-o",
                         self.path(name + "_eval.h5"))
        with h5py.File(self.path("scan.h5")) as scan, h5py.File(self.path("scan_dem.h5")) as dem:
            hit = scan["points/status"][:] == 0
            x, y, z = (scan["points/" + k][:][hit][::40] for k in ["x_true", "y_true", "z_true"])
            self.assertGreater(len(x), 400)
            # Seen from above, most first hits are on the highest surface, and none is above it.
            H = ground.elevation(x, y)
            self.assertLess(np.max(z - H), 1e-9)
            self.assertGreater(np.mean(np.abs(z - H) < 1e-9), 0.9)
            rows, cols = np.nonzero(dem["count"][:])
            rows, cols = rows[::20], cols[::20]
            X = dem["x"][:][cols] + dem["x_true"][:][rows, cols] - dem["x_est_mean"][:][rows, cols]
            Y = dem["y"][:][rows] + dem["y_true"][:][rows, cols] - dem["y_est_mean"][:][rows, cols]
            z_true = dem["z_true"][:][rows, cols]
            H = ground.elevation(X, Y)
            near = np.abs(z_true - H) < 1e-5  # x_est_mean is float32, and the slab's walls are steps
            self.assertGreater(np.mean(near), 0.98)
        with h5py.File(self.path("scan_eval.h5")) as evaluation:
            self.assertLess(np.nanmedian(np.abs(evaluation["e_z"][:])), 0.05)

    def test_lidar_in_a_closed_mesh_sees_it_from_inside(self):
        cube = np.array([[i & 1, i >> 1 & 1, i >> 2] for i in range(8)]) * 2.0 - 1
        quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
        terrain, _ = self.terrain(cube, quads)
        with self.scan(terrain, flash(16, 0.02, [0, 0, 0.5]), "inside.h5") as scan:
            np.testing.assert_allclose(scan["points/z_true"][:], -1, atol=1e-12)
            self.assertEqual(len(scan["points/z_true"]), 256)

    def test_keys_of_a_grid_are_refused(self):
        out = self.path("out.h5")
        for key, value in [("grid", {}), ("base", {"type": "plane"}), ("features", []), ("patterns", [])]:
            both = self.config({"mesh": {"path": self.path("mesh.off")}, key: value}, "both.json")
            self.refuse(2, "terrain-gen", "-c", both, "-o", out, words=["both.json", "/" + key, "/mesh"], output=out)

    def test_resolved_configuration_can_be_given_again(self):
        config = self.config({"mesh": {"path": "m.obj"}, "seed": 3})
        first = self.succeed("terrain-gen", "-c", config, "--print-config").stdout
        self.assertEqual(json.loads(first), {"mesh": {"path": "m.obj", "scale_m": 1, "translate_m": [0, 0, 0],
                                                      "rotate_rpy_deg": [0, 0, 0]}})
        again = self.succeed("terrain-gen", "-c", self.config(first, "again.json"), "--print-config").stdout
        self.assertEqual(first, again)

    def test_a_mesh_that_stands_on_edge(self):
        vertices, faces = rolling_terrain_with_a_roof()
        plain, turned, said = self.path("plain.off"), self.path("turned.off"), self.path("said.off")
        for path, points, head in ((plain, vertices, ""), (turned, vertices[:, [0, 2, 1]] * [1, 1, -1], ""), (said, vertices, "# Blender v2.93\n")):
            self.write(path, head + off_text(points, faces))
        h5 = self.path("t.h5")

        def terrain(*arguments):
            stderr = self.succeed("terrain-gen", *arguments, "-o", h5, "-O").stderr
            with h5py.File(h5) as file:
                return stderr, file["mesh/vertices"][()]

        stderr, expected = terrain("--from", plain)
        self.assertEqual(stderr, "")
        stderr, _ = terrain("--from", turned)
        self.assertIn("turned.off: it stands on edge like a wall, far longer in x and z than in y: if its y is up, --up y turns it", stderr)
        for arguments in (("--from", turned, "--up", "y"), ("-c", self.config({"mesh": {"path": turned, "up": "y"}}, "up.json")), ("-c", self.config({"mesh": {"path": turned}}), "--up", "y")):
            stderr, vertices = terrain(*arguments)
            self.assertEqual(stderr, "")
            np.testing.assert_array_equal(vertices, expected)
        self.assertIn("its comment '# Blender v2.93' says that y is up", terrain("--from", said)[0])
        self.assertEqual(terrain("--from", said, "--up", "z")[0], "")
        for arguments, expected in ((("--set", "seed=2"), "--up y: is for a mesh; "), (("--from", h5), "is exported as it is")):
            self.refuse(2, "terrain-gen", *arguments, "--up", "y", "-o", self.path("x.ply"), words=[expected], output=self.path("x.ply"))

    def test_import_and_export_by_options(self):
        vertices, faces = rolling_terrain_with_a_roof()
        source = self.write("m.off", off_text(vertices, faces))
        placement = ["--set", "mesh.scale_m=2", "--set", "mesh.rotate_rpy_deg=[0,0,90]", "--set",
                    "mesh.translate_m=[0.5,-0.25,0.125]"]
        short, (long, _) = self.path("short.h5"), self.terrain(vertices, faces, **PLACEMENT)
        self.succeed("terrain-gen", "--from", source, "-o", short, *placement)
        with h5py.File(short) as a, h5py.File(long) as b:
            for key in ("vertices", "triangles"):
                np.testing.assert_array_equal(a["mesh"][key][()], b["mesh"][key][()])
            expected = a["mesh/vertices"][()][a["mesh/triangles"][()]]
        for name in ("m.obj", "m.ply"):
            self.succeed("terrain-gen", "--from", short, "-o", self.path(name))
            np.testing.assert_array_equal(facets_of(self.path(name)), expected)
            self.succeed("terrain-gen", "--from", source, "-o", self.path("direct_" + name), *placement)
            self.assertEqual(read_bytes(self.path("direct_" + name)), read_bytes(self.path(name)))
            again = self.path(name + ".h5")
            self.succeed("terrain-gen", "--from", self.path(name), "-o", again)
            with h5py.File(again) as file:
                np.testing.assert_array_equal(file["mesh/vertices"][()][file["mesh/triangles"][()]], expected)
        self.refuse(2, "terrain-gen", "--from", short, "-o", self.path("m.tif"), words=["cannot be written as GeoTIFF", ".obj"])
        self.refuse(2, "terrain-gen", "--from", source, "-o", self.path("x.h5"), "--half-width", "3",
                    words=["mesh.scale_m"])

    def test_a_grid_exported_as_a_mesh_keeps_its_triangles(self):
        terrain = self.path("g.h5")
        config = self.config({"grid": {"half_width_m": 4, "resolution_m": 0.25}, "base": {"type": "fractal"},
                              "features": [{"type": "cone", "radius_m": 2, "height_m": 3}]})
        self.succeed("terrain-gen", "-c", config, "-o", terrain)
        with h5py.File(terrain) as file:
            expected = grid_facets(file["x"][()], file["y"][()], file["z"][()])
        for name in ("g.obj", "g.ply"):
            self.succeed("terrain-gen", "-c", config, "-o", self.path(name))
            np.testing.assert_array_equal(facets_of(self.path(name)), expected)
        with h5py.File(terrain, "a") as file:
            z = file["z"][()]
            z[3, 4] = z[20:23, 9] = np.nan
            file["z"][...] = z
            expected = grid_facets(file["x"][()], file["y"][()], z)
        self.succeed("terrain-gen", "--from", terrain, "-o", self.path("holes.ply"))
        np.testing.assert_array_equal(facets_of(self.path("holes.ply")), expected)

    def check_body(self, path, scale, height, pitch, rows):
        """Checks the counts of a body's OBJ, and a flash scan from `height` above it against numpy over all facets."""
        config = self.config({"mesh": {"path": path, "scale_m": scale}}, "terrain.json")
        terrain = self.path("body.h5")
        summary = json.loads(self.succeed("terrain-gen", "-c", config, "-o", terrain, "--json").stdout)
        corners = scale * obj_facets(path)
        with open(path, encoding="utf-8") as file:
            vertex_count = sum(line.startswith("v ") for line in file)
        self.assertEqual(summary["vertex_count"], len(np.unique(corners.reshape(-1, 3), axis=0)))
        self.assertEqual(summary["vertex_count"] + summary["welded_vertex_count"] + summary["unreferenced_vertex_count"],
                         vertex_count)
        self.assertEqual(summary["triangle_count"] + summary["degenerate_facet_count"], len(corners))
        self.assertEqual(len(corners), {BOULDER: 320, ITOKAWA: 49152}[path])
        position = list(corners.mean(axis=(0, 1)) + [0, 0, height])
        with self.scan(terrain, flash(rows, pitch, position), "scan.h5", "--keep-misses") as scan:
            ranges = scan["points/range_true"][:]
            order = scan["points/pixel"][:]
        np.testing.assert_array_equal(order, np.arange(rows**2))
        expected = ranges_from(np.array(position), flash_directions(rows, pitch), corners)
        self.assertGreater(np.isfinite(expected).sum(), rows**2 / 5)
        self.assertGreater(np.isnan(expected).sum(), rows**2 / 5)
        np.testing.assert_array_equal(np.isnan(ranges), np.isnan(expected))
        self.assertLess(np.nanmax(np.abs(ranges - expected)), 1e-6)

    def test_boulder(self):
        self.check_body(BOULDER, 1, 100, 0.0058, 60)

    @unittest.skipUnless(os.path.exists(ITOKAWA), f"no real mesh: {ITOKAWA} (LANDFALL_DATA)")
    def test_itokawa(self):
        self.check_body(ITOKAWA, 1000, 1000, 0.022, 30)


if __name__ == "__main__":
    unittest.main()
