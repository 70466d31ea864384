# SPDX-License-Identifier: GPL-3.0-or-later
"""The record of comparisons: for each quantity the number of values, the largest difference, its bound, and failures."""
import numpy as np

STAGES = ["resolved configuration", "terrain", "points", "pulses", "detector", "dem", "eval", "holes", "metrics", "hazards"]


class Ledger:
    def __init__(self, bounds=None):
        """`bounds`: {prefix: (absolute, relative)} that replace the bounds of quantities; the first matching prefix counts."""
        self.bounds = bounds or {}
        self.rows, self.failures, self.excused, self.case = {}, [], {}, None

    def row(self, quantity, bound):
        row = self.rows.setdefault(quantity, {"values": 0, "largest": 0.0, "share": 0.0, "bound": bound})
        if row["bound"] == "equal":
            row["bound"] = bound  # the quantity has both integers and floats
        return row

    def fail(self, quantity, text):
        self.failures.append(f"case {self.case}: {quantity}: {text}")

    def equal(self, quantity, found, expected, doubtful=None):
        """Compares counts, flags, statuses and ids. They must be equal; differences of doubtful ones are only counted."""
        found, expected = np.asarray(found), np.asarray(expected)
        row = self.row(quantity, "equal")
        if found.shape != expected.shape:
            self.fail(quantity, f"{found.shape} values, not {expected.shape}")
            return
        row["values"] += found.size
        differs = found != expected
        if doubtful is not None:
            self.excused[quantity] = self.excused.get(quantity, 0) + int((differs & doubtful).sum())
            differs = differs & ~doubtful
        if differs.any():
            self.fail(quantity, f"{differs.sum()} of {found.size} differ, first {found[differs].flat[0]} for "
                                f"{expected[differs].flat[0]}")

    def close(self, quantity, found, expected, bound, relative=0.0, doubtful=None):
        """Compares numbers: NaN at the same indices, and differences of at most bound + relative |expected|."""
        found, expected = np.asarray(found, float), np.asarray(expected, float)
        bound, relative = next((own for name, own in self.bounds.items() if quantity.startswith(name)), (bound, relative))
        row = self.row(quantity, f"{bound:g}" + (f" + {relative:g} of the value" if relative else ""))
        if found.shape != expected.shape:
            self.fail(quantity, f"{found.shape} values, not {expected.shape}")
            return
        row["values"] += int(np.isfinite(expected).sum())
        with np.errstate(invalid="ignore"):
            off = np.where(found == expected, 0, abs(found - expected))
        wrong = (np.isnan(found) != np.isnan(expected)) | (off > bound + relative * abs(expected))
        if doubtful is not None:
            doubtful = np.broadcast_to(doubtful, wrong.shape)
            self.excused[quantity] = self.excused.get(quantity, 0) + int((wrong & doubtful).sum())
            off, wrong = np.where(doubtful, 0, off), wrong & ~doubtful
        row["largest"] = max(row["largest"], float(np.nanmax(off, initial=0)))
        row["share"] = max(row["share"], float(np.nanmax(off / np.maximum(bound + relative * abs(expected), 1e-300), initial=0)))
        if wrong.any():
            self.fail(quantity, f"{wrong.sum()} of {wrong.size} differ, by at most {np.nanmax(np.where(wrong, off, 0)):g}; first "
                                f"{found[wrong].flat[0]!r} for {expected[wrong].flat[0]!r}")

    def nested(self, quantity, found, expected, relative, bound, doubtful=False):
        """Compares JSON values: the same keys (null or absent if there is no value), equal integers, close floats."""
        if isinstance(expected, dict):
            for key in sorted(set(expected) | set(found or {})):
                if key not in expected and (found[key] is not None and not self.is_null(found[key])):
                    self.fail(quantity, f"nothing to compare {key} with: {found[key]}")
                elif key in expected:
                    self.nested(f"{quantity}.{key}", (found or {}).get(key), expected[key], relative, bound, doubtful)
        elif expected is None or isinstance(expected, (bool, np.bool_, str)):
            self.equal(self.family(quantity), [found], [expected], np.array([doubtful]))
        elif isinstance(expected, float) and not np.isfinite(expected):
            self.equal(self.family(quantity), [found is None], [True])  # JSON has neither NaN nor infinities
        elif found is None or np.shape(found) != np.shape(expected):
            self.fail(quantity, f"{found} for {expected}")
        elif np.asarray(expected).dtype.kind in "iu":
            self.equal(self.family(quantity), found, expected, np.full(np.shape(expected), doubtful))
        else:
            self.close(self.family(quantity), found, expected, bound, relative, np.array(doubtful))

    def is_null(self, value):
        return value is None or isinstance(value, dict) and all(self.is_null(part) for part in value.values())

    @staticmethod
    def family(quantity):
        return ".".join(quantity.split(".")[:2])

    def table(self):
        lines = ["| quantity | values | largest difference | bound | at a boundary |", "|---|---|---|---|---|"]
        for name, row in sorted(self.rows.items(), key=lambda item: STAGES.index(item[0].split(":")[0])):
            largest = f"{row['largest']:.1e}" if row["bound"] != "equal" else "0"
            lines.append(f"| {name} | {row['values']:,} | {largest} | {row['bound']} | {self.excused.get(name, 0)} |")
        return lines

    def summary(self):
        """The table by stage, with the largest difference as a share of its bound."""
        lines = ["| numbers of | quantities | values | largest difference, share of its bound | at a boundary |", "|---|---|---|---|---|"]
        for stage in STAGES:
            names = [name for name in self.rows if name.split(":")[0] == stage]
            values, share = sum(self.rows[name]["values"] for name in names), max(self.rows[name]["share"] for name in names)
            lines.append(f"| {stage} | {len(names)} | {values:,} | {share:.2g} | {sum(self.excused.get(name, 0) for name in names)} |")
        return lines
