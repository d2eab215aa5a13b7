#!/usr/bin/env python3
"""Runs the tutorials as a reader would: files from fenced blocks that carry a name, commands from blocks marked `sh` (with `exit=N` where
they fail), and the lines quoted in `text` blocks, which the commands above must have printed in that order (`...` stands for anything).

SANDLOT_BIN is the built command; its folder is what is installed for the tutorial that builds a plugin. Arguments: pages to run, all by default."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import sandbox

ROOT = pathlib.Path(__file__).resolve().parent.parent
BLOCK = re.compile(r"^```(\w+) ?([^\n]*)\n(.*?)^```$", re.M | re.S)


def steps(text):
    """(kind, value, content) of each fenced block: ('file', name, text), ('sh', exit code, script), ('text', None, lines)."""
    for language, rest, content in BLOCK.findall(text):
        if language == "sh":
            code = re.fullmatch(r"exit=(\d+)", rest)
            yield "sh", int(code[1]) if code else 0, content
        elif language == "text":
            yield "text", None, content
        elif rest:
            yield "file", rest, content
        else:
            raise SystemExit(f"a block of {language} has no name")


def missing_line(quoted, printed):
    """The first quoted line that was not printed behind the ones before it, or None."""
    lines = printed.splitlines()
    at = 0
    for wanted in filter(None, map(str.strip, quoted.splitlines())):
        pattern = ".*".join(re.sub(r"\\?\s+|(?:\\ )+", r"\\s+", re.escape(part.strip()))
                            for part in wanted.split("..."))
        found = next((i for i in range(at, len(lines)) if re.search(pattern, lines[i])), None)
        if found is None:
            return wanted
        at = found + 1
    return None


def run_page(page, folder, environment):
    """Follows one page in `folder`. Returns what went wrong, or None."""
    printed = ""
    for kind, value, content in steps(page.read_text()):
        if kind == "file":
            (folder / value).write_text(content)
        elif kind == "sh":
            if "cmake" in content:
                install(environment)
            done = subprocess.run(["bash", "-euc", content], cwd=folder, env=environment, text=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=240)
            printed = done.stdout
            if done.returncode != value:
                return f"exit code {done.returncode} instead of {value}:\n{content}\n{printed}"
        elif (wanted := missing_line(content, printed)) is not None:
            return f"'{wanted}' was not printed, but\n{printed}"
    return None


def install(environment):
    """Installs the build into ~/sandlot of the reader."""
    prefix = pathlib.Path(environment["HOME"]) / "sandlot"
    if not prefix.exists():
        subprocess.run(["cmake", "--install", environment["BUILD"], "--prefix", prefix], check=True,
                       stdout=subprocess.DEVNULL)
        # The plugin must come from the same build as the command that loads it.
        environment["PATH"] = f"{prefix}/bin:{environment['PATH']}"


def check_the_test_itself():
    quoted = "drove ... m\nstate  ...\n"
    assert missing_line(quoted, "x drove 3 m\nstate 12\n") is None
    assert missing_line(quoted, "state 12\nx drove 3 m\n") == "state  ..."
    assert missing_line("a.b\n", "axb\n") == "a.b"


def main():
    check_the_test_itself()
    command = pathlib.Path(os.environ["SANDLOT_BIN"]).resolve()
    pages = [pathlib.Path(page) for page in sys.argv[1:]] or sorted((ROOT / "docs/tutorials").glob("*.md"))
    failed = 0
    with tempfile.TemporaryDirectory(prefix="tutorials") as scratch:
        home = pathlib.Path(scratch)
        home.chmod(0o755)  # programs that a run starts are not root, and read their folder
        environment = {**os.environ, "HOME": scratch, "BUILD": str(command.parent),
                       "PATH": f"{home}/bin:{os.environ['PATH']}"}
        (home / "bin").mkdir()
        (home / "bin/sandlot").symlink_to(command)
        room = next(content for kind, name, content in steps((ROOT / "docs/tutorials/1_first_robot.md").read_text())
                    if name == "room.sdf")
        first = next(content for kind, name, content in steps((ROOT / "docs/tutorials/1_first_robot.md").read_text())
                     if name == "first.yaml")
        for page in pages:
            if page.stem.startswith("7_") and sandbox.why_none():
                print(f"{page.name}: left out: {sandbox.why_none()}", flush=True)
                continue
            folder = home / page.stem
            folder.mkdir()
            if not page.stem.startswith("1_"):  # "copy room.sdf from the first tutorial", "go on in its folder"
                (folder / "room.sdf").write_text(room)
            if page.stem.startswith("3_"):
                (folder / "first.yaml").write_text(first)
            if page.stem.startswith("7_"):  # "copy the folder examples/robios"
                shutil.copytree(ROOT / "examples/robios", folder / "robios")
            wrong = run_page(page, folder, environment)
            print(f"{page.name}: {'ok' if wrong is None else wrong}", flush=True)
            failed += wrong is not None
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
