# SPDX-License-Identifier: GPL-3.0-or-later
"""Random configurations of scans: detectors, errors, trajectories."""
import os

import numpy as np

from oracle import detector, receiver, tables
from oracle.drawing import DURATION_S
from oracle.mechanisms import Mechanisms


class Lidars(Mechanisms):
    def scan(self, dealt):
        kind = dealt["scanner"].split()[0]
        config = {"detector": self.detector(dealt), "scanner": self.scanner(dealt), "noise": self.noise(),
                  "laser": {"pulse_rate_hz": self.one_of([800, 1000, 1250.5]), "scan_time_s": DURATION_S},
                  "mount": {"position_m": self.between(-0.5, 0.5, 3), "rpy_deg": [180 + self.between(-1, 1),
                                                                                  self.between(-1, 1), self.between(-20, 20)]},
                  "pointing_error": self.pointing(), "seed": self.whole(0, 2**53 - 1)}
        config["draw"] = config["seed"] >> 22  # any of 2^31
        config["trajectory"] = self.trajectory(dealt["trajectory"])
        config["navigation_error"] = self.navigation(dealt["navigation"], config["trajectory"])
        if dealt["scanner"] == "risley reflecting":
            config["mount"]["rpy_deg"] = [180, 0, 0]
            config["detector"]["ifov_rad"] = 0.003
        if kind in ("flash", "polygon", "palmer"):
            config["detector"].pop("ifov_rad", None)
            config["detector"]["fov_deg"] = self.between(2, 4) if kind != "flash" else self.between(4, 6, 2)
        config.update(self.light(dealt, config))
        self.depart(config)
        return config

    def depart(self, config):
        """In half of the scans the true path departs from the configured one; half of the compensated patterns aim from the estimate. From
        numbers of its own, so that these keys change no other one."""
        rng = np.random.default_rng([config["seed"], 1])
        around = lambda maximum: [float(value) for value in rng.uniform(-maximum, maximum, 3)]
        if rng.random() < 0.5:
            config["trajectory_dispersion"] = {"position_m": around(0.2), "velocity_mps": around(1), "rpy_rad": around(5e-3), "rpy_rate_radps": around(0.02)}
        pattern = config["scanner"].get("pattern", {})
        if pattern.get("compensated", False) and rng.random() < 0.5:
            pattern["aim"] = "estimate"

    def light(self, dealt, scan):
        """The sections beam, surface, link and receiver. Signals are near the threshold, so that some echoes are not detected."""
        b, kind = self.between, dealt["receiver"]
        clock = {"jitter_sigma_s": b(0, 1e-10), "pixel_offset_sigma_m": b(0, 0.03), "clock_scale_ppm": b(-100, 100),
                 "timer_step_s": self.one_of([0, b(1e-11, 3e-10)])} if kind == "clock" or self.chance(0.5) else {}
        if kind in ("none", "clock"):
            return {"receiver": clock} if clock else {}
        optics = scan["detector"]
        optics.pop("estimator", None)
        if self.chance(0.7):
            optics["subpixels"] = self.whole(2, 4)
        mean = self.one_of([b(0.3, 3), b(10, 200)]) if kind == "geiger" else self.one_of([b(5, 40), b(30, 300), b(1e3, 1e5)])
        albedo = 1.0 if self.chance(0.3) else b(0.1, 1)
        threshold = mean * albedo * b(0.1, 0.6)
        if dealt["terrain"] != "mesh" and self.chance(0.4):
            albedo = "terrain"
        sections = {"beam": self.beam(optics), "surface": {"albedo": albedo}}
        sections["link"] = {**self.link(mean, optics, sections["beam"]),
                            "background_pe": self.one_of([0, b(0, 1), b(0, 1000)])}
        returns = dealt["returns"] if (kind, dealt["returns"]) != ("geiger", "strongest") else "all"
        sections["receiver"] = {"type": kind, "pulse_fwhm_s": self.one_of([b(1e-10, 5e-10), b(5e-10, 3e-9)]), "returns": returns,
                                **clock}
        if returns == "all":
            sections["receiver"]["max_returns"] = self.whole(1, 5)
        if kind == "geiger":
            sections["receiver"]["dead_time_s"] = self.one_of([0, b(1e-9, 1e-7)])
        else:
            sections["receiver"].update(threshold_pe=threshold, photon_noise=self.chance(0.75))
        if kind == "constant_fraction":
            sections["receiver"]["fraction"] = self.one_of([0.5, b(0.05, 0.95)])
        if kind == "leading_edge":
            sections["receiver"]["walk_correction"] = self.chance(0.5)
        return sections

    def beam(self, optics):
        b = self.between
        if self.chance(0.4):
            return {}
        field = 0.02 if "distribution" in optics else np.max(detector.pitch(optics)) * max(optics["rows"], optics["columns"])
        return {"profile": self.one_of(["gaussian", "top_hat"]), "divergence_rad": field * b(0.8, 3),
                "offset_rad": b(-1e-3, 1e-3, 2)}

    def link(self, mean, optics, beam):
        """A link with about this mean at 50 m: as a reference, or from a design whose energy follows from it."""
        if not beam or "distribution" in optics or self.chance(0.4):
            range_m = self.between(20, 500)
            return {"reference_pe": mean * (50 / range_m)**2, "reference_range_m": range_m}
        design = {"pulse_energy_J": 1, "wavelength_m": self.one_of([1.064e-6, 532e-9]),
                  "aperture_m": self.between(0.02, 0.1), "efficiency": self.between(0.05, 0.6)}
        of_a_joule = receiver.link_constant({"link": design, "beam": beam, "detector": {"fill_factor": 1, **optics}})
        return {**design, "pulse_energy_J": mean * 50**2 / of_a_joule}

    def detector(self, dealt):
        rows, columns = self.whole(3, 6), self.whole(3, 6)
        config = {"rows": rows, "columns": columns, "ifov_rad": self.one_of([0.0022, self.between(0.001, 0.003, 2)]),
                  "roll_deg": self.between(-20, 20)}
        if self.chance(0.35):
            config.update(subpixels=self.whole(2, 3), estimator=dealt["estimator"], fill_factor=self.between(0.4, 1),
                          range_resolution_m=self.between(0.02, 0.3))
        if self.chance(0.3):
            config["distortion"] = {"k1": self.between(-20, 20), "k2": self.between(-50, 50), "k3": self.between(-50, 50)}
        if self.chance(0.2):
            number = self.rng.permutation(rows * columns)
            config["distribution"] = {"path": self.table("pixels.csv", {
                "row": number // columns, "column": number % columns, "u": self.between(-0.01, 0.01, number.size),
                "v": self.between(-0.01, 0.01, number.size)})}
        return config

    def noise(self):
        b, on = self.between, self.chance
        config = {"range_sigma_m": b(0.002, 0.03) if on(0.7) else 0, "range_bias_m": b(-0.02, 0.02) if on(0.5) else 0,
                  "range_sigma_per_m": b(1e-5, 3e-4) if on(0.3) else 0,
                  "incidence_sigma_rad": b(1e-4, 1e-3) if on(0.35) else 0,
                  "dead_pixel_frac": 0.08 if on(0.4) else 0, "dropout_frac": b(0.01, 0.1) if on(0.5) else 0}
        if on(0.35):
            config.update(false_return_frac=b(0.01, 0.1), false_range_m=[b(30, 40), b(60, 70)])
        return config

    def pointing(self):
        config = {}
        if self.chance(0.4):
            config["misalignment_rpy_rad"] = self.between(-2e-3, 2e-3, 3)
        if self.chance(0.4):
            config["jitter_sigma_rad"] = self.one_of([self.between(0, 1e-3), self.between(0, 1e-3, 2)])
            config["jitter_time_s"] = self.one_of([0, 1e-5, self.between(1e-3, 1), 1e5])
        if self.chance(0.4):
            config.update(time_stamp_bias_s=self.between(-0.01, 0.01), time_stamp_sigma_s=self.between(0, 1e-3))
        if self.chance(0.4):
            config.update(mirror_time_bias_s=self.one_of([1e-4, 2e-3]) * self.between(-1, 1), mirror_time_sigma_s=self.between(0, 1e-4))
        return config

    def trajectory(self, kind):
        b = self.between
        position, speed = [b(-0.4, 0.4), b(-0.4, 0.4), b(42, 58)], [b(-3, 3), b(-3, 3), b(-20, -2)]
        if kind == "constant_velocity":
            return {"type": kind, "position_m": position, "velocity_mps": speed,
                    "rpy_deg": [b(-1.5, 1.5), b(-1.5, 1.5), b(-30, 30)], "rpy_rate_degps": b(-5, 5, 3)}
        if kind == "dynamics":
            return {"type": kind, "position_m": position, "velocity_mps": speed, "rpy_deg": b(-0.5, 0.5, 3),
                    "rate_degps": b(-3, 3, 3), "inertia_kgm2": [90, 100, 120], "inertia_products_kgm2": b(-5, 5, 3),
                    "thrust": {"descent_rate_mps": b(2, 20), "max_n": self.one_of([0, 900, 3000])},
                    "attitude_control": {"command_rpy_deg": b(-0.5, 0.5, 3), "deadband_deg": b(0.02, 0.2),
                                         "torque_nm": self.one_of([[0, 0, 0], [20, 30, 10]])},
                    "disturbance": {"torque_nm": b(-2, 2, 3), "torque_sigma_nm": b(0, 5, 3), "seed": self.whole(1, 99)}}
        return {"type": "table", "path": self.poses("poses.csv", kind.split()[1], position, speed)}

    def poses(self, name, attitude, position, speed, start=None):
        start = self.between(-5, 100) if start is None else start
        t = np.concatenate([[0], np.cumsum(self.rng.uniform(0.02, 0.05, 6))])
        t[-1] = max(t[-1], DURATION_S + 0.01)
        p = np.array(position) + np.outer(t, speed) + self.rng.normal(0, 0.02, (7, 3))
        columns = {"t_s": start + t, **{f"{axis}_m": p[:, n] for n, axis in enumerate("xyz")}}
        if self.chance(0.5):
            v = np.array(speed) + self.rng.normal(0, 0.5, (7, 3))
            columns.update({f"v{axis}_mps": v[:, n] for n, axis in enumerate("xyz")})
        columns.update(self.attitudes(attitude))
        return self.table(name, columns)

    def attitudes(self, kind):
        """Seven attitudes near the nominal one, in columns of the given kind."""
        turn = self.rng.normal(0, 0.01, (7, 3))
        if kind == "angles":
            return {f"{name}_deg": np.degrees(turn[:, n]) for n, name in enumerate(("roll", "pitch", "yaw"))}
        if kind == "mrp":
            return {f"mrp_{n + 1}": turn[:, n] / 4 for n in range(3)}
        q = np.column_stack([np.ones(7), turn / 2])
        q *= self.rng.choice([-1, 1], (7, 1)) / np.linalg.norm(q, axis=1, keepdims=True)
        return {name: q[:, n] for n, name in enumerate(("qw", "qx", "qy", "qz"))}

    def navigation(self, kind, trajectory):
        if kind == "none":
            return {}
        if kind == "table":
            start = 0.0
            if trajectory["type"] == "table":
                start = tables.read(os.path.join(self.folder, trajectory["path"]))["t_s"][0]
            position = trajectory.get("position_m", [0.1, -0.2, 50])
            return {"table": self.poses("estimated.csv", "quaternion", position, [1, -1, -10], start)}
        b = self.between
        config = {"position_m": b(-0.1, 0.1, 3), "velocity_mps": b(-0.5, 0.5, 3), "rpy_rad": b(-2e-3, 2e-3, 3),
                  "rpy_rate_radps": b(-1e-2, 1e-2, 3)} if kind != "commanded" else {"attitude": "commanded"}
        config["interval_s"] = self.one_of([0.01, b(0.003, 0.05)])
        if kind in ("walk", "all"):
            config["random_walk"] = {"position_m_per_sqrt_s": b(0, 0.1, 3), "velocity_mps_per_sqrt_s": b(0, 0.5, 3),
                                     "rpy_rad_per_sqrt_s": b(0, 2e-3, 3)}
        if kind in ("gauss_markov", "all"):
            config["gauss_markov"] = {"position_sigma_m": b(0, 0.05, 3), "position_time_s": b(0.02, 1),
                                      "velocity_sigma_mps": b(0, 0.5, 3), "velocity_time_s": b(0.02, 1),
                                      "rpy_sigma_rad": b(0, 1e-3, 3), "rpy_time_s": b(0.02, 1)}
        return config
