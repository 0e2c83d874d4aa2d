"""Writes the built web viewer as a C++ source that defines WebViewerFiles().

usage: embed_viewer.py DIST OUTPUT.cc
"""

import pathlib
import sys

TYPES = {
    ".css": "text/css; charset=utf-8",
    ".html": "text/html; charset=utf-8",
    ".ico": "image/x-icon",
    ".js": "text/javascript; charset=utf-8",
    ".json": "application/json",
    ".png": "image/png",
    ".svg": "image/svg+xml",
    ".txt": "text/plain; charset=utf-8",
    ".woff2": "font/woff2",
}
PLAIN = set(range(0x20, 0x7F)) - set(b'"\\?')


def literal(data: bytes) -> str:
    """String literals that the compiler joins; each a line of the source."""
    lines = []
    for start in range(0, len(data), 4000):
        piece = data[start:start + 4000]
        lines.append('"' + "".join(
            chr(b) if b in PLAIN else f"\\{b:03o}" for b in piece) + '"')
    return "\n        ".join(lines) or '""'


def main() -> None:
    dist, output = sys.argv[1:]
    entries = []
    for path in sorted(pathlib.Path(dist).rglob("*")):
        if not path.is_file():
            continue
        name = path.relative_to(dist).as_posix()
        data = path.read_bytes()
        address = "/" if name == "index.html" else "/" + name
        immutable = "true" if name.startswith("assets/") else "false"
        entries.append(
            f'    {{"{address}", "{TYPES[path.suffix]}",\n'
            f"     std::string_view({literal(data)},\n"
            f"                      {len(data)}),\n"
            f"     {immutable}}},\n")
    with open(output, "w", encoding="utf-8") as file:
        file.write(
            '#include "server/ui/web_viewer.h"\n\n'
            "namespace graspdb {\nnamespace {\n\n"
            "constexpr ViewerFile kFiles[] = {\n" + "".join(entries) +
            "};\n\n}  // namespace\n\n"
            "std::span<const ViewerFile> WebViewerFiles() { return kFiles; }\n\n"
            "}  // namespace graspdb\n")


main()
