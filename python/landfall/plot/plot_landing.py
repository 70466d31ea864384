# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the landings of a draws.h5 that monte-carlo made with landing: the touchdowns with the lidar and without, safe and not, the
distance that the lander diverted, and slope and roughness on the true terrain against their limits.
"""

import numpy as np

from landfall.errors import DataError
from landfall.plot import captions, maps, plot_command
from landfall.plot.plot_draws import draw_terrain, Draws

ARMS = {"landing": "with the lidar", "blind": "without a lidar"}


parse = plot_command.parser_of(__doc__, {"draws": "DRAWS"}, ending="-landing.png")


def frame(ax, draws):
    """Axes of the site; its half width is that of all touchdowns, and at least that of the map."""
    reach = [np.nanmax(np.abs(draws.columns[f"{arm}.{axis}"])) for arm in ARMS for axis in ("x_m", "y_m")]
    half = max(reach + ([abs(draws.grid.x[0]), abs(draws.grid.y[0])] if draws.grid is not None else [])) * 1.05
    ax.set(xlim=(-half, half), ylim=(-half, half), xlabel="x (m)", ylabel="y (m)")
    ax.set_aspect("equal")


def draw_touchdowns(ax, draws, arm):
    if draws.grid is not None:
        draw_terrain(ax, draws)
    x, y, slope, safe = (draws.columns[f"{arm}.{name}"] for name in ("x_m", "y_m", "slope_deg", "safe"))
    safe, over_terrain = safe == 1, ~np.isnan(slope)
    for shown, color, marker, label in ((safe, maps.BLUE, "o", "safe"), (~safe & over_terrain, maps.VERMILION, "X", "not safe"),
                                        (~over_terrain, "black", "1", "over no terrain")):
        if shown.any():
            ax.scatter(x[shown], y[shown], s=28, color=color, marker=marker, alpha=0.6, linewidths=0 if marker != "1" else 1,
                       label=f"{label}: {np.count_nonzero(shown)}", gid=f"{arm}-{label.replace(' ', '-')}")
    ax.set_title(f"touchdowns {ARMS[arm]}")
    frame(ax, draws)
    if arm == "landing":
        draw_reach(ax, draws)
    ax.legend(loc="upper right", fontsize=maps.NOTE_PT)
    rate = draws.verdict["landing"]["safe" if arm == "landing" else "blind"]
    text = f"{rate['passed']} of {rate['draws']} safe"
    if "note" not in draws.verdict["landing"]:
        text += f": {rate['wilson_low']:.3f} to {rate['wilson_high']:.3f} (Wilson, 95 %)"
    maps.note(ax, text)


def draw_reach(ax, draws):
    """The border of the places among which sites were looked for, as configured: a circle, a polygon, or the lens of a divert
    (docs/user/hazard-map.md)."""
    radius_m = draws.config.get("hazard/sites/divert_radius_m")
    style = {"color": "black", "linestyle": ":", "label": "border of the places within reach"}
    border = reach_border(draws.config, "hazard/sites/reach")
    if border is not None:
        ax.plot(*border.T, gid="reach", scalex=False, scaley=False, **style)
    elif radius_m is not None:
        ax.add_patch(maps.plt.Circle((0, 0), radius_m, fill=False, **{**style, "label": f"divert radius {radius_m:g} m"}))


def reach_border(config, path):
    """Points of the border, closed, of a configured polygon, or of the places within b T^2/4 of both position + v T/4 and position + 3 v T/4
    (none where there are no such places). None where no reach is configured."""
    number = lambda key: config.get(f"{path}/{key}")
    if number("height_m") is None:
        polygon = config.get(path)
        return None if polygon is None else np.array([*polygon, polygon[0]])
    time_s = 2 * number("height_m") / number("descent_mps")
    vertical = number("gravity_mps2") + number("descent_mps") ** 2 / (2 * number("height_m"))
    horizontal = min(vertical * np.tan(np.radians(number("tilt_deg"))), np.sqrt(number("thrust_accel_mps2") ** 2 - vertical ** 2))
    velocity, start, radius_m = np.array(number("velocity_mps")), np.array(number("position_m")), horizontal * time_s ** 2 / 4
    angles = np.linspace(0, 2 * np.pi, 721)
    rings = [start + share * velocity * time_s + radius_m * np.column_stack([np.cos(angles), np.sin(angles)]) for share in (0.25, 0.75)]
    centres = [start + share * velocity * time_s for share in (0.75, 0.25)]
    arcs = np.vstack([ring[np.hypot(*(ring - centre).T) <= radius_m * (1 + 1e-9)] for ring, centre in zip(rings, centres)])
    middle = start + velocity * time_s / 2
    order = np.argsort(np.arctan2(*(arcs - middle).T[::-1]))
    return arcs[[*order, order[0]]] if len(arcs) else arcs


def draw_diverts(ax, draws):
    distance = np.hypot(draws.columns["site.x_m"], draws.columns["site.y_m"])
    known = ~np.isnan(distance)
    ax.set(title="divert to the best site", xlabel="distance from the origin (m)", ylabel="draws")
    if known.any():
        ax.hist(distance[known], 30, color=maps.BLUE, gid="diverts")
        ax.yaxis.get_major_locator().set_params(integer=True)
    maps.note(ax, f"{np.count_nonzero(known)} of {draws.count()} draws have a site")


def draw_margin(ax, draws, column, key, unit):
    """The distribution of what decides a landing, for both arms, and its limit."""
    limit = draws.config.get(f"hazard/limits/{key}")
    for (arm, label), color in zip(ARMS.items(), (maps.BLUE, maps.VERMILION)):
        values = draws.columns[f"{arm}.{column}"]
        values = np.sort(values[~np.isnan(values)])
        if values.size:
            ax.step(values, np.arange(1, values.size + 1) / values.size, where="post", color=color, label=label, gid=arm)
    if limit is not None:
        ax.axvline(limit, color="black", linestyle="--", label=f"limit: at most {limit:g}", gid="limit")
    ax.set(title=column.split("_", maxsplit=1)[0] + " on the true terrain", xlabel=unit, ylabel="share of landings at most this", ylim=(0, 1.02))
    ax.legend(fontsize=maps.NOTE_PT, loc="lower right")


def draw_pairs(ax, draws):
    """The paired table in words."""
    landing = draws.verdict["landing"]
    ax.set_axis_off()
    difference = landing["difference"]
    lines = [f"safe with and without a lidar: {landing['both']}", f"only with the lidar: {landing['only_lidar']}",
             f"only without: {landing['only_blind']}", f"neither: {landing['neither']}", "",
             f"P(safe, lidar) - P(safe, blind) = {difference['value']:+.3f}"]
    lines += [landing["note"]] if "note" in landing else [f"{difference['low']:+.3f} to {difference['high']:+.3f} (Newcombe, 95 %)",
                                                          f"McNemar's exact p = {landing['mcnemar_p']:.2g}"]
    ax.text(0.05, 0.95, "\n".join(lines), va="top", fontsize=13, linespacing=1.6, gid="pairs")


def draw(draws):
    landing = draws.verdict["landing"]
    title = f"{draws.name}: {captions.counted(draws.count(), 'landing')}, safe with the lidar {landing['safe']['passed']}, without {landing['blind']['passed']}"
    figure, axes = maps.new_figure((2, 3), (19, 11), title)
    for ax, arm in zip(axes[0], ARMS):
        draw_touchdowns(ax, draws, arm)
    draw_pairs(axes[0, 2], draws)
    draw_diverts(axes[1, 0], draws)
    draw_margin(axes[1, 1], draws, "slope_deg", "slope_deg", "slope (degrees)")
    draw_margin(axes[1, 2], draws, "roughness_m", "roughness_m", "roughness (m)")
    return figure


def figure_of(options):
    draws = Draws(options.draws)
    if "landing.safe" not in draws.columns:
        raise DataError(f"{draws.name}: has no landings; make it with the section landing")
    return draw(draws)


main = plot_command.main_of(parse, figure_of)
