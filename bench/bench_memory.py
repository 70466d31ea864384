#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures the peak memory of each tool against the size of its work, and fits base + bytes per node, ray or bin.

  bench/bench_memory.py [--bin build/release/bin] [--folder DIR] [--largest FACTOR] [--threads N] [--write]
                        [--save FILE] [--load FILE]

Each row of the table is a ladder of six sizes, three times the one before. The peak is that of the process (ru_maxrss).
The fit makes the sum of squares of the relative deviations least; the last column is the largest of them. Where the last
two peaks differ by less than a tenth (batches go through a pipeline, which is full), the size from which on memory is
constant is fitted too. --write puts the table into docs/quality/performance.md and the picture into
docs/images/memory.png; --save keeps what was measured and --load takes it from there. It takes 2 GB of the disk and
some minutes; --largest 0.1 makes all sizes a tenth.
"""
import argparse
import dataclasses
import json
import math
import os
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PAGE = os.path.join(ROOT, "docs", "quality", "performance.md")
PICTURE = os.path.join(ROOT, "docs", "images", "memory.png")
HEADING = "## Memory"
SITE_M = 100  # edge
FACTORS = [1 / 243, 1 / 81, 1 / 27, 1 / 9, 1 / 3, 1]
LARGEST = {"node": 12_000_000, "bin": 8_000_000, "ray": 13_000_000}
PIXELS = 36  # of a pulse
SMALL = {"node": 501, "bin": 501, "ray": 360_000}  # of what is not varied: nodes, bins along an edge; rays
SCAN = {"detector": {"rows": 6, "columns": 6, "ifov_rad": 2.7e-4},
        "laser": {"pulse_rate_hz": 20000, "scan_time_s": 2},
        "scanner": {"type": "fsm", "incidence_deg": 0,
                    "pattern": {"type": "line_search", "rows": 247, "columns": 161, "half_width_m": 45}},
        "trajectory": {"type": "constant_velocity", "position_m": [0, 0, 500], "velocity_mps": [0, 0, -23]},
        "noise": {"range_sigma_m": 0.01}}
COLORS = {"terrain-gen": "C0", "scan-sim": "C1", "regrid": "C2", "dem-eval": "C3", "landfall-export": "C4", "landfall-info": "C5"}
MARKERS, DASHES = "os^", ("-", "--", ":")  # of a tool's first, second and third use
MEGA = 1e6


@dataclasses.dataclass
class Series:
    """A command against the size of one thing; `sizes` in units, `peaks` in bytes."""
    label: str
    unit: str
    sizes: list = dataclasses.field(default_factory=list)
    peaks: list = dataclasses.field(default_factory=list)


def peak_of(command):
    """Bytes at most in memory of a run that must succeed."""
    with tempfile.TemporaryFile() as errors:
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=errors)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            errors.seek(0)
            sys.exit(f"{' '.join(command)}\nexit {process.returncode}: {errors.read().decode()}")
    return usage.ru_maxrss * 1024


def edge(count):
    """An odd number whose square is about `count`."""
    return 2 * round((count**0.5 - 1) / 2) + 1


class Ladder:
    """Runs the tools; files lie in `folder`."""

    def __init__(self, options, folder):
        self.options, self.folder = options, folder
        self.series = {}

    def path(self, name):
        return os.path.join(self.folder, name)

    def run(self, tool, *words):
        """Words that begin with @ are files."""
        words = [self.path(word[1:]) if word.startswith("@") else word for word in words]
        overwrite = [] if tool == "landfall-info" else ["-O"]
        return peak_of([os.path.join(self.options.bin, tool), *words, *overwrite, "-t", str(self.options.threads)])

    def measure(self, label, unit, size, tool, *words):
        peak = self.run(tool, *words)
        row = self.series.setdefault((label, unit), Series(label, unit))
        row.sizes.append(size)
        row.peaks.append(peak)
        print(f"{label}: {size:,} {unit}s: {peak / MEGA:.1f} MB", flush=True)

    def write_config(self, name, config):
        with open(self.path(name), "w", encoding="utf-8") as file:
            json.dump(config, file)

    def write_terrain(self, nodes):
        """The configuration of a fractal of so many nodes along an edge."""
        self.write_config("terrain.json", {"grid": {"half_width_m": SITE_M / 2, "resolution_m": SITE_M / (nodes - 1)},
                                           "base": {"type": "fractal", "rms_deviation_m": 0.5}})

    def write_scan(self, rays):
        scan = json.loads(json.dumps(SCAN))
        scan["laser"]["pulse_rate_hz"] = rays / PIXELS / SCAN["laser"]["scan_time_s"]
        self.write_config("scan.json", scan)

    def write_regrid(self, bins):
        half = 0.9 * SITE_M / 2
        self.write_config("regrid.json", {"resolution_m": 2 * half / (bins - 1), "half_width_m": half})

    def sizes(self, unit):
        return [LARGEST[unit] * self.options.largest * factor for factor in FACTORS]

    def prepare(self):
        self.write_terrain(SMALL["node"])
        self.write_scan(SMALL["ray"])
        self.write_regrid(SMALL["bin"])
        self.write_config("eval.json", {"region_radius_m": 40, "footprint_m": 0.7})
        self.run("terrain-gen", "-c", "@terrain.json", "-o", "@small-terrain.h5")
        self.run("scan-sim", "-c", "@scan.json", "--terrain", "@small-terrain.h5", "-o", "@small-scan.h5")

    def over_nodes(self):
        for size in self.sizes("node"):
            nodes = edge(size)
            self.write_terrain(nodes)
            count = nodes**2
            self.measure("terrain-gen", "node", count, "terrain-gen", "-c", "@terrain.json", "-o", "@terrain.h5")
            self.measure("terrain-gen --from, to .tif", "node", count, "terrain-gen", "--from", "@terrain.h5", "-o", "@terrain.tif")
            self.measure("scan-sim", "node", count, "scan-sim", "-c", "@scan.json", "--terrain", "@terrain.h5", "-o", "@scan.h5")
            self.measure("regrid --terrain", "node", count, "regrid", "@small-scan.h5", "--terrain", "@terrain.h5", "-c", "@regrid.json",
                         "-o", "@dem.h5", "--other-terrain")

    def over_rays(self):
        for size in self.sizes("ray"):
            rays = PIXELS * round(size / PIXELS)
            self.write_scan(rays)
            self.measure("scan-sim", "ray", rays, "scan-sim", "-c", "@scan.json", "--terrain", "@small-terrain.h5", "-o", "@scan.h5")
            self.measure("scan-sim --ranges-from", "ray", rays, "scan-sim", "-c", "@scan.json", "--ranges-from", "@scan.h5", "--seed", "2",
                         "-o", "@draw.h5")
            os.remove(self.path("draw.h5"))
            self.measure("regrid", "ray", rays, "regrid", "@scan.h5", "-c", "@regrid.json", "-o", "@dem.h5")
            for kind in ("csv", "las"):
                self.measure(f"landfall-export .{kind}", "ray", rays, "landfall-export", "@scan.h5", "-o", f"@scan.{kind}")
                os.remove(self.path(f"scan.{kind}"))
            self.measure("landfall-info", "ray", rays, "landfall-info", "@scan.h5")
        self.write_scan(SMALL["ray"])

    def over_bins(self):
        for size in self.sizes("bin"):
            bins = edge(size)
            self.write_regrid(bins)
            count = bins**2
            self.measure("regrid", "bin", count, "regrid", "@small-scan.h5", "-c", "@regrid.json", "-o", "@dem.h5")
            self.measure("regrid --method median", "bin", count, "regrid", "@small-scan.h5", "-c", "@regrid.json", "-o", "@dem.h5",
                         "--method", "median")
            self.measure("regrid --uncertainty --corrected", "bin", count, "regrid", "@small-scan.h5", "-c", "@regrid.json",
                         "-o", "@dem.h5", "--uncertainty", "--corrected", "--terrain", "@small-terrain.h5")
            self.run("regrid", "@small-scan.h5", "-c", "@regrid.json", "-o", "@dem.h5", "--terrain", "@small-terrain.h5")
            self.measure("dem-eval", "bin", count, "dem-eval", "@dem.h5", "-c", "@eval.json", "-o", "@eval.h5")
            self.measure("dem-eval --metrics-only", "bin", count, "dem-eval", "@dem.h5", "-c", "@eval.json", "--metrics-only")
            self.measure("dem-eval --report", "bin", count, "dem-eval", "@dem.h5", "-c", "@eval.json", "-o", "@eval.h5",
                         "--report", "@report.html")
            self.measure("landfall-export .tif", "bin", count, "landfall-export", "@dem.h5", "-o", "@dem.tif")
            self.measure("landfall-export .png", "bin", count, "landfall-export", "@dem.h5", "-o", "@dem.png")
            self.measure("landfall-info", "bin", count, "landfall-info", "@dem.h5")


@dataclasses.dataclass
class Fit:
    """base + slope * min(size, end) bytes; `deviation` is the largest, relative to the peak."""
    base: float
    slope: float
    end: float
    deviation: float

    def peak(self, size):
        return self.base + self.slope * min(size, self.end)


def linear_fit(series, end):
    import numpy as np  # pylint: disable=import-outside-toplevel
    sizes, peaks = np.minimum(np.array(series.sizes, float), end), np.array(series.peaks, float)
    matrix = np.stack([1 / peaks, sizes / peaks], axis=1)
    (base, slope), *_ = np.linalg.lstsq(matrix, np.ones_like(peaks), rcond=None)
    return Fit(base, slope, end, float(np.max(np.abs(base + slope * sizes - peaks) / peaks)))


def fit(series):
    if series.peaks[-1] > 1.1 * series.peaks[-2]:
        return linear_fit(series, math.inf)
    steps = [series.sizes[1] * (series.sizes[-1] / series.sizes[1])**(i / 100) for i in range(100)]
    return min((linear_fit(series, end) for end in steps), key=lambda one: one.deviation)


def per_unit(slope):
    return f"{slope:.1f} B" if abs(slope) >= 0.95 else f"{slope:.2f} B"


def table(rows):
    lines = ["| tool | against | sizes | peaks | base | bytes each | up to | largest deviation |", "|---|---|---|---|---|---|---|---|"]
    for row in rows:
        one = fit(row)
        end = f"{one.end / MEGA:.1f} M" if one.end < math.inf else ""
        lines.append(f"| {row.label} | {row.unit}s | {row.sizes[0] / MEGA:.2f} - {row.sizes[-1] / MEGA:.1f} M | "
                     f"{row.peaks[0] / MEGA:.0f} - {row.peaks[-1] / MEGA:.0f} MB | {one.base / MEGA:.0f} MB | {per_unit(one.slope)} | {end} | "
                     f"{100 * one.deviation:.0f} % |")
    return lines


def draw_panel(axes, rows):
    import numpy as np  # pylint: disable=import-outside-toplevel
    tools = [row.label.split()[0] for row in rows]
    for i, row in enumerate(rows):
        one, color, use = fit(row), COLORS[tools[i]], tools[:i].count(tools[i])
        sizes = np.geomspace(row.sizes[0], row.sizes[-1], 100)
        axes.loglog(np.array(row.sizes) / MEGA, np.array(row.peaks) / MEGA, MARKERS[use], color=color, ms=5, label=row.label)
        axes.loglog(sizes / MEGA, [one.peak(size) / MEGA for size in sizes], DASHES[use], color=color, lw=1)
    axes.set_xlabel(f"million {rows[0].unit}s")
    axes.grid(True, which="major", color="0.88", lw=0.6)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    axes.legend(loc="upper left", fontsize=7.5, frameon=False)


def draw(rows, path):
    import matplotlib  # pylint: disable=import-outside-toplevel
    matplotlib.use("Agg")
    from matplotlib import pyplot, ticker  # pylint: disable=import-outside-toplevel
    titles = {"node": "nodes of the terrain", "ray": "rays of the scan", "bin": "bins of the DEM"}
    figure, panels = pyplot.subplots(1, 3, figsize=(12, 5), sharey=True, layout="constrained")
    for axes, (unit, title) in zip(panels, titles.items()):
        draw_panel(axes, [row for row in rows if row.unit == unit])
        axes.set_title(title, fontsize=10)
        axes.xaxis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:g}"))
    top = max(max(row.peaks) for row in rows) / MEGA
    panels[0].set_ylim(10, 12 * top)  # room for the legends
    panels[0].set_ylabel("peak memory, MB")
    panels[0].yaxis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:,.0f}"))
    figure.savefig(path, dpi=110, metadata={"Software": None})


def with_table(text, lines):
    """The page with `lines` in place of the first table below the heading."""
    rows = text.split("\n")
    begin = next(i for i in range(rows.index(HEADING), len(rows)) if rows[i].startswith("|"))
    end = next(i for i in range(begin, len(rows)) if not rows[i].startswith("|"))
    return "\n".join([*rows[:begin], *lines, *rows[end:]])


def write(rows, lines):
    draw(rows, PICTURE)
    with open(PAGE, encoding="utf-8") as file:
        text = file.read()
    with open(PAGE, "w", encoding="utf-8") as file:
        file.write(with_table(text, lines))


def measured(options):
    with tempfile.TemporaryDirectory(prefix="landfall-memory-", dir=options.folder) as folder:
        ladder = Ladder(options, folder)
        ladder.prepare()
        ladder.over_nodes()
        ladder.over_rays()
        ladder.over_bins()
    return list(ladder.series.values())


def load(path):
    with open(path, encoding="utf-8") as file:
        return [Series(**row) for row in json.load(file)]


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", default=os.path.join(ROOT, "build", "release", "bin"), help="folder of the tools")
    parser.add_argument("--folder", default="/tmp", help="where the files go")
    parser.add_argument("--largest", type=float, default=1, help="factor on all sizes")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--write", action="store_true", help="write the table and the picture of the documentation")
    parser.add_argument("--save", metavar="FILE", help="write what was measured, as JSON")
    parser.add_argument("--load", metavar="FILE", help="measure nothing, take what --save wrote")
    options = parser.parse_args(arguments)
    rows = load(options.load) if options.load else measured(options)
    rows.sort(key=lambda row: ["node", "ray", "bin"].index(row.unit))
    if options.save:
        with open(options.save, "w", encoding="utf-8") as file:
            json.dump([dataclasses.asdict(row) for row in rows], file, indent=1)
    lines = table(rows)
    print(*lines, sep="\n")
    if options.write:
        write(rows, lines)


if __name__ == "__main__":
    main(sys.argv[1:])
