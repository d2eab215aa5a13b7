"""Drives robots of a Sandlot run from Python: standard library only.

    from sandlot_client import Robot

    with Robot("rover", lockstep=True) as rover:
        laser = rover.subscribe("laser")
        for step in rover.steps():
            near = laser.message and min(laser.message["ranges"]) < 0.5
            rover.command("drive", {"linear": {"x": 0.0 if near else 0.3}, "angular": {"z": 1.0 if near else 0.0}})

Protocol   rosbridge v2 as JSON over TCP, with claims and lockstep of Sandlot's own: docs/clients.md.
Messages   dicts with the field names of ROS 2; lists of numbers are lists; lists of bytes are base64 text, see data_of().
Address    SANDLOT_URL or tcp://127.0.0.1:8765; unix:PATH reaches a run from inside a sandbox.
Token      SANDLOT_TOKEN.
Started    by Sandlot, a program has all of these in its environment, and who it is, too: Robot(), Team() without a name.
Errors     Refused: the server's own words. ConnectionError: it is gone.
Threads    none: messages are taken while steps(), spin() or call() wait.
"""

from __future__ import annotations

import base64
import json
import os
import selectors
import socket
import sys
import time
from typing import Any, Callable, Dict, Iterator, List, Optional

__all__ = ["Connection", "Reading", "Refused", "Robot", "Step", "Team", "data_of", "packet"]

Message = Dict[str, Any]


class Refused(RuntimeError):
    """A request that the server has refused."""


def data_of(message: Message, key: str = "data") -> bytes:
    """Bytes of a field of octets."""
    value = message[key]
    return base64.b64decode(value) if isinstance(value, str) else bytes(value)


def packet(data: bytes, to: str = "") -> Message:
    """A message for a radio. to: a robot, a team, an address; "": all."""
    return {"to": to, "data": base64.b64encode(data).decode()}


class Reading:
    """The latest message of a topic."""

    def __init__(self, topic: str) -> None:
        self.topic = topic
        self.message: Optional[Message] = None
        self.count = 0
        self._seen = 0

    def fresh(self) -> bool:
        """Whether a message has come since it was last asked."""
        seen, self._seen = self._seen, self.count
        return self.count > seen


class Step:
    """A control step: simulated time, its number, a random number of the program's own."""

    def __init__(self, message: Message) -> None:
        self.program: str = message["program"]
        self.number: int = message["step"]
        self.time_ns: int = message["time"]["sec"] * 10**9 + message["time"]["nanosec"]
        self.random = int(message.get("random", "0"))

    @property
    def time_s(self) -> float:
        return self.time_ns / 1e9


