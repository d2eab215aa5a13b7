"""A long run with hostile clients beside honest ones: does the server stay whole, and its size the same?

    ./dev soak --clients 600            ten minutes; or: python3 tests/soak_clients.py 600 [--rate max] [--seed 7]

Two teams of two robots: one robot of each is driven in lockstep, one freely, by honest clients. Beside them hostile ones connect, flood,
stall, send garbage, leave messages unfinished, vanish, guess tokens, and one of them has a token and a robot of its own.

Fails when
  - the run ends, or an honest client is closed, refused anything, or makes no progress for half a minute;
  - an honest client in lockstep misses more than one step in a thousand (a miss here is a deadline of 2 s on a shared machine);
  - descriptors are more than a third above their middle after the warm-up, or threads more than then;
  - the resident size in the last quarter is, in its middle, above that of the quarter after the warm-up by more than a tenth and 16 MiB:
    what slow readers hold at one moment swings, and the history of a run that may be rewound grows up to its own limit.
"""
import argparse
import base64
import json
import multiprocessing
import os
import random
import signal
import socket
import statistics
import struct
import sys
import tempfile
import threading
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from clients_test import Run  # noqa: E402

TOKENS = {"red": "secret-of-red", "blue": "secret-of-blue", "green": "secret-of-green"}
SPECTATOR, ADMIN = "secret-of-spectators", "secret-of-admin"
SCENARIO = """version: 1
physics: planar
time: {step: 20 ms, control_interval: 5}
robots:
  - {name: red1, model: rover, pose: [-2, 1, 0], team: red, controller: {kind: remote, deadline: 2 s}}
  - {name: red2, model: rover, pose: [-2, -1, 0], team: red}
  - {name: blue1, model: rover, pose: [2, 1, 0], team: blue, controller: {kind: remote, deadline: 2 s}}
  - {name: blue2, model: rover, pose: [2, -1, 0], team: blue}
  - {name: green1, model: rover, pose: [0, 2, 0], team: green}
teams: [{name: red}, {name: blue}, {name: green}]
things:
  - {name: walls, model: {builder: square_playground, length: 8, factor_xy: 1, wall: 0.1, height: 1}}
"""
EVERY_TOPIC = ["/%s/laser/ranges" % robot for robot in ("red1", "red2", "blue1", "blue2", "green1")] + ["/tf", "/clock", "/rosout"]


# ------------------------------------------------------------------------------------------------ wires

def connect(port, timeout_s=5.0):
    made = socket.create_connection(("127.0.0.1", port), timeout=timeout_s)
    made.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return made


def line(**message):
    return json.dumps(message, separators=(",", ":")).encode() + b"\n"


def frame(payload, opcode=1, fin=True):
    """A masked WebSocket frame; the mask is 0."""
    length = len(payload)
    head = bytes([(0x80 if fin else 0) | opcode])
    if length < 126:
        head += bytes([0x80 | length])
    elif length < 65536:
        head += bytes([0x80 | 126]) + struct.pack(">H", length)
    else:
        head += bytes([0x80 | 127]) + struct.pack(">Q", length)
    return head + b"\0\0\0\0" + payload


def upgrade(port, query="", protocol=None):
    made = connect(port)
    head = ("GET /%s HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
            "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: %s\r\n" % (query, base64.b64encode(os.urandom(16)).decode()))
    if protocol:
        head += "Sec-WebSocket-Protocol: %s\r\n" % protocol
    made.sendall(head.encode() + b"\r\n")
    return made


class Lines:
    """JSON lines of a connection."""

    def __init__(self, made):
        self.socket, self.rest = made, b""

    def next(self):
        while b"\n" not in self.rest:
            data = self.socket.recv(1 << 16)
            if not data:
                raise ConnectionError("closed")
            self.rest += data
        one, self.rest = self.rest.split(b"\n", 1)
        return json.loads(one)


# ------------------------------------------------------------------------------------------------ honest clients

