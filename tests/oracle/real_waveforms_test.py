#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Real full waveforms through lib/chain/lidar/receiver, and the pulses' origins and directions through scan-sim.

`real_waveforms_test.py --figure FILE` also draws the figure of docs/quality/real-scan.md.
"""
import os
import subprocess
import sys
import unittest

import h5py
import numpy as np
from scipy import sparse

from harness import BIN, ROOT, ToolTest, returns_of
from oracle.flight import angles_of
from oracle.frames import normalised
from oracle.riegl import NAME, Pulses, Returns

DATA = os.path.join(os.environ.get("LANDFALL_DATA", os.path.join(ROOT, "..", "shared", "data")), "outside")
FIGURE = sys.argv[sys.argv.index("--figure") + 1] if "--figure" in sys.argv else None
RECEIVER = os.path.join(BIN, "..", "tests", "receive_waveforms")
CM_PER_NS = 14.9896229
CLASSES = [20, 40, 60, 90, 130, 150, 170, 200, 400]  # counts
THRESHOLD = 15  # counts above the base line
KERNEL_NS = 1.0  # sigma of the Gaussians that represent a waveform: the interval of its samples
FWHM_PER_SIGMA = np.sqrt(8 * np.log(2))
BEAM_RAD = 5e-4  # full angle, of the data sheet


def sub_rays(samples):
    """(times in ns, counts of each waveform) of non-negative Gaussians of KERNEL_NS that sum to the samples: the expectation
    maximisation of Richardson and Lucy."""
    times = np.arange(-2, samples.shape[1] + 2, 0.5)
    kernel = np.exp(-0.5 * ((np.arange(samples.shape[1])[:, None] - times) / KERNEL_NS) ** 2)
    blurred = sparse.csr_matrix(np.where(kernel > 1e-12, kernel, 0))
    spread, total = blurred.T.tocsr(), kernel.sum(0)[:, None]
    samples = samples.T
    counts = np.ones((len(times), 1)) * samples.sum(0) / len(times)
    for _ in range(500):
        counts *= spread @ (samples / np.maximum(blurred @ counts, 1e-9)) / total
    counts[counts < 1e-6 * counts.sum(0)] = 0
    return times, counts.T, (samples - blurred @ counts).std()


def received(times, counts):
    """The reports of lib/chain/lidar/receiver: height in counts; leading edge, constant fraction, peak, centroid in ns."""
    lines = (" ".join(f"{t:g} {e:.9g}" for t, e in zip(times[row > 0], row[row > 0])) for row in counts)
    result = subprocess.run([RECEIVER, str(FWHM_PER_SIGMA * KERNEL_NS), str(THRESHOLD), "0.5"], input="\n".join(lines), text=True,
                            capture_output=True, check=True, timeout=300)
    return np.array([line.split() for line in result.stdout.splitlines()], float).T


def error_of_spread(values, spread):
    """One standard error of the spread of these values: the larger of the bootstrap's and of that of a normal distribution."""
    draws = np.random.default_rng(1).choice(values, (500, len(values)))
    return max(draws.std(axis=1, ddof=1).std(), spread / np.sqrt(2 * (len(values) - 1)))


