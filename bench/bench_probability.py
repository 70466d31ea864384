#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How well p_safe of hazard-map is calibrated: the share of truly safe places beside p, over sites of several kinds of terrain.

  bench/bench_probability.py --folder DIR [--bin build/release/bin] [--families rocks,..] [--cells 5-16.7,..] [--sites 16] [--seed 9100]
                             [--figure FILE.png] [--before FOLDER] [--raster FILE.tif] [--table-only]

A site is 17 m of ground with nodes of 2.5 cm, judged within 7.3 m of its origin. A family is a kind of terrain:

  isolated    half ellipsoids 1.2 m wide and 0.25 .. 0.55 m high, 4 m apart, on a plane
  rocks       fractal terrain (H 0.7, 0.8; 0.1 .. 0.3 m at 10 m) with Golombek's rocks, k = 0.05 and 0.2
  craters     craters in equilibrium on fractal terrain of 0.1 m
  fractal     H 0.5 .. 0.9, 0.28 .. 0.5 m at 10 m
  dunes       three bent waves of 2.5 .. 8 m
  smooth      a raster of 2 m posting, interpolated bicubically
  hirise      part of --raster, of 1 m posting, with fractal relief of 4 cm at 1 m; only with that option
  steps       nine vertical steps of 5 .. 35 cm on nearly level terrain
  plane9.5    a plane of 9.5 deg (or any other slope), whose mean p is printed

and a cell, BINS-NOISE, the bins' edge in cm and the range noise in mm. Four sites of five have 3.2 returns in a bin of 5 cm or 0.9 of that, one
has 9.6; of every second one the map is moved by a random part of a bin of 5 cm. Limits are 10 deg and 0.3 m; of isolated, rocks and steps also
30 deg.