class Honest(threading.Thread):
    """Drives one robot; `steps`, `misses` and `failure` are looked at from outside."""

    def __init__(self, port, robot, team, lockstep):
        super().__init__(daemon=True)
        self.port, self.robot, self.team, self.lockstep = port, robot, team, lockstep
        self.steps = self.misses = 0
        self.failure = None
        self.leaving = False

    def run(self):
        try:
            self.drive()
        except (OSError, ValueError, KeyError) as error:
            if not self.leaving:
                self.failure = "%s: %r" % (self.robot, error)

    def drive(self):
        made = connect(self.port, 60)
        lines = Lines(made)
        made.sendall(line(op="sandlot.claim", robot=self.robot, token="secret-of-" + self.robot, id="claim"))
        made.sendall(line(op="subscribe", topic="/%s/laser/ranges" % self.robot))
        if self.lockstep:
            made.sendall(line(op="sandlot.claim", robot=self.robot, token="secret-of-" + self.robot, id="claim",
                              mode="lockstep", deadline_ms=2000))
        last_ns = None
        while not self.leaving:
            message = lines.next()
            if message["op"] == "status":
                raise ValueError(message["msg"])
            command = line(op="publish", topic="/%s/drive" % self.robot,
                           msg={"linear": {"x": 0.2}, "angular": {"z": 0.3}})
            if self.lockstep and message["op"] == "sandlot.tick":
                now_ns = message["time"]["sec"] * 10**9 + message["time"]["nanosec"]
                if last_ns is not None:
                    self.misses += round((now_ns - last_ns) / 100e6) - 1
                last_ns = now_ns
                made.sendall(command + line(op="sandlot.done", step=message["step"]))
                self.steps += 1
            elif not self.lockstep and message["op"] == "publish":
                made.sendall(command)
                self.steps += 1


# ------------------------------------------------------------------------------------------------ hostile clients

VALID = [
    dict(op="subscribe", topic="/clock"),
    dict(op="publish", topic="/red1/drive", msg={"linear": {"x": 0.3}}),
    dict(op="call_service", service="/rosapi/topics", id="a", args={}),
    dict(op="call_service", service="/sandlot/console", id="a", args={"line": "list entities"}),
    dict(op="sandlot.claim", robot="red1", token="?", mode="lockstep", deadline_ms=20),
    dict(op="sandlot.done", step=7, orders={"drive": {"linear": {"x": 1}}}),
    dict(op="fragment", id="f", num=0, total=3, data="{}"),
    dict(op="advertise", topic="/blue1/drive", type="geometry_msgs/Twist"),
    dict(op="set_level", level="info"),
]


def mutated(rng, data):
    data = bytearray(data)
    for _ in range(rng.randint(1, 8)):
        at = rng.randrange(len(data))
        kind = rng.randrange(4)
        if kind == 0:
            data[at] = rng.randrange(256)
        elif kind == 1:
            del data[at:at + rng.randint(1, 5)]
        elif kind == 2:
            data[at:at] = bytes(rng.randrange(256) for _ in range(rng.randint(1, 5)))
        else:
            data[at:at] = data[max(0, at - 20):at]
        if not data:
            return b"{"
    return bytes(data)


def vanish(rng, port):
    made = connect(port)
    made.sendall(line(op="call_service", service="/rosapi/topics_and_raw_types", id="x"))
    made.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    made.close()


def flood(rng, port):
    with connect(port) as made:
        many = b"".join(line(**rng.choice(VALID)) for _ in range(400))
        for _ in range(rng.randint(1, 15)):
            made.sendall(many)


def flood_with_long_ones(rng, port):
    with connect(port) as made:
        long = line(op="publish", topic="/red1/drive", msg={"linear": [0.125] * 100_000})
        for _ in range(rng.randint(1, 10)):
            made.sendall(long)


def stall(rng, port):
    made = socket.socket()
    with made:
        made.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        made.settimeout(5)
        made.connect(("127.0.0.1", port))
        made.sendall(line(op="call_service", service="/rosapi/topics_and_raw_types", id="x") * 100)
        time.sleep(rng.uniform(0.5, 8))


def garbage(rng, port):
    with connect(port) as made:
        made.sendall(b"{" if rng.random() < 0.5 else b"")
        for _ in range(rng.randint(1, 50)):
            made.sendall(mutated(rng, line(**rng.choice(VALID))))


def garbage_by_websocket(rng, port):
    with upgrade(port) as made:
        for _ in range(rng.randint(1, 50)):
            data = mutated(rng, line(**rng.choice(VALID)))
            sent = frame(data, rng.choice((0, 1, 2, 2, 8, 9, 10)), rng.random() < 0.9)
            made.sendall(sent if rng.random() < 0.8 else mutated(rng, sent))


def half_open(rng, port):
    begun = rng.choice((b"", b"GET / HT", b"{", b'{"op":"subscribe","topic":"', b"\x16\x03\x01\x02\x00"))
    with connect(port) as made:
        made.sendall(begun)
        time.sleep(rng.uniform(0.5, 12))


def guess(rng, port):
    with connect(port) as made:
        for _ in range(20):
            made.sendall(line(op="sandlot.claim", robot=rng.choice(("red1", "blue2")), token="%08x" % rng.getrandbits(32)))
    with upgrade(port, "?token=%08x" % rng.getrandbits(32)) as made:
        made.settimeout(1)
        made.recv(4096)


