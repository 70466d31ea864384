# SPDX-License-Identifier: GPL-3.0-or-later
"""Random configurations of terrains, with their rasters and meshes."""
import os

import numpy as np

from oracle.drawing import Drawing


class Sites(Drawing):
    def terrain(self, kind):
        if kind == "mesh":
            return {"mesh": {"path": self.mesh(), "scale_m": 0.5, "translate_m": self.between(-0.2, 0.2, 3),
                             "rotate_rpy_deg": self.between(-3, 3, 3)}}
        config = {"grid": {"half_width_m": 7, "resolution_m": 0.2}, "base": self.plane(), "seed": self.whole(1, 1000)}
        if kind == "fractal":
            config["base"] = [self.plane(), {"type": "fractal", "rms_deviation_m": 0.15, "reference_length_m": 1}]
        elif kind.startswith("raster"):
            config["base"] = [self.plane(), self.raster(kind.split()[1])]
            config["features"] = self.features(["crater"])
        elif kind == "population":
            config["patterns"] = [{"type": "golombek_rocks", "k": 0.1, "min_diameter_m": 0.4}]
        elif kind == "ring":
            feature = {key: value for key, value in self.feature(self.one_of(["cone", "rock", "pit", "hemisphere"])).items()
                       if key not in ("x_m", "y_m")}
            config["patterns"] = [{"type": "ring", "count": self.whole(3, 7), "radius_m": self.between(1.5, 3),
                                   "first_azimuth_deg": self.between(0, 90), "feature": feature}]
        else:
            standing = ["cone", "hemisphere", "pyramid", "rock", "ice_block"]
            added, draped = ["crater", "pit", "fracture"], ["ridge", "penitente_field"]
            config["features"] = self.features({"plane": [], "standing": standing, "added": added, "draped": draped,
                                                "all": standing + added + draped}[kind])
        return config

    def plane(self):
        return {"type": "plane", "elevation_m": self.between(-0.3, 0.3), "slope_x": self.between(-0.15, 0.15),
                "slope_y": self.between(-0.15, 0.15)}

    def features(self, kinds):
        return [self.feature(kind) for kind in kinds]

    def feature(self, kind):
        b = self.between
        keys = {"cone": lambda: {"radius_m": b(0.5, 1.2), "height_m": b(0.5, 1.5)},
                "hemisphere": lambda: {"radius_m": b(0.4, 1)},
                "pyramid": lambda: {"base_width_m": b(0.8, 2), "height_m": b(0.3, 1), "yaw_deg": b(0, 90)},
                "rock": lambda: {"diameter_m": b(0.8, 2), "axis_ratio": b(0.6, 1), "yaw_deg": b(0, 180),
                                 **({"height_m": b(0.3, 0.8)} if self.chance(0.5) else {})},
                "ice_block": lambda: {"length_m": b(1, 2), "width_m": b(0.6, 1.2), "height_m": b(0.3, 0.8),
                                      "yaw_deg": b(0, 180), "tilt_deg": b(-20, 20)},
                "crater": lambda: {"diameter_m": b(2, 5), "freshness": b(0.4, 1),
                                   **({"depth_m": b(0.1, 0.4)} if self.chance(0.5) else {})},
                "pit": lambda: {"diameter_m": b(1, 3), "depth_m": b(0.3, 0.8), "wall_slope_deg": b(50, 80)},
                "fracture": lambda: {"length_m": b(4, 9), "width_m": b(0.6, 1.5), "depth_m": b(0.2, 0.6),
                                     "throw_m": b(-0.4, 0.4), "fade_m": b(1, 3), "wall_slope_deg": b(45, 80),
                                     "yaw_deg": b(-90, 90)},
                "ridge": lambda: {"length_m": b(4, 12), "width_m": b(0.5, 1.5), "height_m": b(0.3, 0.8),
                                  "spacing_m": self.one_of([0, b(0.8, 2)]), "yaw_deg": b(-90, 90)},
                "penitente_field": lambda: {**({"diameter_m": b(2, 5)} if self.chance(0.5) else
                                               {"length_m": b(2, 5), "width_m": b(2, 5)}),
                                            "amplitude_m": b(0.2, 0.6), "wavelength_m": b(0.7, 1.2),
                                            "exponent": b(0.6, 1.2), "yaw_deg": b(-40, 40), "wobble_m": b(0.05, 0.2),
                                            "wobble_length_m": b(0.8, 2), "seed": self.whole(1, 99)}}[kind]()
        return {"type": kind, "x_m": b(-2.5, 2.5), "y_m": b(-2.5, 2.5), **keys}

    def raster(self, interpolation):
        """An Esri ASCII grid of 44 x 40 cells of 0.5 m with holes; its elevations are exact in single precision."""
        z = np.rint(self.rng.normal(0, 0.15, (40, 44)) * 1024) / 1024
        for _ in range(4):
            row, column = self.whole(4, 35), self.whole(4, 39)
            if max(abs(row - 20), abs(column - 22)) > 3:
                z[row, column] = -9999
        with open(os.path.join(self.folder, "raster.asc"), "w", encoding="utf-8") as file:
            print("ncols 44\nnrows 40\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value -9999", file=file)
            for row in z:
                print(" ".join(repr(float(value)) for value in row), file=file)
        return {"type": "dem", "path": "raster.asc", "interpolation": interpolation, "horizontal_scale_m": 0.5,
                "vertical_scale": self.between(0.5, 1.5), "datum": self.one_of(["center", "none"]),
                "center_pixel": [22 + self.between(0.05, 0.4), 20 + self.between(0.05, 0.4)]}

    def mesh(self):
        """A rough sheet below a floating octahedron, so that the mesh has overhangs."""
        axis = np.linspace(-14, 14, 15)
        x, y = (grid.ravel() for grid in np.meshgrid(axis, axis))
        sheet = np.column_stack([x, y, self.rng.normal(0, 0.4, x.size)])
        sheet[:, :2] += self.rng.uniform(-0.5, 0.5, (x.size, 2))
        corner = np.array([row * 15 + column for row in range(14) for column in range(14)])
        faces = np.vstack([np.column_stack([corner, corner + 1, corner + 15]),
                           np.column_stack([corner + 1, corner + 16, corner + 15])])
        ball = np.vstack([np.eye(3), -np.eye(3)]) * 2 + [self.between(-3, 3), self.between(-3, 3), 3.5]
        sides = np.array([[a, b, c] for a in (0, 3) for b in (1, 4) for c in (2, 5)]) + len(sheet)
        with open(os.path.join(self.folder, "mesh.obj"), "w", encoding="utf-8") as file:
            for vertex in np.vstack([sheet, ball]):
                print("v", *(repr(float(value)) for value in vertex), file=file)
            for face in np.vstack([faces, sides]) + 1:
                print("f", *face, file=file)
        return "mesh.obj"