A tenth shows the share of truly safe places less the mean of p, with its standard error over sites: SE^2 = S/(S-1) sum_s (Y_s - P_s - d n_s)^2 /
(sum n)^2, Y_s the safe places, P_s the sum of p, n_s the places of site s; "!" marks what is not within -0.08 .. 0.10 and two errors. Tenths of
fewer than 200 places or 3 sites are left out. The tail are the places that are judged safe with p >= 0.99: unsafe / predicted / all. The Brier
scores are those of p, of the release of --before, and of the decision by the limits. A second table has the places that are ranked: ten of a site,
1.5 m apart, by p_touchdown for three touchdown sigmas: its mean, and the share of touchdowns that meet a truly safe place. Results are kept in the
folder, and a stopped bench resumes: a site in all cells takes about 15 s of two cores.
"""
import argparse
import json
import os
import random
import subprocess
import sys
import tempfile

import h5py
import numpy as np

HALF_M, NODE_M, RADIUS_M = 8.4, 0.025, 7.3
CELLS = [f"{edge}-{noise}" for edge in (5, 10, 20) for noise in ("3", "16.7", "50")]
FAMILIES = ("isolated", "rocks", "craters", "fractal", "dunes", "smooth", "hirise", "steps")
STEEP = ("isolated", "rocks", "steps")
SIGMAS_M = (0, 0.3, 1)


def fractal(hurst, deviation_m, length_m=10):
    return {"type": "fractal", "hurst_exponent": hurst, "reference_length_m": length_m, "rms_deviation_m": deviation_m}


def write_raster(path, z, posting_m):
    from osgeo import gdal, osr  # pylint: disable=import-outside-toplevel
    gdal.UseExceptions()
    raster = gdal.GetDriverByName("GTiff").Create(path, len(z), len(z), 1, gdal.GDT_Float32)
    raster.SetGeoTransform((0, posting_m, 0, posting_m * len(z), 0, -posting_m))
    frame = osr.SpatialReference()
    frame.SetLocalCS("site")
    frame.SetLinearUnits("metre", 1.0)
    raster.SetProjection(frame.ExportToWkt())
    raster.GetRasterBand(1).WriteArray(z.astype("f4"))


def random_field(seed):
    """32 x 32 values of a power spectrum that falls, scaled by their rms difference over 5."""
    rng, n = np.random.default_rng(seed), 32
    frequency = np.hypot(*np.meshgrid(np.fft.fftfreq(n), np.fft.fftfreq(n)))
    frequency[0, 0] = 1
    spectrum = np.fft.fft2(rng.normal(size=(n, n))) * frequency**-(1 + (0.6, 0.8, 0.9)[seed % 3])
    spectrum[0, 0] = 0
    z = np.fft.ifft2(spectrum).real
    return z * (0.5, 0.8, 1.1, 1.4)[seed % 4] / np.sqrt(np.mean((z - np.roll(z, 5, 0))**2))


def part_of_raster(path, seed):
    """40 x 40 pixels about a random place."""
    from osgeo import gdal  # pylint: disable=import-outside-toplevel
    z = gdal.Open(path).ReadAsArray().astype(float)
    row, column = np.random.default_rng(seed).integers(40, np.array(z.shape) - 80)
    return z[row:row + 40, column:column + 40] - z[row:row + 40, column:column + 40].mean()


def dunes(rng):
    waves = [(rng.uniform(2.5, 8), *rng.uniform(0, 2 * np.pi, 2), rng.uniform(0.1, 0.25)) for _ in range(3)]

    def height(x, y):
        phases = [((x * np.cos(angle) + y * np.sin(angle)) * 2 * np.pi / length + phase, slope * length / 2 / np.pi)
                  for length, angle, phase, slope in waves]
        return sum(scale * (np.sin(u) + np.sin(2 * u) / 4) for u, scale in phases)
    return height


def steps(rng):
    edges = [(rng.uniform(-8, 8), rng.uniform(0, 2 * np.pi), rng.uniform(0.05, 0.35)) for _ in range(9)]

    def height(x, y):
        across = [(x * np.cos(a) + y * np.sin(a) - o + 0.4 * np.sin(0.9 * (y * np.cos(a) - x * np.sin(a)) + o), h) for o, a, h in edges]
        return sum(h * ((u > 0) - 0.5) for u, h in across) + 0.02 * np.sin(x) * np.cos(0.7 * y)
    return height


def ground(family, seed, raster, source):
    """The terrain's configuration, and a function of x and y that replaces its elevations, or None."""
    rng = np.random.default_rng(seed)
    if family == "isolated":
        rocks = [{"type": "rock", "x_m": 4 * i + rng.uniform(-0.5, 0.5), "y_m": 4 * j + rng.uniform(-0.5, 0.5), "diameter_m": 1.2,
                  "axis_ratio": rng.uniform(0.6, 1), "height_m": rng.uniform(0.25, 0.55), "yaw_deg": rng.uniform(0, 180)}
                 for i in range(-2, 3) for j in range(-2, 3)]
        return {"base": {"type": "plane"}, "features": rocks}, None
    if family == "rocks":
        return {"base": fractal((0.8, 0.7)[seed % 2], (0.1, 0.2, 0.3)[seed % 3]),
                "patterns": [{"type": "golombek_rocks", "k": (0.05, 0.2)[seed % 2], "min_diameter_m": 0.1}]}, None
    if family == "craters":
        return {"base": fractal(0.8, 0.1), "patterns": [{"type": "craters", "model": "trask", "min_diameter_m": 1.0}]}, None
    if family == "fractal":
        return {"base": fractal((0.5, 0.6, 0.7, 0.8, 0.9)[seed % 5], (0.28, 0.4, 0.5)[seed % 3])}, None
    if family in ("dunes", "steps"):
        return {"base": {"type": "plane"}}, {"dunes": dunes, "steps": steps}[family](rng)
    if family.startswith("plane"):
        return {"base": {"type": "plane", "slope_x": np.tan(np.radians(float(family[5:])))}}, None
    dem = {"type": "dem", "path": raster}
    write_raster(raster, random_field(seed) if family == "smooth" else part_of_raster(source, seed), 2 if family == "smooth" else 1)
    return {"base": dem if family == "smooth" else [dem, fractal(0.7, 0.04, 1)]}, None


