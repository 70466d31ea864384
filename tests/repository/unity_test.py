#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/check_unity.py: names of units that preset release compiles together, in this repository and in a small one."""
import os
import pathlib
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(os.environ["LANDFALL_ROOT"])
UNIT = "namespace landfall {{\nnamespace {{\n{}\n}}  // namespace\n}}  // namespace landfall\n"


def check(root):
    result = subprocess.run([str(ROOT / "scripts" / "check_unity.py"), str(root)], capture_output=True, text=True, check=False)
    return result.returncode, result.stdout + result.stderr


class Unity(unittest.TestCase):
    def checked(self, one, other, library="landfall_library(some FOLDERS . LINKS)", header=""):
        with tempfile.TemporaryDirectory(prefix="landfall-unity-") as folder:
            some = pathlib.Path(folder) / "lib" / "some"
            some.mkdir(parents=True)
            (some / "CMakeLists.txt").write_text(library, encoding="utf-8")
            for name, text in {"one.cpp": UNIT.format(one), "other.cpp": UNIT.format(other), "some.h": header}.items():
                (some / name).write_text(text, encoding="utf-8")
            return check(folder)[0]

    def test_this_repository(self):
        self.assertEqual(check(ROOT), (0, "units that are compiled together have names of their own\n"))

    def test_names_that_collide(self):
        for one, other in [
                ("constexpr double kPi = 3;", "constexpr int kPi = 3;"),
                ("double f(const A& a, int b = g({1, 2})) { return 1; }", "int f(const A& x, int) { return b; }"),
                ("double f(const A& a) { return 1; }", "template <class B, class C> double f(const std::map<B, C>&) { return 1; }"),
                ("constexpr A kAll[] = {{1, f(2)}};\nstruct B { int a; };", "constexpr C kAll[2] = {};"),
                ("struct Row {\n int a;\n};", "using Row = int;"),
                ("using Row = std::vector<double>;", "using Row = a::Row;"),
                ("int row() { return 1; }", "int row = 0;"),
                ("constexpr auto k = g([](auto a) { return a; }, 1);\nint f() { return 0; }", "void f() {}")]:
            self.assertEqual(self.checked(one, other), 1, (one, other))
        self.assertEqual(self.checked("constexpr int kRows = 1;", "", header="inline constexpr int kRows = 2;\n"), 1)
        self.assertEqual(self.checked("int f(int a) { return a; }", "", header="inline int f(int b) { return b; }\n"), 1)
        self.assertEqual(self.checked("struct Row {\n int a;\n};", "", header="struct Row {\n  int a;\n};\n"), 1)

    def test_names_that_do_not(self):
        for one, other in [
                ("double f(const A& a) { return 1; }", "double f(const B& a, std::map<int, int> b) { return 1; }"),
                ("using Json = nlohmann::json;", "using Json = nlohmann::json;"),
                ("int f() { int row = 1; return row; }", "int g() { int row = 1; return row; }  // int f() {}"),
                ('constexpr const char* kText = "}; int f() {}";', "int f() { return '}'; }"),
                ("static_assert(a == 1);", "static_assert(a == 1);")]:
            self.assertEqual(self.checked(one, other), 0, (one, other))
        self.assertEqual(self.checked("struct Row {\n int a;\n};", "", header="struct Row;\nclass Table {\n  struct Row {};\n};\n"), 0)
        self.assertEqual(self.checked("using shared::Row;\nusing shared::f;", "", header="struct Row {};\ninline int f(int b) { return b; }\n"), 0)

    def test_unit_tests(self):
        for one, other, result in [
                ("TEST(Row, Fits) { f(); }", "TEST_F(Row, Fits) { f(); }", 1),
                ("TEST(Row, Fits) { f(); }", "TEST(Row, IsShort) { f(); }", 0),
                ("INSTANTIATE_TEST_SUITE_P(All, Row, kRows, [](int i) { return i; });", "INSTANTIATE_TEST_SUITE_P(All, Row, kRows);", 1),
                ("INSTANTIATE_TEST_SUITE_P(All, Row, kRows, [](int i) { return i; });\nint row = 1;", "int column = 1;", 0)]:
            self.assertEqual(self.checked(one, other, "landfall_gtest(some SOURCES one.cpp other.cpp LINKS)"), result, (one, other))
            self.assertEqual(self.checked(one, other, "landfall_gtest(some SOURCES one.cpp other.cpp LINKS ALONE one.cpp)"), 0)

    def test_only_units_that_are_compiled_together_matter(self):
        alone_first = "landfall_library(some FOLDERS . ALONE {} LINKS)"
        self.assertEqual(self.checked("int f() { return 1; }", "int f() { return 2; }", alone_first.format("third.cpp")), 1)
        plugin = "file(GLOB all CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} *.cpp)\nlist(REMOVE_ITEM all third.cpp)\nlandfall_plugin(some SOURCES ${all} LINKS)"
        self.assertEqual(self.checked("int f() { return 1; }", "int f() { return 2; }", plugin), 1)
        for library in ["landfall_library(some FOLDERS room LINKS)",
                        alone_first.format("other.cpp"),
                        "landfall_library(some FOLDERS . LINKS ALONE third.cpp KERNELS other.cpp)",
                        "landfall_library(first FOLDERS one.cpp LINKS)\nlandfall_library(some FOLDERS . LINKS)",
                        "landfall_library(some FOLDERS . EXCEPT other.cpp LINKS)"]:
            self.assertEqual(self.checked("int f() { return 1; }", "int f() { return 2; }", library), 0, library)


if __name__ == "__main__":
    unittest.main()
