# SPDX-License-Identifier: GPL-3.0-or-later
# Decisions: D144, D322
#
# A stage's name is a hash of its configuration and of the stages before it, not of the tools' version, which is a file
# that all stages depend on. A new version makes everything again under the same names, because truths of another
# version are refused anyway.
#
# Truths. Scans that differ only in what `--ranges-from` redraws share a traced scan without errors; it is an order-only
# prerequisite, because any change to it also changes its readers. A single scan is traced with its errors. The bytes
# are the same.
"""The stages that a study has to compute: each stage once, named by a hash of all that its content depends on.

    terrain -> (truth ->) scan -> dem -> metrics
                                      -> score, sites
    terrain -> truth -> verdict of a run of draws
    verdict of a run whose draws trace

Scans that differ in errors only share a truth, the same scan traced without errors: `scan-sim --ranges-from truth`. A run of draws adds
errors to the truth. A scan with a receiver is traced for itself: it needs the waveforms.
"""
import hashlib
import json
from dataclasses import dataclass, field

from landfall import dictionary, scan_keys
from landfall.errors import UsageError
from landfall.schema import shown
from landfall.study import model

UPSTREAM = {name: stage.get("upstream") for name, stage in dictionary.stages().items()}
# Stages whose files are a case's results, in the order of its files.
RESULTS = ("eval", "hazard", "draws")
# The part of a run's configuration that it has from the case; of one whose draws trace.
OF_CASE = ("scan", "regrid", "eval")
OF_TRACED_CASE = ("terrain", *OF_CASE)


@dataclass
class Stage:
    """One run of a tool. `id` is the hash of its configuration and of all stages before it."""

    id: str
    config_id: str
    upstream: object  # the Stage before it, None for a terrain
    files: tuple = ()  # data files that the configuration names
    truth: object = None  # of a scan: the Stage whose ranges it takes
    consumers: list = field(default_factory=list)  # Stages that read it


@dataclass
class Graph:
    """All stages of a study: id -> Stage, in the order of the first case that needs them."""

    terrain: dict
    truth: dict
    scan: dict
    regrid: dict
    eval: dict
    hazard: dict  # empty for a study without this stage
    draws: dict  # empty without
    configs: dict  # (tool, config_id): text of the file
    cases: list  # of (values, {stage of its results: Stage})


def build(study):
    """The graph of a study."""
    return _Builder(study).graph


def count(graph):
    """The number of stages."""
    return sum(map(len, (graph.terrain, graph.truth, graph.scan, graph.regrid, graph.eval, graph.hazard, graph.draws)))


def cases_of(graph):
    """{id of a stage: numbers of the cases that it is made for}."""
    found = {}
    for number, (_, results) in enumerate(graph.cases):
        needed = {}
        for stage in results.values():
            while stage:
                needed[stage.id] = True
                if stage.truth:
                    needed[stage.truth.id] = True
                stage = stage.upstream
        for identity in needed:
            found.setdefault(identity, []).append(number)
    return found


def canonical(value):
    return json.dumps(value, sort_keys=True, separators=(",", ":"))


def short_hash(*texts):
    return hashlib.sha256("\n".join(texts).encode()).hexdigest()[:16]


def truth_config(scan):
    """The scan without what --ranges-from redraws (docs/user/scan-sim.md)."""
    truth = scan_keys.part(scan, ("beam",))
    if scan_keys.is_beam_drawn(scan):
        truth |= {key: scan[key] for key in ("seed", "draw") if key in scan}
    return truth


def has_receiver(scan):
    receiver = scan.get("receiver")
    return isinstance(receiver, dict) and receiver.get("type", "none") != "none"


def errors_config(scan):
    """The rest of the scan: what --ranges-from redraws, and what a receiver's echoes depend on."""
    return scan_keys.part(scan, ("echo", "estimate"))


def configuration(study, name, indices):
    """The configuration of a stage at a point of the study. Draws vary what repeats would, and are not repeated."""
    config = model.configuration(study, name, indices)
    if name != "draws":
        return config
    for stage in of_case(study):
        if stage in config:
            raise UsageError(f"{study.path}: draws.{stage}: draws have the {stage} of their case; set {stage} itself")
    given = {stage: model.configuration(study, stage, indices, repeated=False) for stage in of_case(study)}
    return {**config, **given, "scan": given["scan"] if study.traces else errors_config(given["scan"])}


