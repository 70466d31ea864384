# SPDX-License-Identifier: GPL-3.0-or-later
# Decisions: D466, D467
"""Margins of a chain: how near each requirement is to its limit, how large each error may become, and which postings pass (docs/user/margin.md)."""
import copy
import json
import math
import os
import shlex
import shutil
import sys

from landfall import command, requirements, scan_keys, tools
from landfall.answers import margin_page, model, runs
from landfall.errors import UsageError, printable_lines, ToolError
from landfall.study import stages
from landfall.study.model import TOOLS

POSTINGS = (0.05, 0.1, 0.2, 0.4)
NOISE = "scan.noise.range_sigma_m"
STEPS_M, STEPS_RAD = (0.05, None), (1e-4, 1.0)  # the first value of a search, and the last one; of lengths the last is the diameter of the region
PRECISION = 5e-4  # of a search: the gap between the largest value that passes and the smallest that fails, as a part of the latter
BELOW, ABOVE = (1 / 3, 2 / 3), (1.25, 2)  # where it is then checked, as parts of the value found
MAX_HALVINGS = 30  # of the first value, before only 0 is said to pass


def read_chain(configs, values):
    """{stage: resolved configuration} of a configuration of `landfall run`, without hazard-map. `configs` and `values`: of -c and --set."""
    words = [word for name, given in (("-c", configs), ("--set", values)) for one in given for word in (name, one)]
    text = sys.stdin.read() if "-" in configs else None
    try:
        tools.run_tool(tools.find("landfall"), "run", *words, "--check", "-q", input=text)
        printed = tools.run_tool(tools.find("landfall"), "run", *words, "--print-commands", "-o", "margin", input=text).stdout
    except ToolError as error:
        raise ToolError(str(error).removeprefix("landfall run: "), error.exit_code) from error
    stage_of, base = {tool: stage for stage, tool in TOOLS.items()}, {}
    for tool, *rest in map(shlex.split, printed.splitlines()):
        sections = [word.split("=", 1) for name, word in zip(rest, rest[1:]) if name == "--set"]
        base[stage_of[tool]] = {key: json.loads(value) for key, value in sections}
    base.pop("hazard", None)
    return runs.read_base(base, os.getcwd(), " ".join(configs), "")


class Judge:
    """The numbers of the chain with other values of some keys, and the same random numbers: an error is redrawn over the rays, which are traced once."""

    def __init__(self, base, runner, progress):
        self.base, self.runner, self.progress = base, runner, progress
        self.scan, self.seen = runs.Scan(runner, base, 1), {}
        own = [requirement["metric"] for requirement in base["eval"].get("requirements", [])]
        self.metrics = "verdict" if all(map(model.VERDICT_NUMBERS.fullmatch, own)) else "full"

    def numbers(self, changes):
        """{name of a metric: value} with {key: value}: all numbers of the chain as it is, else those that verdicts need."""
        configs = model.set_values(copy.deepcopy(self.base), changes)
        identity = stages.canonical(configs)
        if identity not in self.seen:
            what = ", ".join(f"{key} = {value:g}" for key, value in changes.items()) or "the chain as it is"
            drawn = all(key.startswith("regrid.") or runs.is_redrawn(key, configs["scan"]) for key in changes) and not runs.needs_chain(configs["scan"])
            metrics = self.metrics if changes else "full"
            self.seen[identity] = self.runner.cached("margin", [configs, metrics], lambda: self._made(what, configs, metrics, drawn))[0]
        return self.seen[identity]

    def _made(self, what, configs, metrics, drawn):
        self.progress.say(what)
        if not drawn:
            return self.runner.numbers(configs)
        draw = configs["scan"]["draw"]
        changes = {"metrics": metrics, "draws": draw + 1, "scan": stages.errors_config(configs["scan"]), "regrid": configs["regrid"]}
        [row] = self.scan.rows(changes, *(["--draws", f"{draw}:{draw + 1}"] if draw else []))
        return row

    def verdicts(self, changes):
        """{requirement: whether it passes, None where it is not judged}, the user's own ones last."""
        return requirements.verdicts_of(self.numbers(changes))


# Keys


def error_keys(base):
    """{key: largest value that is tried} of the range noise and of each component of the navigation errors that the schema names."""
    scan, schema_of_scan = base["scan"], scan_keys.scan_schema()
    limit_m, time_s = 2 * base["eval"]["region_radius_m"], scan["laser"]["scan_time_s"]
    keys = {NOISE: (STEPS_M[0], limit_m)}
    if "table" in scan["navigation_error"]:  # excludes the others
        return keys
    for name, node in schema_of_scan["properties"]["navigation_error"]["properties"].items():
        if node.get("$ref") != "#/definitions/vector":
            continue
        first, last = (STEPS_RAD if "_rad" in name else (STEPS_M[0], limit_m))
        scale = 1 / time_s if name.endswith("ps") else 1.0
        keys |= {f"scan.navigation_error.{name}.{axis}": (first * scale, last * scale) for axis in range(3)}
    return keys


