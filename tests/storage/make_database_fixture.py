#!/usr/bin/env python3
"""Makes a small database that holds some of everything, by a release's server.

    make_database_fixture.py GRASPDB DATA FILE

GRASPDB and DATA are that release's program and data folder. first_release.db is
of commit d50c5ed (schema 1); later releases are to open it with all it holds.
"""

import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

import requests

TESTS = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(TESTS / "contract"))

from live_server import LiveServer  # noqa: E402
import meshes  # noqa: E402

FEW = {
    "active_learning": {"seed_samples": 300, "rounds": 1,
                        "queries_per_round": 50, "test_samples": 50},
    "swarm": {"particles": 40, "iterations": 15, "target_grasps": 6},
}


def box(x, y, z):
    vertices, faces = meshes.grid_box(x, y, z, 4)
    return meshes.obj(vertices, faces), len(faces)


def fill(url):
    def post(path, **request):
        answer = requests.post(url + path, timeout=300, **request)
        assert answer.ok, answer.text
        return answer.json()

    post("/v1/categories", headers={"Idempotency-Key": "category"}, json={
        "name": "box", "title": "Boxes",
        "parts": [{"label": "body", "tasks": {"use": "hold it"}}]})
    example, num_faces = box(0.06, 0.07, 0.12)
    labels = json.dumps({"labels": ["body"], "faces": {"body": [[0, num_faces]]}})
    known = post("/v1/categories/box/examples?learn=false&name=example",
                 headers={"Prefer": "wait=100"},
                 files={"mesh": ("a.obj", example), "labels": ("a.json", labels)})
    post(f"/v1/objects/{known['id']}/grasp-spaces", json={"parameters": FEW},
         headers={"Prefer": "wait=300"})
    novel, _ = box(0.065, 0.066, 0.125)
    answer = post("/v1/grasps?category=box&sources=6", data=novel,
                  headers={"Idempotency-Key": "grasps", "Prefer": "wait=300"})
    print(json.dumps(answer, indent=1))


def main(binary, data, out):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "hands").symlink_to(pathlib.Path(data).resolve() / "hands")
        database = folder / "a.db"
        subprocess.run([binary, "populate", name, "--db", database, "--no-learn"],
                       check=True)
        server = LiveServer(binary, database, folder)
        try:
            fill(server.url)
        finally:
            assert server.stop() == 0, server.log()
        shutil.copyfile(database, out)


if __name__ == "__main__":
    main(*sys.argv[1:])
