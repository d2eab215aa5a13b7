"""Drives robots of a Sandlot run from Python: standard library only.

    from sandlot_client import Robot

    with Robot("rover", lockstep=True) as rover:
        laser = rover.subscribe("laser")
        for step in rover.steps():
            ahead = laser.message["ranges"][100:171]  # None: nothing within reach
            near = any(r is not None and r < 0.6 for r in ahead)
            rover.command("drive", {"linear": {"x": 0.0 if near else 0.3}, "angular": {"z": 0.8 if near else 0.0}})

Protocol   rosbridge v2 as JSON over TCP, with claims and lockstep of Sandlot's own: docs/clients.md.
Messages   dicts with the field names of ROS 2; lists of numbers are lists, see numbers(); octets are base64 text, see data_of().
Address    SANDLOT_URL or tcp://127.0.0.1:8765; the address that a run prints (http://...) is one, too. unix:PATH reaches a run
           from inside a sandbox.
Token      SANDLOT_TOKEN, or ?token=... of the address.
Started    by the run itself, a program has all of these in its environment, and who it is, too: Robot(), Team() without a name.
Errors     Refused: the server's own words. RunEnded: the run is over. ConnectionError: the connection broke, or was closed
           for the reason it names. TimeoutError: no answer. Nothing reconnects by itself: a robot is claimed again by a new Robot.
Threads    none: messages are taken while steps(), spin() or call() wait.
"""

from __future__ import annotations

import array
import base64
import json
import math
import os
import re
import selectors
import socket
import sys
import time
import urllib.parse
from typing import Any, Callable, Dict, Iterator, List, Optional, Sequence, Tuple, Union

from .clock import Clock

try:
    import numpy
except ImportError:
    numpy = None  # type: ignore[assignment]

__all__ = ["Call", "Clock", "Connection", "Member", "Reading", "Refused", "Robot", "RunEnded", "Step", "Team", "data_of",
           "numbers", "packet"]

Message = Dict[str, Any]
Handler = Callable[[Message], None]


class Refused(RuntimeError):
    """A request that the server has refused."""


class RunEnded(ConnectionError):
    """The run is over, and the server with it."""


def data_of(message: Message, key: str = "data") -> bytes:
    """Bytes of a field of octets."""
    value = message[key]
    return base64.b64decode(value) if isinstance(value, str) else bytes(value)


def packet(data: Union[bytes, str], to: str = "") -> Message:
    """A message for a radio. to: a robot, a team, an address; "": all. A text is sent as UTF-8."""
    return {"to": to, "data": base64.b64encode(data.encode() if isinstance(data, str) else data).decode()}


def numbers(values: Sequence[Optional[float]], missing: float = math.nan) -> Any:
    """A list of numbers as an array: of numpy where that is installed, else of the standard library.

    missing: what stands for null, such as the range beyond which a laser sees nothing."""
    whole = [missing if value is None else value for value in values]
    return numpy.asarray(whole, dtype=float) if numpy else array.array("d", whole)


def _plain(value: Any) -> Any:
    """Arrays and numbers of numpy as JSON has them."""
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError("%r cannot be sent: a message holds dicts, lists, numbers, texts" % (value,))


class Reading:
    """The latest message of a topic."""

    def __init__(self, topic: str) -> None:
        self.topic = topic
        self.message: Optional[Message] = None
        self.count = 0
        self._seen = 0

    def fresh(self) -> bool:
        """Whether a message has come since the call before."""
        seen, self._seen = self._seen, self.count
        return self.count > seen

    def value(self, path: str) -> Any:
        """A field of the message: "pose.pose.position.x", "ranges[3]". None as long as there is none."""
        found: Any = self.message
        for key, index in re.findall(r"([A-Za-z_]\w*)|\[(\d+)\]", path):
            if found is None:
                return None
            if index:
                found = found[int(index)] if int(index) < len(found) else None
            elif not isinstance(found, dict) or key not in found:
                raise KeyError("%s has no field '%s'" % (self.topic, path))
            else:
                found = found[key]
        return found


