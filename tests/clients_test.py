"""Clients in Python against runs of the built command: what docs/clients.md says, as a user would do it."""
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
SANDLOT = os.environ.get("SANDLOT_BIN", os.path.join(ROOT, "build/sandlot"))
CLIENTS = os.path.join(ROOT, "clients/python")
sys.path.insert(0, CLIENTS)
from sandlot_client import Connection, Refused, Robot, Team  # noqa: E402


class Run:
    """A run with a server on a free port; `summary` after it has ended."""

    def __init__(self, *arguments):
        self.folder = tempfile.TemporaryDirectory()
        self.file = os.path.join(self.folder.name, "summary.json")
        self.process = subprocess.Popen([SANDLOT, "run", *arguments, "--port", "0", "--summary", self.file],
                                        cwd=ROOT, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
        self.said = []
        for line in self.process.stderr:
            self.said.append(line)
            found = re.match(r"page: http://([^/]+)/", line)
            if found:
                self.url = "tcp://" + found.group(1)
                break
        else:
            raise AssertionError("no page: " + "".join(self.said))
        self.reader = threading.Thread(target=lambda: self.said.extend(self.process.stderr))
        self.reader.start()

    def end(self):
        """Waits for its end and returns the summary."""
        code = self.process.wait(timeout=120)
        assert code == 0, "exit code %d: %s" % (code, "".join(self.said))
        with open(self.file) as file:
            return json.load(file)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGKILL)
            self.process.wait()
        self.reader.join()
        self.process.stderr.close()
        self.folder.cleanup()


def run_alone(*arguments):
    return json.loads(subprocess.run([SANDLOT, "run", *arguments, "--json"], cwd=ROOT, check=True, text=True,
                                     stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, timeout=120).stdout)


def client_program(run, *command):
    return subprocess.Popen([sys.executable, *command], cwd=ROOT,
                            env={**os.environ, "SANDLOT_URL": run.url, "PYTHONPATH": CLIENTS})


