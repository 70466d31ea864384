#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Help, man pages and bash completion, which are generated from the tools' declarations of their options."""
import json
import os
import re
import shutil
import subprocess
import unittest

from harness import PROGRAMS, ROOT, TOOLS, ToolTest, read_bytes, run, tool

ALL = [name for name in PROGRAMS if name != "landfall"]
CONFIGURED = {name: PROGRAMS[name]["schema"] for name in TOOLS}

COMPLETE = """
source "$1"
shift
COMP_WORDS=("$@")
COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
function=$(complete -p -- "$1" | sed 's/.*-F \\([^ ]*\\) .*/\\1/')
$function 2>/dev/null
printf '%s\\n' "${COMPREPLY[@]}"
"""


def options_in(help_text):
    """The names of all options that --help lists, which begin its lines."""
    names = []
    for line in help_text.split("\n"):
        if match := re.match(r"  (-[^ ]*)", line):
            names += match[1].split(",")
    return names


def paths_of(config, prefix=""):
    """The dotted paths of a configuration's values."""
    for key, value in config.items():
        if isinstance(value, dict):
            yield from paths_of(value, prefix + key + ".")
        else:
            yield prefix + key


def keys_of(schema):
    """The names of all properties of a schema, at any depth."""
    if isinstance(schema, list):
        for element in schema:
            yield from keys_of(element)
    elif isinstance(schema, dict):
        yield from schema.get("properties", {})
        for value in schema.values():
            yield from keys_of(value)


def undescribed(schema, path=""):
    """Properties without a description. Constants, the names of components, need none: the component has one."""
    for key, value in schema.get("properties", {}).items():
        if "const" not in value and not value.get("description"):
            yield f"{path}/{key}"
        yield from undescribed(value, f"{path}/{key}")
    for name, definition in schema.get("definitions", {}).items():
        yield from undescribed(definition, f"{path}#{name}")


class Schemas(unittest.TestCase):
    def test_every_key_has_a_description_that_needs_no_other_key(self):
        for name in ("terrain", "scan", "regrid", "eval", "study"):
            schema = json.loads(read_bytes(os.path.join(ROOT, f"schemas/{name}.schema.json")))
            self.assertEqual(list(undescribed(schema)), [], name)
            self.assertNotRegex(json.dumps(schema), r'"description": "(Of|As|The same|At|About|Between) ', name)


class Help(ToolTest):
    def test_lines_fit_into_100_columns(self):
        for name in ALL:
            for line in self.succeed(name, "--help").stdout.split("\n"):
                self.assertLessEqual(len(line), 100, f"{name}: {line}")

    def test_groups_are_in_order_and_examples_last(self):
        for name in TOOLS:
            text = self.succeed(name, "--help").stdout
            heads = re.findall(r"^([A-Z]\w+):$", text, re.M)
            self.assertEqual([h for h in heads if h != "Positionals"],
                             ["Options", "Configuration", "Output", "General", "Examples"], name)
        text = self.succeed("landfall-info", "--help").stdout
        self.assertEqual(re.findall(r"^([A-Z]\w+):$", text, re.M), ["Positionals", "Options", "Output", "General", "Examples"])

    def test_the_print_options_are_hidden(self):
        for name in ALL:
            self.assertNotIn("--print-man", self.succeed(name, "--help").stdout)

    def test_every_option_is_in_the_documentation(self):
        for name in ALL:
            pages = ""
            for page in ("cli", name):
                pages += read_bytes(os.path.join(ROOT, "docs", "user", page + ".md")).decode()
            for option in options_in(self.succeed(name, "--help").stdout):
                self.assertRegex(pages, rf"(?<![\w-]){option}(?![\w-])", name)