class Step:
    """A control step: simulated time, its number, a 64-bit random word of the program's own."""

    def __init__(self, message: Message) -> None:
        self.program: str = message["program"]
        self.number: int = message["step"]
        self.time_ns: int = message["time"]["sec"] * 10**9 + message["time"]["nanosec"]
        self.random = int(message.get("random", "0"))

    @property
    def time_s(self) -> float:
        return self.time_ns / 1e9

    def bits(self, index: int = 0) -> int:
        """The step's random words: the one that came, then those that SplitMix64 makes from it."""
        if index == 0:
            return self.random
        mask = (1 << 64) - 1
        z = (self.random + index * 0x9E3779B97F4A7C15) & mask
        z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9 & mask
        z = (z ^ (z >> 27)) * 0x94D049BB133111EB & mask
        return z ^ (z >> 31)

    def uniform(self, index: int = 0) -> float:
        """A random number in [0, 1), a multiple of 2^-53: the same in every language, and again in a run with the same seed.

        index: another number for each; the same one again for the same."""
        return (self.bits(index) >> 11) * 2.0**-53


class Call:
    """A service call whose answer may still be on its way."""

    def __init__(self, connection: Connection, service: str, identity: str) -> None:
        self.service = service
        self._connection = connection
        self._id = identity
        self._answer: Optional[Message] = None

    def done(self) -> bool:
        """Whether the answer is there."""
        self._answer = self._answer or self._connection._answers.pop(self._id, None)
        return self._answer is not None

    def result(self, timeout_s: float = 10) -> Message:
        """The answer, waited for if need be. Raises Refused with the server's reason."""
        if not self.done():
            self._answer = self._connection._answer_to(self._id, timeout_s, self.service)
        assert self._answer is not None
        if self._answer.get("op") == "status":
            raise Refused(self._answer["msg"])
        if not self._answer.get("result", False):
            raise Refused(str(self._answer.get("values")))
        values: Message = self._answer["values"]
        return values


