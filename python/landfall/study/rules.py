# SPDX-License-Identifier: GPL-3.0-or-later
"""A study's folder: where each stage's files lie, and the rules by which Makefile.studies makes them.

Terrains, truths, metrics, scores, sites and verdicts stay. A scan or a DEM that is not kept is made within the recipe of the only stage that
reads it, and removed after it; one that several stages read stays in shared/ until all of them are done.
"""
import json
from dataclasses import dataclass, field, replace

from landfall import dictionary
from landfall.command import write_text
from landfall.scan_keys import scan_schema
from landfall.schema import default_at
from landfall.study import names, session, stages

KEEPABLE = ("scan", "dem", "eval", "hazard", "draws")
MAX_SHARED = 16
BYTES_PER_RAY = 40  # of a truth: 38.5 with 648,000 rays on rocky terrain (2026-11-26)


@dataclass(frozen=True)
class Layout:
    """Names of files, relative to the study's folder."""

    keep: frozenset

    def config(self, tool, stage):
        return f"config/{tool}/{stage.config_id}.json"

    def file(self, kind, stage):
        """None for one that is not kept: layers and draws, and a scan or DEM that only one stage reads, which its reader's recipe makes."""
        if kind not in KEEPABLE or kind in self.keep:
            return f"{kind}/{stage.id}.{'json' if kind in session.FORMATS else 'h5'}"
        return f"shared/{stage.id}.{kind}.h5" if kind in ("scan", "dem") and len(stage.consumers) > 1 else None

    def results(self, stages_of_case):
        """The files of a case's results that cases.json names; sites have the name of their score."""
        return [self.file({"eval": "metrics", "hazard": "score", "draws": "verdict"}[name], stage) for name, stage in stages_of_case.items()]


def folders(graph):
    """All folders of a study."""
    tools = {tool for tool, _ in graph.configs}
    return [*(f"config/{tool}" for tool in sorted(tools)), "terrain", "truth", "scan", "dem", "eval", "metrics",
            *(("hazard", "score", "sites") if graph.hazard else ()), *(("draws", "verdict") if graph.draws else ()),
            "shared", "readers", "log", "scratch"]


@dataclass
class Recipe:
    """The needs and the steps of a rule."""

    inputs: list  # files of the study
    files: tuple = ()  # others
    steps: list = field(default_factory=list)  # of study-chain
    order_only: list = field(default_factory=list)
    shared: list = field(default_factory=list)  # inputs that go when all who read them are done

    def add(self, inputs, files, step):
        self.inputs = [*self.inputs, *inputs]
        self.files = (*self.files, *files)
        self.steps.append(step)


def _file(name, otherwise):
    return f"$O/{name}" if name else otherwise