class Site:
    """One ground, and its maps in a temporary folder."""

    def __init__(self, options, folder, family, seed):
        self.options, self.folder, self.family, self.seed = options, folder, family, seed
        config, height = ground(family, seed, self.path("raster.tif"), options.raster)
        self.write("terrain.json", {**config, "grid": {"half_width_m": HALF_M + 1.6, "resolution_m": NODE_M}, "seed": seed})
        self.run("terrain-gen", "-c", self.path("terrain.json"), "-o", self.path("terrain.h5"))
        if height:
            with h5py.File(self.path("terrain.h5"), "r+") as file:
                file["z"][...] = height(*np.meshgrid(file["x"], file["y"]))

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, config):
        with open(self.path(name), "w", encoding="utf-8") as file:
            json.dump(config, file)

    def run(self, tool, *arguments, binaries=None):
        command = [os.path.join(binaries or self.options.bin, tool), *map(str, arguments), "-O", "-q"]
        result = subprocess.run(command, capture_output=True, text=True, check=False)
        if result.returncode != 0:
            sys.exit(f"{' '.join(command)}\nexit {result.returncode}: {result.stderr}")

    def map(self, cell):
        """Scans and grids the ground; returns the bins' edge."""
        edge, noise = cell.split("-")
        rng, share = random.Random(f"{self.seed} {noise}"), (1, 1, 1, 3, 0.9)[self.seed % 5]**0.5
        rows, columns = round(43 * share), round(29 * share)
        moved = [rng.uniform(-0.025, 0.025), rng.uniform(-0.025, 0.025), 0.05] if self.seed % 2 else [0, 0, 0]
        self.write("scan.json", {
            "detector": {"rows": 18, "columns": 18, "ifov_rad": 8.888888888888889e-5},
            "laser": {"pulse_rate_hz": 20000, "scan_time_s": rows * columns / 20000},
            "scanner": {"type": "fsm", "incidence_deg": 0, "pattern": {"type": "line_search", "rows": rows, "columns": columns, "half_width_m": 8.9}},
            "trajectory": {"type": "constant_velocity", "position_m": [0, 0, 500], "velocity_mps": [0, 0, -23]},
            "noise": {"range_sigma_m": float(noise) / 1000}, "navigation_error": {"position_m": moved}, "seed": self.seed})
        self.run("scan-sim", "-c", self.path("scan.json"), "--terrain", self.path("terrain.h5"), "-o", self.path("scan.h5"))
        self.run("regrid", self.path("scan.h5"), "--terrain", self.path("terrain.h5"), "-o", self.path("dem.h5"), "--uncertainty",
                 "--set", f"half_width_m={HALF_M}", "--set", f"resolution_m={int(edge) / 100}", "--navigation-sigma", "position_m=0.015")
        return int(edge) / 100

    def judge(self, limit, binaries=None):
        self.run("hazard-map", self.path("dem.h5"), "-o", self.path("hazards.h5"), "--set", f"region_radius_m={RADIUS_M}",
                 "--set", f"limits.slope_deg={limit}", binaries=binaries)
        with h5py.File(self.path("hazards.h5")) as file:
            return {layer: file[layer][()] for layer in ("safe", "p_safe", "safe_true")}

    def results(self, cell):
        """{name: values} of a cell: p, decision and truth for each limit, and the ranked places."""
        resolution, found = self.map(cell), {}
        for limit in (10, 30) if self.family in STEEP else (10,):
            layers = self.judge(limit)
            inside = np.isfinite(layers["p_safe"]) & (layers["safe_true"] != 2) & (layers["safe"] != 2)
            found.update({f"p{limit}": layers["p_safe"][inside], f"s{limit}": layers["safe"][inside], f"t{limit}": layers["safe_true"][inside],
                          f"r{limit}": np.array([ranked(layers, resolution, sigma) for sigma in SIGMAS_M])})
            if self.options.before:
                found[f"b{limit}"] = self.judge(limit, self.options.before)["p_safe"][inside]
        return found


def smoothed(values, resolution, sigma):
    if sigma == 0:
        return values
    reach = int(3 * sigma / resolution + 1e-9)
    weight = np.exp(-0.5 * (np.arange(-reach, reach + 1) * resolution / sigma)**2)
    for axis in (0, 1):
        values = np.apply_along_axis(np.convolve, axis, values, weight / weight.sum(), "same")
    return values


