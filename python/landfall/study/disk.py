# SPDX-License-Identifier: GPL-3.0-or-later
"""Disk space of a study's files, told before any is made."""
import json

from landfall.scan_keys import scan_schema
from landfall.schema import default_at
from landfall.study.names import counted

BYTES_PER_RAY = 40  # of a truth: 38.5 with 648,000 rays on rocky ground (2026-11-26)


def rays_of(scan):
    """The number of rays of a scan's configuration."""
    def value(*path):
        return default_at(scan_schema(), scan, path)
    pulses = int(value("laser", "pulse_rate_hz") * value("laser", "scan_time_s") + 1e-9)
    return pulses * value("detector", "rows") * value("detector", "columns")


def size_text(size):
    return f"{size / 1e9:.1f} GB" if size >= 1e9 else f"{max(size / 1e6, 1):.0f} MB"


def text(graph, keep):
    """The files that stay on the disk beside terrains and results, in one line."""
    parts = []
    if graph.truth:
        rays = sum(rays_of(json.loads(graph.configs["scan", stage.config_id])) for stage in graph.truth.values())
        parts.append(f"{counted(len(graph.truth), 'truth')}, about {size_text(rays * BYTES_PER_RAY)}, until study-clean")
    kept = [name for name in ("scan", "dem", "eval", "hazard", "draws") if name in keep]
    parts.append(f"KEEP={','.join(kept)}" if kept else "no scans and DEMs (KEEP names files to keep)")
    return "on the disk: " + "; ".join(parts)
