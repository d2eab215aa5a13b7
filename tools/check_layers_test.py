#!/usr/bin/env python3
"""Plants breaches in a small tree and expects check_layers.py to name each of them, and nothing else."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).with_name("check_layers.py")
LAYERS = """
base:
physics: base
optics: physics base
devices: optics physics base
app: *
peers: devices
third-party ode | ode/ | physics/rigid
third-party fmt | fmt/ | *
"""


class CheckLayers(unittest.TestCase):
    def check(self, path, text):
        """The problems found in a tree with this one file: (exit code, what was printed)."""
        with tempfile.TemporaryDirectory() as folder:
            src = pathlib.Path(folder, "src")
            file = src / path
            file.parent.mkdir(parents=True)
            file.write_text(text)
            (src / "layers.txt").write_text(LAYERS)
            run = subprocess.run([sys.executable, SCRIPT, src], capture_output=True, text=True)
            return run.returncode, run.stdout + run.stderr

    def refused(self, path, text, *words):
        code, output = self.check(path, text)
        self.assertEqual(code, 1, f"{text!r} in {path} was let through: {output}")
        self.assertIn("1 problems", output, output)
        for word in words:
            self.assertIn(word, output)

    def allowed(self, path, text):
        code, output = self.check(path, text)
        self.assertEqual(code, 0, output)

    def test_an_include_points_down_only(self):
        self.allowed("optics/a.h", '#include "physics/b.h"\n#include "optics/c.h"\n#include <vector>\n')
        self.refused("physics/a.h", '\n#include "optics/b.h"\n', "a.h:2:", "physics must not include optics")
        self.refused("physics/a.cpp", '  #  include "app/b.h"\n', "physics must not include app")
        self.allowed("app/a.cpp", '#include "devices/laser/laser.h"\n')
        self.refused("unknown/a.h", '#include "base/b.h"\n', "not a layer")
        self.refused("base/a.h", '#include "b.h"\n', "names its layer")

    def test_siblings_do_not_meet_but_share_the_border(self):
        self.allowed("devices/laser/laser.h", '#include "devices/kind.h"\n#include "devices/laser/beam.h"\n')
        self.refused("devices/laser/laser.h", '#include "devices/motor/motor.h"\n', "sibling devices/motor")
        self.allowed("devices/kinds.cpp", '#include "devices/motor/motor.h"\n')

    def test_third_party_headers_stay_with_their_owner(self):
        self.allowed("physics/rigid/world.cpp", "#include <ode/ode.h>\n#include <fmt/format.h>\n#include <cmath>\n")
        self.refused("physics/planar/world.cpp", "#include <ode/ode.h>\n", "ode belongs to physics/rigid")
        self.refused("physics/rigidity.cpp", "#include <ode/ode.h>\n", "ode belongs to")
        self.refused("base/a.cpp", "#include <zlib.h>\n", "no third-party line")

    def test_a_test_may_include_from_anywhere(self):
        self.allowed("base/a_test.cpp", '#include "app/b.h"\n#include <gtest/gtest.h>\n')

    def test_libm_is_banned_bare_and_with_std(self):
        for call in ("std::sin(x)", "sin(x)", "::cosf (x)", "std :: pow(x, 2)", "y = 2*atan2(y, x)", "fma(a, b, c)"):
            self.refused("physics/a.cpp", f"double y = {call};\n", "math.h")
        self.refused("physics/a_test.cpp", "double y = std::exp(x);\n", "math.h")
        self.refused("physics/a.cpp", "using std::sin;\n", "math::")
        for call in ("math::sin(x)", "sandlot::math::exp(x)", "std::sqrt(x)", "std::floor(x)", "v.array().cos()",
                     "p->log(x)", "wasting(x)", "std::abs(x)", "log::info(x)", "my_sin(x)", "std::lower_bound(x)"):
            self.allowed("physics/a.cpp", f"auto y = {call};\n")
        self.allowed("base/math.cpp", "double y = std::sin(x);\n")

    def test_chance_and_wall_clocks_are_banned(self):
        for text in ("std::mt19937 g;", "int x = rand();", "std::srand(1);", "std::random_device d;",
                     "std::normal_distribution<double> n;"):
            self.refused("physics/a.cpp", text + "\n", "base/random.h")
        self.allowed("physics/a.cpp", "Stream random(int key);\nint n = dRandInt(5);\n")
        now = "auto t = std::chrono::steady_clock::now();\n"
        self.refused("physics/a.cpp", now, "wall clock")
        self.allowed("app/a.cpp", now)

    def test_comments_and_texts_are_no_code(self):
        self.allowed("physics/a.cpp", '// std::sin(x)\n/* rand()\n sin(x) */ auto t = "cos(x)";\n'
                                      'auto r = R"(std::exp(x) ")";\nint n = 1\'000\'000;\n')
        self.refused("physics/a.cpp", '/* two\nlines */ auto t = "a\\"b"; int n = 1\'000; auto y = sin(x);\n', "a.cpp:2:")

    def test_a_reason_lets_a_call_pass(self):
        self.allowed("physics/a_test.cpp", "double y = std::sin(x);  // lint-ok: libm is the oracle\n")

    def test_files_stay_short(self):
        self.allowed("base/a.h", "\n" * 300)
        self.refused("base/a.h", "\n" * 301, "over 300 lines")
        self.allowed("base/a.cpp", "\n" * 600)
        self.refused("base/a.cpp", "\n" * 601, "over 600 lines")
        self.allowed("base/a.h", "/// long file: one table, easier to read whole\n" + "\n" * 400)

    def test_files_of_the_page_stay_short(self):
        self.allowed("../web/src/a.ts", "\n" * 600)
        self.refused("../web/src/a.ts", "\n" * 601, "over 600 lines")
        self.allowed("../web/src/a.ts", "// long file: one scene\n" + "\n" * 700)

    def test_the_real_tree_has_rules_for_every_folder(self):
        src = SCRIPT.parent.parent / "src"
        layers = {line.partition(":")[0] for line in (src / "layers.txt").read_text().splitlines() if line[:1].isalpha()}
        self.assertLessEqual({folder.name for folder in src.iterdir() if folder.is_dir()}, layers)


if __name__ == "__main__":
    unittest.main()