def endless_fragments(rng, port):
    with connect(port) as made:
        for k in range(rng.randint(1, 40)):
            made.sendall(line(op="fragment", id="endless", num=k, total=10_000, data="x" * 30_000))
        time.sleep(rng.uniform(0, 3))


def greedy_spectator(rng, port):
    """Everything at once, in the forms that are the most work; read slowly or not at all."""
    with upgrade(port, "?token=" + SPECTATOR) as made:
        made.settimeout(2)
        for topic in EVERY_TOPIC:
            made.sendall(frame(line(op="subscribe", topic=topic, compression=rng.choice(("none", "png", "cbor", "cbor-raw")),
                                    fragment_size=rng.choice((0, 100, 1000)))))
        for _ in range(30):
            made.sendall(frame(line(op="call_service", service=rng.choice(
                ("/get_entities", "/sandlot/console", "/sandlot/complete", "/rosapi/topics_and_raw_types")), id="x",
                args={"line": "list values"} if rng.random() < 0.3 else {}, compression=rng.choice(("none", "png")))))
        end = time.monotonic() + rng.uniform(1, 6)
        slow = rng.random() < 0.5
        while time.monotonic() < end:
            if slow:
                time.sleep(0.2)
            elif not made.recv(1 << 16):
                return


def foxglove_spectator(rng, port):
    with upgrade(port, "?token=" + SPECTATOR, "foxglove.sdk.v1") as made:
        made.settimeout(2)
        made.sendall(frame(json.dumps({"op": "subscribe", "subscriptions": [
            {"id": i, "channelId": rng.randint(1, 60)} for i in range(rng.choice((10, 5000)))]}).encode()))
        for message in ({"op": "getParameters", "parameterNames": [], "id": "p"}, {"op": "subscribeConnectionGraph"},
                        {"op": "subscribeParameterUpdates", "parameterNames": []},
                        {"op": "setParameters", "parameters": [{"name": "sandlot.paused", "value": True}]}):
            made.sendall(frame(json.dumps(message).encode()))
        for _ in range(20):
            made.sendall(frame(os.urandom(rng.randint(1, 200)), 2))
        end = time.monotonic() + rng.uniform(0.5, 3)
        while time.monotonic() < end and made.recv(1 << 16):
            pass


def insider(rng, port):
    """Has a token and a robot: claims, claims again, commands nonsense, and at others' robots, takes over from itself."""
    with connect(port) as made:
        for _ in range(rng.randint(1, 6)):
            made.sendall(line(op="sandlot.claim", team="green", token=TOKENS["green"], mode=rng.choice(("free", "lockstep"))))
        for _ in range(rng.randint(1, 200)):
            robot = rng.choice(("green1", "green1", "red1", "blue1"))
            number = rng.choice((0.3, -0.3, 1e308, "NaN", None, [1], 1e-300))
            made.sendall(line(op="publish", topic="/%s/drive" % robot, msg={"linear": {"x": number}}))
        made.sendall(line(op="call_service", service="/green1/odometry/reset", id="r") * 20)
        made.sendall(line(op="sandlot.release") if rng.random() < 0.5 else b"")
        time.sleep(rng.uniform(0, 1))


HOSTILE = [vanish, flood, flood_with_long_ones, stall, stall, garbage, garbage_by_websocket, half_open, half_open, guess,
           endless_fragments, greedy_spectator, greedy_spectator, foxglove_spectator, insider]


