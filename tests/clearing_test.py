"""The clearing experiment with its law in four places: in Sandlot, in a plugin, in a client in C++, in a client in Python. All parts of the
state end equal but the programs' own, whatever the network and the order in which clients come do to their answers."""
import importlib.util
import os
import random
import subprocess
import sys
import tempfile
import threading
import time
import unittest

from clients_test import CLIENTS, ROOT, SANDLOT, Run, run_alone

sys.path.insert(0, CLIENTS)
from sandlot_client import Robot, packet  # noqa: E402

BUILD = os.path.dirname(os.path.realpath(SANDLOT))
SCENARIO = "scenarios/clearing.yaml"
PUSHERS = ("pusher1", "pusher2")
REMOTE = ("--set", "robots.pusher.controller={kind: remote, deadline: 5 s}")

spec = importlib.util.spec_from_file_location("clearing", os.path.join(ROOT, "examples/clients/clearing.py"))
clearing = importlib.util.module_from_spec(spec)
spec.loader.exec_module(clearing)


def run_with(clients, *arguments):
    """Runs the scenario with a client process for each pusher; returns the summary."""
    with Run(SCENARIO, "--rate", "max", *REMOTE, *arguments) as run:
        started = [subprocess.Popen([*command, pusher], env={**os.environ, "SANDLOT_URL": run.url, "PYTHONPATH": CLIENTS},
                                    stdout=subprocess.DEVNULL)
                   for pusher, command in zip(PUSHERS, clients)]
        summary = run.end()
        codes = [client.wait(timeout=20) for client in started]
        assert codes == [0] * len(codes), codes
        return summary


def differing(a, b):
    assert list(a["sub_hashes"]) == list(b["sub_hashes"])
    return [part for part, its_hash in a["sub_hashes"].items() if its_hash != b["sub_hashes"][part]]


def drive(url, pusher, wait_s, answer_delays_s, deadline_s=1.0):
    """A client whose network is bad: it comes late, and each of its answers is late."""
    time.sleep(wait_s)
    law = clearing.Clearing(pusher, (1.6, 0.0), 0.6)
    with Robot(pusher, url=url, lockstep=True, deadline_s=deadline_s) as robot:
        camera, radio = robot.subscribe("camera"), robot.subscribe("radio")
        for step in robot.steps():
            packets = radio.message["packets"] if radio.fresh() else []
            motion, text = law.step(step.time_ns, step.random, camera.message, packets)
            time.sleep(answer_delays_s())
            robot.command("drive", {"linear": {"x": motion[0]}, "angular": {"z": motion[1]}})
            if text is not None:
                robot.command("radio", packet(text.encode()))


def run_with_threads(waits_s, delays_s, *arguments, deadline_s=1.0):
    with Run(SCENARIO, "--rate", "max", "--set", "robots.pusher.controller=remote", *arguments) as run:
        threads = [threading.Thread(target=drive, args=(run.url, pusher, wait_s, delays_s, deadline_s))
                   for pusher, wait_s in zip(PUSHERS, waits_s)]
        for thread in threads:
            thread.start()
        summary = run.end()
        for thread in threads:
            thread.join()
        return summary


class Clearing(unittest.TestCase):
    def test_the_law_gives_one_run_wherever_it_is_computed(self):
        built_in = run_alone(SCENARIO)
        self.assertEqual(built_in["success"], True)
        own = ["pusher1/controller", "pusher2/controller"]
        plugin = run_alone(SCENARIO, "--path", os.path.join(BUILD, "test_plugins"), "--set", "plugins=[clearing_plugin]",
                           "--set", "robots.pusher.controller.kind=my_clearing")
        self.assertEqual(differing(built_in, plugin), [])
        self.assertEqual(built_in["state_hash"], plugin["state_hash"])
        in_cpp = [os.path.join(BUILD, "client_clearing")]
        in_python = [sys.executable, os.path.join(ROOT, "examples/clients/clearing.py")]
        for clients in ((in_cpp, in_cpp), (in_python, in_python), (in_cpp, in_python)):
            remote = run_with(clients)
            self.assertEqual(remote["end_tick"], built_in["end_tick"], clients)
            self.assertEqual(differing(built_in, remote), own, clients)

    def test_a_law_that_is_another_one_is_noticed(self):
        """The test above can fail: a last bit of one number in one step is enough."""
        built_in = run_alone(SCENARIO, "--duration", "5s")
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(ROOT, "examples/clients/clearing.py")) as file:
                text = file.read()
            self.assertIn("3 * turn_between", text)
            other = os.path.join(folder, "clearing.py")
            with open(other, "w") as file:
                file.write(text.replace("3 * turn_between", "3.0000000000000004 * turn_between"))
            in_python = [sys.executable, other]
            parts = differing(built_in, run_with((in_python, in_python), "--duration", "5s"))
        self.assertIn("pusher1", parts)

    def test_delays_and_the_order_of_starts_change_nothing(self):
        runs = [run_with_threads((0, 0), lambda: 0, "--duration", "4s")]
        for waits_s in ((0, 0), (0, 0.5), (0.5, 0)):
            jitter = random.Random(str(waits_s))
            runs.append(run_with_threads(waits_s, lambda: jitter.uniform(0, 0.02), "--duration", "4s"))
        self.assertEqual([run["end_tick"] for run in runs], [400] * 4)
        self.assertEqual(len({run["state_hash"] for run in runs}), 1)

    def test_a_run_with_misses_replays_without_its_clients(self):
        jitter = random.Random(7)
        with tempfile.TemporaryDirectory() as folder:
            recording, log = os.path.join(folder, "run.mcap"), os.path.join(folder, "run.csv")
            summary = run_with_threads((0, 0), lambda: 0.03 if jitter.random() < 0.2 else 0, "--duration", "4s", "--record",
                                       recording, "--log", log, "--log-values",
                                       "pusher1/controller.misses,pusher1/controller.answers", deadline_s=0.005)
            with open(log) as file:
                lines = file.read().split()
            misses, answers = (float(number) for number in lines[-1].split(",")[-2:])
            self.assertGreater(misses, 5, lines[0])
            self.assertGreater(answers, 5, lines[0])
            replay = subprocess.run([SANDLOT, "replay", recording, "--verify"], cwd=ROOT, text=True,
                                    stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=120)
            self.assertEqual(replay.returncode, 0, replay.stdout)
            self.assertIn(summary["state_hash"], replay.stdout)


if __name__ == "__main__":
    unittest.main(verbosity=1)