class Connection:
    """A connection to a run: topics, services, statuses."""

    def __init__(self, url: Optional[str] = None, timeout_s: float = 10) -> None:
        self.url = url or os.environ.get("SANDLOT_URL") or "tcp://127.0.0.1:8765"
        self._socket = _connect(self.url, timeout_s)
        self._selector = selectors.DefaultSelector()
        self._selector.register(self._socket, selectors.EVENT_READ)
        self._rest = b""
        self._ids = 0
        self._readings: Dict[str, Reading] = {}
        self._handlers: Dict[str, List[Handler]] = {}
        self._answers: Dict[str, Message] = {}
        self._steps: List[Step] = []
        self._closed = False
        self._in_step = False
        self._lost: Optional[ConnectionError] = None
        self.statuses: List[Message] = []

    def __enter__(self) -> Any:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        if not self._closed:
            self._closed = True
            self._selector.close()
            self._socket.close()

    def on_status(self, message: Message) -> None:
        """Called with each refusal that answers no call; prints it unless it is replaced."""
        if message.get("level") in ("info", "none"):
            return
        print("sandlot: %s: %s" % (message.get("level"), message.get("msg")), file=sys.stderr)

    # ------------------------------------------------------------------------------------------------- messages

    def send(self, **message: Any) -> None:
        """Sends an operation of docs/clients.md."""
        self._check_open()
        line = json.dumps(message, separators=(",", ":"), allow_nan=False, default=_plain).encode() + b"\n"
        try:
            self._socket.sendall(line)
        except OSError:
            self._drain()

    def next_id(self) -> str:
        self._ids += 1
        return "py%d" % self._ids

    def poll(self, timeout_s: Optional[float] = 0) -> bool:
        """Takes what has come, waiting for it up to a time (None: for ever). False: nothing came."""
        self._check_open()
        if not self._selector.select(timeout_s):
            return False
        try:
            data = self._socket.recv(1 << 20)
        except OSError:
            data = b""
        if not data:
            self._lose()
        *lines, self._rest = (self._rest + data).split(b"\n")
        for line in lines:
            if line.strip():
                self._take(json.loads(line))
        return True

    def _check_open(self) -> None:
        if self._lost:
            raise self._lost
        if self._closed:
            raise ConnectionError("this connection was closed")

    def _drain(self) -> None:
        """Reads what the server sent before it went, its farewell above all, and raises."""
        while True:
            if not self.poll(1):
                self._lose()

    def _lose(self) -> None:
        """The server's last line is its farewell: of level info when the run has ended, else with what was wrong."""
        last = self.statuses[-1] if self.statuses else {}
        if last.get("level") == "info":
            self._lost = RunEnded("the run has ended: " + last["msg"])
        elif last.get("level") == "error" and not last.get("id"):
            self._lost = ConnectionError("the server has closed the connection: " + last["msg"])
        else:
            self._lost = ConnectionError("the connection to %s broke" % self.url)
        raise self._lost

    def _take(self, message: Message) -> None:
        op = message.get("op")
        if op == "publish":
            reading = self._readings.get(message["topic"])
            if reading:
                reading.message = message["msg"]
                reading.count += 1
            for handler in self._handlers.get(message["topic"], ()):
                handler(message["msg"])
        elif op == "sandlot.tick":
            self._steps.append(Step(message))
        elif op == "status":
            self.statuses = self.statuses[-99:] + [message]
            identity = message.get("id", "")
            if identity.startswith("py"):
                self._answers[identity] = message
            else:
                self.on_status(message)
        elif "id" in message:
            self._answers[message["id"]] = message

    def _answer_to(self, identity: str, timeout_s: float, what: str) -> Message:
        end = time.monotonic() + timeout_s
        while identity not in self._answers:
            left = end - time.monotonic()
            if left <= 0:
                raise TimeoutError("no answer to %s within %g s" % (what, timeout_s))
            self.poll(left)
        return self._answers.pop(identity)

    def wait(self, identity: str, timeout_s: float) -> Message:
        """The answer to a request that was sent with an id of next_id()."""
        answer = self._answer_to(identity, timeout_s, "a request")
        if answer.get("op") == "status":
            raise Refused(answer["msg"])
        return answer

    # --------------------------------------------------------------------------------------------------- topics

    def subscribe_topic(self, topic: str, handler: Optional[Handler] = None, throttle_ms: float = 0) -> Reading:
        """The latest message of a topic: "/rover/laser/ranges". handler: called with each."""
        if handler:
            self._handlers.setdefault(topic, []).append(handler)
        reading = self._readings.setdefault(topic, Reading(topic))
        self.send(op="subscribe", topic=topic, throttle_rate=throttle_ms, id="subscribe:" + topic)
        return reading

    def publish(self, topic: str, message: Message) -> None:
        try:
            self.send(op="publish", topic=topic, msg=message)
        except RunEnded:
            if not self._in_step:  # else the loop over the steps ends
                raise

    def request(self, service: str, args: Optional[Message] = None) -> Call:
        """Calls a service without waiting for its answer."""
        call = Call(self, service, self.next_id())
        self.send(op="call_service", service=service, args=args or {}, id=call._id)
        return call

    def call(self, service: str, args: Optional[Message] = None, timeout_s: float = 10) -> Message:
        """Calls a service and waits for its answer. Raises Refused with the server's reason."""
        return self.request(service, args).result(timeout_s)

    def topics(self) -> Dict[str, str]:
        """Types by topic."""
        found = self.call("/rosapi/topics")
        return dict(zip(found["topics"], found["types"]))

    def services(self) -> List[str]:
        return list(self.call("/rosapi/services")["services"])


