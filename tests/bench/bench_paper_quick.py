"""`graspdb bench paper` on one category, eight grasps a part: every table is
filled, and what was done before is read and not done again."""

import json
import pathlib
import subprocess
import sys
import tempfile


def run(binary, data, out):
    subprocess.run(
        [binary, "bench", "paper", "--quick", "--category", "mug", "--sources", "4",
         "--seeding-seconds", "2", "--data", data, "--out", out],
        check=True,
    )
    return json.loads(pathlib.Path(out, "paper.json").read_text())


def main():
    binary, data = sys.argv[1:]
    with tempfile.TemporaryDirectory() as out:
        first = run(binary, data, out)
        rows = pathlib.Path(out, "rows")
        written = {path: path.stat().st_mtime_ns for path in rows.iterdir()}
        again = run(binary, data, out)
        # Seconds of what was done once are read, too.
        assert first == again, "a second run tells something else"
        for path, changed in written.items():
            assert path.stat().st_mtime_ns == changed, f"{path} was made twice"
        html = pathlib.Path(out, "paper.html").read_text()

    variant = first["variants"][0]
    parts = {row["part"] for row in variant["rows"]}
    assert parts == {"body", "handle"}, parts
    for row in variant["rows"]:
        assert row["attempted"] == 4, row
        assert row["transferred"] >= row["assembled"], row
        judged = row["physical"]["six_pushes"]["count"]
        assert judged == row["assembled"], row
        assert row["physical"]["lift"]["count"] == judged, row
    for row in variant["learning"]:
        assert row["grasps"] >= 40 and row["curve"], row
    seeded = {(row["part"], row["seeding"]): row["tried"] for row in variant["seeding"]}
    assert len(seeded) == 2 * 3, seeded
    # Learning the support vectors may take all the time on a slow machine.
    assert all(n for (_, how), n in seeded.items() if how != "support vectors"), seeded
    assert html.count("<svg") == 2 + 2 + 4 * 2, html.count("<svg")
    assert "1343.6" not in html and ">1344<" in html, "Table I is not beside ours"


if __name__ == "__main__":
    main()
