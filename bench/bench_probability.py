#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How well p_safe of hazard-map is calibrated: the share of truly safe places in each tenth of p, over sites of several kinds of ground.

  bench/bench_probability.py --folder DIR [--bin build/release/bin] [--families rocks,..] [--cells base,..] [--sites 20] [--seed 9100]
                             [--figure FILE.png] [--before FOLDER]

A site is 26 m of ground with nodes of 2.5 cm, judged within 12 m of its origin. A family is a kind of ground:

  rocks       fractal ground (H 0.7, 0.8; 0.2 .. 0.4 m at 10 m) with rocks, k = 0.05 .. 0.2
  fractal     H 0.5 .. 0.8, 0.2 .. 0.8 m at 10 m, without rocks
  craters     craters in equilibrium on fractal ground of 0.1 m
  smooth      a raster of 2 m posting, interpolated bicubically
  smoothfine  the same with fractal relief of 5 cm at 2 m
  blocks      blocks of ice with vertical sides on a tenth of the area
  plane9.5    a plane of 9.5 deg (or any other slope), whose mean p is printed

and a cell one setting of the chain: base (1.67 cm of range noise, bins of 5 cm, 3.1 returns per bin, a slope limit of 10 deg, the map
moved by a random fraction of a bin), n5 (5 cm of noise), b10 (bins of 10 cm), v3 (0.3 m/s of velocity error), thin2 and thin15 (2 and 1.5
returns per bin, 10 % dropouts), and limit30 (base with a slope limit of 30 deg).

Each tenth shows the share less the mean of p, with its standard error over sites: SE^2 = S/(S-1) sum_s (Y_s - P_s - d n_s)^2 / (sum n)^2, Y_s
the safe places, P_s the sum of p, n_s the places of site s. Tenths of fewer than 1,000 places or 8 sites are left out. The Brier scores are those
of p, and of the decision by the limits at the places that are known. A second table does the same for p_touchdown, whose truth is the
share of touchdowns that meet a place that is truly safe and not unknown in the map; its last column has the sites that hazard-map ranked:
their number, mean p_safe and the share truly safe. With --before, the hazard-map of another release judges the same DEMs, and a third
table has the Brier scores of both. Results are kept in the folder, and a stopped bench resumes: 20 sites of one family in all cells take
about 6 minutes of two cores.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile

import h5py
import numpy as np

HALF_M, NODE_M, RADIUS_M = 13.0, 0.025, 12
PATTERN = (79, 52)  # images of Example 2's raster, for its returns per bin
CELLS = {"base": {}, "n5": {"sigma": 0.05}, "b10": {"resolution": 0.1}, "v3": {"velocity": 0.3},
         "thin2": {"returns": 2 / 3.2, "dropouts": 0.1}, "thin15": {"returns": 1.5 / 3.2, "dropouts": 0.1}}
LIMITS_DEG = {"base": (10, 30)}
FAMILIES = ("rocks", "fractal", "craters", "smooth", "smoothfine", "blocks")


def fractal(hurst, deviation_m, length_m=10):
    return {"type": "fractal", "hurst_exponent": hurst, "reference_length_m": length_m, "rms_deviation_m": deviation_m}


def ground(family, seed, raster):
    """The base and the patterns of a site."""
    if family == "rocks":
        return fractal((0.8, 0.7)[seed % 2], (0.2, 0.3, 0.4)[seed % 3]), \
            [{"type": "golombek_rocks", "k": (0.05, 0.08, 0.1, 0.15, 0.2)[seed % 5], "min_diameter_m": 0.1}]
    if family == "fractal":
        return fractal((0.5, 0.6, 0.7, 0.8)[seed % 4], (0.2, 0.35, 0.5, 0.65, 0.8)[seed % 5]), []
    if family == "craters":
        return fractal(0.8, 0.1), [{"type": "craters", "model": "trask", "min_diameter_m": 1.0}]
    if family == "blocks":
        return fractal(0.7, 0.25), [{"type": "ice_blocks", "area_fraction": 0.1}]
    if family.startswith("plane"):
        return {"type": "plane", "slope_x": np.tan(np.radians(float(family[5:])))}, []
    make_raster(raster, seed)
    dem = {"type": "dem", "path": raster}
    return (dem if family == "smooth" else [dem, fractal(0.7, 0.05, 2)]), []