class ManPage(ToolTest):
    def rendered(self, name):
        """The page as a terminal shows it, without its hyphenation and wrapping."""
        path = self.write(name + ".1", self.succeed(name, "--print-man").stdout)
        result = subprocess.run(["groff", "-man", "-Tascii", "-ww", "-P-c", "-P-b", "-P-u", "-rLL=1000n", path],
                                capture_output=True, text=True, check=True)
        self.assertEqual(result.stderr, "", name)
        return result.stdout

    @unittest.skipUnless(shutil.which("groff"), "groff-base is not installed")
    def test_groff_gives_no_warning(self):
        for name in ALL:
            text = self.rendered(name)
            heads = re.findall(r"^([A-Z][A-Z ]+)$", text, re.M)
            expected = ["NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "CONFIGURATION", "EXIT STATUS", "ENVIRONMENT",
                        "EXAMPLES", "FILES", "SEE ALSO"]
            if name not in CONFIGURED:
                expected.remove("CONFIGURATION")
            if "plugin" not in PROGRAMS[name]:
                expected.remove("ENVIRONMENT")
            self.assertEqual(heads, expected, name)

    @unittest.skipUnless(shutil.which("man"), "man-db is not installed")
    def test_man_gives_no_warning(self):
        for name in ALL:
            page = self.succeed(name, "--print-man").stdout
            result = subprocess.run(["man", "--warnings", "-l", "-"], input=page, capture_output=True, text=True, check=True,
                                    env={**os.environ, "MANWIDTH": "80", "LC_ALL": "C.UTF-8", "PAGER": "cat"})
            self.assertEqual(result.stderr, "", name)

    @unittest.skipUnless(shutil.which("groff"), "groff-base is not installed")
    def test_every_option_of_help_is_in_it(self):
        for name in ALL:
            text = self.rendered(name)
            for option in options_in(self.succeed(name, "--help").stdout):
                self.assertRegex(text, rf"(?m)^ +(-[^ ]+, )*{option}(,| |$)", name)

    @unittest.skipUnless(shutil.which("groff"), "groff-base is not installed")
    def test_examples_can_be_copied(self):
        for name in ALL:
            text = self.rendered(name)
            for line in self.succeed(name, "--help").stdout.split("Examples:\n")[1].split("\n"):
                if line.startswith("  "):
                    self.assertIn(line.strip(), text, name)

    @unittest.skipUnless(shutil.which("groff"), "groff-base is not installed")
    def test_every_key_of_the_configuration_is_in_it(self):
        for name, schema in CONFIGURED.items():
            text = self.rendered(name)
            config = json.loads(self.succeed(name, "--print-config").stdout)
            self.assertGreater(len(list(paths_of(config))), 1)
            for path in paths_of(config):
                self.assertRegex(text, rf"(?m)^ +{re.escape(path)} \(", name)
            with open(os.path.join(ROOT, "schemas", schema + ".schema.json"), encoding="utf-8") as file:
                for key in keys_of(json.load(file)):
                    self.assertIn(key, text, name)

    @unittest.skipUnless(shutil.which("groff"), "groff-base is not installed")
    def test_a_key_has_type_unit_bounds_default_and_meaning(self):
        text = re.sub(r"\s+", " ", self.rendered("scan-sim"))
        self.assertIn("laser.scan_time_s (number, s, above 0, at most 1e6; default 2)", text)
        self.assertIn('detector.estimator (one of "mean", "first", "median", "strongest"; default "mean")', text)
        self.assertIn("mount.rpy_deg (array of 3 numbers, degrees, at least -1e9, at most 1e9; default [180,0,0])", text)
        self.assertIn('scanner.max_deflection_deg (number, degrees, above 0, at most 180; default 30)', text)
        self.assertIn("detector.subpixels (integer, at least 1, at most 64; default 1) Sub-rays per pixel along each axis: m gives m x m rays.", text)

    @unittest.skipUnless(shutil.which("groff"), "groff-base is not installed")
    def test_the_keys_of_a_choice_are_listed_below_it(self):
        lines = self.rendered("scan-sim").split("\n")
        indent = len(" " * 7)
        at = lines.index(" " * indent + 'scanner of type "fsm"')
        under = lines[at + 1:lines.index(" " * indent + 'scanner of type "risley"')]
        keys = [line.split()[0] for line in under if re.match(r" +scanner\.\S+ \(", line)]
        self.assertIn("scanner.max_deflection_deg", keys)
        self.assertTrue(all(line.startswith(" " * (indent + 1)) for line in under if line))

    def test_the_page_is_reproducible(self):
        for name in ALL:
            self.assertEqual(self.succeed(name, "--print-man").stdout, run(name, "--print-man").stdout)


