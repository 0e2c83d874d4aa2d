"""Counts the instructions of a fixed workload under callgrind and fails when they
are more than a tenth above the record. Time is a matter of the machine; this is not.

A change that needs more, or much less, writes the record anew in the same commit,
with the reason: instruction_gate.py WORKLOAD RECORD --write"""

import json
import pathlib
import re
import subprocess
import sys
import tempfile

TOLERANCE = 0.10
FUNCTIONS = ("WorkOnGrasps", "WorkOnPostures")


def count(workload, function):
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder, "callgrind.out")
        subprocess.run(
            ["valgrind", "--tool=callgrind", f"--callgrind-out-file={out}",
             f"--toggle-collect=graspdb::bench::{function}(*", workload],
            check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        return int(re.search(r"^(?:summary|totals): (\d+)", out.read_text(), re.M)[1])


def main():
    workload, record_path = sys.argv[1], pathlib.Path(sys.argv[2])
    counts = {function: count(workload, function) for function in FUNCTIONS}
    if sys.argv[3:] == ["--write"]:
        record_path.write_text(json.dumps(counts, indent=1) + "\n")
        return 0
    record = json.loads(record_path.read_text())
    failed = False
    for function, recorded in record.items():
        ratio = counts[function] / recorded
        verdict = "too many" if ratio > 1 + TOLERANCE else "ok"
        if ratio < 1 - TOLERANCE:
            verdict = "fewer: record it"
        print(f"{function}: {counts[function]:,} instructions, {ratio:.3f} of the record, {verdict}")
        failed = failed or ratio > 1 + TOLERANCE
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
