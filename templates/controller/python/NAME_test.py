#!/usr/bin/env python3
"""Runs @NAME@.yaml with the program, twice. SANDLOT names the command where it is not in PATH."""
import json
import os
import subprocess
import sys
import tempfile
import unittest

from @NAME@_controller import decide

HERE = os.path.dirname(os.path.abspath(__file__))


def run():
    """The summary of a run as fast as it goes."""
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "summary.json")
        command = [os.environ.get("SANDLOT", "sandlot"), "run", "@NAME@.yaml", "--port", "0", "--rate", "max", "--summary", file]
        with subprocess.Popen(command, cwd=HERE, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as server:
            address = next((line for line in server.stderr if line.startswith("page: ")), "").partition(" ")[2].strip()
            assert address, "the run did not begin"
            subprocess.run([sys.executable, "@NAME@_controller.py"], cwd=HERE, check=True, timeout=120,
                           env={**os.environ, "SANDLOT_URL": address})
            said = server.communicate(timeout=120)[1]
        assert server.returncode == 0, said
        with open(file) as summary:
            return json.load(summary)


class Test(unittest.TestCase):
    def test_it_turns_to_the_side_with_more_room(self):
        ranges = [None] * 271
        self.assertEqual(decide({"ranges": ranges, "range_max": 8}), {"linear": {"x": 0.4}})
        ranges[135] = 0.3  # ahead
        ranges[90] = 1.0  # to the right
        self.assertEqual(decide({"ranges": ranges, "range_max": 8}), {"angular": {"z": 1.0}})

    def test_it_arrives_and_does_so_again(self):
        first, second = run(), run()
        self.assertEqual(first["events"][0]["count"], 1, "it did not arrive")
        self.assertEqual(first["state_hash"], second["state_hash"])


if __name__ == "__main__":
    unittest.main()
