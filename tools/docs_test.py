#!/usr/bin/env python3
"""Checks the pages: every relative link leads to a file, every anchor to a heading, every function that a page links to its
source file by [`name`](path) stands in that file, and so does every block of code that begins with ```cpp from=path."""
import pathlib
import re
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
LINK = re.compile(r"!?\[([^\]]*)\]\(([^)\s]+)\)")
QUOTE = re.compile(r"^```\w+ from=(\S+)\n(.*?)^```", re.M | re.S)
SKIPPED = {"build", "node_modules", ".git"}


def pages(root):
    for path in sorted(root.rglob("*.md")):
        if not SKIPPED & set(path.relative_to(root).parts):
            yield path


def prose(text):
    """The page without fenced blocks: brackets in code are not links."""
    return re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)


def anchors(text):
    """Anchors of a page's headings, by GitHub's rule."""
    return {re.sub(r"[^\w\- ]", "", heading.lower().strip()).replace(" ", "-")
            for heading in re.findall(r"^#+ (.*)$", text, flags=re.M)}


def mistakes(root):
    found = []
    for page in pages(root):
        for words, target in LINK.findall(prose(page.read_text())):
            if re.match(r"[a-z]+:", target):
                continue
            name, _, anchor = target.partition("#")
            path = page.parent / name if name else page
            if not path.exists():
                found.append(f"{page.relative_to(root)}: '{target}' leads nowhere")
                continue
            if anchor and path.suffix == ".md" and anchor not in anchors(path.read_text()):
                found.append(f"{page.relative_to(root)}: '{target}' names no heading")
            code = re.fullmatch(r"`([\w:]+)`", words)
            if code and path.suffix in {".h", ".cpp"}:
                if not re.search(rf"\b{re.escape(code[1].split('::')[-1])}\b", path.read_text()):
                    found.append(f"{page.relative_to(root)}: '{code[1]}' is not in {name}")
        for name, code in QUOTE.findall(page.read_text()):
            source = root / name
            if not source.exists() or code not in source.read_text():
                found.append(f"{page.relative_to(root)}: this is not in {name}:\n{code}")
    return found


def unlisted(root):
    """Pages of docs/ that the index does not lead to."""
    docs = root / "docs"
    text = (docs / "index.md").read_text()
    linked = {(docs / target.partition("#")[0]).resolve() for _, target in LINK.findall(text)}
    return [str(page.relative_to(root)) for page in pages(docs)
            if page.name != "index.md" and page.resolve() not in linked]


class Docs(unittest.TestCase):
    def test_links_lead_somewhere_and_functions_are_where_the_pages_say(self):
        self.assertEqual(mistakes(ROOT), [])

    def test_the_index_leads_to_every_page(self):
        self.assertEqual(unlisted(ROOT), [])

    def test_each_mistake_is_found(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            (root / "code.cpp").write_text("void here() {}\n")
            (root / "good.md").write_text("# A heading\n[`here`](code.cpp), [x](#a-heading), [y](https://a.b/c)\n"
                                          "```\n[in](code)\n```\n```cpp from=code.cpp\nvoid here() {}\n```\n")
            self.assertEqual(mistakes(root), [])
            (root / "bad.md").write_text("[a](gone.md) [b](good.md#nothing) [`away`](code.cpp) ![c](gone.png)\n"
                                         "```cpp from=code.cpp\nvoid there() {}\n```\n")
            self.assertEqual(len(mistakes(root)), 5)


if __name__ == "__main__":
    unittest.main()