def hostile(port, seed, counts, number_of_them):
    """One process of hostile threads, so that they do not take the time of the honest."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def behave(number):
        rng = random.Random("%d/%d" % (seed, number))
        while True:
            kind = rng.randrange(len(HOSTILE))
            try:
                HOSTILE[kind](rng, port)
            except OSError:
                pass  # it was closed, which is what it deserves
            with counts.get_lock():
                counts[kind] += 1
            time.sleep(rng.uniform(0, 0.1))

    threads = [threading.Thread(target=behave, args=(i,), daemon=True) for i in range(number_of_them)]
    for each in threads:
        each.start()
    for each in threads:
        each.join()


# ------------------------------------------------------------------------------------------------ the watch

def size_of(pid):
    """Resident MiB, descriptors, threads."""
    with open("/proc/%d/status" % pid) as file:
        status = dict(each.split(":", 1) for each in file if ":" in each)
    return int(status["VmRSS"].split()[0]) / 1024, len(os.listdir("/proc/%d/fd" % pid)), int(status["Threads"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("seconds", nargs="?", type=float, default=60)
    parser.add_argument("--rate", default="1", help="of the run: 1 is real time, or max")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--hostile", type=int, default=14, help="hostile clients at a time; 0: what does the run take by itself?")
    parser.add_argument("--every", type=float, default=60, help="seconds between two lines of figures")
    options = parser.parse_args()

    folder = tempfile.TemporaryDirectory()
    scenario, tokens = os.path.join(folder.name, "soak.yaml"), os.path.join(folder.name, "tokens.yaml")
    with open(scenario, "w") as file:
        file.write(SCENARIO)
    with open(tokens, "w") as file:
        file.write("".join("- {token: %s, team: %s}\n" % (token, team) for team, token in TOKENS.items()))
        file.write("".join("- {token: secret-of-%s, robot: %s}\n" % (robot, robot) for robot in ("red1", "red2", "blue1", "blue2")))
        file.write("- {token: %s, role: admin}\n- {token: %s, role: spectator}\n" % (ADMIN, SPECTATOR))
    os.chmod(tokens, 0o600)

    failures = []
    samples = []  # seconds, RSS, descriptors, threads
    with Run(scenario, "--rate", options.rate, "--tokens", tokens, "--most-clients", "100") as run:
        pid, port = run.process.pid, int(run.url.rsplit(":", 1)[1])
        honest = [Honest(port, robot, team, robot.endswith("1"))
                  for robot, team in (("red1", "red"), ("red2", "red"), ("blue1", "blue"), ("blue2", "blue"))]
        for each in honest:
            each.start()
        counts = multiprocessing.Array("q", len(HOSTILE))
        attackers = multiprocessing.Process(target=hostile, args=(port, options.seed, counts, options.hostile), daemon=True)
        attackers.start()
        begin = next_line = time.monotonic()
        progress = {each: (0, begin) for each in honest}
        print("%8s %9s %6s %8s %14s %8s %9s" % ("seconds", "RSS MiB", "files", "threads", "honest steps", "misses", "attacks"))
        while time.monotonic() < begin + options.seconds and not failures:
            time.sleep(0.5)
            now = time.monotonic()
            if run.process.poll() is not None:
                failures.append("the run ended with %s: %s" % (run.process.returncode, "".join(run.said[-5:])))
                break
            samples.append((now - begin, *size_of(pid)))
            for each in honest:
                steps, since = progress[each]
                if each.failure:
                    failures.append(each.failure)
                if each.steps > steps:
                    progress[each] = (each.steps, now)
                elif now > since + 30:
                    failures.append("%s made no progress for 30 s" % each.robot)
            if now >= next_line:
                next_line += options.every
                print("%8.0f %9.1f %6d %8d %14s %8d %9d" % (*samples[-1], "/".join(str(each.steps) for each in honest),
                                                          sum(each.misses for each in honest), sum(counts)), flush=True)
        attackers.kill()
        attackers.join()
        for each in honest:
            each.leaving = True
        steps = sum(each.steps for each in honest if each.lockstep)
        misses = sum(each.misses for each in honest)
        if misses > max(2, steps / 1000):
            failures.append("the honest missed %d of %d steps" % (misses, steps))
        if run.process.poll() is None:
            run.process.send_signal(signal.SIGINT)
            run.process.wait(timeout=30)
    warm = options.seconds / 4
    after = [each for each in samples if warm <= each[0] < 2 * warm]
    last = [each for each in samples if each[0] >= 3 * warm]
    if after and last and not failures:
        middle = [statistics.median(each[i] for each in after) for i in (1, 2, 3)]
        end = [statistics.median(each[i] for each in last) for i in (1, 2, 3)]
        print("middle after the warm-up: RSS %.1f MiB, %d files, %d threads; at the end: %.1f MiB, %d files, %d threads; most: %.1f MiB"
              % (*middle, *end, max(each[1] for each in samples)))
        if end[0] > 1.1 * middle[0] + 16:
            failures.append("the resident size grew from %.1f to %.1f MiB" % (middle[0], end[0]))
        if end[1] > 4 / 3 * middle[1]:
            failures.append("descriptors grew from %d to %d" % (middle[1], end[1]))
        if end[2] > middle[2]:
            failures.append("threads grew from %d to %d" % (middle[2], end[2]))
    print("attacks: " + ", ".join("%s %d" % (name, sum(counts[i] for i in range(len(HOSTILE)) if HOSTILE[i].__name__ == name))
                                  for name in sorted({each.__name__ for each in HOSTILE})))
    print("soak: %s" % ("; ".join(failures) if failures else "%.0f s, whole; the honest took %d steps in lockstep and missed %d"
                        % (options.seconds, steps, misses)))
    folder.cleanup()
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
