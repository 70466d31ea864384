# SPDX-License-Identifier: GPL-3.0-or-later
"""Mutant schemata: a copy of the sources in which every mutant is compiled in (schema.h), and the list of mutants."""
import glob
import hashlib
import json
import os
import pickle
import re
import shlex
import subprocess
import types

import points
from points import Finder

HERE = os.path.dirname(os.path.abspath(__file__))
OUTERMOST_FIRST = ["array", "statement", "return", "condition", "logical", "relational", "assignment", "arithmetic", "extreme", "lanes",
                   "constant", "use"]
COPIED = ["CMakeLists.txt", "CMakePresets.json", "cmake", "lib", "tools", "tests", "testdata", "schemas", "packaging", "scripts"]
# For the mutated sources and their tests: libstdc++ checks indices.
FLAGS = "-O1 -g0 -Wno-error=deprecated-declarations -D_GLIBCXX_ASSERTIONS"


def compile_arguments(database, folder):
    """The arguments that the parser needs, from the compile command of the folder's first file."""
    with open(database, encoding="utf-8") as file:
        commands = json.load(file)
    command = next(c["command"] for c in commands if os.path.dirname(c["file"]) == folder)
    words = shlex.split(command)
    pairs = [pair for i, word in enumerate(words) if word == "-isystem" for pair in words[i:i + 2]]
    return [w for w in words if re.match("-[ID]|-std", w)] + pairs + ["-x", "c++", "-Wno-pragma-once-outside-header"]


def find_points(root, library, database, cache):
    """{path below root: Finder}, with the text, points and constants of each file."""
    folder = os.path.join(root, "lib", library)
    found = {}
    for path in sorted(glob.glob(folder + "/*.cpp") + glob.glob(folder + "/*.h")):
        # A header of Highway's is compiled once for each instruction set; alone, it has none to be repeated for.
        alone = ["-DHWY_COMPILE_ONLY_STATIC"] if path.endswith("-inl.h") else []
        found[os.path.relpath(path, root)] = found_in(path, compile_arguments(database, folder) + alone, cache)
    return found


def found_in(path, arguments, cache):
    with open(path, "rb") as file, open(points.__file__, "rb") as program:
        name = os.path.join(cache, hashlib.sha256(path.encode() + file.read() + program.read()).hexdigest())
    if os.path.exists(name):
        with open(name, "rb") as file:
            return types.SimpleNamespace(**pickle.load(file))
    finder = Finder(path, arguments)
    if finder.errors:
        raise SystemExit("\n".join(finder.errors))
    finder.find()
    found = {"text": finder.text, "points": finder.points, "constants": finder.constants}
    os.makedirs(cache, exist_ok=True)
    with open(name, "wb") as file:
        pickle.dump(found, file)
    return types.SimpleNamespace(**found)


def number_mutants(finders, root):
    """Numbers the mutants, and gives each use of a named constant the mutant of its declaration."""
    listed, constants = [], {}

    def enter(mutant, file, function, line):
        mutant.id = len(listed) + 1
        listed.append({"id": mutant.id, "file": file, "line": line, "function": function, "kind": mutant.kind,
                       "change": mutant.change})

    for file, finder in finders.items():
        for point in sorted(finder.points.values(), key=lambda p: (p.start, -p.end)):
            for mutant in point.mutants:
                enter(mutant, file, point.function, point.line)
        for offset, (mutant, function) in finder.constants.items():
            enter(mutant, file, function, finder.text.count("\n", 0, offset) + 1)
            constants[os.path.join(root, file), offset] = mutant
    for finder in finders.values():
        for key, point in list(finder.points.items()):
            if point.named:
                if point.named in constants:
                    point.mutants = [constants[point.named]]
                else:
                    del finder.points[key]
    name_mutants(listed)
    return listed


def name_mutants(listed):
    """Adds a key that does not depend on line numbers: file, function, change, and a number if these are equal."""
    seen = {}
    for mutant in listed:
        key = f"{mutant['file']}: {mutant['function']}: {mutant['change']}"
        seen[key] = seen.get(key, 0) + 1
        mutant["key"] = key if seen[key] == 1 else f"{key} #{seen[key]}"


def render(file, finder, dropped):
    """The text of the file with all points replaced, except those with a dropped mutant."""
    kept = [p for p in finder.points.values() if not {m.id for m in p.mutants} & dropped]
    kept.sort(key=lambda p: (p.start, -p.end, OUTERMOST_FIRST.index(kind_of(p))))
    # Headers are also included by files that are compiled with warnings as errors.
    silence = "#pragma GCC system_header\n" if file.endswith(".h") else ""
    # A function whose throw is removed returns, so it must not be [[noreturn]].
    text = render_piece(finder.text, 0, len(finder.text), kept).replace("[[noreturn]] ", "")
    return silence + '#include "landfall_mutant/schema.h"\n#line 1\n' + text


def kind_of(point):
    return "use" if point.named else point.mutants[0].kind if point.mutants else "array"


def render_piece(text, start, end, points):
    """text[start:end] with its points replaced; they are sorted, outer points first."""
    result, offset, i = [], start, 0
    while i < len(points):
        point = points[i]
        inner = [p for p in points[i + 1:] if point.start <= p.start and p.end <= point.end]
        result.append(text[offset:point.start])
        for part in point.parts:
            if isinstance(part, str):
                result.append(re.sub(r"@(\d)", lambda m: str(point.mutants[0].id + int(m[1])), part))
            else:
                result.append(render_piece(text, *part, [p for p in inner if part[0] <= p.start and p.end <= part[1]]))
        offset = point.end
        i += 1 + len(inner)
    return "".join(result) + text[offset:end]


def write_tree(root, target, finders, dropped):
    """Copies the repository, with mutants in the files of `finders`. Only changed files are written, to keep builds short."""
    listed = subprocess.run(["git", "ls-files", *COPIED], cwd=root, check=True, capture_output=True, text=True).stdout.split("\n")
    for name in filter(None, listed):
        if name not in finders:
            with open(os.path.join(root, name), "rb") as file:
                write(os.path.join(target, name), file.read())
    with open(os.path.join(HERE, "schema.h"), "rb") as file:
        write(os.path.join(target, "lib", "landfall_mutant", "schema.h"), file.read())
    for file, finder in finders.items():
        write(os.path.join(target, file), render(file, finder, dropped).encode("latin-1"))
    libraries = sorted({file.split("/")[1] for file in finders})
    for folder, name in (("lib", "landfall_{}"), ("tests", "{}_test")):
        with open(os.path.join(root, folder, "CMakeLists.txt"), "rb") as file:
            options = "".join(f"target_compile_options({name.format(library)} PRIVATE {FLAGS})\n" for library in libraries)
            write(os.path.join(target, folder, "CMakeLists.txt"), file.read() + options.encode())


def write(path, text):
    if os.path.exists(path):
        with open(path, "rb") as file:
            if file.read() == text:
                return
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as file:
        file.write(text)
