"""Promises of the table of bad input that are not kept yet: all fail."""

import concurrent.futures
import json
import os
import re
import resource
import socket
import subprocess
import time

import pytest
import requests

import meshes
from contract_client import ROOT
from test_bad_command_line import (COMMANDS, HUMBLE, complain, database,
                                   populated, snapshot)
from test_bad_input import (BOX, FACES, MUG, VERTICES, WHOLE, at_once, ball,
                            client, collada, count, doomed, forgotten, gltf,
                            moved, transfer, unchanged, xyz)


def sawn_off():
    """A mug without its handle, open where that was."""
    lines = (MUG / "classic.obj").read_text().splitlines()
    ranges = json.loads((MUG / "classic.labels.json").read_text())["faces"]
    faces = [line for line in lines if line.startswith("f ")]
    return "\n".join(
        [line for line in lines if line.startswith("v ")] +
        [faces[i] for a, b in ranges["body"] for i in range(a, b)]).encode()


# ---- The answer is not the promised one --------------------------------------


def test_a_mug_without_a_handle_gets_grasps_for_its_body(client, forgotten):
    answer = transfer(client, 200, category="mug", body=sawn_off())
    assert any("handle" in warning for warning in answer["warnings"])
    assert {grasp["part"] for grasp in answer["grasps"]} == {"body"}


@pytest.mark.parametrize("index", [8, 30000, 65535])
def test_an_index_out_of_range_in_gltf_is_a_422(client, unchanged, index):
    client.call("postObject", 422, query={"format": "gltf"},
                body=gltf(VERTICES, FACES[:-1] + [(1, 7, index)]))


def test_a_dae_needs_no_units(client, forgotten):
    body = collada("", "")
    problem = transfer(client, 422, category="mug", format="dae", body=body)
    assert problem["code"] == "not_in_category"
    problem = client.call("postExample", 422, path={"name": "mug"}, body=body,
                          query={"format": "dae", "learn": "false"},
                          headers={"Prefer": "wait=60"})
    assert problem["code"] == "not_in_category"


def test_off_is_a_word_in_the_contract(client):
    schema = client.spec["components"]["parameters"]["Format"]["schema"]
    assert "off" in schema["enum"]
    served = client.session.get(client.base_url + "/openapi.json").json()
    assert "off" in served["components"]["schemas"]["Object"]["properties"][
        "format"]["enum"]


def test_an_object_of_off_fits_the_contract(client):
    stored = requests.post(client.base_url + "/v1/objects?format=off",
                           data=WHOLE["off"]).json()
    requests.delete(f"{client.base_url}/v1/objects/{stored['id']}")
    client.validate(stored, {"$ref": "#/components/schemas/Object"})


@pytest.mark.parametrize("mesh_format,name", [
    ("obj", "OBJ"), ("stl", "STL"), ("gltf", "glTF"), ("xyz", "XYZ")])
def test_an_empty_file_is_a_422_naming_the_format(
        client, unchanged, mesh_format, name):
    problem = client.call("postObject", 422, query={"format": mesh_format},
                          files={"mesh": ("a", b"")})
    assert name in problem["detail"]


@pytest.mark.parametrize("operation,query", [
    ("listGraspSpaces", {"category": "mug", "part": "lid"}),
    ("listGraspSpaces", {"part": "lid"}), ("queryGrasps", {"part": "lid"})])
def test_an_unknown_part_is_a_404_with_the_known_ones(
        client, world, operation, query):
    assert "handle" in client.call(operation, 404, query=query)["hint"]


@pytest.mark.parametrize("operation", [
    "listCategories", "listObjects", "listHands", "listJobs"])
def test_a_cursor_that_no_page_gave_is_a_400(client, world, operation):
    problem = client.call(operation, 400, query={"cursor": "' OR 1=1 --"})
    assert problem["field"] == "cursor"


def test_points_said_twice_are_not_more_points(client, unchanged):
    client.call("postObject", 422, query={"format": "xyz"},
                body=xyz(list(ball(100)) * 3))


@pytest.mark.parametrize("value", ["nan", "inf"])
def test_a_point_that_is_not_finite_is_a_422(client, unchanged, value):
    client.call("postObject", 422, query={"format": "xyz"},
                body=xyz(list(ball(300)) + [(value, 0, 0)]))


# ---- What is stored is not what was sent -------------------------------------


@pytest.mark.parametrize("distance", [1e4, 1e5])
def test_a_mesh_far_from_its_origin_is_kept_exactly_or_refused(
        client, forgotten, distance):
    content = meshes.obj(moved(VERTICES, (distance, 0, 0)), FACES)
    answer = client.call("postObject", (201, 422), body=content)
    if client.last.status_code == 201:
        box = answer["bounding_box"]
        assert box["max"][0] - box["min"][0] == pytest.approx(
            VERTICES[1][0], rel=1e-3)


# ---- One request changes the answer to another -------------------------------


def test_the_same_request_gives_the_same_warnings(client, world, forgotten):
    warnings = []
    for seed, parts in ((41, ("body", None)), (42, (None, "body"))):
        answers = {part: transfer(
            client, 200, category="mug", seed=seed, body=world["novel_bytes"],
            **({"part": part} if part else {})) for part in parts}
        warnings.append((answers[None]["warnings"],
                         answers["body"]["warnings"]))
    assert warnings[0] == warnings[1]
    assert warnings[0] == (["nothing is learned for the handle"], [])


def test_of_many_that_send_one_mesh_one_made_the_object(client, forgotten):
    content = meshes.box_obj(0.0311, 0.0422, 0.0533)
    statuses = at_once(lambda _: requests.post(
        f"{client.base_url}/v1/objects", data=content).status_code)
    assert sorted(statuses) == [200] * 15 + [201]