class _Driver(Connection):
    """What robots and teams have in common."""

    def __init__(self, kind: str, name: Optional[str], *, url: Optional[str] = None, token: Optional[str] = None,
                 lockstep: Optional[bool] = None, deadline_s: Optional[float] = None, timeout_s: float = 10) -> None:
        # What is not given, a program that Sandlot has started has in its environment.
        name = name or os.environ.get("SANDLOT_" + kind.upper())
        if not name:
            raise ValueError("name the %s, or set SANDLOT_%s" % (kind, kind.upper()))
        if lockstep is None:
            lockstep = os.environ.get("SANDLOT_LOCKSTEP") == "1"
        if deadline_s is None:
            deadline_s = float(os.environ.get("SANDLOT_DEADLINE_S", "1"))
        super().__init__(url, timeout_s)
        self.name = name
        self.lockstep = lockstep
        self.period_s: Optional[float] = None  # of the control steps, once steps() has begun
        self._timeout_s = timeout_s
        self._begun = False
        self._samples: List[str] = []
        self._clock: Optional[Clock] = None
        self._claim = {"token": token or _token_of(self.url) or os.environ.get("SANDLOT_TOKEN", ""),
                       "name": os.path.basename(sys.argv[0]), kind: name}
        try:
            self._robots: List[str] = self._claim_as(mode="free")["robots"]
            self._topics = self.topics()
        except BaseException:
            self.close()
            raise
        self._deadline_ms = 1000 * deadline_s

    def _claim_as(self, **how: Any) -> Message:
        identity = self.next_id()
        self.send(op="sandlot.claim", id=identity, **self._claim, **how)
        return self.wait(identity, self._timeout_s)

    def _topic(self, name: str) -> str:
        """"laser" or "laser/ranges" of a robot as a topic."""
        wanted = "/" + name.strip("/")
        for again in (False, True):
            if again:
                self._topics = self.topics()  # a device may have come
            for topic in self._topics:
                if topic == wanted or topic.startswith(wanted + "/"):
                    return topic
        raise Refused("'%s' publishes nothing; there are: %s" % (name, ", ".join(sorted(self._topics))))

    def _begin(self) -> None:
        """Lockstep begins when everything is subscribed to, so that the first step has its readings."""
        answer = self._claim_as(mode="lockstep", deadline_ms=self._deadline_ms)
        self._begun = True
        self.period_s = answer["programs"][0]["control_period_s"]

    def steps(self) -> Iterator[Step]:
        """The control steps of a program in lockstep, until the run ends. What is commanded within one acts with its end."""
        if not self.lockstep:
            raise Refused("steps() is for lockstep=True; spin() is for others")
        try:
            if not self._begun:
                self._begin()
            while True:
                while not self._steps:
                    self.poll(None)
                step = self._steps.pop(0)
                self._in_step = True
                try:
                    yield step
                finally:  # also of a loop that is left
                    self._in_step = False
                    if not self._closed:
                        samples, self._samples = self._samples, []
                        more = {"samples": samples} if samples else {}
                        self.send(op="sandlot.done", step=step.number, program=step.program, **more)
        except RunEnded:
            return

    def spin(self, seconds: float) -> bool:
        """Takes messages for a while, by the wall clock. False: the run has ended."""
        end = time.monotonic() + seconds
        try:
            while True:
                self.poll(max(0.0, end - time.monotonic()))
                if time.monotonic() >= end:
                    return True
        except RunEnded:
            return False


    @property
    def clock(self) -> Clock:
        """Simulated time and its speed, for programs that run freely; its first use subscribes to the step times."""
        if self._clock is None:
            clock = self._clock = Clock(wait=self.poll)
            self.subscribe_topic("/sandlot/step_times", lambda m: clock.take(
                m["stamp"]["sec"] + m["stamp"]["nanosec"] / 1e9, m["step_s"], m["wall_s"], restarted=m["restarted"]))
        return self._clock