def of_case(study):
    """The stages whose configurations a run of draws has from its case."""
    return OF_TRACED_CASE if study.traces else OF_CASE


def data_files(value):
    """Absolute paths that a configuration names (model.with_full_paths made them so)."""
    found = []
    model.with_paths(value, found.append)
    return [path for path in found if path.startswith("/")]


class _Builder:
    def __init__(self, study):
        self.study = study
        self.graph = Graph({}, {}, {}, {}, {}, {}, {}, {}, [])
        self.known = {stage: {} for stage in study.base}  # indices of the dimensions that matter: configuration
        self.relevant = {stage: self.dimensions_of(stage) for stage in study.base}
        for indices in study.cases():
            self.graph.cases.append((study.values(indices), self.add_case(indices)))
        self.share_truths()

    def dimensions_of(self, stage):
        """Which dimensions set keys of the stage, or of what a run of draws has from its case."""
        stages = {stage, *(of_case(self.study) if stage == "draws" else ())}
        return [any(model.stage_of(key) in stages for axis in dimension for key in axis.keys())
                for dimension in self.study.dimensions]

    def add_case(self, indices):
        made = {}
        for name in self.study.base:
            is_alone = name == "draws" and self.study.traces
            made[name] = self.add_stage(name, indices, None if is_alone else made.get(UPSTREAM[name]))
        return {name: made[name] for name in RESULTS if name in made}

    def add_stage(self, name, indices, upstream):
        mine = tuple(index for index, matters in zip(indices, self.relevant[name]) if matters)
        if mine not in self.known[name]:
            config = configuration(self.study, name, indices)
            if name == "scan" and has_receiver(config) and "draws" in self.study.base and not self.study.traces:
                raise UsageError(f"{self.study.path}: scan.receiver: the draws of a study use true ranges, without a receiver; use "
                                 "scan-sim --keep-echoes and monte-carlo, or \"trace_draws\": true")
            # The whole configuration of a scan with a receiver, so that it shares its truth with no other.
            truth = canonical(config if has_receiver(config) else truth_config(config)) if name == "scan" else None
            self.known[name][mine] = (self.add_config(name, config), tuple(self.checked_files(config)), truth)
        config_id, files, _ = self.known[name][mine]
        options = " ".join(self.study.options.get(name, []))
        # A run of draws does not depend on the errors of a scan that has the same truth.
        source = "" if upstream is None else self.truth_of(upstream) if name == "draws" else upstream.id
        identity = short_hash(name, config_id, options, source)
        stages = getattr(self.graph, name)
        if identity not in stages:
            stages[identity] = Stage(identity, config_id, upstream, files)
            if upstream and name != "draws":
                upstream.consumers.append(stages[identity])
            if name == "scan":
                stages[identity].truth = self.known[name][mine][2]  # its text, until share_truths()
        return stages[identity]

    def add_config(self, tool, config):
        text = json.dumps(config, sort_keys=True, indent=1) + "\n"
        config_id = short_hash(tool, text)
        self.graph.configs[tool, config_id] = text
        return config_id

    def checked_files(self, config):
        files = list(dict.fromkeys(data_files(config)))
        for path in files:
            if any(character in " $#%:;|\\*?[]{}~'\"`&()<>=" or not character.isprintable() for character in path):
                raise UsageError(
                    f"{self.study.path}: {shown(path)}: make cannot take this file name; link it under a plain one")
        return files

    def share_truths(self):
        """A truth for every two or more scans that differ in errors only, and for a run of draws; a single one is traced with its errors."""
        groups = {}
        for scan in self.graph.scan.values():
            groups.setdefault((scan.upstream.id, scan.truth), []).append(scan)
        for scans in groups.values():
            truth = self.add_truth(scans[0]) if len(scans) > 1 or (self.graph.draws and not self.study.traces) else None
            for scan in scans:
                scan.truth = truth
        for draws_stage in self.graph.draws.values():
            draws_stage.upstream = draws_stage.upstream and draws_stage.upstream.truth

    @staticmethod
    def truth_of(scan):
        """The id of a scan's truth, before share_truths()."""
        return short_hash("truth", scan.truth, scan.upstream.id)

    def add_truth(self, scan):
        config = json.loads(scan.truth)
        truth = Stage(self.truth_of(scan), self.add_config("scan", config), scan.upstream,
                      tuple(data_files(config)))
        self.graph.truth[truth.id] = truth
        return truth
