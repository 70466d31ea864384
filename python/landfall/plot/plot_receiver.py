# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws what each type of receiver reports: the waveforms of a pixel, and the error of the range on slopes, by scans of a tilted lidar."""
import os

import matplotlib.pyplot as plt
import numpy as np

from landfall import files
from landfall.plot import plot_command

LIGHT_MPS = 299792458
FWHM_S = 1e-9
SIGMA_M = LIGHT_MPS / 2 * FWHM_S / (2 * np.sqrt(2 * np.log(2)))
RANGE_M = 500
PITCH_RAD = 1.6e-3 / 18
SIGNAL_PE = 250
THRESHOLD_PE = 50
SUBPIXELS = 15
SLOPES_DEG = [0, 15, 30, 40, 50, 60, 65, 70, 75, 80]
TERRAIN = {"grid": {"half_width_m": 60, "resolution_m": 1}, "base": {"type": "plane"}}
# (type, its settings, label, colour)
RECEIVERS = [
    ("leading_edge", {"threshold_pe": THRESHOLD_PE}, "leading edge", "C3"),
    ("constant_fraction", {"threshold_pe": THRESHOLD_PE}, "constant fraction", "C0"),
    ("peak", {"threshold_pe": THRESHOLD_PE}, "peak", "C2"),
    ("centroid", {"threshold_pe": THRESHOLD_PE}, "centroid", "C1"),
    ("geiger", {}, "Geiger, mean", "C4"),
]


def configuration(slope_deg, kind, keys):
    """A lidar at RANGE_M from level terrain, which its boresight meets at this angle from the normal."""
    slope = np.radians(slope_deg)
    quiet = {} if kind == "geiger" else {"photon_noise": False}
    return {"detector": {"rows": 8, "columns": 8, "ifov_rad": PITCH_RAD, "subpixels": SUBPIXELS},
            "laser": {"pulse_rate_hz": 100, "scan_time_s": 0.2 if kind == "geiger" else 0.01},
            "scanner": {"type": "flash"},
            "trajectory": {"type": "constant_velocity", "velocity_mps": [0, 0, 0], "rpy_deg": [slope_deg, 0, 0],
                           "position_m": [0, -RANGE_M * np.sin(slope), RANGE_M * np.cos(slope)]},
            # the same signal on every slope, so that only the shape of the echo changes
            "link": {"reference_pe": SIGNAL_PE / np.cos(slope), "reference_range_m": RANGE_M},
            "receiver": {"type": kind, "pulse_fwhm_s": FWHM_S, **quiet, **keys}}


def error_m(slope_deg, kind, keys, folder, options):
    """The mean of measured minus true range."""
    config, terrain = configuration(slope_deg, kind, keys), os.path.join(folder, "terrain.h5")
    path = plot_command.run_tool("scan-sim", folder, "scan", config, options, "--terrain", terrain)
    with files.open_landfall(path, "landfall.scan") as file:
        error = file["points/range_measured"][()] - file["points/range_true"][()]
    return np.nanmean(error)


def errors_of_slopes(folder, options):
    """{type: the error on each slope, metres}"""
    plot_command.run_tool("terrain-gen", folder, "terrain", TERRAIN, options)
    return {kind: np.array([error_m(slope, kind, keys, folder, options) for slope in SLOPES_DEG]) for kind, keys, _, _ in RECEIVERS}


def waveform(ranges_m, at_m):
    """The echoes of sub-rays of equal signal, over the maximum of one pulse."""
    return np.exp(-((at_m[:, None] - ranges_m) / SIGMA_M) ** 2 / 2).mean(axis=1)


def draw_waveforms(ax):
    at = np.linspace(-0.3, 0.3, 1201)
    steps = (np.arange(SUBPIXELS) + 0.5) / SUBPIXELS - 0.5
    pixel_m = PITCH_RAD * RANGE_M
    surfaces = [("level terrain", np.zeros(1), "0.2", "-"), ("slope of 70°", pixel_m * np.tan(np.radians(70)) * steps, "0.45", "--"),
                ("half on a step of 12 cm", np.where(steps < 0, -0.12, 0.0), "0.6", ":")]
    for label, ranges, colour, style in surfaces:
        ax.plot(100 * at, SIGNAL_PE * waveform(ranges, at), color=colour, linestyle=style, label=label)
    ax.axhline(THRESHOLD_PE, color="C3", linewidth=0.8)
    ax.text(19, THRESHOLD_PE + 4, "threshold", color="C3", fontsize=9)
    ax.set(xlabel="range beyond the pixel's own ray, cm", ylabel="signal, photoelectrons", ylim=(0, 1.35 * SIGNAL_PE))
    ax.set_title("Waveforms of a pixel", fontsize=11)
    ax.legend(frameon=False, fontsize=9, loc="upper left")


def draw_errors(ax, errors):
    for kind, _, label, colour in RECEIVERS:
        style = (0, (4, 4)) if kind == "centroid" else "-"  # it hides no other curve
        ax.plot(SLOPES_DEG, 100 * errors[kind], marker="o", linestyle=style, color=colour, markersize=3, label=label)
    ax.axhline(0, color="0.8", linewidth=0.8, zorder=0)
    ax.set(xlabel="slope, degrees", ylabel="reported minus true range, cm")
    ax.set_title("Error of the range on slopes", fontsize=11)
    ax.legend(frameon=False, fontsize=9, loc="center left", bbox_to_anchor=(0.02, 0.72))


def figure_of(folder, options):
    errors = errors_of_slopes(folder, options)
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.4), layout="constrained")
    draw_waveforms(left)
    draw_errors(right, errors)
    figure.suptitle(f"Pixels of {100 * PITCH_RAD * RANGE_M:.1f} cm at {RANGE_M} m, pulse of {1e9 * FWHM_S:g} ns, {SIGNAL_PE} photoelectrons",
                    fontsize=11)
    return figure


main = plot_command.main_of_tools(__doc__, figure_of)