def ranked(layers, resolution, sigma):
    """Number, sum of p_touchdown and of the true share of touchdowns of ten places 1.5 m apart, best first."""
    known = layers["safe"] != 2
    p = smoothed(np.where(known, np.nan_to_num(layers["p_safe"]), 0), resolution, sigma)
    true = smoothed((known & (layers["safe_true"] == 1)).astype(float), resolution, sigma)
    row, column = np.indices(p.shape) - p.shape[0] // 2
    left, found = (layers["safe"] == 1) & (np.hypot(row, column) * resolution <= RADIUS_M - 3 * sigma), np.zeros(3)
    for _ in range(10):
        if not left.any():
            break
        best = np.unravel_index(np.argmax(np.where(left, p, -1)), p.shape)
        found += 1, p[best], true[best]
        left &= np.hypot(row - row[best], column - column[best]) * resolution >= 1.5
    return found


def kept(options, family, cell, seed):
    return os.path.join(options.folder, f"{family}-{cell}-{seed}.npz")


def measure(options):
    for seed in range(options.seed, options.seed + options.sites):
        for family in options.families:
            cells = [cell for cell in options.cells if not os.path.exists(kept(options, family, cell, seed))]
            if not cells:
                continue
            with tempfile.TemporaryDirectory(dir=options.folder) as folder:
                site = Site(options, folder, family, seed)
                for cell in cells:
                    np.savez_compressed(kept(options, family, cell, seed), **site.results(cell))
        print(f"{seed - options.seed + 1} of {options.sites} sites", file=sys.stderr)


def rows(options):
    """(family, limit, cell, the results of its sites)."""
    for family in options.families:
        for limit in (10, 30) if family in STEEP else (10,):
            for cell in options.cells:
                paths = [kept(options, family, cell, seed) for seed in range(options.seed, options.seed + options.sites)]
                sites = [np.load(path) for path in paths if os.path.exists(path)]
                if sites:
                    yield family, limit, cell, [{name[0]: site[name] for name in site.files if name[1:] == str(limit)} for site in sites]


def off_with_error(sites, chosen):
    """(share less mean p, its standard error) of the chosen places; None where they are too few."""
    counts = np.array([np.count_nonzero(chosen(site)) for site in sites])
    off = np.array([np.sum((site["t"] - site["p"].astype(float))[chosen(site)]) for site in sites])
    if counts.sum() < 200 or np.count_nonzero(counts) < 3:
        return None
    mean = off.sum() / counts.sum()
    return mean, np.sqrt(len(sites) / (len(sites) - 1) * np.sum((off - mean * counts)**2)) / counts.sum()


def tenths(sites):
    return [off_with_error(sites, lambda site, k=k: np.minimum((10 * site["p"]).astype(int), 9) == k) for k in range(10)]


def tenth_text(tenth):
    if tenth is None:
        return ""
    off, error = tenth
    return f"{off:+.2f}" + ("" if -0.08 - 2 * error <= off <= 0.1 + 2 * error else " !")


def tail_text(sites):
    def of(site):
        chosen = (site["p"] >= 0.99) & (site["s"] == 1)
        return np.count_nonzero(site["t"][chosen] == 0), np.sum(1 - site["p"][chosen].astype(float)), np.count_nonzero(chosen)
    found = np.array([of(site) for site in sites])
    error = np.sqrt(len(found)) * np.std(found[:, 0] - 1.5 * found[:, 1], ddof=1) if len(found) > 1 else 0
    unsafe, predicted, count = found.sum(0)
    return f"{unsafe:.0f} / {predicted:.0f} / {count:.0f}" + (" !" if unsafe > 1.5 * predicted + 2 * error else "")


def table(options):
    print("| family | limit | cell | sites |", " | ".join(f"{k / 10:.1f}" for k in range(10)), "| tail | Brier score | before | of `safe` |")
    print("|---" * 18 + "|")
    for family, limit, cell, sites in rows(options):
        def brier(name):
            if any(name not in site for site in sites):
                return ""
            return f"{np.concatenate([(site[name].astype(float) - site['t'])**2 for site in sites]).mean():.4f}"
        print(f"| {family} | {limit} | {cell} | {len(sites)} |", " | ".join(map(tenth_text, tenths(sites))),
              f"| {tail_text(sites)} | {brier('p')} | {brier('b')} | {brier('s')} |")


