"""The referee box of a run, by a base station that knows docs/referee_box.md alone."""
import json
import os
import re
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
SANDLOT = os.environ.get("SANDLOT_BIN", os.path.join(ROOT, "build/sandlot"))
sys.path.insert(0, os.path.join(ROOT, "tests"))
from refbox_client import SET_PIECES, Station  # noqa: E402

MATCH = os.path.join(ROOT, "scenarios/match.yaml")
QUIET = """version: 1
name: quiet
physics: planar
time: {step: 20 ms, substeps: 2, stop: 2 s}
robots:
  - {name: rover, model: rover}
"""


class Box(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)

    def start(self, *options, scenario=None):
        if scenario is None:
            scenario = os.path.join(self.scratch.name, "quiet.yaml")
            with open(scenario, "w") as file:
                file.write(QUIET)
        self.run_ = subprocess.Popen([SANDLOT, "run", scenario, "--refbox=0", "--json", *options], cwd=ROOT,
                                     stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(self.stop)
        while True:
            line = self.run_.stderr.readline()
            self.assertTrue(line, "it ended before it had a box")
            found = re.match(r"referee box: 127\.0\.0\.1:(\d+)$", line)
            if found:
                return int(found.group(1))

    def station(self, port, protocol="json"):
        made = Station(port=port, protocol=protocol)
        self.addCleanup(made.close)
        return made

    def stop(self):
        self.run_.kill()
        self.run_.communicate()

    def summary(self):
        out, err = self.run_.communicate(timeout=60)
        self.assertEqual(self.run_.returncode, 0, err)
        return json.loads(out)

    def refuse(self, *options):
        done = subprocess.run([SANDLOT, "run", os.path.join(ROOT, "scenarios/indoor.yaml"), *options], cwd=ROOT,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, 2, done.stderr)
        return done.stderr

    def test_stations_are_welcomed_and_counted(self):
        port = self.start("--refbox-protocol", "cyan=json,magenta=2009")
        cyan = self.station(port)
        self.assertEqual(cyan.welcome, ("WELCOME", "own"))
        self.assertEqual(cyan.own, "224.16.32.1")
        magenta = self.station(port, "2009")
        self.assertEqual(magenta.welcome, ("WELCOME", ""))
        cyan.send_world_state(robots=[{"id": 1, "pose": [1, 2, 0]}])
        magenta.send_world_state(balls=[{"position": [float("nan"), 0, 0]}])
        teams = {each["team"]: each for each in self.summary()["refbox"]["teams"]}
        self.assertEqual(teams["cyan"]["world_states"], 1)
        self.assertEqual(teams["magenta"]["wrong"], 1)
        self.assertEqual(teams["magenta"]["protocol"], "2009")
        self.assertIsNone(cyan.next(), "the box goes with the run")

    def test_hostile_stations_leave_the_run_as_it_is(self):
        port = self.start()
        cyan = self.station(port)
        flood = b"x" * 10_000
        try:
            for _ in range(100):
                cyan.socket.sendall(flood)
                time.sleep(0.001)
        except ConnectionError:
            pass
        cyan.close()
        magenta = self.station(port)
        magenta.socket.sendall(b'{"type":"worldst')
        magenta.close()
        attacked = self.summary()
        self.start()
        self.assertEqual(self.summary()["state_hash"], attacked["state_hash"])
        # The flood, and half a message of the station that took the place of the first.
        self.assertEqual(attacked["refbox"]["teams"][0]["wrong"], 2)

    def test_poses_that_are_no_numbers_are_counted_and_change_nothing(self):
        nan, inf = float("nan"), float("inf")  # as Python writes them, which is not JSON
        wrong = [{"robots": [{"id": 1, "pose": [nan, 0, 0]}]}, {"robots": [{"id": 1, "pose": [0, inf, 0]}]},
                 {"robots": [{"id": 1, "pose": [0, 0, -inf]}]}, {"robots": [{"id": 1, "pose": ["nan", 0, 0]}]},
                 {"robots": [{"id": 1, "pose": [1e300, 0, 0]}]}, {"robots": [{"id": 1, "pose": nan}]},
                 {"balls": [{"position": [nan, nan, nan]}]}, {"obstacles": [{"position": [0, nan]}]}]
        port = self.start()
        cyan, magenta = self.station(port), self.station(port)
        for state in wrong:
            cyan.send_world_state(**state)
        # The connection stays, and what is right is taken.
        cyan.send_world_state(robots=[{"id": 1, "pose": [1, 2, 0]}])
        magenta.send_world_state(robots=[{"id": 1, "pose": [1, 2, 0]}])
        attacked = self.summary()
        cyan_report, magenta_report = attacked["refbox"]["teams"]
        self.assertEqual((cyan_report["wrong"], cyan_report["world_states"]), (len(wrong), 1))
        self.assertEqual((magenta_report["wrong"], magenta_report["world_states"]), (0, 1))
        self.start()
        self.assertEqual(self.summary()["state_hash"], attacked["state_hash"])

    def test_wrong_flags_are_named(self):
        self.assertIn("--refbox-teams: magenta is missing", self.refuse("--refbox=0", "--refbox-teams", "cyan=127.0.0.1"))
        self.assertIn("is neither json nor 2009", self.refuse("--refbox=0", "--refbox-protocol", "xml"))
        self.assertIn("add --refbox", self.refuse("--refbox-protocol", "json"))
        self.assertIn("'nowhere' is not a port", self.refuse("--refbox=nowhere"))
        self.assertIn("cannot listen at port 28097 of 192.0.2.7", self.refuse("--refbox=192.0.2.7:28097"))

    def test_a_match_begins_with_stop_kickoff_start(self):
        port = self.start("--duration", "90s", "--rate", "5", "--refbox-protocol", "cyan=json,magenta=2009", scenario=MATCH)
        cyan, magenta = self.station(port), self.station(port, "2009")
        for station in (cyan, magenta):
            # The first stop may have been said before a station came: what follows the first start is whole.
            self.assertTrue(station.until(lambda word: word[0] == "START", 60), "the kick-off never started")
            words = station.until(lambda word: word[0] == "START", 60)
            commands = [word for word, _ in words]
            self.assertTrue(words, "no set piece followed")
            piece = max(i for i, word in enumerate(commands) if word in SET_PIECES)
            self.assertTrue(words[piece][1] or commands[piece] == "DROP_BALL", "a set piece is of one team")
            self.assertIn("STOP", commands[:piece])


if __name__ == "__main__":
    unittest.main()
