#!/usr/bin/env python3
"""Writes the tables of functions into docs/robios.md, from robios/src/costs.def and the two headers.

Usage: make_robios_table.py [--check]      --check: changes nothing, exits 1 if the page is not up to date
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
BEGIN, END = "<!-- functions -->", "<!-- end of functions -->"
ROW = re.compile(r'^ROBIOS_(GROUP|COST)\((.*)\)$', re.M)


def functions(generation: int) -> "set[str]":
    header = (ROOT / f"robios/include/robios{generation}/eyebot.h").read_text()
    names = set(re.findall(r"^[A-Za-z][A-Za-z ]*[ *]+([A-Z]+[A-Za-z0-9]*)\(", header, re.M))
    return {"RADIOCheck" if name.startswith("RADIOCheck") else name for name in names}


def cost(microseconds: str) -> str:
    value = float(microseconds)
    return f"{value / 1000:g} ms" if value >= 1000 else f"{value:g} us"


def table() -> str:
    text = (ROOT / "robios/src/costs.def").read_text()
    in_6, in_7 = functions(6), functions(7)
    lines: "list[str]" = []
    for kind, body in ROW.findall(text):
        if body in ("title", "function, cost in microseconds of virtual time, what it does here"):
            continue
        if kind == "GROUP":
            title = body.strip('"')
            lines += ["", f"### {title}", "", "| function | RoBIOS | cost | here |", "|---|---|---|---|"]
            continue
        name, microseconds, rest = body.split(", ", 2)
        generations = [g for g, names in (("6", in_6), ("7", in_7)) if name in names]
        lines.append(f"| `{name}` | {' '.join(generations) or '6 7'} | {cost(microseconds)} | "
                     + rest[1:-1].replace('\\"', '"').replace("|", "\\|") + " |")
    return "\n".join(lines).strip() + "\n"


def main() -> int:
    page = ROOT / "docs/robios.md"
    text = page.read_text()
    begin, end = text.index(BEGIN) + len(BEGIN), text.index(END)
    wanted = text[:begin] + "\n" + table() + text[end:]
    if "--check" in sys.argv[1:]:
        if text != wanted:
            print("docs/robios.md is not up to date: run tools/make_robios_table.py", file=sys.stderr)
        return int(text != wanted)
    page.write_text(wanted)
    return 0


if __name__ == "__main__":
    sys.exit(main())
