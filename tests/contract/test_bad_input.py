"""What bad input gets: an answer that says why, and nothing stored or lost."""

import base64
import collections
import concurrent.futures
import json
import math
import re
import socket
import struct
import threading
import time

import numpy
import pytest
import requests

import meshes
from conftest import QUICK
from contract_client import ROOT, Contract, operations, patient, resolve
from live_server import LiveServer

UNKNOWN_UUID = "01890000-0000-7000-8000-000000000000"
UNKNOWN_HASH = "0" * 32
SIDES = (0.031, 0.042, 0.053)
VOLUME = SIDES[0] * SIDES[1] * SIDES[2]
VERTICES = meshes.box_vertices(*SIDES)
FACES = meshes.BOX_FACES
BOX = meshes.obj(VERTICES, FACES)
MUG = ROOT / "data" / "mug"


@pytest.fixture(scope="module")
def client(server, world):
    """A client of its own: what it calls counts for no other test."""
    return Contract(server.url)


def count(client):
    counts = client.call("getReadiness", 200)["counts"]
    counts.pop("jobs_unfinished")
    return counts


@pytest.fixture
def unchanged(client):
    """The test stores and loses nothing, and the server goes on serving."""
    before = count(client)
    yield
    assert count(client) == before
    assert client.call("getHealth", 200)["status"] == "ok"


@pytest.fixture
def forgotten(client):
    """What the test stores beside a world of others is deleted again."""
    def ids():
        return {item["id"] for item in client.call(
            "listObjects", 200, query={"limit": 1000})["items"]}
    before = ids()
    yield
    for object_id in ids() - before:
        client.call("deleteObject", 204, path={"id": object_id})


def at_once(work, workers=16):
    with concurrent.futures.ThreadPoolExecutor(workers) as pool:
        return list(pool.map(work, range(workers)))


def moved(vertices, offset):
    return [tuple(a + b for a, b in zip(v, offset)) for v in vertices]


def scaled(vertices, scale):
    return [tuple(scale * x for x in v) for v in vertices]


def joined(*pairs):
    vertices, faces = [], []
    for more_vertices, more_faces in pairs:
        faces += [tuple(i + len(vertices) for i in f) for f in more_faces]
        vertices = vertices + more_vertices
    return meshes.obj(vertices, faces)


def off(vertices, faces):
    lines = ["OFF", f"{len(vertices)} {len(faces)} 0"]
    lines += [f"{x} {y} {z}" for x, y, z in vertices]
    lines += ["3 " + " ".join(map(str, f)) for f in faces]
    return ("\n".join(lines) + "\n").encode()


def ply(vertices, faces):
    header = (f"ply\nformat binary_little_endian 1.0\nelement vertex "
              f"{len(vertices)}\nproperty float x\nproperty float y\nproperty "
              f"float z\nelement face {len(faces)}\nproperty list uchar int "
              "vertex_indices\nend_header\n").encode()
    return (header + b"".join(struct.pack("<3f", *v) for v in vertices) +
            b"".join(struct.pack("<B3i", 3, *f) for f in faces))


def stl(vertices, faces):
    return (b"\0" * 80 + struct.pack("<I", len(faces)) + b"".join(
        b"\0" * 12 + b"".join(struct.pack("<3f", *vertices[i]) for i in f) +
        b"\0\0" for f in faces))


def gltf(vertices, faces, **changes):
    data = b"".join(struct.pack("<3f", *v) for v in vertices)
    indices = b"".join(struct.pack("<3H", *f) for f in faces)
    uri = ("data:application/octet-stream;base64," +
           base64.b64encode(data + indices).decode())
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "buffers": [{"uri": uri, "byteLength": len(data + indices)}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": len(data)},
            {"buffer": 0, "byteOffset": len(data), "byteLength": len(indices)}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(vertices),
             "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 3 * len(faces),
             "type": "SCALAR"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0},
                                    "indices": 1}]}]}
    return json.dumps({**document, **changes}).encode()


def pcd(points, data="ascii"):
    head = ("VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
            f"WIDTH {len(points)}\nHEIGHT 1\nPOINTS {len(points)}\n"
            f"DATA {data}\n")
    return (head + xyz(points).decode()).encode()


def xyz(points):
    return "".join("{} {} {}\n".format(*p) for p in points).encode()


def ball(count, radius=0.04):
    points = numpy.random.default_rng(3).normal(size=(count, 3))
    return radius * points / numpy.linalg.norm(points, axis=1)[:, None]


def refuse_everywhere(client, content, mesh_format, statuses):
    """Each operation that takes a mesh answers alike; returns the problems."""
    query = {"format": mesh_format, "units": "m"}
    upload = {"body": content} if content else {
        "files": {"mesh": ("file", content)}}
    problems = [
        client.call("postObject", statuses, query=query, **upload),
        client.call("postGrasps", statuses, query={**query, "category": "mug"},
                    **upload),
        client.call("searchByShape", statuses, query=query, **upload),
        client.call("postExample", statuses, path={"name": "mug"},
                    query={**query, "learn": "false"},
                    headers={"Prefer": "wait=60"}, **upload)]
    assert len({p["detail"] for p in problems}) == 1, problems
    return problems[0]


# ---- Bytes that are no mesh --------------------------------------------------

NAMES = {"obj": "OBJ", "stl": "STL", "ply": "PLY", "off": "OFF", "glb": "GLB",
         "gltf": "glTF", "dae": "DAE", "pcd": "PCD", "xyz": "XYZ"}
WHOLE = {"obj": BOX, "stl": stl(VERTICES, FACES), "ply": ply(VERTICES, FACES),
         "off": off(VERTICES, FACES), "gltf": gltf(VERTICES, FACES),
         "pcd": pcd(ball(300))}


@pytest.mark.parametrize("mesh_format", NAMES)
@pytest.mark.parametrize("content", [
    b"\n", bytes(range(256)) * 8, b"%PDF-1.7 nothing like it\n" * 9],
    ids=["blank", "binary", "text"])