class Connection:
    """A connection to a run: topics, services, statuses."""

    def __init__(self, url: Optional[str] = None, timeout_s: float = 10) -> None:
        url = url or os.environ.get("SANDLOT_URL") or "tcp://127.0.0.1:8765"
        self._socket = _connect(url, timeout_s)
        self._selector = selectors.DefaultSelector()
        self._selector.register(self._socket, selectors.EVENT_READ)
        self._rest = b""
        self._ids = 0
        self._readings: Dict[str, Reading] = {}
        self._handlers: Dict[str, List[Callable[[Message], None]]] = {}
        self._answers: Dict[str, Message] = {}
        self._steps: List[Step] = []
        self._closed = False
        self.statuses: List[Message] = []

    def __enter__(self):
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
        self._socket.sendall(json.dumps(message, separators=(",", ":"), allow_nan=False).encode() + b"\n")

    def next_id(self) -> str:
        self._ids += 1
        return "py%d" % self._ids

    def poll(self, timeout_s: Optional[float] = 0) -> bool:
        """Takes what has come, waiting for it up to a time (None: for ever). False: nothing came."""
        if not self._selector.select(timeout_s):
            return False
        data = self._socket.recv(1 << 20)
        if not data:
            raise ConnectionError("the server has closed the connection" + self._last_word())
        *lines, self._rest = (self._rest + data).split(b"\n")
        for line in lines:
            if line.strip():
                self._take(json.loads(line))
        return True

    def _last_word(self) -> str:
        return ": " + self.statuses[-1]["msg"] if self.statuses else ""

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
            if message.get("id"):
                self._answers[message["id"]] = message
            else:
                self.on_status(message)
        elif "id" in message:
            self._answers[message["id"]] = message

    def wait(self, identity: str, timeout_s: float) -> Message:
        """The answer to a request."""
        end = time.monotonic() + timeout_s
        while identity not in self._answers:
            left = end - time.monotonic()
            if left <= 0:
                raise TimeoutError("no answer within %g s" % timeout_s)
            self.poll(left)
        answer = self._answers.pop(identity)
        if answer.get("op") == "status":
            raise Refused(answer["msg"])
        return answer

    # --------------------------------------------------------------------------------------------------- topics

    def subscribe_topic(self, topic: str, handler: Optional[Callable[[Message], None]] = None,
                        throttle_ms: float = 0) -> Reading:
        """The latest message of a topic: "/rover/laser/ranges". handler: called with each."""
        if handler:
            self._handlers.setdefault(topic, []).append(handler)
        reading = self._readings.setdefault(topic, Reading(topic))
        self.send(op="subscribe", topic=topic, throttle_rate=throttle_ms, id="subscribe:" + topic)
        return reading

    def publish(self, topic: str, message: Message) -> None:
        self.send(op="publish", topic=topic, msg=message)

    def call(self, service: str, args: Optional[Message] = None, timeout_s: float = 10) -> Message:
        """Calls a service. Raises Refused with the server's reason."""
        identity = self.next_id()
        self.send(op="call_service", service=service, args=args or {}, id=identity)
        answer = self.wait(identity, timeout_s)
        if not answer.get("result", False):
            raise Refused(str(answer.get("values")))
        return answer["values"]

    def topics(self) -> Dict[str, str]:
        """Types by topic."""
        found = self.call("/rosapi/topics")
        return dict(zip(found["topics"], found["types"]))


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
        try:
            identity = self.next_id()
            self.send(op="sandlot.claim", id=identity, token=token or os.environ.get("SANDLOT_TOKEN", ""),
                      mode="free", **{kind: name})
            self.wait(identity, timeout_s)
            self._topics = self.topics()
        except BaseException:
            self.close()
            raise
        self._claim = dict(token=token or os.environ.get("SANDLOT_TOKEN", ""), mode="lockstep",
                           deadline_ms=1000 * deadline_s, **{kind: name})
        self._timeout_s = timeout_s
        self._begun = False
        self.period_s: Optional[float] = None

    def _topic(self, name: str) -> str:
        """"laser" or "laser/ranges" of a robot as a topic."""
        wanted = "/" + name.strip("/")
        for topic in self._topics:
            if topic == wanted or topic.startswith(wanted + "/"):
                return topic
        raise Refused("'%s' publishes nothing; there are: %s" % (name, ", ".join(sorted(self._topics))))

    def _begin(self) -> None:
        """Lockstep begins when everything is subscribed to, so that the first step has its readings."""
        self._begun = True
        identity = self.next_id()
        self.send(op="sandlot.claim", id=identity, **self._claim)
        answer = self.wait(identity, self._timeout_s)
        self.period_s = answer["programs"][0]["control_period_s"]

    def steps(self) -> Iterator[Step]:
        """The control steps of a program in lockstep. What is commanded within one acts with its end."""
        if not self.lockstep:
            raise Refused("steps() is for lockstep=True; spin() is for others")
        if not self._begun:
            self._begin()
        while True:
            while not self._steps:
                try:
                    self.poll(None)
                except ConnectionError:
                    return  # the run has ended
            step = self._steps.pop(0)
            yield step
            try:
                self.send(op="sandlot.done", step=step.number, program=step.program)
            except OSError:
                return

    def spin(self, seconds: float) -> None:
        """Takes messages for a while, by the wall clock."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            self.poll(left)


class Robot(_Driver):
    """The client that drives a robot."""

    def __init__(self, name: Optional[str] = None, **options: Any) -> None:
        super().__init__("robot", name, **options)

    def subscribe(self, device: str, handler: Optional[Callable[[Message], None]] = None) -> Reading:
        """The latest message of a device: "laser", or "laser/ranges" of one with several levels."""
        return self.subscribe_topic(self._topic(self.name + "/" + device), handler)

    def command(self, device: str, message: Message) -> None:
        """A command for a device, at its active level or "drive/ideal"."""
        self.publish("/%s/%s" % (self.name, device), message)


class Team(_Driver):
    """The client that drives all robots of a team."""

    def __init__(self, name: Optional[str] = None, **options: Any) -> None:
        super().__init__("team", name, **options)

    def subscribe(self, robot: str, device: str,
                  handler: Optional[Callable[[Message], None]] = None) -> Reading:
        return self.subscribe_topic(self._topic(robot + "/" + device), handler)

    def command(self, robot: str, device: str, message: Message) -> None:
        self.publish("/%s/%s" % (robot, device), message)


def _connect(url: str, timeout_s: float) -> socket.socket:
    """Tries for a while: client and run may start in any order."""
    end = time.monotonic() + timeout_s
    while True:
        try:
            if url.startswith("unix:"):
                made = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
                made.connect(url[5:])
            elif url.startswith("tcp://"):
                host, _, port = url[6:].rstrip("/").rpartition(":")
                made = socket.create_connection((host.strip("[]"), int(port)), timeout=timeout_s)
                made.settimeout(None)
                made.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            else:
                raise ValueError("%r is no address: tcp://HOST:PORT or unix:PATH" % url)
            return made
        except (ConnectionRefusedError, FileNotFoundError):
            if time.monotonic() > end:
                raise
            time.sleep(0.05)
