# SPDX-License-Identifier: GPL-3.0-or-later
# Decisions: D291
"""How well a DEM's 1-sigma maps predict its errors: reliability and z-scores."""
import math

import numpy as np
from matplotlib.ticker import LogLocator, NullLocator

from landfall.plot import captions, maps


def draw(name, metrics):
    title = f"{name}: do the 1-sigma maps predict the errors?"
    figure, axes = maps.new_figure((2, 2), (11, 10), title)
    for row, kind in enumerate(("absolute", "relative")):
        draw_reliability(axes[row, 0], metrics, kind)
        draw_shares(axes[row, 1], metrics, kind)
    return figure


def draw_reliability(ax, metrics, kind):
    """Predicted sigma against the root mean square of the errors, bins of nearly equal sigma together."""
    values = {key: np.asarray(metrics.get(f"uncertainty/{kind}/reliability/{key}") or [], float)
              for key in ("sigma_m", "rmse_m", "bins")}
    ax.set(title=f"{kind}: {captions.number(metrics.get(f'uncertainty/{kind}/count'))} bins",
           xlabel="predicted sigma (cm)", ylabel="root mean square of the errors (cm)", xscale="log", yscale="log")
    ax.set_box_aspect(1)
    shown = values["rmse_m"] > 0
    if not shown.any():
        maps.notice(ax, "no z-score")
        return
    sigma, rmse = 100 * values["sigma_m"][shown], 100 * values["rmse_m"][shown]
    low, high = min(sigma.min(), rmse.min()) / 1.3, max(sigma.max(), rmse.max()) * 1.3
    ax.plot([low, high], [low, high], color="black", linewidth=1, label="predicted")
    area = 16 + 160 * values["bins"][shown] / values["bins"].max()
    ax.plot(sigma, rmse, color=maps.BLUE, linewidth=1)
    ax.scatter(sigma, rmse, area, color=maps.BLUE, label="measured (area: bins)")
    ax.set(xlim=(low, high), ylim=(low, high))
    few = high / low < 30
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(LogLocator(subs=(1, 1.5, 2, 3, 5, 7) if few else (1,)))
        axis.set_major_formatter(lambda value, _: f"{value:g}")
        axis.set_minor_locator(NullLocator())
    ax.grid(True, color="#e0e0e0", linewidth=0.6)
    ax.set_axisbelow(True)
    ax.legend(loc="upper left")


def draw_shares(ax, metrics, kind):
    """The share of the errors within k sigma against that of a normal distribution."""
    k = np.asarray(metrics.get(f"uncertainty/{kind}/within_k_sigma/k") or [], float)
    found = np.asarray(metrics.get(f"uncertainty/{kind}/within_k_sigma/frac") or [], float)
    within = [captions.percent(metrics.get(f"uncertainty/{kind}/within_{n}_sigma_frac")) for n in (1, 2)]
    spread = metrics.get(f"uncertainty/{kind}/std")
    ax.set(title=f"{kind}: {within[0]} within 1 sigma, {within[1]} within 2"
                 + ("" if spread is None else f"\nstandard deviation of the z-scores {spread:.3g}"),
           xlabel="k (sigma)", ylabel="errors within k sigma (%)", xlim=(0, 4), ylim=(0, 103))
    ax.set_box_aspect(1)
    if k.size == 0 or k.size != found.size:
        maps.notice(ax, "no z-score")
        return
    steps = np.linspace(0, 4, 161)
    ax.plot(steps, [100 * math.erf(step / math.sqrt(2)) for step in steps], color="black", linewidth=1,
            label="normal distribution")
    ax.plot(np.append(0, k), 100 * np.append(0, found), color=maps.BLUE, marker="o", markersize=4, linewidth=1,
            label="measured")
    ax.grid(True, color="#e0e0e0", linewidth=0.6)
    ax.legend(loc="lower right")
