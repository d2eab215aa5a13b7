"""Processes that are killed at any moment: is what they leave on the disk whole, and does the work go on?

    ./dev soak --kills 100              a hundred times kill -9; or: python3 tests/soak_kills.py 100 [--seed 7]

By turns
  - a run that records: `sandlot doctor` makes the recording whole, and `sandlot replay --verify` proves what it holds;
  - a run with --summary and --log: there is no summary, or a whole one, and each line of the log but the last has all columns;
  - a tournament, killed and started again until it ends: its results are those of one that nothing interrupted, to the bit.

The moments are spread evenly over the time that the same command takes when nobody kills it.
"""
import argparse
import collections
import csv
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

SANDLOT = os.environ.get("SANDLOT_BIN", "build/sandlot")
TEAMS = ["teams/run_and_kick", "teams/dribbling", "teams/passing"]
counts = collections.Counter()


def fail(what):
    sys.exit(f"soak: {what}")


def whole(command):
    """Seconds that it takes."""
    begin = time.monotonic()
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        fail(f"{' '.join(command)}: {done.stderr}")
    return time.monotonic() - begin


def killed(command, after_s):
    """Starts a command and kills it, and nothing of its family is left. @return whether it was still running"""
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
    try:
        code = process.wait(after_s)
        if code != 0:
            fail(f"{' '.join(command)} ended with {code} before it was killed")
        return False
    except subprocess.TimeoutExpired:
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
    return True


def recording(folder, random_s):
    file = os.path.join(folder, "run.mcap")
    command = [SANDLOT, "run", "scenarios/indoor.yaml", "--headless", "--duration", "60s", "--record", file]
    was_running = killed(command, random_s(command))
    if not os.path.exists(file) or os.path.getsize(file) == 0:
        counts["recordings not begun"] += 1
        return was_running
    looked = subprocess.run([SANDLOT, "doctor", file], capture_output=True, text=True)
    if looked.returncode == 2:  # cut off in what every recording begins with
        counts["recordings without a tick"] += 1
        return was_running
    if looked.returncode != 0:
        fail(f"doctor ended with {looked.returncode}: {looked.stdout}{looked.stderr}")
    proved = subprocess.run([SANDLOT, "replay", file, "--verify"], capture_output=True, text=True)
    if "ended before the first one was written" in proved.stderr:
        counts["recordings without a tick"] += 1
    elif proved.returncode != 0:
        fail(f"a killed run's recording is not proved: {proved.stdout}{proved.stderr}")
    else:
        counts["recordings proved"] += 1
    return was_running


def summary(folder, random_s):
    result, log = os.path.join(folder, "summary.json"), os.path.join(folder, "log.csv")
    command = [SANDLOT, "run", "scenarios/indoor.yaml", "--headless", "--duration", "60s", "--summary", result, "--log", log,
               "--log-values", "rover.pose.x,rover.pose.y"]
    was_running = killed(command, random_s(command))
    if os.path.exists(result):
        with open(result) as file:
            json.load(file)
        counts["summaries whole"] += 1
    else:
        counts["summaries absent"] += 1
    if os.path.exists(log):
        with open(log, newline="") as file:
            rows = list(csv.reader(file))
        if any(len(row) != 3 for row in rows[:-1]):
            fail(f"a line of {log} lacks columns")
        counts["logs readable"] += 1
    return was_running


def games(folder):
    """Results without where they lie, and how many of them were played before."""
    with open(os.path.join(folder, "games.csv"), newline="") as file:
        rows = list(csv.DictReader(file))
    counts["games kept"] += sum(row["stored"] == "true" for row in rows)
    return [{key: row[key] for key in row if key not in ("recording", "stored")} for row in rows]


def tournament(folder, random_s):
    def command(out):
        return [SANDLOT, "tournament", *TEAMS, "--seeds", "2", "--duration", "20 s", "--physics", "planar", "--drive", "ideal", "--out", out]

    out, reference = os.path.join(folder, "cup"), os.path.join(folder, "reference")
    moment = random_s(command(reference))
    was_running = killed(command(out), moment)
    done = subprocess.run(command(out), capture_output=True, text=True)
    if done.returncode != 0:
        fail(f"a killed tournament does not go on: {done.stdout}{done.stderr}")
    if not hasattr(tournament, "games"):
        whole(command(reference))
        tournament.games = games(reference)
    if games(out) != tournament.games:
        fail(f"a tournament that was killed after {moment:.2f} s ends in other results:\n{games(out)}, not\n{tournament.games}")
    counts["tournaments gone on"] += 1
    return was_running


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kills", type=int, nargs="?", default=100)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    chance, lengths, begin = random.Random(options.seed), {}, time.monotonic()
    kills = ended = 0
    while kills < options.kills:
        kind = (recording, summary, tournament)[(kills + ended) % 3]
        folder = tempfile.mkdtemp(prefix="sandlot-kills-")

        def moment(command):
            if kind not in lengths:
                lengths[kind] = whole([word.replace(folder, folder + "/whole") for word in command])
            return chance.uniform(0, lengths[kind])

        os.makedirs(folder + "/whole")
        if kind(folder, moment):
            kills += 1
        else:
            ended += 1
        shutil.rmtree(folder)
    print(f"soak: {kills} times killed in {time.monotonic() - begin:.0f} s, "
          + ", ".join(f"{count} {name}" for name, count in sorted(counts.items())))


if __name__ == "__main__":
    main()
