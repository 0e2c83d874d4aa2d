"""What the prose names exists: links, headings and paths in code spans."""

import re
import unittest

from source_tree import ROOT, find_files

LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
HEADING = re.compile(r"^#+\s+(.+?)\s*$", re.MULTILINE)
SOURCE_PATH = re.compile(
    r"`((?:engine|server|schema|clients|data|tests|docker|\.ci)/[\w./-]*)`")
CODE_BLOCK = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)


def make_anchor(heading):
    """The fragment under which GitHub and GitLab show a heading."""
    words = re.sub(r"[^\w\- ]", "", heading.replace("`", "").lower())
    return words.strip().replace(" ", "-")


def find_broken(page):
    """What a page names and does not exist."""
    text = CODE_BLOCK.sub("", page.read_text(encoding="utf-8"))
    broken = []
    for target in LINK.findall(text):
        if re.match(r"[a-z]+:", target):
            continue
        name, _, anchor = target.partition("#")
        path = (page.parent / name) if name else page
        if not path.exists():
            broken.append(f"{page.relative_to(ROOT)}: {target}")
        elif anchor and path.suffix == ".md":
            headings = HEADING.findall(path.read_text(encoding="utf-8"))
            if anchor not in map(make_anchor, headings):
                broken.append(f"{page.relative_to(ROOT)}: #{anchor}")
    for path in SOURCE_PATH.findall(text):
        if not (ROOT / path).exists():
            broken.append(f"{page.relative_to(ROOT)}: {path}")
    return broken


class LinksTest(unittest.TestCase):
    def test_everything_named_exists(self):
        pages = find_files(ROOT, (".",), {".md"})
        self.assertTrue(pages)
        self.assertEqual([b for p in pages for b in find_broken(ROOT / p)], [])

    def test_anchors_are_made_as_readers_expect(self):
        self.assertEqual(make_anchor("Five minutes: a tour"),
                         "five-minutes-a-tour")
        self.assertEqual(make_anchor("`POST /v1/grasps`"), "post-v1grasps")


if __name__ == "__main__":
    unittest.main()
