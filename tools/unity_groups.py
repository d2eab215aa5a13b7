#!/usr/bin/env python3
"""Batches of sources for a unity build: files that the compiler may see as one, since no two of them define the same name.

Reads paths of sources from standard input, separated by newlines; an empty line begins a new list (one per CMake target). Prints
`PATH<tab>NUMBER` for each: files with the same number in a list go into one batch. A pure function of the files' text, so that
every machine builds the same batches.

A name is what stands at the beginning of a line inside an unnamed namespace, a `static`, or a macro; it also keeps a file from
those that include a header of ours with the same name in it. The reading is rough and errs on the side of keeping files apart. A file that must be compiled alone says `unity: alone` in one of its first 15 lines.

Usage: unity_groups.py < paths
"""
import pathlib
import re
import sys

MOST_FILES, MOST_LINES = 12, 3000

BLANK = re.compile(r'R"(?P<d>[^()\\\s]{0,16})\(.*?\)(?P=d)"|//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"', re.DOTALL)
NAMESPACE = re.compile(r"(?:inline )?namespace(?:\s+([\w:]+))?\s*\{")
TYPE = re.compile(r"(?:template\s*<.*>\s*)?(?:struct|class|enum(?:\s+class)?|union)\s+(\w+)")
ALIAS = re.compile(r"using\s+(\w+)\s*=|namespace\s+(\w+)\s*=|using\s+[\w:]*?(\w+);")
VALUE = re.compile(r"[\w:<>,&*\s\[\]().\"']*?[\s&*>](\w+)\s*(?:\(|=|\{|;|\[)")
MACRO = re.compile(r"\s*#\s*define\s+(\w+)")
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
        text = BLANK.sub(lambda m: "\n" * m[0].count("\n") or '""', raw.replace("'{'", "''").replace("'}'", "''"))
        stack = []
        for line in namespaces_closed(text).splitlines():
            if line == "@end":
                stack.pop()
            elif macro := MACRO.match(line):
                self.hidden.add(("#", macro[1]))
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
            self.hidden.add((space, match[1] or match[2] or match[3]))
        elif match := VALUE.match(line):
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
    """The words that the headers of ours behind a file declare."""
    words = set()
    for include in File.of(path).includes:
        header = f"{src}/{include}"
        if header in done or not File.of(header):
            continue
        done.add(header)
        words |= {word for _, word in File.of(header).shown} | declared(header, src, done)
    return words


def groups_of(paths):
    batches = []  # [number, files, lines, hidden names, their words, words declared by headers]
    result, number = [], 0
    for path in paths:
        file = File.of(path)
        words = {word for _, word in file.hidden}
        headers = declared(path, path[: path.index("src/") + 3] if "src/" in path else "src", set()) - words
        for batch in [] if file.alone else batches:
            if (batch[1] < MOST_FILES and batch[2] + file.lines <= MOST_LINES and not batch[3] & file.hidden
                    and not batch[4] & headers and not batch[5] & words):
                break
        else:
            number += 1
            batch = [number, 0, 0, set(), set(), set()]
            if not file.alone:
                batches.append(batch)
        batch[1] += 1
        batch[2] += file.lines
        batch[3] |= file.hidden
        batch[4] |= words
        batch[5] |= headers
        result.append((path, batch[0]))
    return result


def main():
    for part in sys.stdin.read().split("\n\n"):
        for path, number in groups_of([line for line in part.splitlines() if line]):
            print(f"{path}\t{number}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
