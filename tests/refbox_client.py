"""A base station of the middle-size league, from docs/referee_box.md alone: what it is told by a referee box, in both protocols.

    python3 tests/refbox_client.py [HOST:PORT] [json|2009]     prints each word as it comes
"""
import json
import socket
import sys
import time

PORT = 28097
COMMON = {"S": "STOP", "s": "START", "N": "DROP_BALL", "h": "HALF_TIME", "e": "END_GAME", "z": "GAMEOVER", "L": "PARK",
          "1": "FIRST_HALF", "2": "SECOND_HALF", "3": "FIRST_HALF_OVERTIME", "4": "SECOND_HALF_OVERTIME", "Z": "RESET",
          "W": "WELCOME", "V": "TESTMODE_ON", "v": "TESTMODE_OFF"}
OF_TEAM = {"K": "KICKOFF", "F": "FREEKICK", "G": "GOALKICK", "T": "THROWIN", "C": "CORNER", "P": "PENALTY", "A": "GOAL",
           "D": "SUBGOAL", "O": "REPAIR", "I": "REPAIR_END", "Y": "YELLOW_CARD", "B": "DOUBLE_YELLOW", "R": "RED_CARD"}
SET_PIECES = {"KICKOFF", "FREEKICK", "GOALKICK", "THROWIN", "CORNER", "PENALTY", "DROP_BALL"}


class Station:
    """Words are (command, team): "cyan" and "magenta" by the case of a byte; in JSON "own", "other" or "" by the address in
    the welcome."""

    def __init__(self, host="127.0.0.1", port=PORT, protocol="json", timeout=20):
        self.protocol = protocol
        self.own = None
        self.waiting = b""
        self.socket = socket.create_connection((host, port), timeout)
        self.welcome = self.next()

    def next(self, timeout=20):
        """The next word; None: none came in time, or the box is gone."""
        self.socket.settimeout(timeout)
        try:
            while True:
                word = self._take()
                if word:
                    return word
                got = self.socket.recv(4096)
                if not got:
                    return None
                self.waiting += got
        except (socket.timeout, ConnectionError):
            return None

    def until(self, wanted, timeout=20):
        """Words up to one for which wanted(word) holds, with it; [] where it never came."""
        words = []
        end = time.monotonic() + timeout
        while time.monotonic() < end:
            word = self.next(max(0.01, end - time.monotonic()))
            if word is None:
                break
            words.append(word)
            if wanted(word):
                return words
        return []

    def send_world_state(self, **changes):
        state = {"type": "worldstate", "teamName": "test", "intention": "", "ageMs": 0, "robots": [], "balls": [],
                 "obstacles": []}
        state.update(changes)
        self.socket.sendall(json.dumps(state).encode() + b"\0")

    def close(self):
        self.socket.close()

    def _take(self):
        if self.protocol == "2009":
            while self.waiting:
                byte, self.waiting = chr(self.waiting[0]), self.waiting[1:]
                if byte in COMMON:
                    return COMMON[byte], ""
                if byte.upper() in OF_TEAM:
                    return OF_TEAM[byte.upper()], "cyan" if byte.isupper() else "magenta"
                raise ValueError("no command has the byte %r" % byte)
            return None
        message, found, rest = self.waiting.partition(b"\0")
        if not found:
            return None
        self.waiting = rest
        command = json.loads(message.decode("utf-8"))
        target = command["targetTeam"]
        if command["command"].strip() == "WELCOME":
            self.own = target
        return command["command"].strip(), "" if not target else "own" if target == self.own else "other"


if __name__ == "__main__":
    place = sys.argv[1] if len(sys.argv) > 1 else "127.0.0.1:%d" % PORT
    station = Station(place.rpartition(":")[0], int(place.rpartition(":")[2]), (sys.argv[2:] or ["json"])[0])
    said = station.welcome
    while said:
        print("%s %s" % said, flush=True)
        said = station.next(3600)