class Completion(ToolTest):
    def candidates(self, name, *words):
        script = self.write(name, self.succeed(name, "--print-completion").stdout)
        result = subprocess.run(["bash", "--norc", "--noprofile", "-c", COMPLETE, "bash", script, name, *words],
                                capture_output=True, text=True, check=True, cwd=self.folder)
        self.assertEqual(result.stderr, "")
        return [line for line in result.stdout.split("\n") if line]

    def test_all_options(self):
        for name in ALL:
            self.assertEqual(sorted(self.candidates(name, "-")),
                             sorted(options_in(self.succeed(name, "--help").stdout)), name)
        self.assertEqual(self.candidates("scan-sim", "--eng"), ["--engine"])

    def test_values_of_an_option(self):
        self.assertEqual(self.candidates("regrid", "--method", "m"), ["mean", "min", "max", "median"])
        self.assertEqual(self.candidates("regrid", "--method", "=", "bil"), ["bilinear_nearest", "bilinear4"])
        self.assertEqual(self.candidates("scan-sim", "-t", ""), [])

    def test_keys_after_set(self):
        for name in CONFIGURED:
            keys = self.candidates(name, "--set", "")
            self.assertTrue(all(key.endswith("=") for key in keys))
            for path in paths_of(json.loads(self.succeed(name, "--print-config").stdout)):
                self.assertIn(path + "=", keys, name)
        self.assertEqual(self.candidates("scan-sim", "--set", "laser."), ["laser.pulse_rate_hz=", "laser.scan_time_s="])
        self.assertEqual(self.candidates("terrain-gen", "--set", "features.0.fresh"), ["features.0.freshness="])

    def test_values_of_a_key_can_be_given_to_the_tool(self):
        for words in (["scanner.type", "="], ["scanner.type", "=", "f"], ["scanner.type", "=", '\\"f']):
            values = self.candidates("scan-sim", "--set", *words)
            self.assertIn('\\"fsm\\"', values)
        self.assertEqual(values, ['\\"flash\\"', '\\"fsm\\"'])
        self.assertEqual(self.candidates("terrain-gen", "--set", "patterns.0.overlap", "="), ["false", "true"])
        command = f'{tool("scan-sim")} --check --set scanner.type={values[0]}'
        self.assertEqual(subprocess.run(["bash", "-c", command], check=False).returncode, 0)

    def test_files_by_their_extension(self):
        for name in ("a.h5", "b.json", "c d.h5", "e.txt"):
            self.config("", name)
        os.mkdir(self.path("folder"))
        def files(*arguments):
            return sorted(self.candidates(*arguments))
        self.assertEqual(files("dem-eval", ""), ["a.h5", "c d.h5", "folder"])
        self.assertEqual(files("dem-eval", "--metrics-only", ""), ["a.h5", "c d.h5", "folder"])
        self.assertEqual(files("landfall-info", "a.h5", "c"), ["c d.h5"])
        self.assertEqual(files("scan-sim", "-c", ""), ["b.json", "folder"])
        self.assertEqual(files("scan-sim", "--terrain", "="), ["a.h5", "c d.h5", "folder"])
        self.assertEqual(files("scan-sim", "-o", "e"), ["e.txt"])

    def test_the_scripts_are_valid_bash(self):
        for name in ALL:
            script = self.succeed(name, "--print-completion").stdout
            result = subprocess.run(["bash", "-n"], input=script, capture_output=True, text=True, check=False)
            self.assertEqual((result.returncode, result.stderr), (0, ""), name)


if __name__ == "__main__":
    unittest.main()