def make_raster(path, seed):
    """32 x 32 pixels of 2 m: a random field of a power spectrum that falls, scaled by its rms difference over 10 m."""
    from osgeo import gdal, osr  # pylint: disable=import-outside-toplevel
    rng, n = np.random.default_rng(seed), 32
    frequency = np.hypot(*np.meshgrid(np.fft.fftfreq(n), np.fft.fftfreq(n)))
    frequency[0, 0] = 1
    spectrum = np.fft.fft2(rng.normal(size=(n, n))) * frequency**-(1 + (0.6, 0.8, 0.9)[seed % 3])
    spectrum[0, 0] = 0
    z = np.fft.ifft2(spectrum).real
    z *= (0.5, 0.8, 1.1, 1.4)[seed % 4] / np.sqrt(np.mean((z - np.roll(z, 5, 0))**2))
    gdal.UseExceptions()
    raster = gdal.GetDriverByName("GTiff").Create(path, n, n, 1, gdal.GDT_Float32)
    raster.SetGeoTransform((0, 2, 0, 2 * n, 0, -2))
    frame = osr.SpatialReference()
    frame.SetLocalCS("site")
    frame.SetLinearUnits("metre", 1.0)
    raster.SetProjection(frame.ExportToWkt())
    raster.GetRasterBand(1).WriteArray(z.astype("f4"))


