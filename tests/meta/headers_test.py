"""Each header can be included alone and twice. Headers without a source of
their own are compiled by CMakeLists.txt beside this file."""

import unittest

from source_tree import ROOT, find_files, find_includes

LISTS_OF_VALUES = ("records.h",)


class HeadersTest(unittest.TestCase):
    def test_a_source_includes_its_own_header_first(self):
        for path in find_files(ROOT, ("engine", "server"), {".cc"}):
            header = path.with_suffix(".h")
            if (ROOT / header).exists():
                self.assertEqual(find_includes(ROOT / path)[0],
                                 ('"', str(header)), path)

    def test_a_header_is_read_once(self):
        for path in find_files(ROOT, ("engine", "server", "tests"), {".h"}):
            text = (ROOT / path).read_text(encoding="utf-8")
            self.assertTrue(text.startswith("#pragma once\n"), path)

    def test_headers_are_short(self):
        for path in find_files(ROOT, ("engine", "server"), {".h"}):
            text = (ROOT / path).read_text(encoding="utf-8")
            limit = 400 if path.name in LISTS_OF_VALUES else 300
            self.assertLessEqual(text.count("\n"), limit, path)


if __name__ == "__main__":
    unittest.main()
