"""Tests of programs that run in a sandbox: they are skipped, with the reason, on a system that lets nobody make one, such as most
containers and roots made by chroot."""
import functools
import json
import os
import subprocess

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
SANDLOT = os.environ.get("SANDLOT_BIN", os.path.join(ROOT, "build/release/sandlot"))


@functools.cache
def why_none():
    """@return why this system makes no sandbox; empty: it does"""
    doctor = subprocess.run([SANDLOT, "doctor", "--json"], cwd=ROOT, stdout=subprocess.PIPE, text=True).stdout
    detail = next(each["detail"] for each in json.loads(doctor) if each["name"] == "sandbox")
    return "" if "run in sandboxes" in detail else detail


def skip_without(test):
    if why_none():
        test.skipTest(why_none())
