#!/usr/bin/env python3
"""Batches of sources for a unity build: files that the compiler may see as one, since no two of them define the same name.

Reads paths of sources from standard input, separated by newlines; an empty line begins a new list (one per CMake target). Prints
`PATH<tab>NUMBER` for each: files with the same number in a list go into one batch. A pure function of the files' text, so that
every machine builds the same batches.

A name is what stands at the beginning of a line inside an unnamed namespace, a `static`, or a macro that stays defined; it also keeps a file from
those that include a header of ours with the same name in it. What `using a::b;` and `using b = a::c;` name may be named so by others,
and be in headers: it is the same thing. Overloads that are found by the type of their argument (OVERLOADED) are no such names. The
reading is rough and errs on the side of keeping files apart. A file that must be compiled alone says `unity: alone` in one of its
first 15 lines.

Usage: unity_groups.py < paths
"""
import math
import pathlib
import re
import sys

# A batch of the upper layers takes 4 to 8 s for what its files include, however short they are: long ones, but not so long that a
# single one holds up the rest (the longest takes 45 s and 1.8 GB).
MOST_FILES, MOST_LINES = 50, 6100

BLANK = re.compile(r'R"(?P<d>[^()\\\s]{0,16})\(.*?\)(?P=d)"|//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"', re.DOTALL)
NAMESPACE = re.compile(r"(?:inline )?namespace(?:\s+([\w:]+))?\s*\{")
TYPE = re.compile(r"(?:template\s*<.*>\s*)?(?:struct|class|enum(?:\s+class)?|union)\s+(\w+)")
ALIAS = re.compile(r"(?:using|namespace)\s+(\w+)\s*=\s*([\w:]*)|using\s+(?:::)?((?:\w+::)*)(\w+);")
VALUE = re.compile(r"[\w:<>,&*\s\[\]().\"']*?[\s&*>](\w+)\s*(?:\(|=|\{|;|\[)")
MACRO = re.compile(r"\s*#\s*(define|undef)\s+(\w+)")
# Found by the type of their argument: where two files have them for one type, its own name keeps them apart.
OVERLOADED = {"enum_names", "PrintTo"}
TEST = re.compile(r"(?:TYPED_)?TEST(?:_[FP])?\(|INSTANTIATE_")


def namespaces_closed(text):
    """The text with each namespace's end marked, found by counting braces."""
    out, depth, opened = [], 0, []
    for line in text.splitlines():
        if NAMESPACE.match(line) and "}" not in line:
            opened.append(depth)
        depth += line.count("{") - line.count("}")
        if opened and depth == opened[-1]:
            opened.pop()
            line = "@end"
        out.append(line)
    return "\n".join(out)


class File:
    """What matters of one file: its own names by namespace, the plain words of them, includes, length."""

    cache = {}

    def __init__(self, path):
        raw = pathlib.Path(path).read_text(encoding="utf-8", errors="replace")
        head = raw.splitlines()[:15]
        self.alone = any("unity: alone" in line for line in head)
        self.lines = raw.count("\n")
        self.includes = re.findall(r'^#include "([^"]+)"', raw, re.MULTILINE)
        self.hidden, self.shown = set(), set()  # names that only this file sees; names that a header declares
        self.opened = re.findall(r"^\s*using namespace ([\w:]+);", raw, re.MULTILINE)
        self.used = {}  # of the hidden names those of `using a::b;`, `using b = a::c;`, with what they stand for
        text = BLANK.sub(lambda m: "\n" * m[0].count("\n") or '""', raw.replace("'{'", "''").replace("'}'", "''"))
        stack = []
        for line in namespaces_closed(text).splitlines():
            if line == "@end":
                stack.pop()
            elif macro := MACRO.match(line):
                (self.hidden.add if macro[1] == "define" else self.hidden.discard)(("#", macro[2]))
            elif (space := NAMESPACE.match(line)) and "}" not in line:
                stack.append(space[1] or "")
            elif line and not line[0].isspace() and line[0] not in "#)}@" and not TEST.match(line) \
                    and not line.startswith("using namespace"):
                self.name(line, "::".join(s for s in stack if s), "" in stack)

    def name(self, line, space, unnamed):
        if match := TYPE.match(line):
            if "{" in line or not line.rstrip().endswith(";"):
                (self.hidden if unnamed else self.shown).add((space, match[1]))
        elif match := ALIAS.match(line):
            name = (space, match[1] or match[4])
            self.hidden.add(name)
            if match[4] or match[2] and line[match.end():].strip() == ";":
                self.used[name] = match[2] or match[3] + match[4]
        elif match := VALUE.match(line):
            if match[1] in OVERLOADED:
                return
            names = self.hidden if unnamed or line.startswith("static ") else self.shown
            names.add((space, match[1]))
            if match[0][-1] in "={":  # constexpr double g = 9.81, h = 0.001;
                names.update((space, word) for word in re.findall(r",\s*(\w+)\s*=(?!=)", line))

    @classmethod
    def of(cls, path):
        if path not in cls.cache:
            try:
                cls.cache[path] = cls(path)
            except OSError:
                cls.cache[path] = None
        return cls.cache[path]