def chosen_keys(keys, chosen):
    for key in chosen or []:
        if key not in keys:
            raise UsageError(f"--keys: {key}: is not one of {', '.join(keys)}")
    return {key: ends for key, ends in keys.items() if not chosen or key in chosen}


def value_at(configs, key):
    """The value of a key of resolved configurations."""
    node = configs
    for part in key.split("."):
        node = node[int(part)] if isinstance(node, list) else node[part]
    return node


class Search:
    """The largest value of one key, in the direction of its configured value, with which requirements pass. `verdicts_at`: {requirement: verdict} of a
    value. `first` and `last`: where the search begins and ends."""

    def __init__(self, configured, first, last, verdicts_at):
        self.configured, self.first, self.last = configured, min(first, last), max(last, abs(configured))
        self.smallest, self.sign = self.first * 2 ** -MAX_HALVINGS, -1 if configured < 0 else 1
        self._verdicts_at, self.tried = verdicts_at, {}

    def at(self, size):
        if size not in self.tried:
            self.tried[size] = self._verdicts_at(self.sign * size if size else 0)
        return self.tried[size]

    def passes(self, size, names):
        return all(self.at(size)[name] for name in names)

    def answer(self, names):
        """{"passes_up_to", "decides", "monotone"} for these requirements; None of the first one where no error of this size limits."""
        if not self.passes(0, names):
            self.passes(abs(self.configured), names)
            return {"passes_up_to": 0, **self._end(0, names)}
        low, high = self._bracket(names)
        while True:
            low, high = self._bisect(low, high, names)
            sizes = [size * low for size in BELOW] + [min(size * high, self.last) for size in ABOVE] if high else [low * size for size in BELOW]
            for size in sizes:
                self.passes(size, names)
            failing = [size for size in self.tried if not self.passes(size, names)]
            if not failing or min(failing) == high:
                break
            high = min(failing)
            low = max(size for size in self.tried if size < high)
        if high is None:
            return {"passes_up_to": None, "decides": None, "monotone": True}
        return {"passes_up_to": self.sign * low if low else 0, **self._end(high, names)}

    def _end(self, high, names):
        """The requirement that fails at the smallest failing size, and whether no larger one passes."""
        return {"decides": next(name for name in names if not self.at(high)[name]),
                "monotone": not any(self.passes(size, names) for size in self.tried if size > high)}

    def _bracket(self, names):
        """(size that passes, larger size that fails); of the latter None if none does."""
        low, size = 0, abs(self.configured) or self.first
        while self.passes(size, names):
            if size >= self.last:
                return size, None
            low, size = size, min(max(4 * size, self.first), self.last)
        return low, size

    def _bisect(self, low, high, names):
        while high and high - low > PRECISION * high and high > self.smallest:
            middle = (low + high) / 2
            low, high = (middle, high) if self.passes(middle, names) else (low, middle)
        return low, high


def key_margin(judge, key, first, last, judged):
    """The entry of a key. Where a requirement of `judged` fails even without this error, "others" is the answer without such requirements."""
    configured = value_at(judge.base, key)
    search = Search(configured, first, last, lambda value: judge.verdicts({key: value}))
    at_zero = search.at(0)
    others = [name for name in judged if at_zero[name]]
    found_others = {"others": {**search.answer(others), "left_out": [name for name in judged if name not in others]}} if 0 < len(others) < len(judged) else {}
    return {"configured": configured, **search.answer(judged), "passes_at_zero": len(others) == len(judged), **found_others}


# Postings


def posting(judge, resolution_m):
    """The entry of a posting: all else, and the traced rays, as in the chain. A half width that is not a whole number of bins is rounded up to one.
    Throws ToolError, naming the option, for one that regrid or dem-eval refuses."""
    half = judge.base["regrid"]["half_width_m"]
    whole = [math.ceil(one / resolution_m - 1e-9) for one in (half if isinstance(half, list) else [half])]
    changes = {"regrid.resolution_m": resolution_m}
    if any(abs(bins * resolution_m - one) > 1e-9 * one for bins, one in zip(whole, half if isinstance(half, list) else [half])):
        rounded = [bins * resolution_m for bins in whole]
        changes["regrid.half_width_m"] = rounded if isinstance(half, list) else rounded[0]
    try:
        verdicts = judge.verdicts(changes)
    except ToolError as error:
        raise ToolError(f"--postings {resolution_m:g}: {error}", error.exit_code) from error
    return {"resolution_m": resolution_m, "pass": requirements.all_of(verdicts), "fails": [name for name, passes in verdicts.items() if passes is False]}