@unittest.skipUnless(os.path.exists(os.path.join(DATA, NAME + ".las")), f"no real waveforms: {DATA} (LANDFALL_DATA)")
class RealWaveforms(ToolTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.returns = Returns(DATA)
        cls.rows = cls.returns.of_one()
        samples = np.stack([cls.returns.samples(row) for row in cls.rows])
        above = np.clip(samples - np.median(samples[:, :10], axis=1)[:, None], 0, None)
        times, counts, cls.residual = sub_rays(above)
        cls.height, cls.edge, cls.fraction, cls.peak, cls.centroid = received(times, counts)
        cls.fitted = np.arange(len(cls.rows)) % 2 == 0  # the others are judged
        cls.sigma_ns = -np.median((cls.fraction - cls.peak)[cls.fitted]) / np.sqrt(2 * np.log(2))
        cls.closed = -cls.sigma_ns * np.sqrt(2 * np.log(cls.height / THRESHOLD))
        cls.walk = cls.edge - cls.peak

    def classes(self):
        """(low, high, rows that are judged, rows that were fitted)."""
        for low, high in zip(CLASSES, CLASSES[1:]):
            inside = (self.height >= low) & (self.height < high)
            yield low, high, inside & ~self.fitted, inside & self.fitted

    def noise_cm(self):
        """The noise law of the fitted half, landfall's own: variance = square/height. Returns its square root at one count."""
        error = CM_PER_NS * (self.walk - self.closed)
        square = [(error[mine] - error[mine].mean()) ** 2 * self.height[mine] for *_, mine in self.classes()]
        return np.sqrt(np.concatenate(square).mean())

    def test_the_representation_is_within_the_noise(self):
        print(f"{len(self.rows)} pulses, residual {self.residual:.2f} counts, sigma {self.sigma_ns:.3f} ns")
        self.assertEqual(len(self.rows), 2202)
        self.assertLess(self.residual, 0.5)  # 0.75 counts of noise before the echoes
        self.assertAlmostEqual(FWHM_PER_SIGMA * self.sigma_ns, 4.51, delta=0.05)
        self.assertTrue(np.isfinite(self.walk).all())

    def check_class(self, name, values_ns, expected_ns):
        """Means of the judged half by class, within 2.5 cm, and 2 SE more where there are few."""
        for low, high, judged, _ in self.classes():
            error = CM_PER_NS * (values_ns - expected_ns)[judged]
            slack = 2 * error.std(ddof=1) / np.sqrt(len(error)) if len(error) < 50 else 0
            print(f"{name} {low}-{high}: n {len(error)}, {values_ns[judged].mean():.3f} ns, closed form {expected_ns[judged].mean():.3f} ns, "
                  f"difference {error.mean():+.2f} cm")
            self.assertLess(abs(error.mean()), 2.5 + slack, f"{name} {low}-{high}")

    def test_the_threshold_is_crossed_where_the_closed_form_says(self):
        self.check_class("leading edge", self.walk, self.closed)
        walk = [self.walk[judged].mean() for *_, judged, _ in self.classes()]
        self.assertGreater(CM_PER_NS * (max(walk) - min(walk)), 25)  # what the closed form explains

    def test_half_of_the_maximum_is_crossed_at_one_place(self):
        self.check_class("constant fraction", self.fraction - self.peak, np.full(len(self.rows), -self.sigma_ns * np.sqrt(2 * np.log(2))))

    def test_the_centroid_is_late(self):
        """It does not agree: the instrument's pulses have a tail, which a Gaussian does not have."""
        late = CM_PER_NS * (self.centroid - self.peak)
        for low, high, judged, _ in self.classes():
            print(f"centroid {low}-{high}: {late[judged].mean():.1f} +- {late[judged].std():.1f} cm after the maximum")
        self.assertTrue(10 < late.mean() < 60, late.mean())

    def test_one_noise_law_predicts_the_spread(self):
        law = self.noise_cm()
        print(f"noise {law / np.sqrt(150):.2f} cm at 150 counts: {self.photoelectrons():.0f} photoelectrons")
        error = CM_PER_NS * (self.walk - self.closed)
        for low, high, judged, _ in self.classes():
            predicted = law * np.sqrt((1 / self.height[judged]).mean())
            found = error[judged].std(ddof=1)
            core = 1.4826 * np.median(abs(error[judged] - np.median(error[judged])))
            allowed = 0.2 * predicted + 2 * error_of_spread(error[judged], predicted)
            print(f"spread {low}-{high}: n {judged.sum()}, {found:.2f} cm, predicted {predicted:.2f} cm, within {allowed:.2f}, NMAD {core:.2f}")
            self.assertLess(abs(found - predicted), allowed, f"{low}-{high}")

    def photoelectrons(self):
        """That give an echo of 150 counts this noise in landfall's receiver, sigma/sqrt(n)."""
        return (CM_PER_NS * self.sigma_ns / self.noise_cm()) ** 2 * 150

    def plane(self):
        """Range errors (cm) of a scan of a plane by the instrument's numbers, with walk correction."""
        ground = self.config({"grid": {"half_width_m": 40, "resolution_m": 1}}, "terrain.json")
        self.succeed("terrain-gen", "-c", ground, "-o", self.path("plane.h5"))
        height = np.median(self.height)
        signal = self.photoelectrons() * height / 150
        distance_m = 560
        lit = np.pi / 32  # mean weight of a Gaussian beam over a pixel of twice its diameter
        config = {"detector": {"rows": 1, "columns": 1, "subpixels": 9, "ifov_rad": 2 * BEAM_RAD},
                  "laser": {"pulse_rate_hz": 240000, "scan_time_s": 0.1},
                  "scanner": {"type": "flash"}, "trajectory": {"position_m": [0, 0, distance_m], "velocity_mps": [0, 0, 0]},
                  "beam": {"profile": "gaussian", "divergence_rad": BEAM_RAD}, "noise": {"range_sigma_m": 0},
                  "surface": {"albedo": 1}, "link": {"reference_pe": signal / lit, "reference_range_m": distance_m},
                  "receiver": {"type": "leading_edge", "pulse_fwhm_s": 1e-9 * FWHM_PER_SIGMA * self.sigma_ns,
                               "threshold_pe": THRESHOLD * signal / height, "walk_correction": True}}
        self.succeed("scan-sim", "-c", self.config(config, "plane.json"), "--terrain", self.path("plane.h5"), "-o", self.path("plane-scan.h5"))
        points = returns_of(self.path("plane-scan.h5"))
        self.assertAlmostEqual(points["intensity"].mean() / signal, 1, delta=0.02)
        return 100 * (points["range_measured"] - points["range_true"])

    def test_a_simulated_plane_has_the_real_spread(self):
        simulated = self.plane()
        real = CM_PER_NS * (self.walk - self.closed)[~self.fitted]
        steps = [5, 25, 50, 75, 95]
        quantiles = {name: np.percentile(values - np.median(values), steps) for name, values in (("real", real), ("simulated", simulated))}
        for name, values in quantiles.items():
            print(name, "quantiles (cm)", dict(zip(steps, np.round(values, 2))))
        print(f"standard deviation {real.std():.2f} and {simulated.std():.2f} cm, mean {real.mean():.2f} and {simulated.mean():.2f} cm")
        allowed = 0.2 * simulated.std() + 2 * error_of_spread(real, simulated.std())
        self.assertLess(abs(real.std() - simulated.std()), allowed)
        self.assertLess(abs(real.mean() - simulated.mean()), 2.5)
        # It does not agree: most real errors are smaller, a few are larger than a normal distribution has them.
        self.assertLess(np.diff(quantiles["real"][[1, 3]])[0], 0.8 * np.diff(quantiles["simulated"][[1, 3]])[0])
        if FIGURE:
            self.draw(real, simulated)

    def test_the_returns_follow_from_origins_and_directions(self):
        """scan-sim flies the table of the pulses; its beams and the times of the waveforms give the returns of the .las."""
        pulses = Pulses(DATA)
        order = np.argsort(pulses.table["t"])
        time_us = pulses.table["t"][order] - pulses.table["t"].min()
        origin = np.floor(self.returns.places.min(axis=0))
        down = -normalised(pulses.steps[order])
        side = normalised(np.cross([0, 1, 0], down))
        attitudes = np.stack([side, np.cross(down, side), down], axis=-1)
        table = np.column_stack([1e-6 * time_us, pulses.anchors[order] - origin, angles_of(attitudes)])
        np.savetxt(self.path("pulses.csv"), table, delimiter=",", header="t_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg", comments="", fmt="%.17g")
        ground = self.config({"grid": {"half_width_m": 800, "resolution_m": 50}}, "terrain.json")
        self.succeed("terrain-gen", "-c", ground, "-o", self.path("ground.h5"))
        config = {"detector": {"rows": 1, "columns": 1}, "laser": {"pulse_rate_hz": 1e6, "scan_time_s": 1e-6 * (time_us.max() + 1)},
                  "scanner": {"type": "flash"}, "mount": {"rpy_deg": [180, 0, 0]},
                  "trajectory": {"type": "table", "path": self.path("pulses.csv")}}
        self.succeed("scan-sim", "-c", self.config(config, "real.json"), "--terrain", self.path("ground.h5"), "--keep-misses", "-o", self.path("real.h5"))
        with h5py.File(self.path("real.h5")) as file:
            poses = np.stack([file[f"pulses/p{axis}_true"][()] for axis in "xyz"], -1)[time_us]
            hits = np.stack([file[f"points/{axis}_true"][()] for axis in "xyz"], -1)[time_us]
        beams = normalised(hits - poses)
        mine = np.searchsorted(time_us, np.rint(1e6 * self.returns.table["t"][self.rows]).astype(int) - pulses.table["t"].min())
        time_ns = pulses.starts_ns(order[mine]) + self.returns.table["location_ps"][self.rows] / 1000
        step_m = np.linalg.norm(pulses.steps[order[mine]], axis=1)
        error = poses[mine] + beams[mine] * (time_ns * step_m)[:, None] + origin - self.returns.places[self.rows]
        along = (error * beams[mine]).sum(axis=1)
        across = np.linalg.norm(error - along[:, None] * beams[mine], axis=1)
        # Rounding to 1 mm of anchor and target, the latter farther by 1000 samples, and of the return itself.
        lever = time_ns.mean() / 1000
        rounding = 1e-3 / np.sqrt(12) * np.sqrt(lever ** 2 + (lever - 1) ** 2 + 1)
        print(f"across {1e3 * np.sqrt((across ** 2).mean()):.2f} mm rms, at most {1e3 * across.max():.1f}; along {1e3 * along.mean():.2f} +- "
              f"{1e3 * along.std():.2f} mm; rounding {1e3 * rounding:.2f} mm an axis")
        self.assertEqual(len(along), 2202)
        self.assertAlmostEqual(np.sqrt((across ** 2).mean()), np.sqrt(2) * rounding, delta=0.1 * rounding)
        self.assertAlmostEqual(along.std(), rounding, delta=0.1 * rounding)
        self.assertLess(abs(along.mean()), 1e-3)
        self.assertLess(across.max(), 6e-3)

    def draw(self, real, simulated):
        import matplotlib
        matplotlib.use("Agg")
        from matplotlib import pyplot
        figure, (left, right) = pyplot.subplots(1, 2, figsize=(11, 4.2), layout="constrained")
        judged = ~self.fitted
        left.plot(self.height[judged], CM_PER_NS * self.walk[judged], ".", ms=3, color="#0072b2", alpha=0.4, label="lib/chain/lidar/receiver on real waveforms")
        curve = np.linspace(17, 260, 200)
        left.plot(curve, -CM_PER_NS * self.sigma_ns * np.sqrt(2 * np.log(curve / THRESHOLD)), color="#d55e00", label="closed form")
        left.set(xlabel="amplitude, counts", ylabel="threshold crossing after the maximum, cm", title="Walk of 1,100 real pulses that were not fitted", ylim=(-85, -5))
        left.legend()
        bins = np.arange(-12, 12.1, 0.5)
        for values, label, color in ((real, "real pulses", "#0072b2"), (simulated, "scan of a plane", "#d55e00")):
            right.hist(values - np.median(values), bins, density=True, histtype="step", lw=1.8, color=color, label=label)
        right.set(xlabel="range error, less its median, cm", ylabel="density, 1/cm", title="Range errors")
        right.legend()
        figure.savefig(FIGURE, dpi=110)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
