# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds generated files of a study that a crash or a full disk has damaged, and removes them, so that make makes them again.

Called under the study's lock, before make looks at any file.
"""
import contextlib
import hashlib
import json
import os
import re

from landfall.study import session, stages

CHECKSUM = "# checksum: "
PLAN = ("tools.txt", "targets.txt", "names.txt", "cases.json")
# Written by Python under such names first; the number is the process.
TEMPORARY = re.compile(r"(?:\..*\.(\d+)\.part|.*\.(\d+)\.tmp)")
HDF5 = b"\x89HDF\r\n\x1a\n"
PNG_END = b"IEND\xaeB`\x82"


def checksum(files):
    """Of {name: text}: what the last line of study.mk says of the rest of the plan."""
    digest = hashlib.sha256()
    for name in sorted(files):
        data = files[name].encode()
        digest.update(f"{name} {len(data)}\n".encode() + data)
    return digest.hexdigest()


def repair(folder):
    """Names of the files that are made again; they and what is made with them are removed."""
    sweep(folder)
    return [*_plan(folder), *_outputs(folder), *_table(folder), *_pages(folder)]


def sweep(folder):
    """Removes temporary files of processes that have ended."""
    for top in ("", "config", "readers", "figures"):
        for inner, _, names in os.walk(os.path.join(folder, top)) if top else [(folder, [], _names(folder))]:
            for name in names:
                match = TEMPORARY.fullmatch(name)
                if match and not os.path.exists(f"/proc/{match[1] or match[2]}"):
                    _remove(inner, name)


def _plan(folder):
    """The plan is made again as a whole, which writes only what differs."""
    if not os.path.exists(os.path.join(folder, "study.mk")):
        return []
    text = _read(folder, "study.mk").decode(errors="replace")
    body, _, last = text.rpartition(CHECKSUM)
    readers = {f"readers/{name}" for name in re.findall(r"--drop \$O/shared/([^\s)]+)", body)}
    files = {name: _read(folder, name).decode(errors="replace") for name in (*PLAN, *readers)}
    bad = [name for name in sorted(set(re.findall(r"\$O/(config/\w+/[0-9a-f]+\.json)", body))) if not _is_config(folder, name)]
    if last.strip() != checksum({**files, "study.mk": body}):
        bad.append("study.mk")
    if bad:
        _remove(folder, "study.mk")
    return bad


def _is_config(folder, name):
    """A configuration is named by the hash of its text."""
    _, tool, file = name.split("/")
    return stages.short_hash(tool, _read(folder, name).decode(errors="replace")) == file[:-5]


def _outputs(folder):
    """Results that are not JSON; HDF5 files that are shorter than they say."""
    bad = []
    for top in ("terrain", "truth", "scan", "dem", "eval", "hazard", "draws", "shared", *session.FORMATS):
        bad += [f"{top}/{name}" for name in _names(os.path.join(folder, top))
                if name.endswith((".h5", ".json")) and not name.startswith(".") and not _is_output(os.path.join(folder, top, name), top)]
    for name in bad:
        _remove(folder, name)
    return bad


def _is_output(path, top):
    return _is_result(path, session.FORMATS[top]) if top in session.FORMATS else _is_hdf5(path)


def _is_result(path, name):
    try:
        with open(path, "rb") as file:
            return json.load(file)["format"] == name
    except (OSError, ValueError, TypeError, KeyError):
        return False


def _is_hdf5(path):
    """Whether the file reaches the end that its superblock gives, at a byte that depends on the superblock's version."""
    try:
        with open(path, "rb") as file:
            head = file.read(52)
        if len(head) < 52 or not head.startswith(HDF5):
            return False
        at = {0: 40, 1: 44, 2: 28, 3: 28}.get(head[8])
        return at is None or os.path.getsize(path) >= int.from_bytes(head[at:at + 8], "little")
    except OSError:
        return False


def _table(folder):
    """results.csv stands for both files of the table."""
    return _again(folder, ["results.csv", "results.h5"], "results.csv")


def _pages(folder):
    """pass_rates.csv stands for all figures."""
    figures = os.path.join(folder, "figures")
    pictures = [f"figures/{name}" for name in _names(figures) if name.endswith(".png")]
    drawn = _again(folder, ["figures/pass_rates.csv", "figures/percentiles.csv", *pictures], "figures/pass_rates.csv")
    return drawn + _again(folder, ["report.html"], "report.html")


def _again(folder, names, target):
    """Those of the files that are damaged, if make holds `target` for made; it is removed then."""
    if not os.path.lexists(os.path.join(folder, target)):
        return []
    bad = [name for name in names if not _is_whole(os.path.join(folder, name))]
    if bad:
        _remove(folder, target)
    return bad


def _is_whole(path):
    if path.endswith(".h5"):
        return _is_hdf5(path)
    ending = {".csv": b"\n", ".png": PNG_END, ".html": b"</html>\n"}[os.path.splitext(path)[1]]
    try:
        with open(path, "rb") as file:
            file.seek(-len(ending), os.SEEK_END)
            return file.read() == ending
    except OSError:
        return False


def _names(folder):
    try:
        return sorted(os.listdir(folder))
    except OSError:
        return []


def _read(folder, name):
    try:
        with open(os.path.join(folder, name), "rb") as file:
            return file.read()
    except OSError:
        return b""


def _remove(folder, name):
    with contextlib.suppress(FileNotFoundError):
        os.remove(os.path.join(folder, name))
