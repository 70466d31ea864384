#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""lib and tools take elementary functions from base/numerics/portable_math.h; docs/quality/tests.md lists the others, each with its reason."""
import glob
import os
import re
import subprocess
import unittest

ROOT = os.environ["LANDFALL_ROOT"]
BUILD = os.path.dirname(os.environ["LANDFALL_BIN"])
PAGE = os.path.join(ROOT, "docs", "quality", "tests.md")
# The functions of <cmath> that IEEE 754 does not define, and Eigen's that call them.
CALLS = re.compile(r"\bstd::(?:sin|cos|tan|asin|acos|atan|atan2|sinh|cosh|tanh|asinh|acosh|atanh|exp|exp2|expm1|log|log2|log10|log1p|pow"
                   r"|hypot|cbrt|erf|erfc|tgamma|lgamma|polar)\b|\bAngleAxis\w*|\bslerp\(|\bboost::math::(?!tools\b)\w+")
# The same as symbols, complex ones as well, and the fused operation of long double: double's is exact.
SYMBOLS = re.compile(r" U c?((?:a?(?:sin|cos|tan)h?|atan2|exp|exp2|exp10|expm1|log|log2|log10|log1p|sincos|pow|hypot|cbrt|erfc?|[lt]gamma)"
                     r"[fl]?|fmal)$", re.MULTILINE)


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def code(text):
    return re.sub(r"//.*", "", text)


class ElementaryFunctions(unittest.TestCase):
    def test_those_of_the_c_library_are_listed(self):
        listed = set(re.findall(r"^\| `((?:lib|tools)/[^`]+[^/`])` \|", read(PAGE), re.MULTILINE))
        names = [os.path.join(folder, name) for top in ("lib", "tools") for folder, _, files in os.walk(os.path.join(ROOT, top)) for name in files]
        found = {os.path.relpath(name, ROOT) for name in names if name.endswith((".cpp", ".h")) and CALLS.search(code(read(name)))}
        self.assertGreater(len(found), 3)
        self.assertEqual(found, listed)

    def test_header_libraries_call_no_others(self):
        """By the symbols of each object, which no pattern of the source finds: Boost, CGAL and Eigen call functions as well."""
        rows = re.findall(r"^\| `(lib/[^`]+)` \| (.*?) \|", read(PAGE), re.MULTILINE)
        objects = glob.glob(os.path.join(BUILD, "lib", "**", "landfall_*.dir", "**", "*.o"), recursive=True)
        self.assertGreater(len(objects), 10)
        for name in objects:
            unity = name.removesuffix(".o")  # What LANDFALL_UNITY compiles together; else one source, by its path in lib.
            sources = re.findall(r"/(lib/[^\"]+)\"", read(unity)) if os.path.exists(unity) else ["lib/" + unity.rpartition(".dir/")[2]]
            listed = {called for place, names in rows if any(place in source for source in sources) for called in re.findall(r"`(\w+)`", names)}
            symbols = subprocess.run(["nm", "--undefined-only", name], capture_output=True, text=True, check=True).stdout
            with self.subTest(name):
                self.assertLessEqual(set(SYMBOLS.findall(symbols)), listed)


if __name__ == "__main__":
    unittest.main()
