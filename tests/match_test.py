"""`sandlot match` and `sandlot tournament` as people use them: results, exit codes, and teams that are wrong, late, silent or hostile."""
import glob
import json
import os
import re
import shlex
import shutil
import signal
import subprocess
import tempfile
import time
import unittest

import sandbox

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
SANDLOT = os.environ.get("SANDLOT_BIN", os.path.join(ROOT, "build/sandlot"))
SHORT = ["--level", "world", "--drive", "ideal", "--physics", "planar", "--size", "12x8"]
for key, value in (("players", "2"), ("break", "0.5"), ("rules[0].stop_time", "0.1"), ("rules[0].prepare_min", "0.1"),
                   ("rules[0].prepare_max", "0.5"), ("rules[0].prepare_kickoff", "0.5")):
    SHORT += ["--set", key + "=" + value]
OURS = "teams/run_and_kick"

# A robot that answers each step by standing still.
ANSWERS = """
from sandlot_client import Robot
with Robot() as robot:
    for step in robot.steps():
        %s
"""
# 300 orders a step, and 5000 letters of output: more than the server takes, so that ends of steps may be refused as well.
FLOODS = "[robot.command('drive', {'linear': {'x': float(i % 3)}}) for i in range(300)]; print('x' * 5000)"


class Match(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        os.chmod(self.scratch.name, 0o755)  # also for `nobody`, when the tests run as root

    def file(self, name):
        return os.path.join(self.scratch.name, name)

    def team(self, name, robots, program=None, head=""):
        """A folder with a team.yaml."""
        folder = self.file(name.lower())
        os.mkdir(folder)
        with open(os.path.join(folder, "team.yaml"), "w") as file:
            file.write("version: 1\nname: %s\n%srobots:\n  - %s\n" % (name, head, robots))
        if program is not None:
            with open(os.path.join(folder, "player.py"), "w") as file:
                file.write(program)
        return folder

    def program_team(self, name, program, keys=""):
        """A team whose robots run `program`."""
        return self.team(name, "{controller: {kind: remote, command: [python3, player.py], folder: ., rate: 25, %s}}" % (keys or "deadline: 0.5 s"), program)

    def sandlot(self, *arguments, code=0, timeout=100):
        done = subprocess.run([SANDLOT, *arguments], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=timeout)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def play(self, *arguments, code=0, short=SHORT):
        """The result of a match as JSON; with another exit code what it said."""
        done = self.sandlot("match", *arguments, *short, *(["--json"] if code == 0 else []), code=code)
        return json.loads(done.stdout) if code == 0 else done.stderr


class Play(Match):
    def test_a_match_ends_with_a_result_a_summary_and_a_recording_that_replays(self):
        recording, summary = self.file("match.mcap"), self.file("match.json")
        result = self.play("teams/passing", OURS, "--duration", "6 s", "--record", recording, "--summary", summary, "--seed", "3")
        self.assertEqual(result["names"], ["Passing", "Run and kick"])
        self.assertTrue(result["ended"])
        self.assertEqual(result["walk_over"], "")
        self.assertEqual(result["seed"], 3)
        self.assertEqual(result["recording"], recording)
        with open(summary) as file:
            written = json.load(file)
        self.assertEqual(written["state_hash"], result["state_hash"])
        self.assertEqual(result["goals"], [int(written["criteria"][side]["value"]) for side in ("cyan", "magenta")])
        # Every tick of it again, by the recording alone.
        replayed = json.loads(self.sandlot("replay", recording, "--verify", "--json").stdout)
        self.assertTrue(replayed["verified"])
        self.assertEqual(replayed["state_hash"], result["state_hash"])
        # The decisions are those of the game, from its beginning to its end.
        echoed = self.sandlot("topic", "echo", recording, "/rules/referee/decision", "--json").stdout
        decisions = [json.loads(line)["message"] for line in echoed.splitlines()]
        self.assertEqual(decisions[0]["rule"], "begin")
        self.assertIn("start", [each["rule"] for each in decisions])
        self.assertEqual(decisions[-1]["rule"], "end")
        self.assertIn("half_time", [each["rule"] for each in decisions])
        self.assertEqual([each["sequence"] for each in decisions], list(range(1, len(decisions) + 1)))
        self.assertEqual(decisions[-1]["score"], result["goals"])
        for each in decisions:
            self.assertEqual(len(each["players"]), 4, each)
            self.assertTrue(each["reason"])

    def test_a_recording_is_shown_from_any_of_its_decisions(self):
        recording = self.file("match.mcap")
        self.play("teams/passing", OURS, "--duration", "3 s", "--record", recording)
        half = next(each for each in (json.loads(line) for line in self.sandlot(
            "topic", "echo", recording, "/rules/referee/decision", "--json").stdout.splitlines()) if each["message"]["rule"] == "half_time")
        from_s = "%.2fs" % half["time"]
        there = json.loads(self.sandlot("replay", recording, "--until", from_s, "--json").stdout)
        shown = subprocess.Popen([SANDLOT, "replay", recording, "--port", "0", "--from", from_s], cwd=ROOT, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        self.addCleanup(shown.stdout.close)
        self.addCleanup(shown.wait)
        self.addCleanup(shown.kill)
        address = re.search(r"http://([0-9.:]+)/", next(line for line in shown.stdout if "page:" in line)).group(1)

        def say(line):
            return json.loads(self.sandlot("console", address, "--command", line, "--json").stdout)["text"]
        until = time.monotonic() + 60
        while "paused" not in say("time") and time.monotonic() < until:
            time.sleep(0.05)
        self.assertIn("tick %d, paused" % there["end_tick"], say("time"))
        self.assertIn(there["state_hash"], say("hash"))
        past = self.sandlot("replay", recording, "--port", "0", "--from", "100s", code=2)
        self.assertIn("--from 100 s: ", past.stderr)

    def test_sides_are_exchanged_and_threads_change_nothing(self):
        one = self.play("teams/passing", OURS, "--duration", "3 s")
        self.assertEqual(self.play("teams/passing", OURS, "--duration", "3 s", "--threads", "2")["state_hash"], one["state_hash"])
        # The other way round and exchanged: the same game, told from the other side.
        swapped = self.play(OURS, "teams/passing", "--duration", "3 s", "--swap")
        self.assertEqual(swapped["state_hash"], one["state_hash"])
        self.assertEqual(swapped["goals"], one["goals"][::-1])

    def test_penalty_kicks_decide_a_draw(self):
        # No goal falls in four seconds; then one penalty kick each until one team has one more, each at most 24 s.
        recording = self.file("match.mcap")
        result = self.play("teams/passing", OURS, "--duration", "2 s", "--set", "shootout=1", "--set", "overtime=1", "--record", recording, "--swap")
        self.assertEqual(result["goals"], [0, 0])
        ours, theirs = result["penalty_kicks"]
        self.assertEqual(abs(ours - theirs), 1)
        self.assertEqual(result["winner"], result["names"][ours < theirs])
        # The first team plays as magenta: the referee names the sides the other way round.
        self.assertIn("penalty kicks %d : %d" % (theirs, ours), result["summary"]["stopped"])
        lines = self.sandlot("topic", "echo", recording, "/rules/referee/decision", "--json").stdout.splitlines()
        decisions = [json.loads(line)["message"] for line in lines]
        # All parts in their order; goals and misses of the kicks, and the end, which is decided in the same tick as the last one.
        self.assertEqual([each["stage"] for each in decisions if each["rule"] == "begin"],
                         ["first_half", "second_half", "overtime_first", "overtime_second", "penalties"])
        kicks = [each for each in decisions if each["stage"] == "penalties" and each["rule"] in ("goal", "no_goal")]
        self.assertEqual(len(kicks) % 2, 0)
        for side, goals in (("cyan", theirs), ("magenta", ours)):
            self.assertEqual(len([each for each in kicks if each["team"] == side and each["rule"] == "goal"]), goals)
        self.assertEqual(decisions[-1]["rule"], "end")

    def test_text_for_people_has_score_and_seed(self):
        said = self.sandlot("match", "teams/passing", OURS, *SHORT, "--duration", "2 s", "--seed", "5").stdout
        self.assertRegex(said, r"^Passing \d+ : \d+ Run and kick")
        self.assertIn("seed 5; hash ", said)

    def test_a_team_without_goalkeeper_or_with_fewer_robots_plays(self):
        alone = self.team("Alone", "{controllers: [{name: player, kind: soccer_player, play: run_and_kick, size: '${size}', keeper: 0,"
                          " attacks_positive_x: '${attacks_positive_x}', placed: true, start: '${start}'}]}", head="players: 1\n")
        result = self.play(alone, OURS, "--duration", "2 s")
        self.assertEqual(result["walk_over"], "")
        self.assertTrue(result["ended"])
        self.assertEqual(sorted(each["name"] for each in result["summary"]["robots"]), ["cyan1", "magenta1", "magenta2"])

    def test_a_robot_that_cannot_be_built_is_named_and_nothing_is_played(self):
        broken = self.team("Broken", "{controller: {kind: wander, laser: nothing}}")
        said = self.play(broken, OURS, "--duration", "2 s", code=2)
        self.assertIn("broken/team.yaml:4", said)
        self.assertIn("nothing", said)


class Mistakes(Match):
    def test_a_folder_without_a_team_is_named_with_the_remedy(self):
        said = self.play("docs", OURS, code=2)
        self.assertRegex(said, r"there is no team in '.*/docs'")
        self.assertIn("team.yaml", said)
        self.assertIn("no/where", self.play(OURS, "no/where", code=2))

    def test_a_wrong_key_is_named_with_file_and_line(self):
        self.assertIn("wrong/team.yaml:3", self.play(self.team("Wrong", "{controller: wander}", head="colour: red\n"), OURS, code=2))
        said = self.play(self.team("Robot", "{controler: wander}"), OURS, code=2)
        self.assertIn("robot/team.yaml:4", said)
        self.assertIn("did you mean 'controller'", said)

    def test_seven_robots_are_too_many(self):
        said = self.play(self.team("Many", "{controller: wander}", head="players: 7\n"), OURS, code=2)
        self.assertIn("many/team.yaml", said)
        self.assertIn("the team brings 7 robots, and 2 may play", said)

    def test_a_deadline_that_holds_up_the_game_is_refused(self):
        said = self.play(self.team("Slow", "{controller: {kind: remote, command: [python3, player.py], deadline: 20 s}}", ""), OURS, code=2)
        self.assertIn("slow/team.yaml:4", said)
        self.assertIn("write deadline: 1 s", said)

    def test_options_that_cannot_be_are_named(self):
        self.assertIn("--level", self.sandlot("match", OURS, OURS, "--level", "smell", code=2).stderr)
        self.assertIn("a match takes 2 s at least", self.sandlot("match", OURS, OURS, "--duration", "1 s", code=2).stderr)
        self.assertIn("--record", self.sandlot("match", OURS, OURS, "--record", self.file("match.txt"), code=2).stderr)


class Programs(Match):
    def setUp(self):
        sandbox.skip_without(self)
        super().setUp()

    def loses(self, folder, reason, *arguments, duration="2 s"):
        """It loses by rule as the second team, and the other one wins by three goals at least."""
        result = self.play(OURS, folder, "--duration", duration, *arguments)
        self.assertIn(reason, result["walk_over"])
        self.assertEqual(result["winner"], "Run and kick")
        self.assertGreaterEqual(result["goals"][0] - result["goals"][1], 3)
        return result

    def test_a_program_that_ends_at_once_loses_by_rule(self):
        result = self.loses(self.program_team("Absent", "raise SystemExit('not today')"),
                            "Absent loses by rule: none of its programs answered")
        self.assertEqual(result["goals"], [3, 0])
        self.assertTrue(result["ended"])

    def test_a_program_that_never_connects_loses_by_rule(self):
        self.loses(self.program_team("Silent", "import time\ntime.sleep(1000)", "deadline: 0.5 s, patience: 0.5 s"), "none of its programs answered")

    def test_a_program_that_stalls_loses_by_rule_before_the_end(self):
        # Two robots miss 25 steps a second each: 500 after ten seconds of a game of forty.
        late = self.program_team("Late", ANSWERS % "import time; time.sleep(0.1)", "deadline: 5 ms")
        result = self.loses(late, "Late loses by rule: its programs missed", duration="40 s")
        self.assertFalse(result["ended"])
        self.assertLess(result["sim_seconds"], 40)

    def test_a_program_that_floods_harms_nobody(self):
        flood = self.program_team("Flood", ANSWERS % FLOODS)
        result = self.play(OURS, flood, "--duration", "2 s")
        self.assertTrue(result["ended"])
        self.assertEqual(result["summary"]["errors"], [])

    def test_a_program_that_crashes_midway_leaves_the_game_to_the_others(self):
        # 75 steps of 3 s and those of the break: what it does not answer after its 20th counts as missed.
        crash = self.program_team("Crash", "import os\n" + ANSWERS % "os.abort() if step.number > 20 else None",
                                  "deadline: 0.5 s, restart: never")
        done = self.sandlot("match", OURS, crash, *SHORT, "--duration", "3 s", "--json")
        result = json.loads(done.stdout)
        self.assertTrue(result["ended"])
        self.assertRegex(done.stderr, r"magenta[12]/controller.*signal 6")
        missed, steps = re.search(r"Crash loses by rule: its programs missed (\d+) of (\d+) steps", result["walk_over"]).groups()
        self.assertGreater(int(missed) / int(steps), 0.6)
        self.assertGreaterEqual(int(steps), 2 * 75)

    def test_a_program_that_crashes_once_and_comes_back_has_not_lost(self):
        once = self.program_team("Once", "import os\n" + ANSWERS % "os.abort() if step.number == 20 else None",
                                 "deadline: 0.5 s, restart: on_failure")
        self.assertEqual(self.play(OURS, once, "--duration", "6 s", "--rate", "1")["walk_over"], "")

    def test_nonsense_in_answers_is_counted_and_orders_nothing(self):
        mad = self.program_team("Mad", ANSWERS % "robot.command('drive', {'linear': {'x': float('nan')}}); robot.command('wings', {})")
        result = self.play(OURS, mad, "--duration", "2 s")
        self.assertTrue(result["ended"])

    def test_the_python_team_plays_in_lockstep(self):
        result = self.play("examples/soccer_team", OURS, "--duration", "4 s", "--level", "objects",
                           short=[each for each in SHORT if each not in ("--level", "world")])
        self.assertEqual(result["names"], ["Python", "Run and kick"])
        self.assertEqual(result["walk_over"], "")
        for client in result["summary"]["clients"]:
            self.assertGreater(client["steps"], 100)
            self.assertEqual(client["misses"], 0)


class Demo(Match):
    def test_it_is_a_match_and_says_how_to_have_the_same_again(self):
        # What every machine runs in real time; which level it is is measured.
        run = ["--headless", "--duration", "1 s", "--json"]
        done = self.sandlot("demo", *run, "--set", "players=1", "--set", "sense=world")
        said = re.search(r"^match: senses world, drives (\w+), engine (\w+); measured [\d.]+ x real time$", done.stderr, re.M)
        self.assertTrue(said, done.stderr)
        again = re.search(r"^the same again: sandlot (.*)$", done.stderr, re.M).group(1)
        self.assertIn("--set drive=%s --set engine=%s" % said.groups(), again)
        first = json.loads(done.stdout)
        self.assertEqual(first["name"], "match")
        self.assertEqual(json.loads(self.sandlot(*shlex.split(again), *run).stdout)["state_hash"], first["state_hash"])

    def test_others_have_names(self):
        self.assertEqual(json.loads(self.sandlot("demo", "yard", "--headless", "--duration", "0.1 s", "--json").stdout)["name"], "yard")
        self.assertIn("match\n", self.sandlot("demo", "list").stdout)


class Tournament(Match):
    def command(self, *arguments):
        return ["tournament", *arguments, "--out", self.file("cup"), *SHORT, "--jobs", "2"]

    def cup(self, *arguments, code=0, timeout=100):
        return self.sandlot(*self.command(*arguments), code=code, timeout=timeout)

    def games_under_way(self):
        """Process numbers of the games of this tournament."""
        found = []
        for folder in glob.glob("/proc/[0-9]*"):
            try:
                with open(folder + "/cmdline", "rb") as file:
                    words = file.read().decode().split("\0")
            except OSError:
                continue
            if "match" in words[:2] and any(self.scratch.name in word for word in words):
                found.append(int(os.path.basename(folder)))
        return sorted(found)

    def until(self, condition, seconds=60):
        end = time.monotonic() + seconds
        while not condition():
            self.assertLess(time.monotonic(), end, "it never happened")
            time.sleep(0.02)

    def begin(self, *arguments):
        begun = subprocess.Popen([SANDLOT, *self.command(*arguments)], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.addCleanup(lambda: (begun.kill(), begun.communicate()))
        return begun

    def test_a_game_that_crashes_ends_alone(self):
        # Two long games: one is ended from outside as by a fault of its own, then the other one, asked, ends.
        begun = self.begin("teams/passing", OURS, "--duration", "6000 s", "--seeds", "2")
        self.until(lambda: len(self.games_under_way()) == 2)
        one, other = self.games_under_way()
        os.kill(one, signal.SIGSEGV)
        line = begun.stdout.readline()
        self.assertIn("not played: its process was ended by signal 11", line)
        self.assertEqual(self.games_under_way(), [other])
        begun.send_signal(signal.SIGINT)
        out = begun.communicate(timeout=30)[0]
        self.assertEqual(begun.returncode, 1, out)
        self.assertIn("not at its end", out)
        self.assertEqual(self.games_under_way(), [])

    def test_it_goes_on_after_kill_and_leaves_no_game_behind(self):
        arguments = ("teams/passing", OURS, "--duration", "4 s", "--seeds", "6")
        begun = self.begin(*arguments)
        self.assertRegex(begun.stdout.readline(), r"^ +1 +round 1 ")
        begun.kill()
        self.until(lambda: not self.games_under_way())
        self.cup(*arguments)
        self.assertTrue(self.read()["ended"])
        self.assertEqual(len(self.read()["games"]), 6)
        self.assertGreaterEqual(self.read()["stored"], 1)
        for game in self.read()["games"]:
            self.assertTrue(os.path.exists(os.path.join(ROOT, game["recording"])), game)

    def read(self, name="tournament.json"):
        with open(os.path.join(self.file("cup"), name)) as file:
            return json.load(file) if name.endswith(".json") else file.read()

    def test_each_decision_has_a_command_that_shows_the_game_from_there(self):
        self.cup("teams/passing", OURS, "--duration", "2 s", "--seeds", "1")
        page = self.read("index.html")
        self.assertIn('href="games/r1_Passing_Run_and_kick_s1.html"', page)
        self.assertIn('href="games/r1_Passing_Run_and_kick_s1.mcap"', page)
        game = self.read("games/r1_Passing_Run_and_kick_s1.html")
        self.assertIn("<td>half_time</td>", game)
        self.assertIn("sandlot replay r1_Passing_Run_and_kick_s1.mcap --port 8765 --from 0.00s", game)

    def test_a_game_that_cannot_be_played_is_named_and_the_others_are_played(self):
        bad = self.team("Bad", "{controller: {kind: wander, laser: nothing}}")
        said = self.cup("teams/passing", OURS, bad, "--duration", "2 s", "--seeds", "1", code=1).stdout
        self.assertIn("not played: ", said)
        self.assertIn("bad/team.yaml:4", said)
        self.assertIn("1 games, 2 more could not be played; not at its end", said)
        games = self.read()["games"]
        self.assertEqual([each["played"] for each in games].count(False), 2)
        self.assertEqual({team["team"]: team["played"] for team in self.read()["table"]}, {"Passing": 1, "Run and kick": 1, "Bad": 0})
        # Mended: only those two are played.
        shutil.copy(os.path.join(ROOT, OURS, "team.yaml"), os.path.join(bad, "team.yaml"))
        with open(os.path.join(bad, "team.yaml")) as file:
            text = file.read().replace("name: Run and kick", "name: Bad")
        with open(os.path.join(bad, "team.yaml"), "w") as file:
            file.write(text)
        self.cup("teams/passing", OURS, bad, "--duration", "2 s", "--seeds", "1")
        self.assertTrue(self.read()["ended"])
        self.assertEqual(self.read()["stored"], 1)

    def test_teams_that_fail_lose_by_rule_and_harm_nobody(self):
        sandbox.skip_without(self)
        silent = self.program_team("Silent", "import time\ntime.sleep(1000)", "deadline: 0.5 s, patience: 0.5 s")
        crash = self.program_team("Crash", "import os\n" + ANSWERS % "os.abort() if step.number > 5 else None", "deadline: 0.5 s, restart: never")
        late = self.program_team("Late", ANSWERS % "import time; time.sleep(0.1)", "deadline: 5 ms")
        flood = self.program_team("Flood", ANSWERS % FLOODS)
        self.cup("teams/passing", OURS, silent, crash, late, flood, "--duration", "2 s", "--seeds", "1", timeout=400)
        cup = self.read()
        self.assertTrue(cup["ended"])
        self.assertEqual(cup["not_played"], 0)
        failing, games = {"Silent", "Crash", "Late"}, cup["games"]
        self.assertEqual(len(games), 15)
        for game in games:
            fails = failing & {game["left"], game["right"]}
            floods = "Flood" in (game["left"], game["right"])
            if floods and not fails:  # whether it answers in time depends on the machine
                self.assertTrue(game["played"], game)
                continue
            self.assertEqual(game["walk_over"], bool(fails), game)
            # Each is judged by its own clock: also Late, while one that floods is waited for.
            for name in fails:
                self.assertRegex(game["reason"], name + "(:| loses by rule:) (none of )?its programs (missed|answered)|" + name + ".* none of its programs answered")
            if floods:
                continue
            if len(fails) == 1:
                self.assertIn(fails.copy().pop() + " loses by rule", game["reason"])
                lost = game["goals_left"] - game["goals_right"] if game["left"] in fails else game["goals_right"] - game["goals_left"]
                self.assertLessEqual(lost, -3, game)
            elif fails:
                self.assertIn("neither has won", game["reason"])
        for row in cup["table"]:
            if row["team"] in ("Passing", "Run and kick"):
                self.assertGreaterEqual(row["won"], len(failing), row)
        # The game of two others is the one that they play alone.
        both = next(game for game in games if {game["left"], game["right"]} == {"Passing", "Run and kick"})
        alone = self.play("teams/passing", OURS, "--duration", "2 s", "--seed", "1")
        self.assertEqual(both["state_hash"], alone["state_hash"])

    def test_a_game_has_its_time(self):
        # A game of ten minutes is not played in a tenth of a second.
        said = self.cup("teams/passing", OURS, "--duration", "600 s", "--seeds", "1", "--game-limit", "0.1 s", code=1).stdout
        self.assertIn("not played: it took longer than 0.1 s", said)
        self.assertEqual(self.read()["not_played"], 1)

    def test_what_a_team_names_outside_its_folder_counts(self):
        def write(text):
            with open(self.file("common.py"), "w") as file:
                file.write(text)

        sandbox.skip_without(self)
        write("raise SystemExit(1)")
        one = self.team("One", "{controller: {kind: remote, command: [python3, ../common.py], folder: .}}")
        arguments = ("teams/passing", one, "--duration", "2 s", "--seeds", "1")
        for text, stored in (("raise SystemExit(1)", 0), ("raise SystemExit(1)", 1), ("raise SystemExit(2)", 0)):
            write(text)
            self.cup(*arguments)
            self.assertEqual(self.read()["stored"], stored, text)


if __name__ == "__main__":
    unittest.main()