def read_postings(text):
    try:
        found = [float(part) for part in text.split(",")]
    except ValueError as error:
        raise UsageError(f"--postings {text}: is not a list of numbers, as 0.05,0.1") from error
    if not all(0 < one < math.inf for one in found):
        raise UsageError(f"--postings {text}: not all are > 0 m")
    return found


# The whole


def margins(judge, postings, keys):
    """The content of margins.json; `keys`: those of error_keys(), or some of them."""
    numbers = judge.numbers({})
    verdicts = judge.verdicts({})
    judged = [name for name, passes in verdicts.items() if passes is not None]
    progress = judge.progress
    progress.start("keys and postings", len(keys) + len(postings))
    answer = {"format": "landfall.margins", "version": 1, "source": judge.runner.version.strip(), "seed": judge.base["scan"]["seed"], "draw": judge.base["scan"]["draw"],
              "pass": requirements.all_of(verdicts), "requirements": requirements.margins_of(numbers, judge.base["eval"]), "keys": {}, "postings": []}
    for resolution_m in postings:  # first, so that one that is refused ends the run early
        answer["postings"].append(posting(judge, resolution_m))
        progress.step()
    for key, ends in keys.items():
        answer["keys"][key] = key_margin(judge, key, *ends, judged)
        progress.step()
    progress.clear()
    return answer


def options_of(arguments):
    parser = command.Parser(description="How far a chain is from its limits: the margin of each requirement, the largest error of each kind "
                            "with which it passes, and the postings that pass.")
    parser.add_argument("-c", "--config", metavar="FILE", action="append", default=[], help="configuration of landfall run: a file, - (standard input) or preset:NAME; repeatable")
    parser.add_argument("--set", metavar="KEY=JSON", action="append", default=[], help="set a configuration value; repeatable")
    parser.add_argument("-o", "--output", metavar="FILE", required=True, help="margins.json; an interrupted run resumes from the folder FILE.runs")
    parser.add_argument("-O", "--overwrite", action="store_true", help="replace outputs that exist")
    parser.add_argument("--report", metavar="FILE", help="write an HTML report")
    parser.add_argument("--postings", metavar="M,M,...", default=",".join(map(str, POSTINGS)), help="bin widths to judge, metres (%(default)s)")
    parser.add_argument("--keys", metavar="KEY,KEY,...", type=lambda text: text.split(","), help="search these errors only (all)")
    parser.add_argument("--require-pass", action="store_true", help="exit with 3 unless every requirement passes as configured")
    parser.add_argument("-q", "--quiet", action="store_true", help="print no table")
    parser.add_argument("--progress", action="store_true", default=sys.stderr.isatty(), help="show progress; default: only if stderr is a terminal")
    options = parser.parse_args(arguments)
    if not options.config:
        raise UsageError("-c: a configuration is required, as preset:paper (see --help)")
    command.check_outputs([path for path in (options.output, options.report) if path], options.overwrite)
    return options


def work_folder(output):
    """The folder that keeps what an interrupted run has found, and the lock that says that a run is in it."""
    folder = output + ".runs"
    if os.path.lexists(folder) and not os.path.isdir(os.path.join(folder, "cache")):
        raise UsageError(f"{folder}: is not a folder of an interrupted run; move it, or choose another -o")
    os.makedirs(os.path.join(folder, "cache"), exist_ok=True)
    lock = runs.locked(folder)
    if lock is None:
        raise UsageError(f"{folder}: another run uses it; wait, or choose another -o")
    return folder, lock


def main(arguments):
    options = options_of(arguments)
    postings = read_postings(options.postings)
    base = read_chain(options.config, options.set)
    keys = chosen_keys(error_keys(base), options.keys)
    folder, _lock = work_folder(options.output)  # which is held while the name lives
    judge = Judge(base, runs.Runner(folder), runs.Progress() if options.progress else runs.Silent())
    answer = margins(judge, postings, keys)
    if options.report:
        margin_page.write(answer, base, options.report)
    runs.write_json(options.output, answer)
    shutil.rmtree(folder, ignore_errors=True)
    if not options.quiet:
        print(printable_lines(margin_page.text_of(answer)))
    if options.require_pass and not answer["pass"]:
        sys.exit(3)
