"""engine/docs/equations.md and the @paper tags in the headers agree: each row
names a documented function that carries the tag, and a test that uses it; each
tag has its row."""

import re
import unittest

from source_tree import ROOT, find_files

PAGE = ROOT / "engine/docs/equations.md"
ROW = re.compile(r"^\| ([^|]+) \| `([^`|]+)` \| `([^`|]+)` \| `([^`|]+)` \|$",
                 re.MULTILINE)
# A documentation comment and the declaration after it, up to ; or {.
DOCUMENTED = re.compile(r"/\*\*(.*?)\*/\s*([^;{]*[;{])", re.DOTALL)
TAG = re.compile(r"@paper\{([^}]*)\}")
NAME = re.compile(r"(\w+)\s*\(|(?:class|struct)\s+(\w+)")


def read_rows():
    """(paper, function, header, test) of every row of the table."""
    return [tuple(cell.strip() for cell in row)
            for row in ROW.findall(PAGE.read_text(encoding="utf-8"))]


def find_tags(header):
    """(tag, name of what is documented) in a header."""
    found = []
    text = header.read_text(encoding="utf-8")
    for comment, declaration in DOCUMENTED.findall(text):
        name = NAME.search(declaration)
        for tag in TAG.findall(comment):
            found.append((re.sub(r"\s+", " ", tag),
                          (name.group(1) or name.group(2)) if name else "?"))
    return found


class EquationsTraceTest(unittest.TestCase):
    def test_every_row_names_a_tagged_function(self):
        for paper, function, header, _ in read_rows():
            path = ROOT / header
            self.assertTrue(path.exists(), header)
            *scope, last = function.split("::")
            for name in scope:
                self.assertIn(f"class {name} ", path.read_text(encoding="utf-8"))
            self.assertIn((paper, last), find_tags(path),
                          f"{header} does not tag {last} with "
                          f"@paper{{{paper}}}")

    def test_every_row_names_a_test_that_uses_the_function(self):
        for _, function, _, test in read_rows():
            path = ROOT / test
            self.assertTrue(path.exists(), test)
            self.assertIn(function.split("::")[-1],
                          path.read_text(encoding="utf-8"), test)

    def test_every_tag_has_its_row(self):
        rows = {(paper, header, function.split("::")[-1])
                for paper, function, header, _ in read_rows()}
        for header in find_files(ROOT, ("engine",), {".h"}):
            for tag, name in find_tags(ROOT / header):
                self.assertIn((tag, str(header), name), rows)

    def test_the_table_is_read(self):
        lines = [line for line in PAGE.read_text(encoding="utf-8").splitlines()
                 if line.startswith("| ") and "`" in line]
        self.assertTrue(lines)
        self.assertEqual(len(lines), len(read_rows()))


if __name__ == "__main__":
    unittest.main()
