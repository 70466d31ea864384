# SPDX-License-Identifier: GPL-3.0-or-later
"""True surfaces, a triangulated grid or a mesh: first hits of rays, elevations, normals."""
import h5py
import numpy as np

from oracle.frames import dot, normalised

# Surfaces have no gaps: a hit counts up to this distance, in metres along the ray, outside its piece.
CLOSED_M = 1e-9


def of_file(path):
    with h5py.File(path) as file:
        if "mesh" in file:
            return Mesh(file["mesh/vertices"][()], file["mesh/triangles"][()].astype(int))
        return Grid(file["x"][()], file["y"][()], file["z"][()])


def paint(path, minimum, greatest, seed):
    """Adds a random layer /albedo to a terrain file."""
    with h5py.File(path, "r+") as file:
        shape = file["z"].shape
        values = np.random.default_rng(seed).uniform(minimum, greatest, shape).astype(np.float32)
        file["albedo"] = np.where(np.isnan(file["z"][()]), np.float32(np.nan), values)
        file["albedo"].attrs.update(dict(file["z"].attrs))


def albedo(path):
    """The layer /albedo at the nearest node of points, as a function; None if the file has none."""
    with h5py.File(path) as file:
        if "albedo" not in file:
            return None
        x, y, values = file["x"][()], file["y"][()], file["albedo"][()].astype(float)

    def at(px, py):
        nearest = lambda axis, p: np.clip(np.rint((np.nan_to_num(p) - axis[0]) / (axis[1] - axis[0])).astype(int), 0, len(axis) - 1)
        return np.where(np.isnan(px), np.nan, values[nearest(y, py), nearest(x, px)])
    return at


