#!/usr/bin/env python3
"""docs/what_it_does.md has each row once, says what is missing where something is, and names tests, files, verbs and options that exist."""
import pathlib
import re
import shlex
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
STATES = {"whole", "in part", "not yet"}
ROW = re.compile(r"^\| *([A-Z]\d+) *\|(.*)\|$", re.M)
CODE = re.compile(r"`([^`]+)`")
OUTPUTS = {"--out", "--store", "--summary", "--record", "--svg", "--video"}  # options with a file that the command writes
NAMED = {"list", "validate", "bench", "reproduce", "demo"}  # verbs whose argument is a name in the source


def texts(folder, *patterns):
    return "\n".join(path.read_text() for pattern in patterns for path in sorted(folder.rglob(pattern))
                     if "node_modules" not in path.parts and path.is_file())


class Tree:
    """What the page may name."""

    def __init__(self, root):
        self.root = root
        cpp = texts(root / "src", "*_test.cpp") + texts(root / "tests", "*.cpp")
        self.tests = {f"{suite}.{name}" for suite, name in re.findall(r"^TEST(?:_F|_P)?\((\w+),\s*(\w+)\)", cpp, re.M)}
        self.suites = {name.partition(".")[0] for name in self.tests}
        self.python = set(re.findall(r"def (test_\w+)", texts(root / "tests", "*.py")))
        self.verbs = {path.stem for path in (root / "src/app/verbs").glob("*.cpp")}
        self.options = set(re.findall(r"--[a-z][a-z-]*", texts(root / "src/app", "*.cpp")))
        self.words = set(re.findall(r'"([\w-]+)"', texts(root / "src", "*.cpp", "*.h")))
        self.demos = self.words | {path.stem for path in (root / "scenarios").glob("*.yaml")}


def of_command(words, tree):
    """What is wrong with a command of the program."""
    if len(words) < 2 or words[1] not in tree.verbs:
        return [f"there is no verb '{' '.join(words[:2])}'"]
    verb, wrong = words[1], []
    for before, word in zip(words[1:], words[2:]):
        if word.startswith("--"):
            if word not in tree.options:
                wrong.append(f"there is no option '{word}'")
        elif before in OUTPUTS:
            continue
        elif "/" in word and before not in {"--camera", "--path"}:
            if not (tree.root / word).exists():
                wrong.append(f"there is no file '{word}'")
        elif verb in NAMED and before == verb and word not in (tree.demos if verb == "demo" else tree.words):
            wrong.append(f"'{verb}' knows no '{word}'")
    return wrong


def of_evidence(code, tree):
    if code.startswith("sandlot "):
        return of_command(shlex.split(code), tree)
    if code.startswith("test_"):
        return [] if code in tree.python else [f"there is no test '{code}'"]
    if "/" in code:
        return [] if (tree.root / code).exists() else [f"there is no file '{code}'"]
    if code.endswith(".*"):
        return [] if code[:-2] in tree.suites else [f"there is no suite '{code}'"]
    return [] if code in tree.tests else [f"there is no test '{code}'"]


def mistakes(page, tree):
    found = []
    counts = re.search(r"^Rows: (.*)\.$", page, re.M)
    wanted = [letter + str(n) for letter, count in re.findall(r"([A-Z]) (\d+)", counts[1]) for n in range(1, int(count) + 1)]
    rows = ROW.findall(page)
    if [each for each, _ in rows] != wanted:
        found.append("the rows are not those that the page counts, each once and in order")
    for name, rest in rows:
        cells = [cell.strip() for cell in rest.split("|")]
        if len(cells) != 4:
            found.append(f"{name}: {len(cells) + 1} cells in place of 5")
            continue
        what, state, how, missing = cells
        if state not in STATES:
            found.append(f"{name}: '{state}' is not a state")
        if state != "whole" and not missing:
            found.append(f"{name}: says '{state}', but not what is missing")
        if state != "not yet" and not CODE.search(how):
            found.append(f"{name}: names nothing to see it by")
        found += [f"{name}: {wrong}" for code in CODE.findall(how) for wrong in of_evidence(code, tree)]
    return found


class WhatItDoes(unittest.TestCase):
    def test_rows_and_what_they_name_exist(self):
        self.assertEqual(mistakes((ROOT / "docs/what_it_does.md").read_text(), Tree(ROOT)), [])

    def test_each_mistake_is_found(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for name, text in {"src/a/a_test.cpp": "TEST(Suite, Name) {}\n", "tests/b.py": "def test_b(self):\n",
                               "src/app/verbs/run.cpp": '"--seed"', "src/app/verbs/bench.cpp": '{"swarm", 1}',
                               "scenarios/s.yaml": ""}.items():
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(text)
            tree = Tree(root)

            def of(*rows, counted="A 1"):
                return mistakes(f"Rows: {counted}.\n\n" + "\n".join(rows) + "\n", tree)

            good = "`Suite.Name`, `Suite.*`, `test_b`, `tests/b.py`, `sandlot run scenarios/s.yaml --seed 1`, `sandlot bench swarm`"
            self.assertEqual(of(f"| A1 | x | whole | {good} | |"), [])
            self.assertEqual(of("| A1 | x | not yet | | all |"), [])
            for row in ("| A1 | x | done | `Suite.Name` | y |", "| A1 | x | in part | `Suite.Name` | |", "| A1 | x | whole | | |",
                        "| A1 | x | whole | `Suite.Gone` | |", "| A1 | x | whole | `Gone.*` | |", "| A1 | x | whole | `test_gone` | |",
                        "| A1 | x | whole | `tests/gone.py` | |", "| A1 | x | whole | `sandlot gone` | |",
                        "| A1 | x | whole | `sandlot run scenarios/gone.yaml` | |", "| A1 | x | whole | `sandlot run --gone` | |",
                        "| A1 | x | whole | `sandlot bench gone` | |", "| A1 | x | whole | `Suite.Name` |"):
                self.assertEqual(len(of(row)), 1, row)
            row = "| A1 | x | whole | `Suite.Name` | |"
            self.assertEqual(len(of(row, row)), 1)
            self.assertEqual(len(of(row, counted="A 2")), 1)
            self.assertEqual(len(of(row, counted="A 1, B 1")), 1)


if __name__ == "__main__":
    unittest.main()
