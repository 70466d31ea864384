# SPDX-License-Identifier: GPL-3.0-or-later
"""The cost of a study: a trial of its first case, multiplied by the numbers of its stages."""
import json
import os
import subprocess
import tempfile

from landfall import dictionary, tools
from landfall.errors import ToolError
from landfall.study import names, rules

STUDY_CHAIN = os.path.join(tools.SHARE, "studies", "runners", "study-chain")
TRIAL_DRAWS = 2


def duration(seconds):
    return f"{seconds:.1f} s" if seconds < 60 else f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


def cost_text(study, graph, options, scratch=None):
    """One line: the time with options.jobs stages at a time, and the memory of the largest. Files of the trial lie in the folder `scratch` for as long as it runs."""
    with tempfile.TemporaryDirectory(dir=scratch, prefix="trial-") as folder:
        try:
            measured = _Trial(study, graph, options, folder).run()
        except ToolError as error:
            return f"cost: unknown, because the first case fails: {str(error).splitlines()[-1]}"
    counts = {"terrain": graph.terrain, "truth": graph.truth, "scan": graph.scan, "regrid": graph.regrid, "eval": graph.eval, "hazard": graph.hazard,
              "draws": graph.draws}
    total = sum(seconds * len(counts[kind]) for kind, (seconds, _) in measured.items())
    parts = ", ".join(f"{len(counts[kind])} x {kind} {duration(seconds)}" for kind, (seconds, _) in measured.items())
    memory = "" if options.runner else f"; a stage needs up to {rules.size_text(max(peak for _, peak in measured.values()))} of memory"
    return f"cost: about {duration(total / options.jobs)} with {names.counted(options.jobs, 'stage')} at a time, by the first case ({parts}){memory}"


class _Trial:
    """The stages of the first case, one after another."""

    def __init__(self, study, graph, options, folder):
        self.study, self.graph, self.options, self.folder = study, graph, options, folder

    def path(self, name):
        return os.path.join(self.folder, name)

    def config(self, kind, stage, **changes):
        path = self.path(f"{kind}-{stage.id}.json")
        with open(path, "w", encoding="utf-8") as file:
            json.dump({**json.loads(self.graph.configs[kind, stage.config_id]), **changes}, file)
        return path

    def run(self):
        """{stage: (seconds, peak memory in bytes)}."""
        results = self.graph.cases[0][1]
        terrain, scan, dem = (self.path(name) for name in ("terrain.h5", "scan.h5", "dem.h5"))
        regrid, truth, measured = results["eval"].upstream, "-", {}
        of_scan = regrid.upstream
        measured["terrain"] = self.step("terrain", self.config("terrain", of_scan.upstream), terrain)
        if of_scan.truth:
            truth = self.path("truth.h5")
            measured["truth"] = self.step("scan", self.config("scan", of_scan.truth), terrain, "-", truth)
        measured["scan"] = self.step("scan", self.config("scan", of_scan), terrain, truth, scan)
        measured["regrid"] = self.step("regrid", self.config("regrid", regrid), scan, terrain, dem, *self.study.options.get("regrid", []))
        measured["eval"] = self.step("eval", self.config("eval", results["eval"]), dem, self.path("metrics.json"), "-")
        if "hazard" in results:
            measured["hazard"] = self.step("hazard", self.config("hazard", results["hazard"]), dem, terrain, self.path("score.json"), self.path("sites.json"),
                                           self.path("hazards.h5"))
        if "draws" in results:
            measured["draws"] = self.draws(results["draws"], [] if self.study.traces else [truth, "--terrain", terrain])
        return measured

    def draws(self, stage, inputs):
        """Some draws; a run has as many as it may have."""
        config = self.config("draws", stage, stop={"type": "fixed"})
        count = json.loads(self.graph.configs["draws", stage.config_id]).get("draws", 299)
        few = min(TRIAL_DRAWS, count)
        seconds, peak = self.timed([os.path.join(self.options.bin, dictionary.stages()["draws"]["tool"]), *inputs, "-c", config, "-q", "-t", str(self.options.threads),
                                    "--draws", f"0:{few}", "-o", self.path("draws.h5")])
        return seconds * count / few, peak

    def step(self, *words):
        return self.timed([STUDY_CHAIN, self.options.bin, str(self.options.threads), self.folder, "trial", *words])

    def timed(self, words):
        """(seconds, peak memory in bytes) of a command."""
        with tempfile.TemporaryFile(dir=self.folder) as messages:
            begin = os.times().elapsed
            process = subprocess.Popen([*self.options.runner.split(), *words], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=messages)
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            if process.returncode:
                messages.seek(0)
                raise ToolError(messages.read().decode(errors="replace").strip() or f"{words[0]}: exit code {process.returncode}", process.returncode)
            return os.times().elapsed - begin, usage.ru_maxrss * 1024