class Site:
    """One ground, and its maps in a temporary folder."""

    def __init__(self, options, folder, family, seed):
        self.bin, self.before, self.folder, self.seed = options.bin, options.before, folder, seed
        base, patterns = ground(family, seed, self.path("raster.tif"))
        config = {"grid": {"half_width_m": HALF_M + 2, "resolution_m": NODE_M}, "seed": seed, "base": base}
        if patterns:
            config["patterns"] = patterns
        with open(self.path("terrain.json"), "w", encoding="utf-8") as file:
            json.dump(config, file)
        self.run("terrain-gen", "-c", self.path("terrain.json"), "-o", self.path("terrain.h5"))

    def path(self, name):
        return os.path.join(self.folder, name)

    def run(self, tool, *arguments, binaries=None):
        command = [os.path.join(binaries or self.bin, tool), *map(str, arguments), "-O", "-q"]
        result = subprocess.run(command, capture_output=True, text=True, check=False)
        if result.returncode != 0:
            sys.exit(f"{' '.join(command)}\nexit {result.returncode}: {result.stderr}")

    def map(self, cell):
        """Scans and grids the ground; returns the bins' centres and where the lander believes them to be."""
        setting, rng = CELLS[cell], np.random.default_rng(self.seed * 7 + len(cell))
        resolution = setting.get("resolution", 0.05)
        share = setting.get("returns", 1)**0.5
        offset = rng.uniform(-0.5, 0.5, 2) * resolution
        values = {"scanner.pattern.rows": round(PATTERN[0] * share), "scanner.pattern.columns": round(PATTERN[1] * share),
                  "scanner.pattern.half_width_m": 16, "laser.scan_time_s": 0.2054 * share * share, "seed": self.seed,
                  "navigation_error.position_m": [*offset, rng.normal() * 0.1], "noise.range_sigma_m": setting.get("sigma", 0.05 / 3),
                  "noise.dropout_frac": setting.get("dropouts", 0)}
        speed = setting.get("velocity", 0)
        if speed:
            angle = rng.uniform(0, 2 * np.pi)
            values["navigation_error.velocity_mps"] = [speed * np.cos(angle), speed * np.sin(angle), speed * rng.normal() / 2]
        self.run("scan-sim", "-c", "preset:paper", *(word for key, value in values.items() for word in ("--set", f"{key}={json.dumps(value)}")),
                 "--terrain", self.path("terrain.h5"), "-o", self.path("scan.h5"))
        sigmas = {"navigation_sigma": {"position_m": [0, 0, 0], "velocity_mps": [speed] * 3}}
        self.run("regrid", self.path("scan.h5"), "-o", self.path("dem.h5"), "--uncertainty", "--set", f"half_width_m={HALF_M}",
                 "--set", f"resolution_m={resolution}", "--set", "uncertainty=" + json.dumps(sigmas))
        return resolution, not speed

    def truth(self, resolution, is_rigid):
        """A terrain file with the ground under each bin's true place, also where no return fell."""
        with h5py.File(self.path("dem.h5")) as file:
            moved = [file[f"{axis}_true"][()] - file[f"{axis}_est_mean"][()] for axis in "xy"]
        moved = [np.where(np.isnan(values) | is_rigid, np.nanmean(values), values) for values in moved]
        with h5py.File(self.path("terrain.h5")) as file:
            z, first = file["z"][()], file["x"][0]
        n = round(HALF_M / resolution)
        x, y = np.meshgrid(np.arange(-n, n + 1) * resolution, np.arange(-n, n + 1) * resolution)
        column, row = (x + moved[0] - first) / NODE_M, (y + moved[1] - first) / NODE_M
        i, j = np.floor(column).astype(int), np.floor(row).astype(int)
        u, v = column - i, row - j
        below, above = z[j, i] * (1 - u) + z[j, i + 1] * u, z[j + 1, i] * (1 - u) + z[j + 1, i + 1] * u
        self.run("terrain-gen", "-o", self.path("truth.h5"), "--set", f'grid={{"half_width_m": {HALF_M}, "resolution_m": {resolution}}}')
        with h5py.File(self.path("truth.h5"), "r+") as file:
            file["z"][...] = below * (1 - v) + above * v

    def judge(self, name, limit, *options, binaries=None):
        self.run("hazard-map", self.path(name), "-o", self.path("hazards.h5"), "--no-truth", "--set", f"region_radius_m={RADIUS_M}",
                 "--set", f"limits.slope_deg={limit}", *options, binaries=binaries)
        with h5py.File(self.path("hazards.h5")) as file:
            found = {layer: file[layer][()] for layer in ("safe", "p_safe", "p_touchdown") if layer in file}
            if "sites" in file:
                found["places"] = np.stack([file[f"sites/{axis}"][()] for axis in "xy"], -1)
            return found

    def results(self, cell):
        """{name: layer} of a cell: p, decision and truth for each limit."""
        resolution, is_rigid = self.map(cell)
        self.truth(resolution, is_rigid)
        found = {}
        for limit in LIMITS_DEG.get(cell, (10,)):
            fill = ["--set", "hole_fill_bins=1000"] if CELLS[cell].get("dropouts") else []
            judged = self.judge("dem.h5", limit, *fill)
            true = self.judge("truth.h5", limit)
            found.update({f"p{limit}": judged["p_safe"], f"s{limit}": judged["safe"], f"t{limit}": true["safe"],
                          f"q{limit}": judged["p_touchdown"], f"r{limit}": ranked(judged, true, resolution)})
            if self.before:
                found[f"b{limit}"] = self.judge("dem.h5", limit, *fill, binaries=self.before)["p_safe"]
        return found


