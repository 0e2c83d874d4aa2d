"""Shell scripts parse, stop at the first error and can be run."""

import os
import re
import subprocess
import unittest

from source_tree import ROOT, SKIPPED, find_files


def find_scripts():
    found = []
    for folder, folders, names in os.walk(ROOT):
        folders[:] = sorted(set(folders) - SKIPPED)
        for name in sorted(names):
            path = os.path.join(folder, name)
            with open(path, "rb") as file:
                if re.match(rb"#!.*\b(ba)?sh\b", file.readline(80)):
                    found.append(path)
    return found


class ScriptsTest(unittest.TestCase):
    def test_scripts_parse(self):
        scripts = find_scripts()
        self.assertTrue(scripts)
        for path in scripts:
            result = subprocess.run(["bash", "-n", path], capture_output=True,
                                    text=True, check=False)
            self.assertEqual(result.returncode, 0, result.stderr)

    def test_scripts_stop_at_the_first_error(self):
        for path in find_scripts():
            with open(path, encoding="utf-8") as file:
                self.assertRegex(file.read(), r"(?m)^set -eu?", path)

    def test_scripts_are_executable(self):
        for path in find_scripts():
            self.assertTrue(os.access(path, os.X_OK), path)

    def test_nothing_is_left_undone(self):
        marks = re.compile(r"\b(%s)\b" % "|".join(("TO" + "DO", "FIX" + "ME")))
        for path in find_files(ROOT, ("engine", "server", "tests"),
                               {".h", ".cc", ".py"}):
            text = (ROOT / path).read_text(encoding="utf-8")
            self.assertIsNone(marks.search(text), path)


if __name__ == "__main__":
    unittest.main()
