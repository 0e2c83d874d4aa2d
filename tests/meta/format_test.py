"""Every C++ file is as clang-format 14 would write it."""

import shutil
import subprocess
import unittest

from source_tree import ROOT, find_files


class FormatTest(unittest.TestCase):
    def test_clang_format_changes_nothing(self):
        program = shutil.which("clang-format-14") or shutil.which("clang-format")
        self.assertIsNotNone(program, "clang-format 14 is not installed")
        files = find_files(ROOT, ("engine", "server", "clients", "tests"),
                           {".h", ".cc"})
        self.assertTrue(files)
        result = subprocess.run(
            [program, "--dry-run", "--Werror", *map(str, files)], cwd=ROOT,
            capture_output=True, text=True, check=False)
        unformatted = sorted({line.split(":")[0]
                              for line in result.stderr.splitlines()
                              if "error:" in line})
        self.assertEqual(unformatted, [])
        self.assertEqual(result.returncode, 0, result.stderr)


if __name__ == "__main__":
    unittest.main()
