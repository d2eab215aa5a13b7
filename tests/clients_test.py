"""Clients in Python against runs of the built command: what docs/clients.md says, as a user would do it."""
import json
import os
import re
import shutil
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
from sandlot_client import Connection, Refused, Robot, RunEnded, Step, Team, data_of, numbers, packet  # noqa: E402


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

    def test_the_shell_of_the_docs_drives_a_robot(self):
        with open(os.path.join(ROOT, "docs/clients.md")) as file:
            text = file.read()
        command = re.search(r"```sh\nsandlot run (.*?) --port 8765", text).group(1).split()
        script = re.search(r"```sh\n(\(echo .*?)```", text, re.S).group(1)
        if not shutil.which("nc"):  # bash can do what it does
            script = "nc() { exec 3<>/dev/tcp/$1/$2; cat <&3 & cat >&3; }\n" + script
        with Run(*command, "--set", "robots.rover.controller=null", "--duration", "2s", "--rate", "1") as run:
            shell = subprocess.Popen(["bash", "-c", script.replace("8765", run.url.rpartition(":")[2])], stdout=subprocess.DEVNULL,
                                     stderr=subprocess.DEVNULL, start_new_session=True)
            try:
                summary = run.end()
            finally:
                os.killpg(shell.pid, signal.SIGKILL)
                shell.wait()
        self.assertGreater(summary["robots"][0]["distance_m"], 0.1)

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

    def test_a_client_in_lockstep_learns_values_and_asks_devices(self):
        odometry = ("{kind: wheel_odometry, left_joint: left_wheel_joint, right_joint: right_wheel_joint, "
                    "wheel_radius: 5 cm, wheel_separation: 23 cm}")
        with tempfile.TemporaryDirectory() as folder:
            scenario = os.path.join(folder, "odometry.yaml")
            with open(scenario, "w") as out:
                out.write("""version: 1
physics: planar
time: {step: 20 ms, control_interval: 5, stop: 2 s}
robots:
  - {name: rover, model: rover, devices: {odometry: %s}, controller: {kind: remote, deadline: 5 s}}
""" % odometry)
            with Run(scenario) as run:
                x, ranges = [], None
                with Robot("rover", url=run.url, lockstep=True, deadline_s=5) as rover:
                    rover.subscribe("laser")
                    self.assertIsNone(rover.latest("odometry"))
                    self.assertIn("/rover/odometry/reset", rover.call("/rosapi/services")["services"])
                    with self.assertRaisesRegex(Refused, "'rover/lasr' publishes nothing; there are: .*/rover/laser/ranges"):
                        rover.subscribe("lasr")
                    for step in rover.steps():
                        x.append(rover.value("odometry.pose.pose.position.x"))
                        rover.command("drive", {"linear": {"x": 0.5}})
                        if step.number == 9:
                            reset = rover.request("odometry/reset")
                            with self.assertRaisesRegex(Refused, "in lockstep a device answers after the step"):
                                rover.call("odometry/reset")
                        if step.number == 10:
                            self.assertTrue(reset.result(1)["success"])
                        if step.number == 12:
                            ranges = rover.latest("laser")["ranges"]
                            self.assertEqual(rover.value("laser.ranges[3]"), ranges[3])
                            self.assertIsNone(rover.value("laser.ranges[999]"))
                            with self.assertRaisesRegex(KeyError, "has no field 'rangs'"):
                                rover.value("laser.rangs")
                run.end()
        self.assertEqual(len(ranges), 271)
        # 0.5 m/s but for an acceleration of 1 m/s^2; the call in step 9 sets the way back to zero.
        self.assertGreater(x[9], 0.3)
        self.assertLess(x[10], 0.1)
        self.assertGreater(x[15], 0.2)

    def test_the_end_of_a_run_and_a_connection_that_is_closed_are_told_apart(self):
        with Run("examples/clients/wander.yaml", "--duration", "1s", "--rate", "max") as run:
            rover = Robot("rover", url=run.url, lockstep=True, deadline_s=5)
            for step in rover.steps():
                if step.number == 2:
                    break  # ends the step, too
            self.assertEqual([step.number for step in rover.steps()][0], 3)
            self.assertFalse(rover.spin(1))
            with self.assertRaisesRegex(RunEnded, "the run has ended"):
                rover.command("drive", {})
            run.end()
            rover.close()
            with self.assertRaises(ConnectionError):
                rover.poll()
        with Run("examples/clients/wander.yaml", "--duration", "20s") as run:
            first = Robot("rover", url=run.url, token="one word")
            with self.assertRaisesRegex(Refused, "'rover' is driven by another client"):
                Robot("rover", url=run.url)
            with Robot("rover", url=run.url, token="one word"):
                with self.assertRaisesRegex(ConnectionError, "another client has taken over") as caught:
                    while first.spin(0.01):
                        pass
                self.assertNotIsInstance(caught.exception, RunEnded)
            first.close()

    def test_a_free_client_has_a_clock_of_simulated_time(self):
        with Run("examples/clients/wander.yaml", "--set", "robots.rover.controller=null", "--duration", "3s", "--rate", "2") as run:
            with Robot("rover", url=run.url) as rover:
                if "/sandlot/step_times" not in rover.topics():
                    self.skipTest("this server sends no step times")
                begun = time.monotonic()
                self.assertTrue(rover.clock.sleep_until(2.5, timeout_s=20))
                took = time.monotonic() - begun
                self.assertGreater(rover.clock.messages, 10)
                self.assertAlmostEqual(rover.clock.now_s(), 2.5, delta=0.2)
                self.assertLess(took, 2.5)  # at twice real time
            run.end()

    def test_addresses(self):
        for url in ("127.0.0.1:8765", "tcp://127.0.0.1", "tcp://127.0.0.1:port", "https://127.0.0.1:8765"):
            with self.assertRaisesRegex(ValueError, "is not an address: tcp://HOST:PORT"):
                Connection(url)
        with self.assertRaisesRegex(ConnectionRefusedError, "no run answers at tcp://127.0.0.1:1: start one with --port"):
            Connection("tcp://127.0.0.1:1", timeout_s=0.1)
        with self.assertRaisesRegex(ConnectionError, "unix:/dev/null"):
            Connection("unix:/dev/null", timeout_s=0.1)
        with Run("examples/clients/wander.yaml", "--duration", "20s", "--token", "sesame") as run:
            address = run.url.replace("tcp:", "http:") + "/"
            with self.assertRaisesRegex(Refused, "this is not the token of 'rover'"):
                Robot("rover", url=address)
            Robot("rover", url=address + "?token=sesame").close()

    def test_random_numbers_octets_and_numbers_with_gaps(self):
        def step(random):
            return Step({"program": "a/b", "step": 1, "time": {"sec": 1, "nanosec": 500000000}, "random": str(random)})
        self.assertEqual(step(2047).uniform(), 0)  # the eleven lowest bits do not count
        self.assertEqual(step(2048).uniform(), 2.0**-53)
        self.assertEqual(step(2**64 - 1).uniform(), 1 - 2.0**-53)
        self.assertEqual(step(2**63).uniform(), 0.5)
        # SplitMix64 from the seed 1234567: the first numbers of its reference implementation (prng.di.unimi.it/splitmix64.c).
        self.assertEqual([step(1234567).bits(i) for i in (1, 2, 3)],
                         [6457827717110365317, 3203168211198807973, 9817491932198370423])
        self.assertEqual(step(5).time_s, 1.5)
        self.assertEqual(packet("h\u00e9", "blue"), {"to": "blue", "data": "aMOp"})
        self.assertEqual(data_of(packet(bytes([0, 255, 128]))), bytes([0, 255, 128]))
        self.assertEqual(list(numbers([1, None, 3], 8)), [1, 8, 3])


