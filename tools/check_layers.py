#!/usr/bin/env python3
"""The architecture test: reads src/layers.txt and every file in src/, prints each breach, exits 1 if there is one.

Checked: includes between layers, between sibling folders of a `peers` layer, and of third-party headers; what would
make two runs differ (libm, unseeded randomness, wall clocks); the length of files, of those of the page (web/src), too. A *_test.cpp may include from any
layer. A line that has to break a rule about calls says why in a comment `lint-ok: reason`.

Usage: check_layers.py [SRC]      SRC defaults to the src/ beside this script's folder
"""
import pathlib
import re
import sys

HEADER_LINES, SOURCE_LINES = 300, 600

LIBM = ("sin cos tan asin acos atan atan2 sinh cosh tanh asinh acosh atanh exp exp2 expm1 log log2 log10 log1p "
        "pow cbrt hypot fmod fma remainder erf erfc tgamma lgamma sincos").split()
NAMES = "|".join(name + suffix for name in LIBM for suffix in ("", "f", "l"))

# what is banned, why, and the files (prefixes relative to src/) where it is at home
BANS = [
    # after std:: or :: or bare; a member (x.cos()) or another namespace (math::cos()) is something else
    (re.compile(rf"(?:\bstd\s*::\s*|(?<![\w.:>~])(?:::\s*)?)(?:{NAMES})\s*\("),
     "differs between machines: use math:: from base/math.h", ["base/math"]),
    (re.compile(rf"\busing\s+(?:namespace\s+math\b|(?:std|math)\s*::\s*(?:{NAMES})\s*;)"),
     "hides which mathematics is called: write math::", ["base/math"]),
    (re.compile(r"(?<![\w.:>])(?:std\s*::\s*|::\s*)?(?:s?rand|[dl]rand48)\s*\(|\bstd\s*::\s*(?:random_device|mt19937(?:_64)?|"
                r"default_random_engine|minstd_rand0?|\w+_distribution|shuffle|random_shuffle)\b"),
     "is not reproducible: draw from a stream of base/random.h", ["base/random"]),
    (re.compile(r"_clock\s*::\s*now\s*\(|\b(?:gettimeofday|clock_gettime)\s*\(|\bstd\s*::\s*time\s*\("),
     "reads a wall clock: simulation time comes with the tick",
     ["app/", "bench/", "server/", "sim/session/", "sim/world/phase_timer", "run/repeat", "base/log"]),
]

COMMENT_OR_LITERAL = re.compile(
    r'//[^\n]*|/\*.*?\*/|R"(?P<d>[^()\\\s]{0,16})\(.*?\)(?P=d)"|"(?:\\.|[^"\\\n])*"|(?<![0-9a-fA-F])\'(?:\\.|[^\'\\\n])*\'',
    re.DOTALL)
INCLUDE = re.compile(r'\s*#\s*include\s*(["<])([^">]+)[">]')
# <vector>, <cmath>: a standard header has neither a folder nor an extension. These C ones we use too.
STANDARD = re.compile(r"\w+|(?:stddef|stdint|stdio|string|inttypes)\.h")


class Rules:
    """layers.txt. Paths are prefixes relative to src/: `physics/rigid` holds for physics/rigid/ and physics/rigid.h."""

    def __init__(self, text):
        self.layers, self.peers, self.third_party = {}, set(), []
        for line in text.splitlines():
            line = line.split("#")[0].strip()
            if not line:
                continue
            if line.startswith("third-party "):
                name, prefixes, folders = (part.split() for part in line.split("|"))
                self.third_party.append((name[1], prefixes, folders))
            else:
                name, _, rest = line.partition(":")
                if name == "peers":
                    self.peers |= set(rest.split())
                else:
                    self.layers[name] = set(self.layers) if rest.split() == ["*"] else set(rest.split())

    def first_party(self, here, there):
        """Why the file with path parts `here` may not include `there`; None when it may."""
        if here[0] not in self.layers:
            return f"{here[0]} is not a layer of layers.txt"
        if there[0] != here[0] and there[0] not in self.layers[here[0]]:
            return f"{here[0]} must not include {there[0]}"
        for depth in range(1, min(len(here), len(there)) - 1):
            if here[:depth] != there[:depth]:
                break
            if here[depth] != there[depth] and "/".join(here[:depth]) in self.peers:
                return f"{'/'.join(here[:depth + 1])} must not include its sibling {'/'.join(there[:depth + 1])}"
        return None

    def third(self, here, header):
        if STANDARD.fullmatch(header):
            return None
        for name, prefixes, folders in self.third_party:
            if any(header.startswith(p) for p in prefixes):
                return None if any(f == "*" or under(here, f) for f in folders) else f"{name} belongs to {' '.join(folders)}"
        return "no third-party line of layers.txt lists this header"


def under(path, prefix):
    return path.startswith(prefix) and (prefix[-1] == "/" or path[len(prefix):][:1] in ("/", ".", "_"))


def without_comments_and_literals(text):
    return COMMENT_OR_LITERAL.sub(lambda m: "\n" * m[0].count("\n") or " ", text)


def problems_in(path, text, rules):
    """Yields (line, message) for the file at `path`, relative to src/ with forward slashes."""
    lines = text.splitlines()
    is_test = path.endswith("_test.cpp") or pathlib.PurePath(path).name.startswith("test_")
    for n, line in enumerate(lines, 1):
        include = INCLUDE.match(line)
        if not include or is_test:
            continue
        bracket, header = include.groups()
        if bracket == "<":
            why = rules.third(path, header)
        elif "/" in header:
            why = rules.first_party(path.split("/"), header.split("/"))
        else:
            why = "an include of ours names its layer: \"layer/file.h\""
        if why:
            yield n, f"#include {header}: {why}"
    for n, line in enumerate(without_comments_and_literals(text).splitlines(), 1):
        for pattern, why, homes in BANS:
            found = pattern.search(line)
            if found and not any(path.startswith(home) for home in homes) and "lint-ok:" not in lines[n - 1]:
                yield n, f"{found[0].rstrip('( ')} {why}"
    yield from too_long(lines, HEADER_LINES if path.endswith(".h") else SOURCE_LINES)


def too_long(lines, limit):
    if len(lines) > limit and "long file:" not in "\n".join(lines[:15]):
        yield len(lines), f"over {limit} lines: split it by concept, or give the reason at its top as `long file: ...`"


def main():
    src = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent / "src"
    rules = Rules((src / "layers.txt").read_text())
    files = [f for f in sorted(src.rglob("*")) if f.suffix in {".h", ".cpp", ".inc"}]
    found = 0
    for f in files:
        for line, message in problems_in(f.relative_to(src).as_posix(), f.read_text(), rules):
            print(f"{f}:{line}: {message}")
            found += 1
    page = sorted((src.parent / "web" / "src").rglob("*.ts"))
    for f in page:
        for line, message in too_long(f.read_text().splitlines(), SOURCE_LINES):
            print(f"{f}:{line}: {message}")
            found += 1
    files += page
    print(f"check_layers: {len(files)} files, {found} problems" if found else f"check_layers: {len(files)} files, all well")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