class Fragment:
    """The make rules of a graph. `$O` is the study's folder.

    Make starts all scans before the first DEM. Where more than MAX_SHARED scans are read several times, all that depends on
    such a scan is therefore made within one recipe: the disk then holds a scan for each recipe that runs.
    """

    def __init__(self, graph, layout, options):
        self.graph, self.layout, self.options = graph, layout, options
        self.lines, self.transient, self.kept = [], [], []
        self.needs = {}  # output: all that it is made of, for targets.txt
        self.logs = {}  # metrics: the name of their recipe's log
        self.readers = {}  # file in shared/: those who read it
        self.sources = {}  # scan or DEM: the Recipe that it is made by
        shared_scans = sum(len(scan.consumers) > 1 or any(len(dem.consumers) > 1 for dem in scan.consumers) for scan in graph.scan.values())
        self.grouped = shared_scans > MAX_SHARED and not layout.keep & {"scan", "dem"}
        self.each("terrain", graph.terrain, self.modelling)
        self.each("truth", graph.truth, self.scanning)
        if self.grouped:
            for stage in graph.scan.values():
                self.group(stage)
        else:
            self.each("scan", graph.scan, self.scanning)
            self.each("dem", graph.regrid, self.gridding)
            for stage in (*graph.eval.values(), *graph.hazard.values()):
                self.judgement(stage)
        for stage in graph.draws.values():
            self.draws(stage)

    def each(self, kind, made, recipe_of):
        """A rule for the file of each stage that others read, unless their recipes make it."""
        for stage in made.values():
            output = self.layout.file(kind, stage)
            if output:
                self.rule(kind, stage.id, [output], recipe_of(stage, output))
                (self.kept if kind in self.layout.keep else self.transient).append(output)

    def rule(self, kind, identity, outputs, recipe):
        """One explicit rule, with what it leaves for targets.txt and readers/."""
        if self.graph.hazard:
            recipe = self.sparing(recipe)
        if kind in ("scan", "dem"):
            self.sources[outputs[0]] = recipe
        targets = " ".join("$O/" + name for name in outputs)
        colon = " &:" if len(outputs) > 1 else ":"
        inputs = " ".join(dict.fromkeys([*("$O/" + name for name in recipe.inputs), *recipe.files]))
        last = " |" * bool(recipe.order_only) + "".join(" $O/" + name for name in recipe.order_only)
        proofs = "".join(f" --output $O/{name}" for name in outputs)
        drops = "".join(f" --drop $O/{name}" for name in recipe.shared)
        self.lines.append(f"{targets}{colon} {inputs} $O/tools.txt{last}")
        self.lines.append(f"\t$(call stage,{kind},{identity},{proofs}{drops}) {' + '.join(recipe.steps)}")
        before = [need for name in (*recipe.inputs, *recipe.order_only) if name in self.needs
                  for need in (*self.needs[name], name)]
        for name in outputs:
            self.needs[name] = list(dict.fromkeys(before))
            self.logs[name] = f"{kind}-{identity}"
        for name in recipe.shared:
            self.readers.setdefault(name, []).append(outputs[0])

    def sparing(self, recipe):
        """The recipe with what its scan or DEM is made of in place of that file, which is order-only: one that is made again for
        another reader makes nothing else again."""
        spared = replace(recipe, inputs=[], order_only=[*recipe.order_only])
        for name in recipe.inputs:
            source = self.sources.get(name)
            spared.inputs += source.inputs if source else [name]
            spared.files = (*spared.files, *(source.files if source else ()))
            spared.order_only += [name] if source else []
        return spared

    # Rules of results

    def judgement(self, stage):
        dem, recipe = self.reading(stage.upstream)
        self.judge(recipe, stage, dem)
        self.rule("score" if stage.id in self.graph.hazard else "metrics", stage.id, self.outputs(stage), recipe)

    def draws(self, stage):
        """Its truth is order-only, as for a scan; the data files of its rays are those of the truth. Draws that trace have none."""
        config, verdict, output = self.layout.config("draws", stage), self.layout.file("verdict", stage), self.layout.file("draws", stage)
        truth = stage.upstream
        terrain, truth_name = (self.layout.file("terrain", truth.upstream), self.layout.file("truth", truth)) if truth else (None, None)
        step = f"draws $O/{config} {_file(truth_name, '-')} {_file(terrain, '-')} $O/{verdict} {_file(output, '@')}"
        inputs = [config, *([terrain] if terrain else [])]
        self.rule("verdict", stage.id, [verdict, *[output] * bool(output)],
                  Recipe(inputs, (*stage.files, *(truth.files if truth else ())), [step], [truth_name] if truth_name else []))
        if output:
            self.kept.append(output)

    def group(self, scan):
        """All that depends on a scan."""
        recipe, outputs = self.scanning(scan, None), []
        for dem in scan.consumers:
            self.grid(recipe, dem, None, None)
            for stage in dem.consumers:
                self.judge(recipe, stage, None)
                outputs += self.outputs(stage)
        self.rule("metrics", scan.id, outputs, recipe)

    def outputs(self, stage):
        """The files that judging a DEM makes."""
        if stage.id in self.graph.hazard:
            score = self.layout.file("score", stage)
            names = score, session.sites_of(score), self.layout.file("hazard", stage)
        else:
            names = self.layout.file("metrics", stage), self.layout.file("eval", stage)
        return [name for name in names if name]

    # Parts of recipes

    def reading(self, stage):
        """(file, recipe) of a DEM that is read; the file is None for one that the recipe makes in scratch."""
        dem = self.layout.file("dem", stage)
        if dem is None:
            return None, self.gridding(stage, None)
        return dem, Recipe([dem], shared=[dem] if dem.startswith("shared/") else [])

    def modelling(self, stage, output):
        """Makes a terrain."""
        config = self.layout.config("terrain", stage)
        return Recipe([config], stage.files, [f"terrain $O/{config} $O/{output}"])

    def scanning(self, stage, output):
        """Makes a scan or truth; an output of None lies in scratch."""
        config, terrain = self.layout.config("scan", stage), self.layout.file("terrain", stage.upstream)
        truth = self.layout.file("truth", stage.truth) if stage.truth else None
        step = f"scan $O/{config} $O/{terrain} {_file(truth, '-')} {_file(output, '@')}"
        # Order-only: what changes a truth changes the scan's other inputs too.
        return Recipe([config, terrain], stage.files, [step], [truth] if truth else [])

    def gridding(self, stage, output):
        """Makes a DEM, and its scan unless that has a rule of its own."""
        scan = self.layout.file("scan", stage.upstream)
        if scan is None:
            recipe = self.scanning(stage.upstream, None)
        else:
            recipe = Recipe([scan, self.layout.file("terrain", stage.upstream.upstream)],
                            shared=[scan] if scan.startswith("shared/") else [])
        self.grid(recipe, stage, scan, output)
        return recipe

    def grid(self, recipe, stage, scan, output):
        config, terrain = self.layout.config("regrid", stage), self.layout.file("terrain", stage.upstream.upstream)
        options = self.options.get("regrid", []) + ([] if "dem" in self.layout.keep else self.lean())
        recipe.add([config], stage.files, " ".join(
            [f"regrid $O/{config} {_file(scan, '@')} $O/{terrain} {_file(output, '@')}", *options]))

    def lean(self):
        """Only the layers that dem-eval reads, uncompressed: for a DEM that is not kept."""
        if "eval" in self.layout.keep:
            return []
        options = ["", *self.options.get("regrid", [])]
        layers = [layer["name"] for layer in dictionary.layers("dem") if layer.get("judged_with") in options]
        return ["--compression 0", "--layers", ",".join(layers)]

    def judge(self, recipe, stage, dem):
        """Evaluates a DEM, or finds its hazards."""
        kind = "hazard" if stage.id in self.graph.hazard else "eval"
        config, layers = self.layout.config(kind, stage), self.layout.file(kind, stage)
        if kind == "eval":
            recipe.add([config], stage.files, f"eval $O/{config} {_file(dem, '@')} $O/{self.layout.file('metrics', stage)} {_file(layers, '-')}")
        else:
            score, terrain = self.layout.file("score", stage), self.layout.file("terrain", stage.upstream.upstream.upstream)
            recipe.add([config, terrain], stage.files, f"hazard $O/{config} {_file(dem, '@')} $O/{terrain} $O/{score} "
                       f"$O/{session.sites_of(score)} {_file(layers, '@')}")
        if layers:
            self.kept.append(layers)

    # The files of a plan

    def results(self):
        """The metrics, scores and verdicts of all cases."""
        kinds = {"metrics": self.graph.eval, "score": self.graph.hazard, "verdict": self.graph.draws}
        return [self.layout.file(kind, stage) for kind, made in kinds.items() for stage in made.values()]

    def text(self, name, keep, bin_folder):
        results = self.results()
        first_verdict = len(results) - len(self.graph.draws)
        results[first_verdict:first_verdict] = [session.sites_of(score) for score in results if session.kind_of(score) == "score"]
        head = ["# Made by sweep.py plan: do not edit.", f"STUDY_NAME := {name}",
                f"PLANNED_KEEP := {keep}", f"PLANNED_BIN := {bin_folder}", _names("METRICS :=", results),
                _names("KEPT :=", self.kept), "", _names(".SECONDARY:", self.transient), ".PRECIOUS: $(METRICS)"]
        return "\n".join([*head, *self.lines]) + "\n"

    def targets(self):
        """A line for each set of metrics, each score and each verdict: its file, its log, all that is made for it."""
        rows = ([name, f"log/{self.logs[name]}.log", *self.needs[name]] for name in self.results())
        return "".join(" ".join(row) + "\n" for row in rows)


