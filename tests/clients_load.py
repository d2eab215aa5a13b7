"""What many clients cost a run, and what a hostile one costs its neighbours: the table of docs/clients.md, "Load".

    python3 tests/clients_load.py [modules] [many] [neighbour] [twelve] [namespace] [--repeat 3]

Every number is the median of some repetitions, of which each measures with and without in turn, so that other work on the machine hits
both. Processor time is that of the server's process. Meant for two processors or more: the run is held to the first, its clients to the
second.
"""
import argparse
import json
import multiprocessing
import os
import selectors
import signal
import statistics
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from clients_test import Run  # noqa: E402
from soak_clients import Lines, connect, flood, flood_with_long_ones, greedy_spectator, line  # noqa: E402

RUN_ON, CLIENTS_ON = {0}, {1 % (os.cpu_count() or 1)}


def scenario_file(folder, robots, sonars=0):
    """Rovers in a walled square, each with `sonars` range finders that measure in every tick of 10 ms."""
    name = os.path.join(folder, "load%d_%d.yaml" % (robots, sonars))
    with open(name, "w") as file:
        file.write("version: 1\nphysics: planar\ntime: {step: 10 ms}\nrobots:\n")
        for i in range(robots):
            file.write("  - name: r%d\n    model: rover\n    pose: [%g, %g, 0]\n" % (i, i % 5 - 2, i // 5 - 1))
            if sonars:
                file.write("    devices:\n")
            for k in range(sonars):
                file.write("      sonar%d: {kind: range_finder, link: base_link, pose: [0.2, 0, 0.1, 0, 0, %d deg], rate: 0}\n"
                           % (k, 18 * k))
        file.write("things:\n  - {name: walls, model: {builder: square_playground, length: 10, factor_xy: 1, wall: 0.1, height: 1}}\n")
    return name


class Server(Run):
    """A run on its own processor, ended by quit(); with the processor time that it took."""

    def __init__(self, *arguments):
        before = os.sched_getaffinity(0)
        os.sched_setaffinity(0, RUN_ON)
        try:
            super().__init__(*arguments)
        finally:
            os.sched_setaffinity(0, before)
        self.port = int(self.url.rsplit(":", 1)[1])

    def processor_s(self):
        with open("/proc/%d/stat" % self.process.pid) as file:
            fields = file.read().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def time_s(self):
        """Simulated time."""
        with connect(self.port) as made:
            made.sendall(line(op="call_service", service="/rosapi/get_time", id="t"))
            now = Lines(made).next()["values"]["time"]
        return now["sec"] + now["nanosec"] / 1e9

    def quit(self):
        self.process.send_signal(signal.SIGINT)
        self.process.wait(timeout=30)
        with open(self.file) as file:
            return json.load(file)


def child(function, *arguments):
    """Runs it in a process on the clients' processor; what it puts into the queue is the result."""
    queue = multiprocessing.Queue()

    def work():
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        os.sched_setaffinity(0, CLIENTS_ON)
        function(queue, *arguments)

    process = multiprocessing.Process(target=work, daemon=True)
    process.start()
    return process, queue


# ------------------------------------------------------------------------------------------------ one connection per module

def drain(queue, port, subscriptions, seconds):
    """Reads what comes at connections with these topics; counts messages by their line breaks."""
    selector = selectors.DefaultSelector()
    for topics in subscriptions:
        made = connect(port)
        made.sendall(b"".join(line(op="subscribe", topic=topic) for topic in topics))
        made.setblocking(False)
        selector.register(made, selectors.EVENT_READ)
    queue.put("ready")
    messages, end = 0, time.monotonic() + seconds
    while time.monotonic() < end:
        for key, _ in selector.select(0.1):
            try:
                messages += key.fileobj.recv(1 << 18).count(b"\n")
            except BlockingIOError:
                pass
            except OSError:
                selector.unregister(key.fileobj)
    queue.put(messages)


def modules_once(file, topics, connections, rate, seconds=2.0):
    """Ticks per second, the run's processor time per tick [us], messages per tick."""
    with Server(file, "--rate", rate) as server:
        share = [topics[i::connections] for i in range(connections)]
        process, queue = child(drain, server.port, share, 3 * seconds)
        queue.get(timeout=30)
        time.sleep(0.5)
        begin_s, used_s, sim_s = time.monotonic(), server.processor_s(), server.time_s()
        time.sleep(seconds)
        sim_s, used_s, wall_s = server.time_s() - sim_s, server.processor_s() - used_s, time.monotonic() - begin_s
        process.kill()
        process.join()
        server.quit()
    ticks = sim_s / 0.01
    return ticks / wall_s, 1e6 * used_s / ticks


def modules(options, folder):
    file = scenario_file(folder, 1, 20)
    topics = ["/r0/sonar%d/range" % i for i in range(20)]
    with Server(file) as server:
        with connect(server.port) as made:
            made.sendall(line(op="call_service", service="/rosapi/topics", id="t"))
            there = Lines(made).next()["values"]["topics"]
        server.quit()
    topics = sorted(topic for topic in there if topic.startswith("/r0/sonar"))[:20]
    rows = []
    for count in (1, 2, 5, 10, 20):
        result = {}
        for connections in (1, count):
            result[connections] = []
        for _ in range(options.repeat):
            for connections in {1, count}:
                fast = modules_once(file, topics[:count], connections, "max")
                paced = modules_once(file, topics[:count], connections, "5")
                result[connections].append((fast[0], paced[1]))
        middle = {k: [statistics.median(x) for x in zip(*v)] for k, v in result.items()}
        rows.append("| %d | %.0f | %.0f | %.2f | %.0f | %.0f | %.2f |" % (
            count, middle[1][0], middle[count][0], middle[count][0] / middle[1][0], middle[1][1], middle[count][1],
            middle[count][1] / middle[1][1]))
        print(rows[-1], file=sys.stderr)
    return ["| modules with a subscription each | ticks/s at full speed, one connection | a connection each | ratio | "
            "processor time per tick at 500 ticks/s, one connection [us] | a connection each [us] | ratio |",
            "|--:|--:|--:|--:|--:|--:|--:|", *rows]


# ------------------------------------------------------------------------------------------------ 200 clients

def many_clients(queue, port, count, seconds):
    begin, sockets = time.monotonic(), []
    for i in range(count):
        made = connect(port)
        made.sendall(line(op="sandlot.claim", robot="r%d" % (i % 10), id="c") * (i < 10)
                     + line(op="subscribe", topic="/r%d/laser/ranges" % (i % 10)) + line(op="subscribe", topic="/clock"))
        sockets.append(Lines(made))
    for each in sockets[10:]:
        each.socket.sendall(line(op="call_service", service="/rosapi/get_time", id="t"))
        while each.next()["op"] != "service_response":
            pass
    connected_s = time.monotonic() - begin
    selector, counts = selectors.DefaultSelector(), [0] * count
    for i, each in enumerate(sockets):
        each.socket.setblocking(False)
        selector.register(each.socket, selectors.EVENT_READ, i)
    begin = time.monotonic()
    while time.monotonic() < begin + seconds:
        for key, _ in selector.select(0.1):
            data = key.fileobj.recv(1 << 18)
            counts[key.data] += data.count(b"/laser/ranges")
    queue.put((connected_s, min(counts) / seconds, statistics.median(counts) / seconds))


def many(options, folder):
    results = []
    for _ in range(options.repeat):
        with Server(scenario_file(folder, 10), "--rate", "1", "--most-clients", "250") as server:
            used_s, begin = server.processor_s(), time.monotonic()
            process, queue = child(many_clients, server.port, 200, 5)
            connected_s, least, middle = queue.get(timeout=120)
            used = (server.processor_s() - used_s) / (time.monotonic() - begin)
            process.join()
            summary = server.quit()
        results.append((connected_s, least, middle, used, summary["late_ticks"] / summary["ticks"]))
    connected_s, least, middle, used, late = (statistics.median(x) for x in zip(*results))
    return ["200 clients at once, each with a laser (10 Hz) and the clock of ten rovers in real time: all connected after %.2f s; messages of "
            "the laser per second: least %.1f, median %.1f; %.0f %% of a processor; %.2f %% of the ticks late."
            % (connected_s, least, middle, 100 * used, 100 * late)]


# ------------------------------------------------------------------------------------------------ a victim and its neighbour

def victim(queue, port, seconds, rate_hz=100):
    """Commands a robot at a rate and asks for the time as often; acknowledged commands per second, latencies."""
    lines = Lines(connect(port))
    lines.socket.sendall(line(op="sandlot.claim", robot="r0", id="c"))
    while lines.next().get("op") != "sandlot.claimed":
        pass
    latencies, answered = [], 0
    begin = due = time.monotonic()
    while due < begin + seconds:
        now = time.monotonic()
        if now < due:
            time.sleep(due - now)
        due += 1 / rate_hz
        sent = time.monotonic()
        lines.socket.sendall(line(op="publish", topic="/r0/drive", msg={"linear": {"x": 0.2}, "angular": {"z": 0.2}})
                             + line(op="call_service", service="/rosapi/get_time", id="t"))
        while lines.next().get("op") != "service_response":
            pass
        latencies.append(time.monotonic() - sent)
        answered += 1
    wall_s = time.monotonic() - begin
    latencies.sort()
    queue.put((answered / wall_s, 1e3 * statistics.median(latencies), 1e3 * latencies[int(0.99 * len(latencies))]))


def flooding(queue, port):
    import random
    rng = random.Random(1)
    os.nice(5)  # of the clients' processor the victim's program shall have its part: what is measured is the server
    while True:
        for attack in (flood, flood, flood_with_long_ones):
            try:
                attack(rng, port)
            except OSError:
                time.sleep(0.01)


def neighbour(options, folder):
    file, alone, beside = scenario_file(folder, 12), [], []
    for _ in range(options.repeat):
        for hostile in (False, True):
            with Server(file, "--rate", "1") as server:
                attackers = [child(flooding, server.port)[0] for _ in range(2 * hostile)]
                process, queue = child(victim, server.port, 5)
                (beside if hostile else alone).append(queue.get(timeout=60))
                for each in [process, *attackers]:
                    each.kill()
                    each.join()
                server.quit()
    a, b = ([statistics.median(x) for x in zip(*each)] for each in (alone, beside))
    return ["A client that commands at 100 Hz, alone and beside two that flood: %.1f and %.1f commands/s acknowledged, ratio %.3f "
            "(at least 0.95); latency %.2f and %.2f ms in the middle, %.2f and %.2f ms at 99 %%."
            % (a[0], b[0], b[0] / a[0], a[1], b[1], a[2], b[2])]


# ------------------------------------------------------------------------------------------------ twelve clients at 100 Hz

def twelve_clients(queue, port, seconds):
    selector, sockets = selectors.DefaultSelector(), []
    for i in range(12):
        made = connect(port)
        made.sendall(line(op="sandlot.claim", robot="r%d" % i, id="c")
                     + line(op="subscribe", topic="/r%d/laser/ranges" % i, throttle_rate=100))
        sockets.append(made)
        selector.register(made, selectors.EVENT_READ)
    queue.put("ready")
    begin = due = time.monotonic()
    commands = [line(op="publish", topic="/r%d/drive" % i, msg={"linear": {"x": 0.2}, "angular": {"z": 0.2}}) for i in range(12)]
    while due < begin + seconds:
        for key, _ in selector.select(max(0, due - time.monotonic())):
            key.fileobj.recv(1 << 18)
        if time.monotonic() >= due:
            due += 0.01
            for made, command in zip(sockets, commands):
                made.sendall(command)
    queue.put("done")


def twelve_once(file, rate, clients, seconds=3.0):
    """The robots drive with and without clients, by the same commands: a world in which nothing moves takes a tenth less time."""
    driving = ['command r%d/drive Twist {"linear": {"x": 0.2}, "angular": {"z": 0.2}}' % i for i in range(12)]
    with Server(file, "--rate", rate, *(word for each in driving for word in ("--command", each))) as server:
        process = None
        if clients:
            process, queue = child(twelve_clients, server.port, 3 * seconds)
            queue.get(timeout=30)
        time.sleep(0.3)
        begin, sim_s, used_s = time.monotonic(), server.time_s(), server.processor_s()
        time.sleep(seconds)
        sim_s, wall_s = server.time_s() - sim_s, time.monotonic() - begin
        used_s = server.processor_s() - used_s
        if process:
            process.kill()
            process.join()
        server.quit()
    return sim_s / wall_s, used_s / wall_s, sim_s / used_s


def twelve(options, folder):
    file, out = scenario_file(folder, 12), []
    for rate, name in (("1", "in real time"), ("max", "at full speed")):
        result = {False: [], True: []}
        for _ in range(options.repeat):
            for clients in (False, True):
                result[clients].append(twelve_once(file, rate, clients))
        without, with_ = ([statistics.median(x) for x in zip(*result[each])] for each in (False, True))
        out.append("Twelve clients that command at 100 Hz each, %s, on the run's own processor: %.4g times real time without, %.4g with, "
                   "ratio %.3f; %.1f and %.1f %% of the processor; simulated time per processor time, of that without, %.3f."
                   % (name, without[0], with_[0], with_[0] / without[0], 100 * without[1], 100 * with_[1], with_[2] / without[2]))
    return out


# ------------------------------------------------------------------------------------------------ another network namespace

CLIENT_ELSEWHERE = """
import json, socket, sys, time
made = socket.create_connection((sys.argv[1], int(sys.argv[2])), timeout=10)
file = made.makefile("rw")
def send(**message): file.write(json.dumps(message) + "\\n"); file.flush()
send(op="call_service", service="/get_entity_state", args={"entity": "r0"}, id="no")
print("without a token:", json.loads(file.readline())["values"])
send(op="sandlot.claim", robot="r0", token=sys.argv[3], id="c")
print("with it:", json.loads(file.readline())["op"])
send(op="subscribe", topic="/r0/laser/ranges")
count, begin = 0, time.monotonic()
while count < 20:
    if json.loads(file.readline())["op"] == "publish":
        count += 1
        send(op="publish", topic="/r0/drive", msg={"linear": {"x": 0.2}})
print("%.1f scans a second" % (count / (time.monotonic() - begin)))
"""


def namespace(options, folder):
    name, ours, theirs = "sandlot%d" % os.getpid(), "10.211.7.1", "10.211.7.2"
    link = "sl%d" % (os.getpid() % 100_000)

    def ip(*words):
        subprocess.run(["ip", *words], check=True, stderr=subprocess.PIPE, text=True)

    tokens = os.path.join(folder, "tokens.yaml")
    with open(tokens, "w") as file:
        file.write("- {token: secret-of-r0, robot: r0}\n")
    os.chmod(tokens, 0o600)
    try:
        ip("netns", "add", name)
    except (OSError, subprocess.CalledProcessError) as error:
        return ["A client in another network namespace: none can be made here (%s)." % error]
    try:
        ip("link", "add", link, "type", "veth", "peer", "name", link + "p", "netns", name)
        ip("addr", "add", ours + "/30", "dev", link)
        ip("link", "set", link, "up")
        ip("-n", name, "addr", "add", theirs + "/30", "dev", link + "p")
        ip("-n", name, "link", "set", link + "p", "up")
        with Server(scenario_file(folder, 1), "--rate", "1", "--tokens", tokens, "--address", ours) as server:
            ran = subprocess.run(["ip", "netns", "exec", name, sys.executable, "-c", CLIENT_ELSEWHERE, ours, str(server.port),
                                  "secret-of-r0"], text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=60)
            server.quit()
        return ["A client in another network namespace, by veth to a server at %s with tokens: %s." % (
            "--address", "; ".join(ran.stdout.strip().splitlines()[-3:]))]
    except subprocess.CalledProcessError as error:
        return ["A client in another network namespace: no link can be made here (%s)." % error.stderr.strip()]
    finally:
        subprocess.run(["ip", "link", "del", link], stderr=subprocess.DEVNULL, check=False)
        subprocess.run(["ip", "netns", "del", name], check=False)


PARTS = dict(modules=modules, many=many, neighbour=neighbour, twelve=twelve, namespace=namespace)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", help=", ".join(PARTS) + "; all when left out")
    parser.add_argument("--repeat", type=int, default=3)
    options = parser.parse_args()
    for part in options.parts:
        if part not in PARTS:
            parser.error("'%s' is none of %s" % (part, ", ".join(PARTS)))
    with tempfile.TemporaryDirectory() as folder:
        for part in options.parts or PARTS:
            print("\n".join(PARTS[part](options, folder)) + "\n", flush=True)


if __name__ == "__main__":
    main()
