#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Generated files that a crash has lost or damaged are made again by the next make, and nothing else is."""
import os
import re
import unittest

from case import LIMITS, RESOLUTIONS, SIGMAS, StudyTest, read, study


def damage(path, how):
    """As a crash leaves a file: gone, empty, cut, or of the right size with zeros."""
    data = read(path)
    if how == "lost":
        os.remove(path)
        return
    with open(path, "wb") as file:
        file.write({"empty": b"", "cut": data[:len(data) // 2], "zeros": b"\0" * len(data)}[how])


class Repairs(StudyTest):
    def first_of(self, *folder):
        return os.path.join(*folder, self.files(*folder)[0])

    def stages_of(self, result):
        """What a make ran, [kind, ...]."""
        return re.findall(r"(?m)^\[\d+ done, .*\] (\w+) ", result.stdout)

    def test_each_generated_file(self):
        self.write(study(SIGMAS, RESOLUTIONS, LIMITS))
        self.make("study-results", "-j2")
        names = ["cases.json", "targets.txt", "study.mk", "results.csv", "results.h5", self.first_of("metrics"), self.first_of("readers"),
                 *(self.first_of("config", tool) for tool in ("terrain", "scan", "regrid", "eval"))]
        whole = {name: read(self.out(name)) for name in names}
        for name in names:
            for how in ("lost", "empty", "cut", "zeros") if name in ("study.mk", names[5], names[-1]) else ("lost", "cut"):
                with self.subTest(name=name, how=how):
                    damage(self.out(name), how)
                    result = self.make("study-results", "-j2")
                    again = set(self.stages_of(result))
                    # Metrics need their DEM, which needs its scan; terrain and truth are still there.
                    self.assertEqual(again, {"scan", "dem", "metrics"} if name.startswith("metrics/") else set())
                    self.assertEqual({name for name, data in whole.items() if read(self.out(name)) != data}, set())
                    if how != "lost":
                        self.assertRegex(result.stderr, rf"({name}|study\.mk) is lost or damaged and is made again")
        self.assertIn("Nothing to be done", self.make("study-results").stdout)

    def test_a_lost_list_of_versions_makes_all_again(self):
        """Nothing says then which tools made the rest."""
        self.write(study())
        self.make("study-results")
        damage(self.out("tools.txt"), "cut")
        self.assertEqual(self.stages_of(self.make("study-results")), ["terrain", "metrics"])

    def test_files_that_new_cases_need(self):
        sigmas = [0.01, 0.02]
        self.write(study({**SIGMAS, "list": sigmas}))
        self.make("study-results", "-j2")
        for folder in ("terrain", "truth"):
            for how in ("empty", "cut", "zeros"):
                with self.subTest(folder=folder, how=how):
                    path = self.out(self.first_of(folder))
                    whole = read(path)
                    damage(path, how)
                    sigmas.append(0.01 + 0.01 * len(sigmas))
                    self.write(study({**SIGMAS, "list": sigmas}))
                    self.make("study-results", "-j2")
                    self.assertEqual((read(path), len(self.rows())), (whole, len(sigmas)))

    def test_figures_and_report(self):
        self.write(study(SIGMAS))
        self.make("study", "-j2")
        names = ["figures/pass_rates.csv", "figures/percentiles.csv", "figures/overview.png", "report.html"]
        whole = {name: read(self.out(name)) for name in names}
        for name in names:
            damage(self.out(name), "cut")
            self.make("study")
            self.assertEqual({name for name, data in whole.items() if read(self.out(name)) != data}, set(), name)
        self.assertIn("Nothing to be done", self.make("study").stdout)

    def test_temporary_files_are_swept(self):
        self.write(study())
        self.make("study-results")
        os.makedirs(self.out("figures"), exist_ok=True)
        ended, alive = 2 ** 22 + 1, os.getpid()  # above the kernel's largest number of a process
        for name in ("figures/overview.png.{}.tmp", "figures/.percentiles.csv.{}.part", ".results.csv.{}.part", "config/scan/.a.json.{}.part"):
            for pid in (ended, alive):
                with open(self.out(name.format(pid)), "w", encoding="utf-8"):
                    pass
        self.make("study-results")
        left = [name for _, _, names in os.walk(self.out()) for name in names if name.endswith((".tmp", ".part"))]
        self.assertEqual(sorted(left), sorted([f"overview.png.{alive}.tmp", f".percentiles.csv.{alive}.part", f".results.csv.{alive}.part",
                                               f".a.json.{alive}.part"]))


if __name__ == "__main__":
    unittest.main()
