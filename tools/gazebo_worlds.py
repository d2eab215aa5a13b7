#!/usr/bin/env python3
"""Runs every world of a folder for 1000 ticks and prints what came of it as a markdown page.

Usage: gazebo_worlds.py SANDLOT FOLDER   (the command; gz-sim/examples/worlds)

docs/gazebo_worlds.md is its output for Gazebo's public examples. A world needs downloads when it names a file that is
neither there nor in the search path: then the run ends with code 2, and the page says which.
"""
import pathlib, re, subprocess, sys

TICKS = 1000
HEAD = """# Gazebo's example worlds

Made by `tools/gazebo_worlds.py build/release/sandlot gz-sim/examples/worlds` from the worlds of
[gz-sim](https://github.com/gazebosim/gz-sim/tree/93bbf3ed1bd25df32709fee40d6935bf36d2bac8/examples/worlds) (commit
93bbf3ed1bd25df32709fee40d6935bf36d2bac8), as they are. "runs" means: loaded, and stepped {ticks} ticks of the world's own step
with exit code 0. Warnings are what the user sees; equal ones count once.
"""


def step_of(text):
    found = re.search(r"<max_step_size>\s*([0-9.eE+-]+)\s*</max_step_size>", text)
    return float(found.group(1)) if found else 0.01


def run(command, world):
    text = world.read_text(errors="replace")
    duration = f"{TICKS * step_of(text):.9g}"
    try:
        done = subprocess.run([command, "run", world.name, "--duration", duration], cwd=world.parent, text=True,
                              capture_output=True, timeout=600)
    except subprocess.TimeoutExpired:
        return {"world": world.stem, "code": "time", "warnings": 0, "said": "not done in 600 s"}
    lines = done.stderr.splitlines()
    warnings = [line for line in lines if line.startswith("warning: ")]
    errors = [line for line in lines if line.startswith("error: ")]
    said = (errors or warnings or [""])[0].split(": ", 1)[-1]
    return {"world": world.stem, "code": done.returncode, "warnings": len(warnings), "said": said}


def table(rows, first):
    print(f"| World | Result | Warnings | {first} |\n| --- | --- | --- | --- |")
    for row in rows:
        result = "runs" if row["code"] == 0 else f"exit {row['code']}"
        said = row["said"].replace("|", "\\|")
        print(f"| {row['world']} | {result} | {row['warnings']} | {said} |")


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    command = str(pathlib.Path(sys.argv[1]).resolve())
    rows = [run(command, world) for world in sorted(pathlib.Path(sys.argv[2]).glob("*.sdf"))]
    far = [row for row in rows if row["code"] == 2 and "downloaded" in row["said"]]
    near = [row for row in rows if row not in far]
    good = sum(row["code"] == 0 for row in near)
    print(HEAD.format(ticks=TICKS))
    print(f"## Worlds that stand alone: {good} of {len(near)} run\n")
    table(near, "First line skipped, or the error")
    print(f"\n## Worlds that need downloads: {len(far)}\n")
    print("Nothing is downloaded by itself: fetch what the line names, put it in the place that the line names, or "
          "leave it out with `--skip-missing`.\n")
    table(far, "What is missing first")


if __name__ == "__main__":
    main()