def ranked_table(options):
    print("\n| family | limit | cell |", " | ".join(f"sigma {sigma} m: places, mean p_touchdown, true share" for sigma in SIGMAS_M), "|")
    print("|---" * 6 + "|")
    for family, limit, cell, sites in rows(options):
        print(f"| {family} | {limit} | {cell} |", " | ".join(
            f"{n:.0f}, {p / max(n, 1):.3f}, {t / max(n, 1):.3f}" for n, p, t in sum(site["r"] for site in sites)), "|")


def figure(options):
    import matplotlib  # pylint: disable=import-outside-toplevel
    matplotlib.use("Agg")
    from matplotlib import pyplot  # pylint: disable=import-outside-toplevel
    found = {row[:3]: tenths(row[3]) for row in rows(options)}
    lines = -(-len(options.cells) // 3)
    drawn, axes = pyplot.subplots(lines, 3, figsize=(9.5, 0.6 + 3.1 * lines), sharex=True, sharey=True, squeeze=False)
    for ax, cell in zip(axes.flat, options.cells):
        ax.fill_between([0, 1], [-0.08, 0.92], [0.1, 1.1], color="0.92", label="wanted")
        ax.plot([0, 1], [0, 1], color="0.5", lw=0.8)
        for number, family in enumerate(options.families):
            points = [(k / 10 + 0.05, *tenth) for k, tenth in enumerate(found.get((family, 10, cell), ())) if tenth]
            if points:
                middle, off, error = map(np.array, zip(*points))
                ax.errorbar(middle, middle + off, 2 * error, color=f"C{number}", marker="o", ms=3, lw=1, elinewidth=0.7, label=family)
        edge, noise = cell.split("-")
        ax.set(title=f"bins of {edge} cm, {noise} mm of noise", xlim=(0, 1), ylim=(0, 1), aspect="equal")
    for ax in axes.flat[len(options.cells):]:
        ax.set_axis_off()
    for ax in axes.flat[max(len(options.cells) - 3, 0):len(options.cells)]:
        ax.xaxis.set_tick_params(labelbottom=True)
        ax.set_xlabel("p_safe, middle of each tenth")
    for ax in axes[:, 0]:
        ax.set_ylabel("share truly safe")
    handles = {label: handle for ax in axes.flat for handle, label in zip(*ax.get_legend_handles_labels())}
    drawn.legend(handles.values(), handles.keys(), loc="upper center", ncol=len(handles), fontsize=9)
    drawn.tight_layout(rect=(0, 0, 1, 1 - 0.35 / drawn.get_figheight()))
    drawn.savefig(options.figure, dpi=100, metadata={"Software": None})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", default="build/release/bin", help="folder of the tools")
    parser.add_argument("--folder", required=True, help="where the results are kept")
    parser.add_argument("--families", type=lambda names: names.split(","), default=list(FAMILIES))
    parser.add_argument("--cells", type=lambda names: names.split(","), default=CELLS)
    parser.add_argument("--sites", type=int, default=16)
    parser.add_argument("--seed", type=int, default=9100, help="seed of the first site")
    parser.add_argument("--figure", help="reliability diagrams")
    parser.add_argument("--before", metavar="FOLDER", help="tools of another release, whose p_safe is compared")
    parser.add_argument("--raster", help="elevations of 1 m posting, for hirise")
    parser.add_argument("--table-only", action="store_true", help="of what is there")
    options = parser.parse_args()
    if not options.raster:
        options.families = [family for family in options.families if family != "hirise"]
    if not options.table_only:
        measure(options)
    if all(family.startswith("plane") for family in options.families):
        for family, _, cell, sites in rows(options):
            print(f"{family} {cell}: mean p {np.concatenate([site['p'] for site in sites]).mean():.5f}, {len(sites)} sites")
        return
    table(options)
    ranked_table(options)
    if options.figure:
        figure(options)


if __name__ == "__main__":
    main()