class _Devices:
    """The devices of a robot."""

    name: str
    _driver: _Driver
    _readings_by_name: Dict[str, Reading]

    def subscribe(self, device: str, handler: Optional[Handler] = None) -> Reading:
        """The latest message of a device: "laser", or "eye/objects" of one with several topics. handler: called with each."""
        topic = self._driver._topic(self.name + "/" + device)
        self._readings_by_name[device] = reading = self._driver.subscribe_topic(topic, handler)
        return reading

    def latest(self, device: str) -> Optional[Message]:
        """The latest message of a device; None until one has come. The first call subscribes: make it before steps()."""
        return self._reading(device).message

    def value(self, path: str) -> Any:
        """A field of the latest message: "drive.pose.pose.position.x", "laser/ranges.ranges[3]"."""
        device, _, field = path.partition(".")
        return self._reading(device).value(field)

    def _reading(self, device: str) -> Reading:
        return self._readings_by_name.get(device) or self.subscribe(device)

    def command(self, device: str, message: Message) -> None:
        """A command for a device, at its active level or "drive/ideal"."""
        self._driver.publish("/%s/%s" % (self.name, device), message)

    def sample(self, device: str) -> None:
        """In lockstep: lets a device take a sample although none is due."""
        prefix = "" if isinstance(self._driver, Robot) else self.name + "/"
        self._driver._samples.append(prefix + device)

    def request(self, service: str, args: Optional[Message] = None) -> Call:
        """Calls a service of a device, "odometry/reset", without waiting for its answer: it is done in the next tick."""
        return Connection.request(self._driver, self._service(service), args)

    def call(self, service: str, args: Optional[Message] = None, timeout_s: float = 10) -> Message:
        """Calls a service of a device, "odometry/reset", and waits for its answer. Raises Refused with the server's reason."""
        full = self._service(service)
        if self._driver.lockstep and not full.startswith("/rosapi/"):  # the tick that does it waits for this program
            raise Refused("in lockstep a device answers after the step: use request() and look in a later step")
        return Connection.call(self._driver, full, args, timeout_s)

    def _service(self, service: str) -> str:
        return service if service.startswith("/") else "/%s/%s" % (self.name, service)


class Robot(_Devices, _Driver):
    """The client that drives a robot."""

    def __init__(self, name: Optional[str] = None, **options: Any) -> None:
        self._driver = self
        self._readings_by_name = {}
        super().__init__("robot", name, **options)


class Member(_Devices):
    """A robot of a team."""

    def __init__(self, team: "Team", name: str) -> None:
        self._driver = team
        self._readings_by_name = {}
        self.name = name


class Team(_Driver):
    """The client that drives all robots of a team: team.robots["red1"] has the methods of a Robot."""

    def __init__(self, name: Optional[str] = None, **options: Any) -> None:
        super().__init__("team", name, **options)
        self.robots: Dict[str, Member] = {each: Member(self, each) for each in self._robots}

    def subscribe(self, robot: str, device: str, handler: Optional[Handler] = None) -> Reading:
        return self.subscribe_topic(self._topic(robot + "/" + device), handler)

    def command(self, robot: str, device: str, message: Message) -> None:
        self.publish("/%s/%s" % (robot, device), message)


def _place(url: str) -> Tuple[str, int]:
    """Host and port of an address of TCP. The run's one port takes it whatever the scheme."""
    split = urllib.parse.urlsplit(url)
    try:
        if split.scheme in ("tcp", "http", "ws") and split.hostname and split.port:
            return split.hostname, split.port
    except ValueError:  # a port that is no number
        pass
    raise ValueError("%r is not an address: tcp://HOST:PORT, the address that a run prints, or unix:PATH" % url)


def _token_of(url: str) -> str:
    """The token of the address that a run prints: http://HOST:PORT/?token=..."""
    return urllib.parse.parse_qs(urllib.parse.urlsplit(url).query).get("token", [""])[0]


def _connect(url: str, timeout_s: float) -> socket.socket:
    """Tries for a while: client and run may start in any order."""
    end = time.monotonic() + timeout_s
    place = None if url.startswith("unix:") else _place(url)
    while True:
        try:
            if place is None:
                made = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
                try:
                    made.connect(url[5:])
                except OSError:
                    made.close()
                    raise
            else:
                made = socket.create_connection(place, timeout=timeout_s)
                made.settimeout(None)
                made.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            return made
        except (ConnectionRefusedError, FileNotFoundError) as error:
            if time.monotonic() > end:
                raise ConnectionRefusedError("no run answers at %s: start one with --port" % url) from error
            time.sleep(0.05)
        except OSError as error:
            raise ConnectionError("%s: %s" % (url, error.strerror or error)) from error