class Grid:
    """A grid whose cells are split from (column + 1, row) to (column, row + 1); triangles with a NaN node are holes (D6)."""

    def __init__(self, x, y, z):
        self.x, self.y, self.z = x, y, z
        self.step = (x[-1] - x[0]) / (len(x) - 1)

    def cells(self, x, y):
        return (x - self.x[0]) / self.step, (y - self.y[0]) / self.step

    def planes(self, u, v):
        """Elevations and slopes dz/dx and dz/dy of the triangles at points in units of cells; NaN off the surface."""
        rows, columns = self.z.shape
        inside = (u >= 0) & (v >= 0) & (u <= columns - 1) & (v <= rows - 1)
        i = np.clip(np.floor(np.where(inside, u, 0)).astype(int), 0, columns - 2)
        j = np.clip(np.floor(np.where(inside, v, 0)).astype(int), 0, rows - 2)
        p, q = u - i, v - j
        z00, z10, z01, z11 = (self.z[j + dj, i + di] for dj, di in ((0, 0), (0, 1), (1, 0), (1, 1)))
        lower = p + q <= 1
        # On the diagonal between a hole and a triangle, a point belongs to the triangle.
        lower = lower & ~((p + q == 1) & np.isnan(z00))
        gx, gy = np.where(lower, z10 - z00, z11 - z01), np.where(lower, z01 - z00, z11 - z10)
        z = np.where(lower, z00 + p * gx + q * gy, z11 - (1 - p) * gx - (1 - q) * gy)
        return np.where(inside, z, np.nan), gx / self.step, gy / self.step

    def elevation(self, x, y):
        return self.planes(*self.cells(x, y))[0]

    def normals_at(self, points):
        """Normals (NaN over holes), and whether they are ambiguous; those of a grid never are."""
        _, gx, gy = self.planes(*self.cells(points[:, 0], points[:, 1]))
        return normalised(np.stack([-gx, -gy, np.ones_like(gx)], -1)), np.zeros(len(points), bool)

    def band(self, origins, directions):
        """The section of each ray over the grid and between its lowest and highest elevation."""
        low, high = np.zeros(len(origins)), np.full(len(origins), np.inf)
        bounds = [(self.x[0], self.x[-1]), (self.y[0], self.y[-1]), (np.nanmin(self.z), np.nanmax(self.z))]
        for axis, (minimum, greatest) in enumerate(bounds):
            margin = 1e-6 if axis == 2 else 0
            d, o = directions[:, axis], origins[:, axis]
            with np.errstate(divide="ignore", invalid="ignore"):
                a, b = (minimum - margin - o) / d, (greatest + margin - o) / d
            flat = d == 0
            out = flat & ((o < minimum - margin) | (o > greatest + margin))
            low = np.where(flat, low, np.maximum(low, np.minimum(a, b)))
            high = np.where(out, -1, np.where(flat, high, np.minimum(high, np.maximum(a, b))))
        return low, high

    def first_hits(self, origins, directions):
        """Ranges (NaN for misses) and normals; between a ray's crossings of grid lines and diagonals the surface is linear."""
        ranges, normals = np.full(len(origins), np.nan), np.full(origins.shape, np.nan)
        low, high = self.band(origins, directions)
        # Sorted, so that the rays of one batch cross about equally many lines.
        active = np.flatnonzero(low <= high)
        length = (high - low)[active] * np.max(abs(directions[active, :2]), axis=1, initial=0)
        active = active[np.argsort(length)]
        for rays in np.array_split(active, max(1, len(active) // 2000)):
            if len(rays):
                found = self.hits_of(origins[rays], directions[rays], low[rays], high[rays])
                ranges[rays], normals[rays] = found
        return ranges, normals

    def crossings(self, u, v, du, dv, low, high):
        """The sorted ray parameters at which u, v or u + v is an integer; NaN last."""
        found = [low[:, None], high[:, None]]
        for start, rate in ((u, du), (v, dv), (u + v, du + dv)):
            a, b = start + rate * low, start + rate * high
            first, last = np.ceil(np.minimum(a, b)), np.floor(np.maximum(a, b))
            whole = first[:, None] + np.arange(max(0, int(np.max(last - first)) + 1))
            with np.errstate(divide="ignore", invalid="ignore"):
                t = (whole - start[:, None]) / rate[:, None]
            found.append(np.where((whole <= last[:, None]) & (rate != 0)[:, None], t, np.nan))
        t = np.clip(np.concatenate(found, axis=1), low[:, None], high[:, None])
        return np.sort(t, axis=1)

    def hits_of(self, origins, directions, low, high):
        u, v = self.cells(origins[:, 0], origins[:, 1])
        du, dv = directions[:, 0] / self.step, directions[:, 1] / self.step
        t = self.crossings(u, v, du, dv, low, high)
        middle = (t[:, 1:] + t[:, :-1]) / 2
        z, gx, gy = self.planes(u[:, None] + du[:, None] * middle, v[:, None] + dv[:, None] * middle)
        # Height of the ray above the plane of the piece: its value in the middle of the piece, and its rate.
        height = origins[:, 2:] + directions[:, 2:] * middle - z
        rate = directions[:, 2:] - gx * directions[:, :1] - gy * directions[:, 1:2]
        with np.errstate(divide="ignore", invalid="ignore"):
            root = middle - height / rate
            meets = (root >= t[:, :-1] - CLOSED_M) & (root <= t[:, 1:] + CLOSED_M)
        piece = np.argmax(meets, axis=1)
        rows = np.arange(len(piece))
        hit = meets[rows, piece]
        normals = normalised(np.stack([-gx[rows, piece], -gy[rows, piece], np.ones(len(piece))], -1))
        return np.where(hit, root[rows, piece], np.nan), np.where(hit[:, None], normals, np.nan)


class Mesh:
    """A mesh of closed, two-sided triangles (D100), searched by brute force."""

    def __init__(self, vertices, triangles):
        self.vertices, self.triangles = vertices, triangles
        self.a, self.b, self.c = (vertices[triangles[:, n]] for n in range(3))
        self.normal = normalised(np.cross(self.b - self.a, self.c - self.a))

    def first_hits(self, origins, directions):
        """Moller and Trumbore (1997)."""
        ranges, normals = np.full(len(origins), np.nan), np.full(origins.shape, np.nan)
        e1, e2 = self.b - self.a, self.c - self.a
        for rays in np.array_split(np.arange(len(origins)), max(1, len(origins) * len(e1) // 1000000)):
            o, d = origins[rays][:, None], directions[rays][:, None]
            p = np.cross(d, e2)
            determinant = dot(e1, p)
            with np.errstate(divide="ignore", invalid="ignore"):
                s = o - self.a
                u = dot(s, p) / determinant
                q = np.cross(s, e1)
                v = dot(d, q) / determinant
                t = dot(e2, q) / determinant
                hit = (u >= -1e-12) & (v >= -1e-12) & (u + v <= 1 + 1e-12) & (t >= 0)
            t = np.where(hit, t, np.inf)
            best = np.argmin(t, axis=1)
            found = t[np.arange(len(rays)), best]
            ranges[rays] = np.where(np.isfinite(found), found, np.nan)
            normals[rays] = self.normal[best]
        return ranges, normals

    def elevation(self, x, y):
        """The highest elevation of the surface at each point."""
        result = np.full(np.shape(x), np.nan)
        for a, b, c in zip(self.a, self.b, self.c):
            area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
            if area == 0:
                continue
            u = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / area
            v = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area
            inside = (u >= -1e-12) & (v >= -1e-12) & (u + v <= 1 + 1e-12)
            result = np.fmax(result, np.where(inside, a[2] + u * (b[2] - a[2]) + v * (c[2] - a[2]), np.nan))
        return result

    def distances(self, points):
        """The distance of each point to each triangle: to its face if the projected point lies inside, else to its edges."""
        result = np.full((len(points), len(self.a)), np.inf)
        for start, end in ((self.a, self.b), (self.b, self.c), (self.c, self.a)):
            along = end - start
            t = np.clip(dot(points[:, None] - start, along) / dot(along, along), 0, 1)
            result = np.minimum(result, np.linalg.norm(points[:, None] - start - t[..., None] * along, axis=-1))
        height = dot(points[:, None] - self.a, self.normal)
        inside = np.ones(height.shape, bool)
        for start, end in ((self.a, self.b), (self.b, self.c), (self.c, self.a)):
            inside &= dot(np.cross(end - start, points[:, None] - start), self.normal) >= 0
        return np.where(inside, abs(height), result)

    def normals_at(self, points):
        """The normals of the nearest triangles, and whether a triangle of another orientation is equally near."""
        result, ambiguous = np.empty(points.shape), np.empty(len(points), bool)
        for rows in np.array_split(np.arange(len(points)), max(1, len(points) * len(self.a) // 1000000)):
            distances = self.distances(points[rows])
            nearest = np.argmin(distances, axis=1)
            near = distances <= distances[np.arange(len(rows)), nearest][:, None] + CLOSED_M
            elsewhere = abs(self.normal[nearest] @ self.normal.T) < 1 - 1e-9
            result[rows], ambiguous[rows] = self.normal[nearest], np.any(near & elsewhere, axis=1)
        return result, ambiguous
