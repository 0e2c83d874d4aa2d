"""What the tests read is in the repository: git ignores none of it."""

import subprocess
import unittest

from source_tree import ROOT

FOLDERS = ("data", "docker", "engine", "schema", "server", "tests")


class IgnoredFilesTest(unittest.TestCase):
    def test_git_ignores_nothing_but_caches(self):
        if not (ROOT / ".git").exists():
            self.skipTest("not a git checkout: there is nothing to ignore")
        listed = subprocess.run(
            ["git", "-c", "safe.directory=*", "ls-files", "--others", "--ignored",
             "--exclude-standard", "--", *FOLDERS],
            cwd=ROOT, capture_output=True, text=True, check=True).stdout.splitlines()
        made = {"__pycache__", ".hypothesis", "node_modules"}
        ignored = [path for path in listed if made.isdisjoint(path.split("/"))]
        self.assertEqual(ignored, [])


if __name__ == "__main__":
    unittest.main()