@pytest.mark.parametrize("same", [False, True], ids=["other", "same"])
def test_of_many_at_once_under_one_key_one_has_an_effect(client, same):
    url = client.base_url + "/v1/categories"
    for n in range(30):
        replies = at_once(lambda i: requests.post(
            url, headers={"Idempotency-Key": f"race-{same}-{n}"},
            json={"name": f"raced-{n}-{0 if same else i}",
                  "parts": [{"label": "a"}]}))
        made = {r.json()["name"] for r in replies if r.status_code == 201}
        for name in made:
            client.call("deleteCategory", 204, path={"name": name})
        assert len(made) == 1
        if same:  # A retry gets the first answer again.
            assert {r.status_code for r in replies} == {201}


# ---- Deleting below a job is no failure of the disk --------------------------


def end_of(client, job):
    while job["state"] not in ("succeeded", "failed", "cancelled"):
        time.sleep(0.05)
        job = client.call("getJob", 200, path={"id": job["id"]})
    return job


def check_honest(job):
    if job["state"] == "failed":
        assert job["error"]["code"] in ("not_found", "conflict", "cancelled")
        assert "FOREIGN KEY" not in job["error"]["detail"]


def test_an_object_deleted_while_it_is_transferred_to(
        client, world, forgotten):
    stored = client.call("postObject", (200, 201), body=world["novel_bytes"],
                         query={"category": "mug"})
    job = client.call("postGrasps", 202, headers={"Prefer": "respond-async"},
                      query={"object": stored["id"], "part": "body",
                             "sources": 20, "seed": 51})
    time.sleep(0.3)
    client.call("deleteObject", 204, path={"id": stored["id"]})
    check_honest(end_of(client, job))


def test_whoever_waits_for_it_gets_no_5xx(client, world, forgotten):
    stored = client.call("postObject", (200, 201), body=world["novel_bytes"],
                         query={"category": "mug"})
    with concurrent.futures.ThreadPoolExecutor() as pool:
        waiting = pool.submit(requests.post, f"{client.base_url}/v1/grasps",
                              params={"object": stored["id"], "part": "body",
                                      "sources": 20, "seed": 52})
        time.sleep(0.3)
        client.call("deleteObject", 204, path={"id": stored["id"]})
        reply = waiting.result(60)
    assert reply.status_code < 500, reply.text


def test_an_example_deleted_while_it_is_transferred_from(
        client, world, doomed):
    job = client.call("postGrasps", 202, headers={"Prefer": "respond-async"},
                      query={"object": doomed["novel"], "part": "body",
                             "sources": 20, "seed": 53})
    time.sleep(0.3)
    client.call("deleteObject", 204, path={"id": doomed["example"]},
                query={"cascade": "true"})
    check_honest(end_of(client, job))


# ---- The command line --------------------------------------------------------


def test_a_taken_port_makes_no_database(binary, tmp_path):
    with socket.create_server(("127.0.0.1", 0)) as owner:
        port = str(owner.getsockname()[1])
        subprocess.run([binary, "serve", "--db", tmp_path / "a.db", "--port",
                        port], capture_output=True, timeout=60)
    assert list(tmp_path.iterdir()) == []


def test_a_taken_port_is_one_line(binary, database):
    with socket.create_server(("127.0.0.1", 0)) as owner:
        port = str(owner.getsockname()[1])
        complain(binary, ["serve", "--db", database, "--port", port],
                 hint=False)


@pytest.mark.parametrize("command", ["serve", "segment"])
def test_a_database_that_may_not_be_written_is_one_line(
        binary, database, tmp_path, command):
    os.chmod(database, 0o444)
    before = snapshot(tmp_path)
    mesh = ROOT / "data" / "mug" / "square.obj"
    words = [str(mesh) if word.endswith("latte.obj") else word
             for word in COMMANDS[command]]
    complain(binary, [*words, "--db", database], prefix=HUMBLE,
             hint=False)
    assert snapshot(tmp_path) == before


def test_a_file_that_fails_while_it_is_read_is_no_bug(binary, database):
    complain(binary, ["segment", "/proc/self/mem", "--category", "mug",
                      "--db", database])


@pytest.mark.parametrize("kind", ["endless", "sparse"])
def test_a_file_over_the_limit_is_not_read_past_it(
        binary, database, tmp_path, kind):
    path = "/dev/zero"
    if kind == "sparse":
        path = tmp_path / "sparse.obj"
        path.touch()
        os.truncate(path, 8 << 30)
    result = subprocess.run(
        [binary, "segment", path, "--category", "mug", "--db", database],
        capture_output=True, text=True, timeout=60, preexec_fn=lambda:
        resource.setrlimit(resource.RLIMIT_AS, (2 << 30, 2 << 30)))
    assert result.returncode == 2
    assert re.fullmatch(r"graspdb: .*67108864.*\n", result.stderr), (
        result.stderr)


def test_output_that_cannot_be_written_is_said(binary, database):
    with open("/dev/full", "wb") as full:
        result = subprocess.run([binary, "query", "--db", database],
                                stdout=full, stderr=subprocess.PIPE, timeout=60)
    assert result.returncode == 2
    assert result.stderr.startswith(b"graspdb: ")


def test_standard_input_that_is_no_mesh_is_one_line(
        binary, database, tmp_path):
    before = snapshot(tmp_path)
    complain(binary, ["segment", "-", "--category", "mug", "--db", database],
             stdin=b"hello\n")
    assert snapshot(tmp_path) == before