def declared(path, src, done):
    """The names that the headers of ours behind a file declare: spaces by word."""
    names = {}
    for include in File.of(path).includes:
        header = f"{src}/{include}"
        if header in done or not File.of(header):
            continue
        done.add(header)
        for space, word in File.of(header).shown:
            names.setdefault(word, set()).add(space)
        for word, spaces in declared(header, src, done).items():
            names.setdefault(word, set()).update(spaces)
    return names


class Batch:
    """Files of one number."""

    def __init__(self, number):
        self.number, self.files, self.lines = number, 0, 0
        self.hidden, self.headers = {}, {}  # hidden names with what they stand for; spaces by word

    def takes(self, file, hidden, headers):
        return (self.files < MOST_FILES and (not self.files or self.lines + file.lines <= 1.25 * MOST_LINES)
                and all(name not in self.hidden or self.hidden[name] == meant != "" for name, meant in hidden.items())
                and not hides(self.hidden, headers) and not hides(hidden, self.headers))

    def add(self, file, hidden, headers):
        self.files += 1
        self.lines += file.lines
        self.hidden.update(hidden)
        for word, spaces in headers.items():
            self.headers.setdefault(word, set()).update(spaces)


def hides(hidden, headers):
    """Whether one of the hidden names takes the place of something else that a header declares in its namespace or around it."""
    return any(around(seen, space) and not (meant and f"::{other}::{word}".endswith(f"::{meant}"))
               for (space, word), meant in hidden.items() for seen, other in headers.get(word, ()))


def around(outer, inner):
    return not outer or inner == "#" or f"{inner}::".startswith(f"{outer}::")


def groups_of(paths):
    """Batches of about the same length, as few as MOST_LINES allows; more only where names ask for it."""
    total = sum(file.lines for file in map(File.of, paths) if not file.alone)
    share = total / max(1, math.ceil(total / MOST_LINES))
    batches, result, number = [], [], 0
    for path in paths:
        file = File.of(path)
        hidden = {name: file.used.get(name, "") for name in sorted(file.hidden)}
        words = {word for _, word in hidden}
        behind = declared(path, path[: path.index("src/") + 3] if "src/" in path else "src", set())
        # Where names are seen, and where they are from. What `using namespace` opens counts as seen everywhere.
        opened = tuple(f"::{name}" for name in file.opened)
        headers = {word: {("" if f"::{space}".endswith(opened) else space, space) for space in spaces}
                   for word, spaces in behind.items() if word not in words}
        fitting = [] if file.alone else [batch for batch in batches if batch.takes(file, hidden, headers)]
        # The first that has not its share yet: neighbours include the same headers. Then the shortest.
        batch = next((b for b in fitting if b.lines + file.lines / 2 < share), None)
        if not batch and fitting and sum(b.lines > share / 2 for b in batches) * share >= total - 1:
            batch = min(fitting, key=lambda b: b.lines)
        if not batch:
            number += 1
            batch = Batch(number)
            if not file.alone:
                batches.append(batch)
        batch.add(file, hidden, headers)
        result.append((path, batch.number))
    return result


def main():
    for part in sys.stdin.read().split("\n\n"):
        for path, number in groups_of([line for line in part.splitlines() if line]):
            print(f"{path}\t{number}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
