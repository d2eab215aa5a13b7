"""Programs that the run itself starts, as docs/clients.md says: sandboxes, budgets, restarts, leftovers."""
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

import sandbox

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
SANDLOT = os.environ.get("SANDLOT_BIN", os.path.join(ROOT, "build/sandlot"))
CLIENTS = os.path.join(ROOT, "clients/python")
sys.path.insert(0, CLIENTS)
from sandlot_client import Connection, Refused, Robot  # noqa: E402

DRIVE = """
from sandlot_client import Robot
with Robot() as rover:
    laser = rover.subscribe("laser")
    for step in rover.steps():
        ahead = min(r for r in laser.message["ranges"][100:171] if r is not None)
        rover.command("drive", {"linear": {"x": 0.3}, "angular": {"z": 1 / (1 + ahead) + step.random % 1000 * 1e-4}})
"""


class Started(unittest.TestCase):
    def setUp(self):
        sandbox.skip_without(self)
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        os.chmod(self.scratch.name, 0o755)  # also for `nobody`, when the tests run as root
        self.team = os.path.join(self.scratch.name, "team")
        os.mkdir(self.team)
        shutil.copytree(os.path.join(CLIENTS, "sandlot_client"), os.path.join(self.team, "sandlot_client"))

    def write(self, name, text, folder=None):
        path = os.path.join(folder or self.team, name)
        with open(path, "w") as file:
            file.write(text)
        return path

    def scenario(self, python, keys="", head="", name="scenario.yaml"):
        self.write("program.py", python)
        controller = "{kind: remote, deadline: 5 s%s%s}" % (
            ", command: [python3, program.py], folder: team" if python else "", ", " + keys if keys else "")
        return self.write(name, """version: 1
name: started
physics: planar
time: {step: 20 ms, substeps: 2, control_interval: 5, stop: 4 s}
%srobots:
  - {name: rover, model: rover, controller: %s}
things:
  - {name: walls, model: {builder: square_playground, length: 6, factor_xy: 0.666667, wall: 0.1, height: 1}}
""" % (head, controller), self.scratch.name)

    def run_scenario(self, *arguments, code=0, env=None):
        file = os.path.join(self.scratch.name, "summary.json")
        ran = subprocess.run([SANDLOT, "run", *arguments, "--summary", file], cwd=ROOT, text=True, timeout=120,
                             stderr=subprocess.STDOUT, stdout=subprocess.PIPE, env=env)
        self.assertEqual(ran.returncode, code, ran.stdout)
        if code:
            return None, ran.stdout
        with open(file) as summary:
            return json.load(summary), ran.stdout

    def value(self, summary, part):
        return summary["sub_hashes"][part]

    # ------------------------------------------------------------------------------------------------- one run

    def test_it_drives_its_robot_to_the_same_hash_as_one_started_by_hand(self):
        started, text = self.run_scenario(self.scenario(DRIVE), "--headless")
        self.assertNotIn("page:", text)
        self.assertGreater(started["robots"][0]["distance_m"], 0.5)
        by_hand = self.scenario("", name="by_hand.yaml")
        self.write("program.py", DRIVE)
        run = subprocess.Popen([SANDLOT, "run", by_hand, "--port", "0", "--json"], cwd=ROOT, text=True,
                               stderr=subprocess.PIPE, stdout=subprocess.PIPE)
        url = re.match(r"page: http://([^/]+)/", run.stderr.readline()).group(1)
        client = subprocess.Popen([sys.executable, "program.py"], cwd=self.team,
                                  env={**os.environ, "SANDLOT_URL": "tcp://" + url, "SANDLOT_ROBOT": "rover",
                                       "SANDLOT_LOCKSTEP": "1", "SANDLOT_DEADLINE_S": "5"})
        out, _ = run.communicate(timeout=60)
        self.assertEqual(client.wait(timeout=20), 0)
        hand = json.loads(out)
        self.assertEqual(started["sub_hashes"], hand["sub_hashes"])
        self.assertEqual(started["state_hash"], hand["state_hash"])

    def test_a_team_has_one_program(self):
        self.write("program.py", """
from sandlot_client import Team
with Team() as red:
    for step in red.steps():
        red.command("red1", "drive", {"linear": {"x": 0.2}})
        red.command("red2", "drive", {"linear": {"x": 0.3}})
""")
        scenario = self.write("team.yaml", """version: 1
physics: planar
time: {step: 20 ms, control_interval: 5, stop: 2 s}
teams:
  - {name: red, controller: {kind: remote, deadline: 5 s, command: [python3, program.py], folder: team}}
robots:
  - {name: red1, model: rover, pose: [-1, 0, 0], team: red}
  - {name: red2, model: rover, pose: [1, 0, 0], team: red}
""", self.scratch.name)
        summary, _ = self.run_scenario(scenario, "--headless")
        # Orders act at 0.02 s; at 1 m/s^2 up to the speed: v * 1.98 - v^2 / 2.
        for robot, speed in zip(summary["robots"], (0.2, 0.3)):
            self.assertAlmostEqual(robot["distance_m"], speed * 1.98 - speed**2 / 2, delta=0.02)

    def test_a_recording_needs_no_process(self):
        recording = os.path.join(self.scratch.name, "run.mcap")
        summary, _ = self.run_scenario(self.scenario(DRIVE), "--headless", "--record", recording)
        shutil.rmtree(self.team)
        replay = subprocess.run([SANDLOT, "replay", recording, "--verify"], cwd=ROOT, text=True, timeout=60,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        self.assertEqual(replay.returncode, 0, replay.stdout)
        self.assertIn(summary["state_hash"], replay.stdout)

    def test_a_snapshot_starts_nothing_unless_it_is_allowed(self):
        half = os.path.join(self.scratch.name, "half.snapshot")
        python = "print('it has begun')\n" + DRIVE
        self.run_scenario(self.scenario(python, "patience: 2 s"), "--headless", "--snapshot", half, "--snapshot-at", "1s")
        _, text = self.run_scenario("--from", half, "--duration", "1s", "--headless", code=2)
        self.assertIn("nobody can connect", text)
        _, text = self.run_scenario("--from", half, "--duration", "0.2s", "--port", "0")
        self.assertIn("'rover/controller' is not started", text)
        self.assertNotIn("it has begun", text)
        _, text = self.run_scenario("--from", half, "--duration", "1s", "--headless", "--allow-programs")
        self.assertIn("rover/controller: it has begun", text)

    # ----------------------------------------------------------------------------------------- ends and restarts

    def test_it_is_started_again_by_its_rule(self):
        python = DRIVE.replace("    for step", "    count = 0\n    for step") + """
        count += 1
        if count == 5:
            import os
            os.kill(os.getpid(), 9)
"""
        log = os.path.join(self.scratch.name, "log.csv")
        values = ("--log", log, "--log-values", "rover/controller.answers,rover/controller.misses,rover.twist.linear.x")

        def last():
            with open(log) as file:
                return [float(each) for each in file.read().split()[-1].split(",")][-3:]

        _, text = self.run_scenario(self.scenario(python, "restart: never"), "--headless", "--rate", "1", *values)
        self.assertIn("program 'rover/controller' was ended by signal 9 (Killed)", text)
        answers, misses, speed = last()
        self.assertLessEqual(answers, 5)
        # Steps at 0, 0.1, ... 4.0; the last one is not awaited.
        self.assertEqual(answers + misses, 40)
        self.assertAlmostEqual(speed, 0, delta=0.01)

        _, text = self.run_scenario(self.scenario(python, "restart: on_failure"), "--headless", "--rate", "1", *values)
        self.assertIn("it is started again in 0.1 s", text)
        self.assertIn("it is started again in 0.2 s", text)
        answers, misses, _ = last()
        self.assertGreater(answers, 5)
        self.assertGreater(misses, 1)

    def test_the_run_does_not_wait_for_one_that_ends_before_it_connects(self):
        begun = time.monotonic()
        python = "import sys\nprint('half done')\nsys.exit('the coach has no plan')\n"
        logs = os.path.join(self.scratch.name, "logs")
        _, text = self.run_scenario(self.scenario(python, "restart: never, patience: 1000 s"), "--headless",
                                    "--program-logs", logs)
        self.assertLess(time.monotonic() - begun, 30)
        self.assertIn("rover/controller: half done", text)
        self.assertIn("program 'rover/controller' ended with code 1; last line of its standard error: "
                      "the coach has no plan", text)
        with open(os.path.join(logs, "rover.controller.log")) as file:
            self.assertEqual(file.read().splitlines(), ["half done", "the coach has no plan"])
        _, text = self.run_scenario(self.scenario(python, "restart: never, on_miss: end"), "--headless", code=1)
        self.assertIn("the client sent no answer in time", text)

    def test_nothing_is_left_of_it(self):
        mark = "sandlot-%d" % os.getpid()
        python = """
import os, time
if os.fork() == 0:
    os.setsid()
    if os.fork() == 0:
        os.execvp("sleep", ["%s", "1000"])
    os._exit(0)
""" % mark + DRIVE
        before = {each for each in os.listdir("/tmp") if each.startswith("sandlot-")}
        self.run_scenario(self.scenario(python), "--headless")
        self.assertEqual(self.processes(mark), [])
        left = {each for each in os.listdir("/tmp") if re.fullmatch("sandlot-.{6}", each)} - before
        with open("/proc/net/unix") as file:  # those of other runs, beside this test, are in use
            used = file.read()
        sockets = {"/tmp/%s/run.sock" % each for each in left}
        self.assertEqual({each for each in sockets if os.path.exists(each) and each not in used}, set())
        # Nor of one whose run is killed.
        run = subprocess.Popen([SANDLOT, "run", self.scenario(python), "--headless", "--rate", "1"], cwd=ROOT,
                               stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        self.until(lambda: self.processes(mark))
        run.send_signal(signal.SIGKILL)
        run.wait()
        self.until(lambda: not self.processes(mark))

    def processes(self, mark):
        found = []
        for each in filter(str.isdigit, os.listdir("/proc")):
            try:
                with open("/proc/%s/cmdline" % each) as file:
                    if file.read().startswith(mark):
                        found.append(int(each))
            except OSError:
                pass
        return found

    def until(self, condition, seconds=20):
        end = time.monotonic() + seconds
        while not condition():
            self.assertLess(time.monotonic(), end, "it did not come to that")
            time.sleep(0.02)

    # -------------------------------------------------------------------------------------------------- budgets

    def test_it_is_ended_over_its_memory(self):
        # Shared memory is none of a single process; what all have together is measured.
        python = """
import mmap, time
held = mmap.mmap(-1, 300_000_000)
for at in range(0, 300_000_000, 4096): held[at] = 1
time.sleep(100)
"""
        _, text = self.run_scenario(self.scenario(python, "restart: never, memory: 200 MB"), "--headless")
        self.assertRegex(text, r"program 'rover/controller' was ended: it had [23]\d\d MB of memory, of 200 MB")

    def test_it_is_held_to_its_share_of_a_processor(self):
        python = """
import time
begun = time.monotonic()
for second in range(1, 3):
    while time.monotonic() < begun + second: pass
    print("used", time.process_time(), "of", time.monotonic() - begun)
"""
        _, text = self.run_scenario(self.scenario(python, "lockstep: false, restart: never, cpu: 25 %"), "--headless",
                                    "--rate", "1")
        used = [tuple(map(float, each)) for each in re.findall(r"used (\S+) of (\S+)", text)]
        self.assertEqual(len(used), 2, text)
        for cpu_s, wall_s in used:
            # It has saved 25 ms at most, is looked at every 40 ms, and its clocks tick at 10 ms, two of each process.
            self.assertLessEqual(cpu_s, 0.25 * wall_s + 0.025 + 0.04 + 0.06)
        self.assertGreater(used[1][0], 0.1)  # less than its share only on a machine that has no more to give

    def test_no_port_is_opened_but_its_own(self):
        python = "import socket, time\n" + DRIVE
        run = subprocess.Popen([SANDLOT, "run", self.scenario(python), "--headless", "--rate", "1"], cwd=ROOT,
                               stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
        mine = set()

        def sockets():
            mine.clear()
            for each in os.listdir("/proc/%d/fd" % run.pid):
                try:
                    target = os.readlink("/proc/%d/fd/%s" % (run.pid, each))
                except OSError:
                    continue
                if target.startswith("socket:"):
                    mine.add(target[8:-1])
            with open("/proc/net/unix") as file:
                return any(line.split()[6] in mine and "run.sock" in line for line in file.read().splitlines()[1:])

        self.until(sockets)
        listening = set()
        for name in ("tcp", "tcp6", "udp", "udp6"):
            with open("/proc/net/" + name) as file:
                listening |= {line.split()[9] for line in file.read().splitlines()[1:]}
        self.assertEqual(mine & listening, set())
        run.send_signal(signal.SIGINT)
        _, text = run.communicate(timeout=20)
        self.assertEqual(run.returncode, 0, text)

    # ----------------------------------------------------------------------------------------------- no sandbox

    def test_without_bubblewrap_the_run_is_refused_unless_it_is_told(self):
        tools = os.path.join(self.scratch.name, "bin")
        os.mkdir(tools)
        os.symlink("/usr/bin/python3", os.path.join(tools, "python3"))
        env = {**os.environ, "PATH": tools}
        _, text = self.run_scenario(self.scenario(DRIVE), "--headless", code=2, env=env)
        self.assertRegex(text, r"error: .*scenario.yaml:\d+:\d+: there is no bubblewrap \(bwrap\)")
        self.assertIn("sandbox: off", text)
        summary, _ = self.run_scenario(self.scenario(DRIVE, "sandbox: off"), "--headless", env=env)
        self.assertGreater(summary["robots"][0]["distance_m"], 0.5)

    @unittest.skipIf(os.geteuid() != 0, "for root only")
    def test_a_folder_that_nobody_can_read_is_refused(self):
        scenario = self.scenario(DRIVE)
        os.chmod(self.team, 0o700)
        _, text = self.run_scenario(scenario, "--headless", code=2)
        self.assertIn("cannot be read by 'nobody', whom programs run as when Sandlot runs as root", text)

    # ------------------------------------------------------------------------------------------------- steering

    def watched_run(self, *arguments):
        run = subprocess.Popen([SANDLOT, "run", *arguments], cwd=ROOT, stderr=subprocess.PIPE,
                               stdout=subprocess.DEVNULL, text=True)
        run.said = []
        reader = threading.Thread(target=lambda: run.said.extend(iter(run.stderr.readline, "")))
        reader.start()

        def end():
            run.send_signal(signal.SIGINT)
            run.wait(timeout=20)
            reader.join()
            run.stderr.close()

        self.addCleanup(end)
        return run

    def test_watch_starts_it_again_when_a_file_of_it_changes(self):
        program = "print('version', %d, flush=True)\n" + DRIVE.replace("%", "%%")
        run = self.watched_run(self.scenario(program % 1), "--headless", "--rate", "0.05", "--watch")
        self.until(lambda: "version 1" in "".join(run.said))
        self.write("program.py", program % 2)
        self.until(lambda: "version 2" in "".join(run.said))
        self.assertIn("a file of it has changed", "".join(run.said))

    def test_an_administrator_starts_it_again(self):
        run = self.watched_run(self.scenario(DRIVE.replace("    for step", "    print('begun', flush=True)\n    for step")), "--port", "0", "--rate", "0.05")
        self.until(lambda: "rover/controller: begun" in "".join(run.said))
        url = "tcp://" + re.search(r"page: http://([^/]+)/", "".join(run.said)).group(1)
        with Connection(url) as admin:
            answer = admin.call("/sandlot/restart_program", {"program": "rover/controler"})
            self.assertEqual((answer["ok"], "'rover/controller'" in answer["text"]), (False, True), answer)
            self.assertTrue(admin.call("/sandlot/restart_program", {"program": "rover/controller"})["ok"])
        self.until(lambda: "".join(run.said).count("rover/controller: begun") == 2)
        with self.assertRaisesRegex(Refused, "is driven by another client"):
            self.until(lambda: Robot("rover", url=url))

    def test_what_does_not_go_together_is_refused(self):
        _, text = self.run_scenario("examples/pipe/wander.yaml", "--watch", "--headless", code=2)
        self.assertIn("the run starts none", text)
        _, text = self.run_scenario(self.scenario(DRIVE, "restart: sometimes"), "--headless", code=2)
        self.assertIn("on_failure", text)
        _, text = self.run_scenario(self.scenario(DRIVE, "memory: 512 MHz"), "--headless", code=2)
        self.assertIn("MB", text)


if __name__ == "__main__":
    unittest.main(verbosity=1)
