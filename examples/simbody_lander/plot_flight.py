# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws a flight of simbody_lander beside one with frozen propellant, and the error of the DEM.

    python3 plot_flight.py flight.csv frozen.csv eval.h5 flight.png
"""
import sys

import h5py
import matplotlib
import numpy as np

matplotlib.use("Agg")
# pylint: disable=wrong-import-position
import matplotlib.pyplot as plt

SCAN_S = 1.0


def draw_swing(axes, flight):
    for tank, color in ((1, "C0"), (2, "C1")):
        axes.plot(flight["t"], np.degrees(flight[f"slosh_{tank}y"]), color=color, label=f"tank {tank}")
    axes.set(title="Propellant: swing about y", ylabel="degrees from the axis of the bus")


def draw_attitude(axes, flight, frozen):
    rows = min(len(flight), len(frozen))
    for axis, color in (("x", "C2"), ("y", "C3")):
        axes.plot(flight["t"][:rows], 1e3 * (flight[f"tilt_{axis}"][:rows] - frozen[f"tilt_{axis}"][:rows]), color=color,
                  label=f"about {axis}")
    axes.set(title="Attitude: what the swing changes", ylabel="mrad, swinging - frozen propellant")


def draw_errors(axes, flight):
    for axis, color in (("x", "C0"), ("y", "C1"), ("z", "C2")):
        sigma = flight[f"sigma_{axis}"]
        axes.plot(flight["t"], flight[f"error_{axis}"], color=color, label=axis)
        axes.plot(flight["t"], sigma, color=color, linestyle=":", linewidth=1)
        axes.plot(flight["t"], -sigma, color=color, linestyle=":", linewidth=1)
    axes.set(title="Filter: error of the position (dotted: 1 sigma)", ylabel="m, true - estimated")


def draw_map(figure, axes, path):
    with h5py.File(path) as file:
        x, y, region = file["x"][()], file["y"][()], file["in_region"][()] == 1
        error = np.where(region, 100 * file["e_z"][()], np.nan)
    middle = np.nanmedian(error)
    image = axes.imshow(error, origin="lower", extent=(x[0], x[-1], y[0], y[-1]), cmap="RdBu_r", vmin=middle - 6, vmax=middle + 6,
                        interpolation="nearest")
    axes.set(title="DEM: error of the elevation", xlabel="x, m", ylabel="y, m")
    figure.colorbar(image, ax=axes, label="cm, true - estimated", extend="both", fraction=0.046, pad=0.03)


def main(flight_path, frozen_path, eval_path, output):
    flight, frozen = (np.genfromtxt(path, delimiter=",", names=True) for path in (flight_path, frozen_path))
    figure, panels = plt.subplots(2, 2, figsize=(11, 8), layout="constrained")
    draw_swing(panels[0, 0], flight)
    draw_attitude(panels[0, 1], flight, frozen)
    draw_errors(panels[1, 0], flight)
    for axes in panels.flat[:3]:
        axes.axvspan(flight["t"][-1] - SCAN_S, flight["t"][-1], color="0.85", label="scan")
        axes.set(xlabel="time, s", xlim=(0, flight["t"][-1]))
        axes.grid(alpha=0.3)
        axes.legend(ncols=2, fontsize="small", loc="upper right" if axes is panels[0, 0] else "lower center",
                    bbox_to_anchor=(0.55, 0.2) if axes is panels[1, 0] else None)
    draw_map(figure, panels[1, 1], eval_path)
    figure.savefig(output, dpi=100)


if __name__ == "__main__":
    main(*sys.argv[1:])