def ranked(judged, true, resolution):
    """p_safe and truth of the places that hazard-map ranked."""
    column, row = (np.round(judged.get("places", np.empty((0, 2))) / resolution).astype(int) + judged["safe"].shape[0] // 2).T
    return np.stack([judged["p_safe"][row, column], true["safe"][row, column] == 1])


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


def kept(options, family, cell, seed):
    return os.path.join(options.folder, f"{family}-{cell}-{seed}.npz")


def kept_layers(options, family, cell, limit, names):
    """Number and layers of each site that was measured."""
    for number, seed in enumerate(range(options.seed, options.seed + options.sites)):
        path = kept(options, family, cell, seed)
        if os.path.exists(path):
            with np.load(path) as found:
                if missing := [name for name in names if f"{name}{limit}" not in found]:
                    sys.exit(f"{path}: was measured without {'--before' if missing == ['b'] else missing[0]}; remove it to measure it again")
                yield number, [found[f"{name}{limit}"] for name in names]


def pooled(options, family, cell, limit):
    """p, truth, decision and number of the site of all places whose truth is known."""
    parts = []
    for number, (p, truth, decided) in kept_layers(options, family, cell, limit, "pts"):
        known = np.isfinite(p) & (truth != 2)
        parts.append((p[known].astype(float), (truth[known] == 1).astype(float), decided[known], np.full(known.sum(), number)))
    return [np.concatenate(column) for column in zip(*parts)] if parts else None


def touchdown_share(safe, resolution):
    """The share of touchdowns, off by 1 m along x and y, that meet a safe place."""
    offset = np.arange(-round(3 / resolution), round(3 / resolution) + 1) * resolution
    weight = np.exp(-offset**2 / 2)
    share = safe.astype(float)
    for axis in (0, 1):
        share = np.apply_along_axis(np.convolve, axis, share, weight / weight.sum(), "same")
    return share


def touchdowns(options, family, cell, limit):
    """p_touchdown, the true share and number of the site of all places; then p_safe and truth of the ranked ones."""
    parts, sites = [], []
    for number, (p, truth, decided, chosen) in kept_layers(options, family, cell, limit, "qtsr"):
        sites.append(chosen)
        hit = touchdown_share((truth == 1) & (decided != 2), CELLS[cell].get("resolution", 0.05))
        known = np.isfinite(p) & (truth != 2)
        parts.append((p[known].astype(float), hit[known], np.full(known.sum(), number)))
    return ([np.concatenate(column) for column in zip(*parts)], np.concatenate(sites, 1)) if parts else None


def tenths(p, truth, site):
    """[(share less mean p, its standard error)] of each tenth; None where it is too small."""
    found = []
    for k in range(10):
        here = np.minimum((10 * p).astype(int), 9) == k
        counts = np.bincount(site[here], minlength=site.max() + 1)
        if here.sum() < 1000 or np.count_nonzero(counts) < 8:
            found.append(None)
            continue
        off = np.mean(truth[here] - p[here])
        sums = np.bincount(site[here], (truth - p)[here], len(counts))
        used = len(counts)
        found.append((off, np.sqrt(used / (used - 1) * np.sum((sums - off * counts)**2)) / here.sum()))
    return found


def rows(options, collected):
    for family in options.families:
        for cell in options.cells:
            for limit in LIMITS_DEG.get(cell, (10,)):
                data = collected(options, family, cell, limit)
                if data is not None:
                    yield family, cell if limit == 10 else f"limit{limit}", data


def text(tenth):
    if tenth is None:
        return "| "
    off, error = tenth
    wanted = -0.08 - 2 * error <= off <= 0.1 + 2 * error
    return f"| {off:+.2f}" + ("" if wanted else " !") + (" ?" if error > 0.03 else "")


def table(options):
    print("| family | cell | sites |", " | ".join(f"{k / 10:.1f}" for k in range(10)), "| Brier score | of `safe` | unknown |")
    print("|---" * 16 + "|")
    for family, cell, (p, truth, decided, site) in rows(options, pooled):
        print(f"| {family} | {cell} | {len(np.unique(site))}", *map(text, tenths(p, truth, site)),
              f"| {np.mean((p - truth)**2):.4f} | {np.mean(((decided == 1) != truth)[decided != 2]):.4f} | {100 * np.mean(decided == 2):.0f} % |")


def plane_table(options):
    print("| plane | cell | sites | mean p |")
    print("|---" * 4 + "|")
    for family, cell, (p, _, _, site) in rows(options, pooled):
        print(f"| {family[5:]} deg | {cell} | {len(np.unique(site))} | {p.mean():.4f} |")


def touchdown_table(options):
    print("\n| family | cell | sites |", " | ".join(f"{k / 10:.1f}" for k in range(10)), "| ranked sites: number, mean p_safe, share safe |")
    print("|---" * 14 + "|")
    for family, cell, ((p, truth, site), sites) in rows(options, touchdowns):
        print(f"| {family} | {cell} | {len(np.unique(site))}", *map(text, tenths(p, truth, site)),
              f"| {sites.shape[1]}, {sites[0].mean():.3f}, {sites[1].mean():.3f} |" if sites.size else "| 0 |")


def brier_scores(options, family, cell, limit):
    """Brier scores of p_safe and of that before, per site, over the places that both judge."""
    found = []
    for _, (p, before, truth) in kept_layers(options, family, cell, limit, "pbt"):
        known = np.isfinite(p) & np.isfinite(before) & (truth != 2)
        safe = truth[known] == 1
        found.append((np.mean((p[known] - safe)**2), np.mean((before[known] - safe)**2)))
    return np.array(found).T if found else None


def before_table(options):
    print("\n| family | cell | sites | Brier score | before | difference | its standard error | sites where it is worse |")
    print("|---" * 8 + "|")
    for family, cell, (now, before) in rows(options, brier_scores):
        off = now - before
        print(f"| {family} | {cell} | {len(off)} | {now.mean():.4f} | {before.mean():.4f} | {off.mean():+.4f} "
              f"| {off.std(ddof=1) / len(off)**0.5 if len(off) > 1 else np.nan:.4f} | {np.count_nonzero(off > 0.001)} |")


def figure(options):
    import matplotlib  # pylint: disable=import-outside-toplevel
    matplotlib.use("Agg")
    from matplotlib import pyplot  # pylint: disable=import-outside-toplevel
    found = list(rows(options, pooled))
    cells = list(dict.fromkeys(cell for _, cell, _ in found))
    drawn, axes = pyplot.subplots(2, -(-len(cells) // 2), figsize=(3.1 * -(-len(cells) // 2), 6.6), sharex=True, sharey=True, squeeze=False)
    for ax, cell in zip(axes.flat, cells):
        ax.fill_between([0, 1], [-0.08, 0.92], [0.1, 1.1], color="0.92", label="wanted")
        ax.plot([0, 1], [0, 1], color="0.5", lw=0.8)
        for number, family in enumerate(options.families):
            for _, _, (p, truth, _, site) in (row for row in found if row[:2] == (family, cell)):
                points = [(np.mean(p[np.minimum((10 * p).astype(int), 9) == k]), *tenth) for k, tenth in enumerate(tenths(p, truth, site)) if tenth]
                if points:
                    mean, off, error = map(np.array, zip(*points))
                    ax.errorbar(mean, mean + off, 2 * error, color=f"C{number}", marker="o", ms=3, lw=1, elinewidth=0.7, label=family)
        ax.set(title=cell, xlim=(0, 1), ylim=(0, 1), aspect="equal")
    for ax in axes.flat[len(cells):]:
        ax.set_axis_off()
    for ax in axes[-1]:
        ax.set_xlabel("mean p_safe")
    for ax in axes[:, 0]:
        ax.set_ylabel("share truly safe")
    handles = {label: handle for ax in axes.flat for handle, label in zip(*ax.get_legend_handles_labels())}
    drawn.legend(handles.values(), handles.keys(), loc="lower right", fontsize=8)
    drawn.tight_layout()
    drawn.savefig(options.figure, dpi=100, metadata={"Software": None})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", default="build/release/bin", help="folder of the tools")
    parser.add_argument("--folder", required=True, help="where the results are kept")
    parser.add_argument("--families", type=lambda names: names.split(","), default=list(FAMILIES))
    parser.add_argument("--cells", type=lambda names: names.split(","), default=list(CELLS))
    parser.add_argument("--sites", type=int, default=20)
    parser.add_argument("--seed", type=int, default=9100, help="seed of the first site")
    parser.add_argument("--figure", help="reliability diagrams")
    parser.add_argument("--before", metavar="FOLDER", help="tools of another release, whose p_safe is compared")
    parser.add_argument("--table-only", action="store_true", help="of what is there")
    options = parser.parse_args()
    if not options.table_only:
        measure(options)
    if all(family.startswith("plane") for family in options.families):
        plane_table(options)
        return
    table(options)
    touchdown_table(options)
    if options.before:
        before_table(options)
    if options.figure:
        figure(options)


if __name__ == "__main__":
    main()
