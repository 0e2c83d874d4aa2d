"""The files of this repository and what they include, for the meta tests."""

import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[2]
SKIPPED = {"build", ".git", ".cache", "node_modules", "dist", "__pycache__"}
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)


def find_files(root, folders, suffixes):
    """Paths below root in the given folders ("." for all), in order."""
    found = []
    for folder in folders:
        for path in sorted((root / folder).rglob("*")):
            relative = path.relative_to(root)
            if path.suffix in suffixes and path.is_file() and not any(
                    part in SKIPPED for part in relative.parts[:-1]):
                found.append(relative)
    return found


def find_includes(path):
    """(bracket, name) of every #include of a file, bracket being < or "."""
    return INCLUDE.findall(path.read_text(encoding="utf-8"))