class Clients(unittest.TestCase):
    def test_a_law_in_a_client_gives_the_run_of_the_same_law_at_a_pipe(self):
        pipe = run_alone("examples/pipe/wander.yaml", "--duration", "6s")["sub_hashes"]
        with Run("examples/clients/wander.yaml", "--duration", "6s") as run:
            client = client_program(run, "examples/clients/wander.py")
            summary = run.end()
            self.assertEqual(client.wait(timeout=20), 0)
        remote = summary["sub_hashes"]
        self.assertEqual(summary["ticks"], 300)
        differing = [part for part in remote if remote[part] != pipe[part]]
        self.assertEqual(differing, ["rover/controller"])

    def test_the_program_of_the_docs_drives_a_robot(self):
        with open(os.path.join(ROOT, "docs/clients.md")) as file:
            text = file.read()
        program = re.search(r"```python\n(.*?)```", text, re.S).group(1)
        command = re.search(r"```sh\nsandlot run (.*?)\n", text).group(1).replace(" --port 8765", "").split()
        with Run(*command, "--duration", "5s") as run, tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "program.py")
            with open(file, "w") as out:
                out.write(program)
            client = client_program(run, file)
            summary = run.end()
            self.assertEqual(client.wait(timeout=20), 0)
        self.assertGreater(summary["robots"][0]["distance_m"], 0.5)

    def test_a_free_client_beside_one_in_lockstep(self):
        with tempfile.TemporaryDirectory() as folder:
            scenario = os.path.join(folder, "two.yaml")
            with open(scenario, "w") as out:
                out.write("""version: 1
physics: planar
time: {step: 20 ms, control_interval: 5, stop: 2 s}
robots:
  - {name: red1, model: rover, pose: [-1, 0, 0], team: red, controller: remote}
  - {name: blue1, model: rover, pose: [1, 0, 0], team: blue}
teams:
  - {name: red}
  - {name: blue}
""")
            with Run(scenario, "--rate", "1") as run:
                steps = []

                def lockstep():
                    with Robot("red1", url=run.url, lockstep=True) as red:
                        odometry = red.subscribe("drive")
                        for step in red.steps():
                            steps.append((step.number, step.time_ns, odometry.fresh()))
                            red.command("drive", {"linear": {"x": 0.2}})

                thread = threading.Thread(target=lockstep)
                thread.start()
                with Team("blue", url=run.url) as blue:
                    for _ in range(10):
                        blue.command("blue1", "drive", {"linear": {"x": 0.2}})
                        blue.spin(0.1)
                    with self.assertRaises(Refused):
                        blue.call("/set_simulation_state", {"state": {"state": 2}})
                    with self.assertRaises(Refused):
                        blue.subscribe("red1", "laser")
                summary = run.end()
                thread.join()
        self.assertEqual([number for number, _, _ in steps], list(range(len(steps))))
        self.assertEqual([time_ns for _, time_ns, _ in steps], [100_000_000 * i for i in range(len(steps))])
        self.assertGreaterEqual(len(steps), 20)  # the last one is of the tick with which the run ends
        self.assertTrue(all(fresh for _, _, fresh in steps))
        self.assertEqual(summary["end_time"], 2)

    def test_tokens_are_needed_and_wrong_ones_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            tokens = os.path.join(folder, "tokens.yaml")
            with open(tokens, "w") as out:
                out.write("- {token: sesame-one, robot: rover}\n- {token: sesame-all, role: admin}\n")
            os.chmod(tokens, 0o600)
            with Run("examples/clients/wander.yaml", "--duration", "1s", "--rate", "1", "--tokens", tokens) as run:
                with self.assertRaisesRegex(Refused, "this is not the token of 'rover'"):
                    Robot("rover", url=run.url)
                with Connection(run.url) as guest:
                    with self.assertRaisesRegex(Refused, "there is no service"):
                        guest.call("/delete_entity", {"entity": "rover"})
                with Robot("rover", url=run.url, token="sesame-one", lockstep=True) as rover:
                    for _ in rover.steps():
                        pass
                run.end()
            bad = os.path.join(folder, "bad.yaml")
            for line, what in (("- {token: x, robot: rover}", "bad.yaml:1:3: the token is shorter than 8"),
                               ("- {token: sesame-one}", "the token opens nothing"),
                               ("- {token: sesame-one, robot: a, team: b}", "the token opens several things"),
                               ("token: sesame", "expected a list of tokens"),
                               ("- {token: sesame-one, robto: a}", "did you mean 'robot'")):
                with open(bad, "w") as out:
                    out.write(line + "\n")
                ran = subprocess.run([SANDLOT, "run", "examples/clients/wander.yaml", "--port", "0", "--tokens", bad],
                                     cwd=ROOT, text=True, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL)
                self.assertEqual(ran.returncode, 2, line)
                self.assertIn(what, ran.stderr)

    def test_a_run_without_a_server_says_that_nobody_can_come(self):
        ran = subprocess.run([SANDLOT, "run", "examples/clients/wander.yaml"], cwd=ROOT, text=True,
                             stderr=subprocess.PIPE, stdout=subprocess.DEVNULL)
        self.assertEqual(ran.returncode, 2)
        self.assertIn("'rover/controller' waits for a client, and nobody can connect to this run", ran.stderr)

    def test_a_recording_repeats_misses_without_a_client(self):
        with tempfile.TemporaryDirectory() as folder:
            recording = os.path.join(folder, "run.mcap")
            with Run("examples/clients/wander.yaml", "--duration", "2s", "--record", recording) as run:
                with Robot("rover", url=run.url, lockstep=True, deadline_s=0.02) as rover:
                    for step in rover.steps():
                        if step.number == 5:
                            time.sleep(0.2)
                        rover.command("drive", {"linear": {"x": 0.3}})
                summary = run.end()
            replay = subprocess.run([SANDLOT, "replay", recording, "--verify"], cwd=ROOT, text=True,
                                    stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
            self.assertEqual(replay.returncode, 0, replay.stdout)
            self.assertIn(summary["state_hash"], replay.stdout)


if __name__ == "__main__":
    unittest.main(verbosity=1)
