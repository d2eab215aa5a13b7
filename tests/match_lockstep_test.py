"""A match whose teams are in the process, in programs in lockstep, or one of each: all parts of the state end equal but the programs' own."""
import os
import shutil
import tempfile
import unittest

from clients_test import ROOT, SANDLOT, run_alone
from sandbox import skip_without

BUILD = os.path.dirname(os.path.realpath(SANDLOT))
IN_PROCESS = "version: 1\nname: Inside\nrobots:\n  - controllers: [{name: player, kind: striker, rate: 25}]\n"
LOCKSTEP = """version: 1
name: Outside
robots:
  - controllers: [{name: player, kind: remote, command: [python3, striker.py], folder: ., rate: 25, deadline: 10 s}]
"""


class MatchInLockstep(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        os.chmod(scratch.name, 0o755)  # programs of teams run as nobody where Sandlot runs as root
        self.teams = {}
        for name, text in (("inside", IN_PROCESS), ("outside", LOCKSTEP)):
            self.teams[name] = os.path.join(scratch.name, name)
            os.mkdir(self.teams[name])
            shutil.copy(os.path.join(ROOT, "tests/striker.py"), self.teams[name])
            with open(os.path.join(self.teams[name], "team.yaml"), "w") as file:
                file.write(text)

    def play(self, cyan, magenta):
        run = run_alone("scenarios/match.yaml", "--duration", "14s", "--set", "players=1", "--path",
                        os.path.join(BUILD, "test_plugins"), "--set", "plugins=[striker]", "--set",
                        "cyan=" + self.teams[cyan], "--set", "magenta=" + self.teams[magenta], "--set", "sense=objects")
        self.assertEqual(run["ticks"], 3500)
        self.assertGreater(run["robots"][0]["distance_m"], 5, "the law is not at work")
        return run["sub_hashes"]

    def test_where_a_law_is_computed_does_not_matter(self):
        skip_without(self)
        inside = self.play("inside", "inside")
        for cyan, magenta in (("outside", "inside"), ("outside", "outside")):
            other = self.play(cyan, magenta)
            self.assertEqual(list(other), list(inside))
            differing = [part for part in inside if inside[part] != other[part]]
            own = [part for part in inside if part.endswith("/player") and
                   (magenta == "outside" or part.startswith("cyan"))]
            self.assertEqual(differing, own, (cyan, magenta))


if __name__ == "__main__":
    unittest.main(verbosity=1)