class Examples(unittest.TestCase):
    """Programs of examples/clients do their tasks, and twice alike, in whatever order they come."""

    def twice(self, name, roles, *arguments):
        summaries = []
        for order in (roles, roles[::-1]):
            with Run("examples/clients/%s.yaml" % name, "--rate", "max", *arguments) as run:
                clients = [client_program(run, "examples/clients/%s.py" % name, *role) for role in order]
                summaries.append(run.end())
                self.assertEqual([client.wait(timeout=20) for client in clients], [0] * len(roles))
        self.assertEqual(summaries[0]["state_hash"], summaries[1]["state_hash"])
        return summaries[0]

    def test_wander(self):
        rover = self.twice("wander", [[]], "--duration", "12s")["robots"][0]
        self.assertGreater(rover["distance_m"], 2)
        self.assertGreater(rover["covered_m2"], 1)

    def test_follow_ball(self):
        events = {event["name"]: event["count"] for event in self.twice("follow_ball", [[]])["events"]}
        self.assertGreaterEqual(events["reached"], 1)
        self.assertEqual(events["pushed"], 1)

    def test_radio_pair(self):
        places = set()
        for seed in ("1", "2"):
            summary = self.twice("radio_pair", [["red"], ["blue"]], "--seed", seed)
            self.assertEqual(summary["events"][0]["count"], 1)
            red, blue = (robot["pose"][0] for robot in summary["robots"])
            self.assertLess(abs(red - blue), 0.03)
            places.add(round(red, 1))
        self.assertEqual(len(places), 2)  # agreed, not built in

    def test_team(self):
        summary = self.twice("team", [[]])
        self.assertEqual(summary["events"][0]["count"], 1)


if __name__ == "__main__":
    unittest.main(verbosity=1)
