#!/usr/bin/env python3
"""Lists the sources of a compile database, or compiles those of the program and its fuzz targets alone, as far as syntax and types go.

Usage: compile_commands.py BUILD --list
       compile_commands.py BUILD --syntax JOBS [N/OF]  exits 1 and prints what the compiler says of those that fail;
                                                    warnings and tests are left out (`./dev test debug` compiles tests
                                                    alone). N/OF: each OF-th source from the N-th on, counted from 0
"""
import concurrent.futures
import json
import pathlib
import shlex
import subprocess
import sys


def check(entry):
    """What the compiler says of one source, without writing anything."""
    words = [w for w in shlex.split(entry["command"]) if not w.endswith("ccache") and w != "-c"]
    at = words.index("-o")
    done = subprocess.run(words[:at] + words[at + 2:] + ["-fsyntax-only", "-w"], cwd=entry["directory"], capture_output=True,
                          text=True, check=False)
    return entry["file"], done.returncode, done.stderr


def main():
    build = pathlib.Path(sys.argv[1])
    entries = json.loads((build / "compile_commands.json").read_text())
    if sys.argv[2] == "--list":
        print("\n".join(entry["file"] for entry in entries))
        return 0
    entries = [entry for entry in entries if ("/src/" in entry["file"] or "/fuzz/" in entry["file"]) and not entry["file"].endswith("_test.cpp")]
    if len(sys.argv) > 4:
        first, of = (int(number) for number in sys.argv[4].split("/"))
        entries = entries[first::of]
    failed = 0
    with concurrent.futures.ThreadPoolExecutor(int(sys.argv[3])) as pool:
        for file, code, said in pool.map(check, entries):
            if code:
                failed += 1
                print(f"{file} does not compile alone:\n{said}")
    print(f"alone: {len(entries)} sources, {failed} problems" if failed else f"alone: {len(entries)} sources, all well")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
