#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""lib and tools take elementary functions from base/portable_math.h; docs/quality/processors.md lists the others, each with its reason."""
import os
import re
import unittest

ROOT = os.environ["LANDFALL_ROOT"]
PAGE = os.path.join(ROOT, "docs", "quality", "processors.md")
# The functions of <cmath> that IEEE 754 does not define, and Eigen's that call them.
CALLS = re.compile(r"\bstd::(?:sin|cos|tan|asin|acos|atan|atan2|sinh|cosh|tanh|asinh|acosh|atanh|exp|exp2|expm1|log|log2|log10|log1p|pow"
                   r"|hypot|cbrt|erf|erfc|tgamma|lgamma|polar)\b|\bAngleAxis\w*|\bslerp\(|\bboost::math::(?!tools\b)\w+")


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def code(text):
    return re.sub(r"//.*", "", text)


class ElementaryFunctions(unittest.TestCase):
    def test_those_of_the_c_library_are_listed(self):
        listed = set(re.findall(r"^\| `(lib/[^`]+|tools/[^`]+)` \|", read(PAGE), re.MULTILINE))
        names = [os.path.join(folder, name) for top in ("lib", "tools") for folder, _, files in os.walk(os.path.join(ROOT, top)) for name in files]
        found = {os.path.relpath(name, ROOT) for name in names if name.endswith((".cpp", ".h")) and CALLS.search(code(read(name)))}
        self.assertGreater(len(found), 3)
        self.assertEqual(found, listed)


if __name__ == "__main__":
    unittest.main()