def _names(begin, names):
    return begin + "".join(f" \\\n $O/{name}" for name in names)


def write_if_changed(path, text):
    """Writes a file whole or not at all, unsynced; one that holds the text keeps its time. True where it was written."""
    try:
        with open(path, "rb") as file:
            if file.read() == text.encode():
                return False
    except FileNotFoundError:
        pass
    write_text(path, text, is_synced=False)
    return True


def axes_of(study):
    """The axes as cases.json holds them; those of one dimension go together."""
    return [{"name": axis.name, "label": axis.label, "unit": axis.unit, "log": axis.log, "numeric": axis.is_numeric(), "role": axis.role,
             "dimension": index} for index, dimension in enumerate(study.dimensions) for axis in dimension]


def names_text(study, graph):
    """names.txt: for each stage, by its id, the cases that it is made for."""
    cases = names.CaseNames(axes_of(study), [values for values, _ in graph.cases])
    return "".join(f"{identity}\t{cases.of_cases(numbers)}\n" for identity, numbers in stages.cases_of(graph).items())


def cases_text(study, graph, layout, limits):
    """cases.json: the axes, the limits that all cases share, and each case's values and files of results."""
    description = {"description": study.description} if study.description else {}
    head = {"format": "landfall.cases", "version": 1, "name": study.name, "title": study.title, **description, "plot": study.plot,
            "limits": limits, "axes": axes_of(study)}
    rows = [json.dumps([*values, *layout.results(results)], ensure_ascii=False) for values, results in graph.cases]
    return json.dumps(head, indent=1, ensure_ascii=False)[:-2] + ',\n "cases": [\n  ' + ",\n  ".join(rows) + "\n ]\n}\n"


# Disk space, reported before any file is made


def rays_of(scan):
    """The number of rays of a scan's configuration."""
    def value(*path):
        return default_at(scan_schema(), scan, path)
    pulses = int(value("laser", "pulse_rate_hz") * value("laser", "scan_time_s") + 1e-9)
    return pulses * value("detector", "rows") * value("detector", "columns")


def size_text(size):
    return f"{size / 1e9:.1f} GB" if size >= 1e9 else f"{max(size / 1e6, 1):.0f} MB"


def disk_text(graph, keep):
    """The files that stay on the disk, other than terrains and results, in one line."""
    parts = []
    if graph.truth:
        rays = sum(rays_of(json.loads(graph.configs["scan", stage.config_id])) for stage in graph.truth.values())
        parts.append(f"{names.counted(len(graph.truth), 'truth')}, about {size_text(rays * BYTES_PER_RAY)}, until study-clean")
    kept = [name for name in KEEPABLE if name in keep]
    parts.append(f"KEEP={','.join(kept)}" if kept else "no scans and DEMs (KEEP names files to keep)")
    return "on the disk: " + "; ".join(parts)
