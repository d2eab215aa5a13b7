#!/usr/bin/env python3
"""docs/robios.md shows the costs that the libraries use."""
import pathlib
import subprocess
import sys
import unittest

TOOL = pathlib.Path(__file__).resolve().parent / "make_robios_table.py"


class Table(unittest.TestCase):
    def test_page_is_up_to_date(self) -> None:
        done = subprocess.run([sys.executable, str(TOOL), "--check"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)


if __name__ == "__main__":
    unittest.main()
