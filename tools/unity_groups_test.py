#!/usr/bin/env python3
"""Tests of tools/unity_groups.py: what may share a batch and what may not."""
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
import unity_groups  # noqa: E402


def batches(**files):
    """The batch of each source; `a_cpp` is a.cpp, and a header is known to others as "layer/NAME.h"."""
    with tempfile.TemporaryDirectory() as folder:
        layer = pathlib.Path(folder) / "src/layer"
        layer.mkdir(parents=True)
        unity_groups.File.cache.clear()
        for name, text in files.items():
            (layer / name.replace("_", ".")).write_text(text)
        sources = [str(layer / name.replace("_", ".")) for name in sorted(files) if name.endswith("_cpp")]
        return [number for _, number in unity_groups.groups_of(sources)]


def unnamed(body):
    return "namespace sandlot {\nnamespace {\n" + body + "\n}  // namespace\n}  // namespace sandlot\n"


class Groups(unittest.TestCase):
    def test_different_names_go_together(self):
        self.assertEqual(batches(a_cpp=unnamed("int one() {\n  return 1;\n}"), b_cpp=unnamed("int two() {\n  return 2;\n}")), [1, 1])

    def test_the_same_name_keeps_apart(self):
        for body in ("int same() {\n  return 1;\n}", "struct same {\n  int x;\n};", "constexpr double g = 9.81, same = 1;",
                     "using same = int;"):
            self.assertEqual(batches(a_cpp=unnamed(body), b_cpp=unnamed("int same() {\n  return 2;\n}")), [1, 2], body)

    def test_the_same_name_in_other_namespaces_goes_together(self):
        body = unnamed("int same() {\n  return 1;\n}")
        self.assertEqual(batches(a_cpp=body, b_cpp=body.replace("sandlot", "sandlot::other")), [1, 1])

    def test_a_header_that_declares_the_name_keeps_apart(self):
        header = "namespace sandlot {\nconstexpr int same = 1;\n}  // namespace sandlot\n"
        self.assertEqual(batches(h_h=header, a_cpp='#include "layer/h.h"\n', b_cpp=unnamed("int same() {\n  return 2;\n}")), [1, 2])

    def test_a_header_that_declares_the_name_elsewhere_goes_together(self):
        for space in ("sandlot::other", "other"):
            header = f"namespace {space} {{\nconstexpr int same = 1;\n}}  // namespace {space}\n"
            self.assertEqual(batches(h_h=header, a_cpp='#include "layer/h.h"\n', b_cpp=unnamed("int same() {\n  return 2;\n}")), [1, 1])

    def test_a_macro_counts_while_it_is_defined(self):
        body = "#define SAME 1\n"
        self.assertEqual(batches(a_cpp=body, b_cpp=body), [1, 2])
        self.assertEqual(batches(a_cpp=body + "#undef SAME\n", b_cpp=body), [1, 1])

    def test_what_using_namespace_opens_keeps_apart(self):
        header = "namespace sandlot::parts {\nint same();\n}  // namespace sandlot::parts\n"
        for opened, expected in (("", [1, 1]), ("using namespace parts;\n", [1, 2])):
            user = f'#include "layer/h.h"\nnamespace sandlot {{\n{opened}}}  // namespace sandlot\n'
            self.assertEqual(batches(h_h=header, a_cpp=user, b_cpp=unnamed("int same() {\n  return 2;\n}")), expected, opened)

    def test_lists_are_cut_into_even_parts(self):
        long = {f"f{i}_cpp": "// line\n" * (unity_groups.MOST_LINES // 4) for i in range(6)}
        self.assertEqual(batches(**long), [1, 1, 1, 2, 2, 2])
        self.assertEqual(batches(a_cpp="// line\n" * (2 * unity_groups.MOST_LINES), b_cpp=""), [1, 2])

    def test_other_names_of_the_same_thing_go_together(self):
        for body in ("using test::same;", "using same = std::string;", "namespace same = std::filesystem;"):
            self.assertEqual(batches(a_cpp=unnamed(body), b_cpp=unnamed(body)), [1, 1], body)
        self.assertEqual(batches(a_cpp=unnamed("using test::same;"), b_cpp=unnamed("using other::same;")), [1, 2])
        self.assertEqual(batches(a_cpp=unnamed("using same = std::map<int, int>;"), b_cpp=unnamed("using same = std::map<int, bool>;")), [1, 2])

    def test_what_a_header_declares_and_a_file_uses_goes_together(self):
        header = "namespace sandlot {\nstruct same {\n  int x;\n};\n}  // namespace sandlot\n"
        for body, expected in (("using sandlot::same;", [1, 1]), ("using other::same;", [1, 2])):
            self.assertEqual(batches(h_h=header, a_cpp='#include "layer/h.h"\n', b_cpp=unnamed(body)), expected, body)

    def test_overloads_by_type_go_together_unless_the_types_have_one_name(self):
        def file(name):
            return unnamed(f"enum class {name} {{ one }};\ninline int enum_names({name}) {{\n  return 1;\n}}")
        self.assertEqual(batches(a_cpp=file("Colour"), b_cpp=file("Shape")), [1, 1])
        self.assertEqual(batches(a_cpp=file("Colour"), b_cpp=file("Colour")), [1, 2])

    def test_a_file_can_ask_to_be_alone(self):
        self.assertEqual(batches(a_cpp="// unity: alone\n", b_cpp="", c_cpp=""), [1, 2, 2])


if __name__ == "__main__":
    unittest.main()