def test_what_is_no_mesh_is_a_422_naming_the_format(
        client, unchanged, mesh_format, content):
    problem = refuse_everywhere(client, content, mesh_format, 422)
    assert NAMES[mesh_format] in problem["detail"]
    assert problem["hint"]


def test_an_empty_file_is_a_422(client, unchanged):
    assert "empty" in refuse_everywhere(client, b"", "stl", 422)["detail"]


@pytest.mark.parametrize("mesh_format", WHOLE)
def test_half_a_file_is_a_422_naming_the_format(
        client, unchanged, mesh_format):
    content = WHOLE[mesh_format]
    cut = content[:len(content) // 2]
    if mesh_format == "obj":
        cut = content[:content.index(b"\nf ")]
    problem = refuse_everywhere(client, cut, mesh_format, 422)
    assert NAMES[mesh_format] in problem["detail"]


@pytest.mark.parametrize("mesh_format", sorted(set(WHOLE) - {"off"}))
def test_the_whole_file_is_taken(client, forgotten, mesh_format):
    stored = client.call("postObject", 201, body=WHOLE[mesh_format],
                         query={"format": mesh_format})
    if mesh_format != "pcd":
        assert stored["mass_properties"]["volume"] == pytest.approx(VOLUME)
        assert stored["repairs"] == []


@pytest.mark.parametrize("mesh_format", ["obj", "stl", "ply", "off", "gltf"])
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_coordinate_that_is_not_finite_is_a_422(
        client, unchanged, mesh_format, value):
    vertices = VERTICES[:-1] + [(SIDES[0], value, SIDES[2])]
    content = {"obj": meshes.obj, "stl": stl, "ply": ply, "off": off,
               "gltf": gltf}[mesh_format](vertices, FACES)
    problem = refuse_everywhere(client, content, mesh_format, 422)
    assert "finite" in problem["detail"]


@pytest.mark.parametrize("mesh_format", ["obj", "ply", "off"])
@pytest.mark.parametrize("index", [8, 30000, -10])
def test_an_index_out_of_range_is_a_422(client, unchanged, mesh_format, index):
    faces = FACES[:-1] + [(1, 7, index)]
    content = {"obj": meshes.obj, "ply": ply,
               "off": off}[mesh_format](VERTICES, faces)
    problem = refuse_everywhere(client, content, mesh_format, 422)
    assert NAMES[mesh_format] in problem["detail"]


@pytest.mark.parametrize("vertices,words", [
    ([(x, y, 0) for x, y, _ in VERTICES], "plane"),
    ([(x, y, x + y) for x, y, _ in VERTICES], "plane"),
    ([(x, 0, 0) for x, _, _ in VERTICES], "area"),
    ([(0.01, 0.01, 0.01)] * 8, "0 m"),
    (scaled(VERTICES, 1e38), "2 m"), (scaled(VERTICES, 1e300), "finite"),
    (VERTICES[:-1] + [(1e38, 0, 0)], "2 m"),
    (scaled(VERTICES, 1e-40), "5 mm"), (scaled(VERTICES, 1e-310), "5 mm"),
    (scaled(VERTICES, 1e-3), "5 mm"), (scaled(VERTICES, 1e3), "2 m"),
    (moved(VERTICES, (1e15, 1e15, 1e15)), "m"),
], ids=["flat", "slanted", "line", "point", "1e38", "1e300", "one 1e38",
        "float denormal", "double denormal", "tiny", "huge", "far away"])
def test_what_has_no_volume_or_no_size_is_a_422(
        client, unchanged, vertices, words):
    problem = refuse_everywhere(client, meshes.obj(vertices, FACES), "obj", 422)
    assert words in problem["detail"]


@pytest.mark.parametrize("content", [
    b"v 0 0 0\n", b"v 0 0 0\nf 1 1 1\n", b"f 1 2 3\n", BOX + b"f 0 1 2\n",
    BOX + b"f 1 2 99999999999999999999\n", BOX + b"f 1 2\n",
    b"v 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"],
    ids=["one vertex", "one corner", "no vertex", "index 0", "wide index",
         "two corners", "two coordinates"])
def test_the_least_of_meshes_is_a_422(client, unchanged, content):
    refuse_everywhere(client, content, "obj", 422)


def test_solids_apart_from_each_other_are_a_422(client, unchanged):
    content = joined((VERTICES, FACES), (moved(VERTICES, (0.2, 0, 0)), FACES))
    problem = refuse_everywhere(client, content, "obj", 422)
    assert "2 solids" in problem["detail"]


# ---- Point clouds ------------------------------------------------------------


@pytest.mark.parametrize("content,mesh_format,words", [
    (xyz(ball(199)), "xyz", "199"), (pcd(ball(199)), "pcd", "199"),
    (ply(ball(199), []), "ply", "199"),
    (xyz(ball(400) * (1, 1, 0)), "xyz", "plane"),
    (xyz(ball(400) * (1, 0, 0)), "xyz", "plane"),
    (xyz([(0.01, 0.01, 0.01)] * 400), "xyz", "0 m"),
    (xyz(ball(400) * 1e9), "xyz", "2 m"),
    (xyz(list(ball(100)) + [("nan", 0, 0)] * 400), "xyz", "100"),
], ids=["199 xyz", "199 pcd", "199 ply", "flat", "line", "point", "huge",
        "mostly nan"])
def test_a_cloud_that_tells_too_little_is_a_422(
        client, unchanged, content, mesh_format, words):
    problem = refuse_everywhere(client, content, mesh_format, 422)
    assert words in problem["detail"]


def test_two_hundred_points_are_enough(client, forgotten):
    stored = client.call("postObject", 201, body=xyz(ball(200)),
                         query={"format": "xyz"})
    assert stored["cloud"]["points"] == 200


# ---- Headers that lie --------------------------------------------------------


def lying():
    """Yields (format, bytes) of files that announce what they do not hold."""
    vertex = b"property float x\nproperty float y\nproperty float z\n"
    for encoding in (b"ascii", b"binary_little_endian", b"binary_big_endian"):
        for n in (b"4000000000", b"9223372036854775807", b"-1", b"1e9",
                  b"99999999999999999999999", b"399999"):
            yield "ply", (b"ply\nformat " + encoding + b" 1.0\nelement vertex "
                          + n + b"\n" + vertex + b"element face " + n +
                          b"\nproperty list uchar int vertex_indices\n"
                          b"end_header\n")
        yield "ply", (b"ply\nformat " + encoding + b" 1.0\nelement vertex 3\n" +
                      vertex + b"element face 1\nproperty list uint int "
                      b"vertex_indices\nend_header\n" + b"\0" * 36 +
                      b"\xff" * 4)
    for n in (0xffffffff, 0x7fffffff, 400_001, 399_999, 1):
        yield "stl", b"\0" * 80 + struct.pack("<I", n)
    yield "off", b"OFF\n4000000000 4000000000 0\n"
    yield "off", b"OFF\n300000 300000 0\n0 0 0\n"
    yield "off", b"OFF\n-1 -1 0\n"
    yield "off", off(VERTICES, FACES)[:-8] + b"4000000000 0 1 2\n"
    for n in (b"4000000000", b"999999", b"-1"):
        for data in (b"ascii", b"binary", b"binary_compressed"):
            yield "pcd", (b"VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\n"
                          b"COUNT 1 1 1\nWIDTH " + n + b"\nHEIGHT 1\nPOINTS " +
                          n + b"\nDATA " + data + b"\n" +
                          struct.pack("<II", 4, 0xffffffff) + b"abcd")
    yield "glb", b"glTF" + struct.pack("<III", 2, 0xffffffff, 0xffffffff)
    yield "gltf", gltf(VERTICES, FACES, accessors=[
        {"bufferView": 0, "componentType": 5126, "count": 4000000000,
         "type": "VEC3"}] * 2)
    yield "gltf", gltf(VERTICES, FACES, buffers=[{
        "uri": "data:application/octet-stream;base64,AAAA",
        "byteLength": 1 << 40}])


@pytest.mark.parametrize("mesh_format,content", list(lying()))
def test_a_header_that_lies_is_refused(
        client, unchanged, mesh_format, content):
    problem = refuse_everywhere(client, content, mesh_format, (413, 422))
    if client.last.status_code == 413:
        assert re.search(r"limit is \d+", problem["detail"])
    else:
        assert NAMES[mesh_format] in problem["detail"]


# ---- What is repaired --------------------------------------------------------

THIRD = moved(VERTICES, (0.011, 0.012, 0.013))


@pytest.mark.parametrize("content,step,volume", [
    (meshes.obj(VERTICES, FACES[:-1]), "filled 1 hole", 1),
    (meshes.obj(VERTICES, FACES[:-2]), "filled 1 hole", 1),
    (meshes.obj(VERTICES, [f[::-1] for f in FACES]), "turned 1 shell", 1),
    (meshes.obj(VERTICES, FACES[:-1] + [FACES[-1][::-1]]), "turned", 1),
    (meshes.obj(VERTICES, FACES + FACES), "dropped 12 duplicate faces", 1),
    (meshes.obj(VERTICES, FACES + [(0, 0, 1)]), "dropped 1 degenerate", 1),
    (meshes.obj([VERTICES[i] for f in FACES for i in f],
                [(3 * k, 3 * k + 1, 3 * k + 2) for k in range(12)]),
     "welded 28 vertices", 1),
    (joined((VERTICES, FACES), (THIRD, FACES)), "united 2 shells",
     2 - (20 * 30 * 40) / (31 * 42 * 53)),
    (joined((VERTICES, FACES), (moved(scaled(VERTICES, 0.3),
                                      (0.005, 0.005, 0.005)), FACES)),
     "united 2 shells", 1),
    (joined((VERTICES, FACES), (moved(VERTICES, SIDES[:2] + (0,)), FACES)),
     "wrapped", 2),
    (meshes.obj(VERTICES + [(0.015, 0.02, 0.08)], FACES + [(0, 7, 8)]),
     "wrapped", 1),
], ids=["open", "no lid", "inside out", "one face turned", "duplicated faces",
        "degenerate face", "corners apart", "crossing shells",
        "shell in a shell", "four faces at an edge", "three faces at an edge"])
def test_what_can_be_repaired_says_how_and_keeps_the_bytes(
        client, forgotten, content, step, volume):
    stored = client.call("postObject", 201, body=content)
    assert any(step in repair for repair in stored["repairs"])
    tolerance = 0.05 if step == "wrapped" else 1e-4
    assert stored["mass_properties"]["volume"] == pytest.approx(
        volume * VOLUME, rel=tolerance)
    path = {"id": stored["id"]}
    assert client.call("getMesh", 200, path=path,
                       query={"format": "original"}) == content
    lines = client.call("getMesh", 200, path=path).decode().splitlines()
    edges = collections.Counter()
    for line in lines:
        if line.startswith("f "):
            corners = [int(word.split("/")[0]) for word in line.split()[1:]]
            edges.update(zip(corners, corners[1:] + corners[:1]))
    assert edges
    assert all(n == 1 and edges[b, a] == 1 for (a, b), n in edges.items())


# ---- Limits ------------------------------------------------------------------


@pytest.fixture(scope="module")
def narrow(binary, tmp_path_factory):
    """A server that takes two kilobytes."""
    folder = tmp_path_factory.mktemp("narrow")
    live = LiveServer(binary, folder / "narrow.db", folder,
                      "--max-upload-bytes", "2000")
    yield live
    assert live.stop() == 0, live.log()


def talk(port, head, rest=b"", most=0):
    """Sends the head, then the rest up to so many bytes, until answered."""
    with socket.create_connection(("127.0.0.1", port), 20) as connection:
        connection.sendall(head)
        sent = 0
        connection.settimeout(0.02 if most else 20)
        received = b""
        while not received.endswith(b"}\n"):
            try:
                chunk = connection.recv(65536)
                if not chunk:
                    break
                received += chunk
            except TimeoutError:
                assert sent < most, received
                connection.sendall(rest)
                sent += len(rest)
        return received


@pytest.mark.parametrize("path", ["objects", "grasps?category=mug", "search",
                                  "categories/mug/examples"])
def test_an_announced_body_over_the_limit_is_refused_before_it_comes(
        narrow, path):
    head = (f"POST /v1/{path} HTTP/1.1\r\nHost: localhost\r\nContent-Length: "
            "99999999999\r\n\r\n").encode()
    received = talk(narrow.port, head)
    assert received.startswith(b"HTTP/1.1 413 ") and b" 2000 " in received


def test_a_body_without_end_is_refused_at_the_limit(narrow):
    head = (b"POST /v1/objects HTTP/1.1\r\nHost: localhost\r\n"
            b"Transfer-Encoding: chunked\r\n\r\n")
    chunk = b"3e8\r\n" + b"#" * 1000 + b"\r\n"
    received = talk(narrow.port, head, chunk, most=50000)
    assert received.startswith(b"HTTP/1.1 413 ") and b" 2000 " in received


def test_a_refused_body_leaves_nothing_and_the_server_serves(narrow):
    client = Contract(narrow.url)
    client.call("postObject", 413, body=b"v 0 0 0\n" * 500)
    client.call("postObject", 413, files={"mesh": ("a.obj", b"#" * 3000)})
    assert client.call("listObjects", 200)["items"] == []
    client.call("postObject", 201, body=BOX)


def test_too_many_triangles_or_points_store_nothing(client, unchanged):
    n = 1_000_001
    cloud = pcd([], "binary").replace(b" 0\n", f" {n}\n".encode())
    problem = client.call("postObject", 413, query={"format": "pcd"},
                          body=cloud + b"\0" * 12 * n)
    assert "points" in problem["detail"] and "1000000" in problem["detail"]
    n = 400_001
    problem = client.call("postObject", 413, query={"format": "stl"},
                          body=b"\0" * 80 + struct.pack("<I", n) +
                          b"\0" * 50 * n)
    assert "triangles" in problem["detail"] and "400000" in problem["detail"]


# ---- Names and values --------------------------------------------------------


@pytest.mark.parametrize("operation,given,known", [
    ("queryGrasps", {"query": {"category": "x"}}, "mug"),
    ("queryGrasps", {"query": {"hand": "x"}}, "barrett-bh8-280"),
    ("queryGrasps", {"query": {"category": "mug", "part": "x"}}, "handle"),
    ("queryGrasps", {"query": {"category": "mug", "task": "x"}}, "handover"),
    ("listGraspSpaces", {"query": {"category": "x"}}, "mug"),
    ("listGraspSpaces", {"query": {"hand": "x"}}, "barrett-bh8-280"),
    ("listObjects", {"query": {"category": "x"}}, "mug"),
    ("postObject", {"query": {"category": "x"}, "body": BOX}, "mug"),
    ("searchByShape", {"query": {"category": "x"}, "body": BOX}, "mug"),
    ("postExample", {"path": {"name": "x"}, "body": BOX}, "mug"),
    ("patchCategory", {"path": {"name": "x"}, "body": {"title": "t"}}, "mug"),
    ("deleteCategory", {"path": {"name": "x"}}, "mug"),
    ("getHand", {"path": {"name": "x"}}, "barrett-bh8-280"),
    ("getUrdf", {"path": {"name": "x"}}, "barrett-bh8-280"),
    ("getMesh", {"path": "example", "query": {"part": "x"}}, "handle"),
    ("postGraspSpaces", {"path": "example", "body": {"parts": ["x"]}},
     "handle"),
    ("postGraspSpaces", {"path": "example", "body": {"hands": ["x"]}},
     "barrett-bh8-280"),
    ("postSegmentation", {"path": "example", "body": {"category": "x"}},
     "mug"),
])
def test_an_unknown_name_is_a_404_that_tells_the_known_ones(
        client, world, unchanged, operation, given, known):
    if given.get("path") == "example":
        given = {**given, "path": {"id": world["example"]["id"]}}
    problem = client.call(operation, 404, **given)
    assert known in problem["hint"]


def test_a_learn_order_names_each_hand_once(client, world, unchanged):
    hand = "barrett-bh8-280"
    for hands in ([hand, hand], [hand] * 50_000):
        problem = client.call("postGraspSpaces", 400, path={"id": world["example"]["id"]},
                              body={"hands": hands})
        assert problem["field"] == "hands"


def test_a_file_name_of_a_megabyte_is_refused(client, unchanged):
    for name in ("m" * 300 + ".obj", "m" * 1_000_000 + ".obj"):
        client.call("postObject", (400, 413), files={"mesh": (name, BOX)})


@pytest.mark.parametrize("where", ["labels", "segmentation"])
def test_a_tree_of_empty_lists_is_refused(client, world, unchanged, where):
    many = b"[" + b"[]," * 1_390_000 + b"[]]"
    if where == "labels":
        client.call("postObject", 413, query={"category": "mug"},
                    files={"mesh": ("m.obj", BOX), "labels": ("l.json", many)})
    else:
        client.call("postSegmentation", 413, path={"id": world["example"]["id"]},
                    body=b'{"face_labels":' + many + b"}",
                    headers={"Content-Type": "application/json"})


@pytest.mark.parametrize("operation,name", [
    ("getObject", UNKNOWN_UUID), ("deleteObject", UNKNOWN_UUID),
    ("getMesh", UNKNOWN_UUID), ("listParts", UNKNOWN_UUID),
    ("getJob", UNKNOWN_UUID), ("cancelJob", UNKNOWN_UUID),
    ("getPart", UNKNOWN_HASH), ("getGrasp", UNKNOWN_HASH),
    ("getTransfer", UNKNOWN_HASH), ("getGraspSpace", UNKNOWN_HASH),
    ("deleteGraspSpace", UNKNOWN_HASH)])
def test_an_unknown_id_is_a_404_that_tells_where_to_look(
        client, unchanged, operation, name):
    problem = client.call(operation, 404, path={"id": name})
    assert problem["hint"] and name in problem["detail"]


def bad_values(schema):
    """Values that a parameter of this schema cannot take."""
    if schema.get("type") in ("integer", "number"):
        yield from ("", "x", "1,5", "nan", "inf", "1e400", "0x10", " 1", "+1",
                    "99999999999999999999999", "1\u0661")
        if schema["type"] == "integer":
            yield from ("1.0", "1e1")
        if "minimum" in schema:
            yield str(schema["minimum"] - 1)
        if "maximum" in schema:
            yield str(schema["maximum"] + 1)
    elif schema.get("type") == "boolean":
        yield from ("", "1", "yes", "TRUE", "true,false")
    elif "enum" in schema:
        yield from ("", "x", schema["enum"][0].upper(), schema["enum"][0] + " ")
    elif "maxLength" in schema:
        yield from ("", "x" * (schema["maxLength"] + 1))


def test_every_parameter_refuses_every_bad_value_by_name(client, unchanged):
    tried = 0
    for operation_id, method, path, operation, item in operations(client.spec):
        if "400" not in operation["responses"]:
            continue
        names = {"id": UNKNOWN_UUID, "name": "x"}
        for parameter in operation.get("parameters", []):
            parameter = resolve(client.spec, parameter)
            if parameter["in"] != "query":
                continue
            schema = resolve(client.spec, parameter["schema"])
            for value in bad_values(schema):
                reply = client.session.request(
                    method, client.base_url + path.format(**names),
                    params={parameter["name"]: value},
                    data=BOX if "Mesh" in str(operation.get("requestBody"))
                    else b"{}" if "requestBody" in operation else None)
                case = (operation_id, parameter["name"], value)
                assert reply.status_code == 400, (case, reply.text)
                problem = client.check(operation_id, operation, reply)
                assert problem["field"] == parameter["name"], case
                assert f"{parameter['name']} takes " in problem["detail"], case
                tried += 1
    assert tried > 200


@pytest.mark.parametrize("query", [
    "category=%ff%fe", "category=mug%00", "category=%c0%af", "=mug",
    "category=mug&category=mug", "a[]=1", "%63ategory=mug&category=mug",
    "category", "Category=mug", "category%00=mug"])
def test_a_query_of_strange_encoding_is_a_400(client, unchanged, query):
    for operation, method in (("queryGrasps", "GET"), ("postGrasps", "POST")):
        reply = client.session.request(
            method, f"{client.base_url}/v1/grasps?{query}",
            data=BOX if method == "POST" else None)
        assert reply.status_code == 400, reply.text
        client.check(operation, client.by_id[operation][2], reply)


# ---- JSON --------------------------------------------------------------------

HOSTILE = {
    "empty": b"", "deep 65": b"[" * 65 + b"]" * 65, "deep 1e6": b"[" * 10**6,
    "deep objects": b'{"faces":' * 65, "huge number": b'{"a":1e400}',
    "NaN": b'{"a":NaN}', "infinite": b'{"a":-Infinity}',
    "bad UTF-8": b'{"faces":{"\xff\xfe":[]}}', "surrogate": b'{"\\ud800":1}',
    "duplicate": b'{"faces":{},"faces":{}}', "a list": b"[]", "null": b"null",
    "duplicate within": b'{"faces":{"body":[],"body":[]}}',
    "wide range": b'{"faces":{"body":[[0,99999999999999999999]]}}',
    "long range": b'{"faces":{"body":[[0,2000000000]]}}',
    "range back": b'{"faces":{"body":[[5,2]]}}',
    "many labels": b'{"face_labels":[' + b'"a",' * 200_000 + b'"a"]}',
    "unknown field": b'{"a":1}', "a number": b'{"face_labels":[1]}'}


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_face_labels_are_a_400(client, unchanged, name):
    files = {"mesh": ("b.obj", BOX), "labels": ("l.json", HOSTILE[name])}
    problem = client.call("postObject", 400, query={"category": "mug"},
                          files=files)
    assert len(problem["detail"]) < 500
    problem = client.call("postExample", 400, path={"name": "mug"},
                          query={"learn": "false"},
                          headers={"Prefer": "wait=60"}, files=files)
    assert len(problem["detail"]) < 500


@pytest.mark.parametrize("value", [
    "[" * 65 + "]" * 65, "[" * 4000, '{"a":' * 700, "[]", "null", "7",
    '{"contact":{"friction":1e400}}', '{"contact":{"friction":NaN}}',
    '{"contact":{"friction":-1}}', '{"contact":{"friction":"0.5"}}',
    '{"contact":{},"contact":{}}', '{"contact":[]}', '{"swarm":null}',
    '{"swarm":{"particles":1.5}}', '{"swarm":{"particles":1e9}}',
    '{"preset":"best"}', '{"preset":1}', '{"\\ud800":{}}'],
    ids=lambda value: value[:32])
def test_hostile_tunables_are_a_400(client, world, unchanged, value):
    problem = client.call("postGrasps", 400, files={
        "mesh": ("b.obj", BOX), "category": (None, "mug"),
        "parameters": (None, value)})
    assert len(problem["detail"]) < 500


# ---- Bodies ------------------------------------------------------------------


def form_part(name, content, file_name=None):
    disposition = f'form-data; name="{name}"' + (
        f'; filename="{file_name}"' if file_name else "")
    return (f"--B\r\nContent-Disposition: {disposition}\r\n\r\n".encode() +
            content + b"\r\n")


@pytest.mark.parametrize("body,statuses", [
    (b"", 400), (b"--B--\r\n", 400), (b"--C--\r\n", 400),
    (form_part("mesh", BOX, "a.obj"), 400),
    (form_part("mesh", BOX, "a.obj") * 2 + b"--B--\r\n", 400),
    (form_part("mesh", BOX) + b"--B--\r\n", (400, 413)),
    (form_part("picture", BOX, "a.obj") + b"--B--\r\n", 400),
    (form_part("mesh", BOX, "a.obj") + form_part("units", b"m") * 2 +
     b"--B--\r\n", 400),
    (form_part("mesh", BOX, "a.obj") + form_part("name", b"\xff") +
     b"--B--\r\n", 400),
    (form_part("mesh", BOX, "a.obj") + form_part("name", b"x" * 5000) +
     b"--B--\r\n", 413),
    (form_part("mesh", BOX, "a.obj") +
     b"".join(form_part(f"f{i}", b"x") for i in range(40)) + b"--B--\r\n", 413),
    (b"--B\r\n\r\n" + BOX + b"\r\n--B--\r\n", 400),
    (form_part("mesh", form_part("mesh", BOX, "a.obj"), "a.obj")[:-9], 400),
], ids=["empty", "no part", "another boundary", "no end", "two meshes",
        "a mesh without a name", "another file", "a field twice", "bad UTF-8",
        "long field", "many parts", "no name", "cut"])
def test_a_broken_form_stores_nothing(client, unchanged, body, statuses):
    for operation in ("postObject", "postGrasps", "searchByShape"):
        problem = client.call(operation, statuses, body=body, headers={
            "Content-Type": "multipart/form-data; boundary=B"})
        assert problem["detail"]


@pytest.mark.parametrize("kind", [
    "multipart/form-data", "multipart/form-data; boundary=",
    'multipart/form-data; boundary="' + "B" * 71 + '"'])
def test_a_form_without_a_boundary_is_a_400(client, unchanged, kind):
    client.call("postObject", 400, body=form_part("mesh", BOX, "a.obj") +
                b"--B--\r\n", headers={"Content-Type": kind})


def test_a_body_where_none_belongs_is_a_400(client, unchanged):
    names = {"id": UNKNOWN_UUID, "name": "x", "file": "x"}
    for operation_id, method, path, operation, _ in operations(client.spec):
        if method not in ("get", "delete"):
            continue
        reply = client.session.request(
            method, client.base_url + path.format(**names), data=b"{}")
        assert reply.status_code == 400, operation_id
        client.validate(reply.json(), {"$ref": "#/components/schemas/Problem"})


def test_json_under_another_type_is_a_415(client, unchanged):
    body = b'{"name":"typed","parts":[{"label":"a"}]}'
    for kind in ("text/plain", "application/octet-stream", "application/xml",
                 "multipart/form-data; boundary=B"):
        client.call("postCategory", 415, body=body,
                    headers={"Content-Type": kind})


def test_a_file_name_is_a_name_and_nothing_else(client, server, forgotten):
    name = "../../../etc/x\u001b[31m.obj"
    stored = client.call("postObject", 201, body=form_part(
        "mesh", BOX, name) + b"--B--\r\n", headers={
            "Content-Type": "multipart/form-data; boundary=B"})
    client.call("getMesh", 200, path={"id": stored["id"]})
    disposition = client.last.headers["Content-Disposition"]
    assert disposition == f'attachment; filename="{stored["id"]}.obj"'
    assert "\x1b" not in server.log()


# ---- Objects that do not suit ------------------------------------------------


def transfer(client, expect, **query):
    body = query.pop("body", None)
    return client.call("postGrasps", expect, body=body, query={
        "sources": 4, "seed": 7, **query})


def test_an_object_too_big_for_the_hand_gets_a_reason_per_grasp(
        client, world, forgotten):
    lines = (MUG / "classic.obj").read_text().splitlines()
    big = "\n".join(
        "v " + " ".join(str(15 * float(x)) for x in line.split()[1:4])
        if line.startswith("v ") else line for line in lines).encode()
    answer = transfer(client, 200, category="mug", part="body", body=big)
    assert answer["grasps"] == [] and answer["complete"]
    assert len(answer["rejected"]) == answer["summary"]["attempted"] == 4
    assert all(r["reason"] != "succeeded" for r in answer["rejected"])
    client.call("getObject", 200, path={"id": answer["object"]["id"]})


@pytest.fixture
def cup(client, world, forgotten):
    """A mug whose handle was sawn off, its only part named."""
    lines = (MUG / "classic.obj").read_text().splitlines()
    ranges = json.loads((MUG / "classic.labels.json").read_text())["faces"]
    faces = [line for line in lines if line.startswith("f ")]
    kept = [faces[i] for begin, end in ranges["body"]
            for i in range(begin, end)]
    content = "\n".join(
        [line for line in lines if line.startswith("v ")] + kept).encode()
    stored = client.call("postObject", 201, body=content,
                         query={"category": "mug"})
    assert [part["label"] for part in stored["parts"]] == ["body"]
    assert stored["segmentation"]["warnings"]
    return client.call("postSegmentation", 200, path={"id": stored["id"]},
                       body={"faces": {"body": [[0, stored["triangles"]]]}})


def test_an_object_without_a_handle_gets_grasps_for_its_body(client, cup):
    answer = transfer(client, 200, object=cup["id"])
    assert "the object has no handle" in answer["warnings"]
    assert [part["label"] for part in answer["object"]["parts"]] == ["body"]
    assert answer["grasps"]
    assert {grasp["part"] for grasp in answer["grasps"]} == {"body"}


def test_where_no_part_matches_it_is_a_422_and_the_object_stays(client, cup):
    before = count(client)
    problem = transfer(client, 422, object=cup["id"], part="handle")
    assert "handle" in problem["detail"]
    assert count(client) == before
    client.call("getObject", 200, path={"id": cup["id"]})


def test_an_object_that_is_like_no_example_is_a_422_and_stays(
        client, world, forgotten):
    before = count(client)
    problem = transfer(client, 422, category="mug", body=BOX)
    assert problem["code"] == "not_in_category"
    after = count(client)
    assert after["objects"] == before["objects"] + 1
    assert after["transfers"] == before["transfers"]


def test_before_anything_is_learned_a_409_keeps_nothing(
        client, world, unchanged):
    client.call("postCategory", 201,
                body={"name": "empty", "parts": [{"label": "body"}]})
    problem = transfer(client, 409, category="empty", body=BOX)
    assert "graspdb" in problem["hint"] and "empty" in problem["detail"]
    client.call("deleteCategory", 204, path={"name": "empty"})


# ---- Deleting what others depend on ------------------------------------------


@pytest.fixture
def doomed(client, world, forgotten):
    """A learned category of its own with a transfer from it."""
    client.call("postCategory", 201, body={
        "name": "doomed", "parts": [{"label": "body"}, {"label": "handle"}]})
    example = client.call(
        "postExample", 200, path={"name": "doomed"}, query={"learn": "false"},
        headers={"Prefer": "wait=150"}, files={
            "mesh": ("c.obj", (MUG / "classic.obj").read_bytes()),
            "labels": ("l.json", (MUG / "classic.labels.json").read_bytes())})
    space = client.call(
        "postGraspSpaces", 200, path={"id": example["id"]}, timeout=320,
        headers={"Prefer": "wait=300"},
        body={"parameters": QUICK, "parts": ["body"]})["items"][0]
    answer = transfer(client, 200, category="doomed", part="body",
                      body=world["novel_bytes"])
    assert answer["grasps"]
    yield {"example": example["id"], "space": space["id"],
           "transfer": answer["transfer_id"], "novel": answer["object"]["id"],
           "grasp": answer["grasps"][0]["id"]}
    client.call("deleteCategory", (204, 404), path={"name": "doomed"},
                query={"cascade": "true"})


def test_an_example_goes_with_its_grasps_only_when_told(client, doomed):
    before = count(client)
    path = {"id": doomed["example"]}
    for cascade in ({}, {"cascade": "false"}):
        problem = client.call("deleteObject", 409, path=path, query=cascade)
        assert doomed["space"] in problem["detail"]
        assert doomed["transfer"] in problem["detail"]
        assert "cascade=true" in problem["hint"]
    client.call("deleteObject", 400, path=path, query={"cascade": "yes"})
    client.call("deleteCategory", 409, path={"name": "doomed"})
    assert count(client) == before
    readers = [("getObject", "example"), ("getGraspSpace", "space"),
               ("getTransfer", "transfer"), ("getGrasp", "grasp")]
    for operation, what in readers:
        client.call(operation, 200, path={"id": doomed[what]})
    client.call("deleteObject", 204, path=path, query={"cascade": "true"})
    for operation, what in readers:
        client.call(operation, 404, path={"id": doomed[what]})
    client.call("getObject", 200, path={"id": doomed["novel"]})
    after = count(client)
    assert after["objects"] == before["objects"] - 1
    assert after["grasp_spaces"] == before["grasp_spaces"] - 1
    assert after["transfers"] == before["transfers"] - 1
    transfer(client, 409, category="doomed", object=doomed["novel"])


# ---- Many at once ------------------------------------------------------------


def test_of_many_that_add_one_category_one_does(client):
    body = {"name": "raced", "parts": [{"label": "a"}]}
    statuses = at_once(lambda _: requests.post(
        f"{client.base_url}/v1/categories", json=body).status_code)
    assert sorted(statuses) == [200] * 15 + [201]
    statuses = at_once(lambda _: requests.delete(
        f"{client.base_url}/v1/categories/raced").status_code)
    assert sorted(statuses) == [204] + [404] * 15


def test_of_many_that_send_one_mesh_all_get_the_same_object(
        client, forgotten):
    before = count(client)["objects"]
    ids = at_once(lambda _: requests.post(
        f"{client.base_url}/v1/objects", data=BOX).json()["id"])
    assert len(set(ids)) == 1
    assert count(client)["objects"] == before + 1


# ---- Files that refer to others ----------------------------------------------


@pytest.fixture
def trap():
    """A port that nobody may call."""
    listener = socket.create_server(("127.0.0.1", 0))
    listener.settimeout(0.05)
    yield listener.getsockname()[1]
    with pytest.raises(TimeoutError):
        listener.accept()
    listener.close()


def references(target):
    """Yields (format, bytes, whether there is a mesh without it)."""
    yield "obj", f"mtllib {target}\nusemtl x\n".encode() + BOX, True
    texture = {"images": [{"uri": target}], "textures": [{"source": 0}],
               "materials": [{"pbrMetallicRoughness": {
                   "baseColorTexture": {"index": 0}}}]}
    yield "gltf", gltf(VERTICES, FACES, **texture), True
    yield "gltf", gltf(VERTICES, FACES, buffers=[
        {"uri": target, "byteLength": 168}]), False
    entity = f'<!DOCTYPE COLLADA [<!ENTITY x SYSTEM "{target}">]>'
    for head, text in ((entity, "&x;"), ("", f"<init_from>{target}</init_from>"
                                         )):
        yield "dae", collada(head, text), None
    yield "dae", collada("", "").replace(b"#g", target.encode()), None
    yield "ply", WHOLE["ply"].replace(
        b"element vertex", f"comment TextureFile {target}\nelement vertex"
        .encode(), 1), True


def collada(head, text):
    positions = " ".join(f"{x} {y} {z}" for x, y, z in VERTICES)
    indices = " ".join(str(i) for f in FACES for i in f)
    return f"""<?xml version="1.0"?>{head}
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="1" name="meter"/><up_axis>Z_UP</up_axis></asset>
<library_images><image id="i" name="i">{text}</image></library_images>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="24">{positions}</float_array>
<technique_common><accessor source="#a" count="8" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="12"><input semantic="VERTEX" source="#v" offset="0"/>
<p>{indices}</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node>
<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>""".encode()


def test_a_file_that_refers_to_others_makes_no_connection(
        client, forgotten, trap):
    for mesh_format, content, whole in references(
            f"http://127.0.0.1:{trap}/x"):
        statuses = {True: 201, False: 422, None: (200, 201, 422)}[whole]
        client.call("postObject", statuses, body=content,
                    query={"format": mesh_format})
        client.call("postGrasps", 422, body=content, query={
            "format": mesh_format, "category": "mug", "units": "m"})


def test_a_file_that_refers_to_others_tells_nothing_of_them(
        client, forgotten, tmp_path):
    secret = tmp_path / "secret"
    secret.write_text("tell-nobody " * 20)
    for target in (f"file://{secret}", str(secret)):
        for mesh_format, content, whole in references(target):
            statuses = {True: 201, False: 422, None: (200, 201, 422)}[whole]
            client.call("postObject", statuses, body=content,
                        query={"format": mesh_format})
            assert b"tell-nobody" not in client.last.content


def test_a_scene_is_taken_when_nothing_is_wrong_with_it(client, forgotten):
    stored = client.call("postObject", 201, query={"format": "dae"},
                         body=collada("", ""))
    assert stored["mass_properties"]["volume"] == pytest.approx(VOLUME)


# ---- A decoder that fails ----------------------------------------------------


@pytest.mark.parametrize("mesh_format,content", [
    ("gltf", b"[" * 10**6), ("gltf", b'{"a":' * 300_000),
    ("dae", b"<a>" * 300_000), ("dae", b"<" * 10**6),
    ("glb", b"glTF" + struct.pack("<III", 2, 10**6 + 20, 10**6) + b"JSON" +
     b"[" * 10**6),
    ("obj", b"f " + b"1 " * 10**6), ("off", b"OFF " * 10**5),
    ("ply", b"ply\n" + b"element a 1\n" * 10**5),
    ("pcd", b"FIELDS " + b"x " * 10**6), ("xyz", b"1e" * 10**6)],
    ids=["deep glTF", "deep objects", "deep XML", "angles", "deep GLB",
         "one long face", "OFF", "PLY", "PCD", "XYZ"])
def test_what_makes_a_decoder_dig_is_refused_and_the_server_serves(
        client, unchanged, mesh_format, content):
    client.call("postObject", (413, 422), body=content,
                query={"format": mesh_format})


def test_a_decoder_that_crashes_or_hangs_is_a_422_and_the_server_serves(
        binary, tmp_path):
    impostor = tmp_path / "impostor"
    mood = tmp_path / "mood"
    mood.write_text("sound")
    impostor.write_text(
        f"#!/bin/sh\nread mood < {mood} || true\ncase $mood in\n"
        "crash) kill -SEGV $$;;\nhang) exec sleep 1000;;\nquit) exit 3;;\n"
        f"*) exec {binary}-decode;;\nesac\n")
    impostor.chmod(0o755)
    live = LiveServer(binary, tmp_path / "a.db", tmp_path,
                      "--decoder", str(impostor))
    client = Contract(live.url)
    for word in ("crash", "quit", "hang"):
        mood.write_text(word)
        replies = []
        waiting = threading.Thread(target=lambda: replies.append(
            requests.post(live.url + "/v1/objects", data=BOX, timeout=40)))
        waiting.start()
        time.sleep(0.1)
        client.call("getReadiness", 200)
        waiting.join(40)
        assert replies[0].status_code == 422 and replies[0].json()["detail"]
        assert client.call("listObjects", 200)["items"] == []
    mood.write_text("sound")
    client.call("postObject", 201, body=BOX)
    metrics = requests.get(live.url + "/metrics", timeout=20).text
    for end, count in (("crashed", 2), ("timed_out", 1), ("admitted", 1)):
        assert f'graspdb_decoded_total{{end="{end}"}} {count}\n' in metrics
    assert live.stop() == 0


def sawn_off():
    """A mug without its handle, open where that was."""
    lines = (MUG / "classic.obj").read_text().splitlines()
    ranges = json.loads((MUG / "classic.labels.json").read_text())["faces"]
    faces = [line for line in lines if line.startswith("f ")]
    return "\n".join(
        [line for line in lines if line.startswith("v ")] +
        [faces[i] for a, b in ranges["body"] for i in range(a, b)]).encode()


# ---- What is answered otherwise than one might think -------------------------


def test_a_mug_without_a_handle_gets_grasps_for_its_body(client, forgotten):
    answer = transfer(client, 200, category="mug", body=sawn_off())
    assert any("handle" in warning for warning in answer["warnings"])
    assert {grasp["part"] for grasp in answer["grasps"]} == {"body"}


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
def test_a_point_without_a_position_is_left_out(client, forgotten, value):
    answer = client.call("postObject", 201, query={"format": "xyz"},
                         body=xyz(list(ball(300)) + [(value, 0, 0)]))
    assert answer["cloud"]["points"] == 300


# ---- What is stored is what was sent -----------------------------------------


@pytest.mark.parametrize("distance", [1e4, 1e5])
def test_a_mesh_far_from_its_origin_is_kept_exactly_or_refused(
        client, forgotten, distance):
    content = meshes.obj(moved(VERTICES, (distance, 0, 0)), FACES)
    answer = client.call("postObject", (201, 422), body=content)
    if client.last.status_code == 201:
        box = answer["bounding_box"]
        assert box["max"][0] - box["min"][0] == pytest.approx(
            VERTICES[1][0], rel=1e-3)


# ---- No request changes the answer to another --------------------------------


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
        # In use, or, once answered, used for another request.
        refused = {409} if same else {409, 422}
        assert {r.status_code for r in replies} <= {201} | refused


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
                             "sources": 4, "seed": 51})
    time.sleep(0.3)
    client.call("deleteObject", 204, path={"id": stored["id"]})
    check_honest(end_of(client, job))


def test_whoever_waits_for_it_gets_no_5xx(client, world, forgotten):
    stored = client.call("postObject", (200, 201), body=world["novel_bytes"],
                         query={"category": "mug"})
    with concurrent.futures.ThreadPoolExecutor() as pool:
        waiting = pool.submit(requests.post, f"{client.base_url}/v1/grasps",
                              params={"object": stored["id"], "part": "body",
                                      "sources": 4, "seed": 52})
        time.sleep(0.3)
        client.call("deleteObject", 204, path={"id": stored["id"]})
        reply = waiting.result(patient(60))
    assert reply.status_code < 500, reply.text


def test_an_example_deleted_while_it_is_transferred_from(
        client, world, doomed):
    job = client.call("postGrasps", 202, headers={"Prefer": "respond-async"},
                      query={"object": doomed["novel"], "part": "body",
                             "sources": 4, "seed": 53})
    time.sleep(0.3)
    client.call("deleteObject", 204, path={"id": doomed["example"]},
                query={"cascade": "true"})
    check_honest(end_of(client, job))
