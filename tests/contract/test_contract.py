"""Every operation of schema/openapi.yaml, called on a real server."""

import concurrent.futures
import gzip
import hashlib
import json
import math
import pathlib
import re
import socket
import subprocess
import threading
import time
from xml.etree import ElementTree

import numpy
import pytest
import requests

import meshes
from contract_client import ROOT, Contract, load_spec, operations, patient
from live_server import LiveServer

UNKNOWN_UUID = "01890000-0000-7000-8000-000000000000"
UNKNOWN_HASH = "0" * 32
BOX = meshes.box_obj(0.05, 0.06, 0.07)


def transfer_query(**changes):
    return {"category": "mug", "part": "body", "sources": 4, "seed": 7,
            **changes}


@pytest.fixture(scope="module")
def answer(contract, world):
    """Grasps on a mug that the database had not seen."""
    return contract.call("postGrasps", 200, query=transfer_query(),
                         body=world["novel_bytes"])


# ---- The server itself -------------------------------------------------------


def test_the_viewer_and_all_that_it_loads_are_served(contract):
    page = contract.call("getViewer", 200).decode()
    files = re.findall(r'(?:src|href)="\.?/assets/([^"]+)"', page)
    assert len(files) >= 3
    for file in files:
        contract.call("getViewerFile", 200, path={"file": file})
        assert "immutable" in contract.last.headers["Cache-Control"]
    policy = contract.last.headers["Content-Security-Policy"]
    assert "script-src 'self'" in policy and "unsafe" not in policy
    contract.call("getViewerFile", 404, path={"file": "none.js"})
    contract.call("getViewer", 200)
    assert requests.get(contract.base_url + "/?anything=goes", timeout=20).ok


def test_health_and_readiness(contract):
    assert contract.call("getHealth", 200)["status"] == "ok"
    counts = contract.call("getReadiness", 200)["counts"]
    assert counts["hands"] >= 1


def test_metrics_are_prometheus_text(contract):
    contract.call("getJob", 404, path={"id": UNKNOWN_UUID})
    text = contract.call("getMetrics", 200).decode()
    samples, types = {}, {}
    for line in text.splitlines():
        if line.startswith("# TYPE"):
            _, _, name, kind = line.split()
            types[name] = kind
        elif not line.startswith("#"):
            match = re.fullmatch(
                r'([a-z_]+)(?:{([a-z_]+="[^"]*"(?:,[a-z_]+="[^"]*")*)})? (\S+)',
                line)
            assert match, line
            base = re.sub("_(bucket|sum|count)$", "", match[1])
            assert match[1] in types or types[base] == "histogram", line
            samples[match[1], match[2]] = float(match[3])
    assert samples["graspdb_http_requests_total",
                   'method="GET",route="/v1/jobs/{id}",status="404"'] >= 1
    assert UNKNOWN_UUID not in text
    assert samples["process_resident_memory_bytes", None] > 1e6
    assert samples["graspdb_database_bytes", None] > 4096
    assert samples["graspdb_stored", 'what="hands"'] >= 1
    for cache in ("grasp_texts", "hands", "hand_shapes", "whole_solids", "descriptors"):
        assert samples["graspdb_cache_bytes", f'cache="{cache}"'] >= 0
    assert samples["graspdb_database_memory_bytes", None] > 4096


def test_the_contract_served_is_the_file(contract):
    served = contract.call("getContract", 200)
    expected = load_spec()
    served["info"].pop("version")
    expected["info"].pop("version")
    assert served == json.loads(json.dumps(expected))


def test_grasps_are_written_once(contract, answer):
    def count_hits():
        text = contract.call("getMetrics", 200).decode()
        return int(re.search(
            r'graspdb_cache_lookups_total{cache="grasp_texts",end="hit"} (\d+)',
            text)[1])

    query = {"transfer": answer["transfer_id"], "stage": "assembly"}
    first = contract.call("queryGrasps", 200, query=query)
    hits = count_hits()
    assert contract.call("queryGrasps", 200, query=query) == first
    assert count_hits() == hits + len(first["items"])


def test_every_parameter_lies_in_its_range(contract):
    for entry in contract.call("listParameters", 200)["items"]:
        assert entry["minimum"] <= entry["value"] <= entry["maximum"]
        assert entry["unit"] and entry["source"]


# ---- Catalogue ---------------------------------------------------------------


def test_hands(contract):
    listed = contract.call("listHands", 200)["items"]
    hand = contract.call("getHand", 200, path={"name": "barrett-bh8-280"})
    assert hand in listed
    assert len(hand["joints"]) == 8
    urdf = contract.call("getUrdf", 200, path={"name": hand["name"]})
    assert b"<robot" in urdf
    problem = contract.call("getHand", 404, path={"name": "shadow"})
    assert "barrett-bh8-280" in problem["hint"]
    contract.call("getUrdf", 404, path={"name": "shadow"})


@pytest.fixture(scope="module")
def hands(binary, contract, tmp_path_factory):
    """A server of its own, so that nothing is learned for these hands."""
    folder = tmp_path_factory.mktemp("hands")
    live = LiveServer(binary, folder / "hands.db", folder)
    client = Contract(live.url)
    client.seen = contract.seen
    yield client
    assert live.stop() == 0, live.log()


def hand_files(name, urdf=None, meshes=None, **changes):
    """A form with the bundled hand's files, under another name."""
    folder = ROOT / "data" / "hands" / "barrett-bh8-280"
    notes = json.loads((folder / "hand.json").read_text())
    notes.update(name=name, **changes)
    if urdf is None:
        urdf = (folder / "hand.urdf").read_text()
    if meshes is None:
        meshes = {path.name: path.read_bytes()
                  for path in sorted((folder / "meshes").iterdir())}
    return ([("hand", ("hand.json", json.dumps(notes))), ("urdf", ("hand.urdf", urdf))] +
            [("mesh", item) for item in meshes.items()])


def test_a_hand_is_stored_once_and_under_its_name_only(contract, hands):
    stored = hands.call("postHand", 201, files=hand_files("claw"))
    assert hands.last.headers["Location"] == "/v1/hands/claw"
    assert hands.call("getHand", 200, path={"name": "claw"}) == stored
    barrett = contract.call("getHand", 200, path={"name": "barrett-bh8-280"})
    for same in ("links", "joints", "actuators", "contact_points"):
        assert stored[same] == barrett[same]
    assert hands.call("postHand", 200, files=hand_files("claw")) == stored
    problem = hands.call("postHand", 409,
                         files=hand_files("claw", closing_force_n=9))
    assert "claw" in problem["detail"]
    urdf = hands.call("getUrdf", 200, path={"name": "claw"})
    assert urdf == (ROOT / "data/hands/barrett-bh8-280/hand.urdf").read_bytes()
    hands.call("getHandMesh", 200, path={"name": "claw", "file": "palm_0.obj"})


PAIR = """<robot name="pair">
  <link name="palm"><collision><geometry><mesh filename="box.obj"/></geometry></collision></link>
  <link name="jaw"><collision><geometry><mesh filename="box.obj"/></geometry></collision></link>
  <joint name="slide" type="prismatic">
    <parent link="palm"/><child link="jaw"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="0.05" effort="1" velocity="1"/>
  </joint>
</robot>"""
PAIR_NOTES = {
    "breakaway": [], "ignored_collisions": [["palm", "jaw"]],
    "actuators": [{"name": "motor", "joint": "slide", "closes": True}],
    "contact_points": [{"link": "jaw", "p_L": [0, 0, 0], "nhat_L": [0, 0, -1]}],
}


def pair_files(name, urdf=PAIR, mesh=BOX, **changes):
    return hand_files(name, urdf, {"box.obj": mesh}, **{**PAIR_NOTES, **changes})


def test_any_jointed_hand_can_be_stored(hands):
    hand = hands.call("postHand", 201, files=pair_files("pair"))
    assert hand["links"] == ["palm", "jaw"]
    assert hand["joints"] == [
        {"name": "slide", "type": "prismatic", "lower": 0, "upper": 0.05}]


@pytest.mark.parametrize("what,form", [
    ("cannot be read", pair_files("bad", urdf="<robot")),
    ("cannot be read", pair_files("bad", urdf="")),
    ("is fixed", pair_files("bad", urdf=PAIR.replace("prismatic", "fixed"))),
    ("neither revolute", pair_files("bad", urdf=PAIR.replace("prismatic", "floating"))),
    ("no mesh", pair_files("bad", urdf=PAIR.replace(
        '<mesh filename="box.obj"/>', '<sphere radius="0.01"/>'))),
    ("scales", pair_files("bad", urdf=PAIR.replace(
        'filename="box.obj"', 'filename="box.obj" scale="0.001 0.001 0.001"'))),
    ("no range of motion", pair_files("bad", urdf=PAIR.replace("0.05", "-1"))),
    ("finger.obj", pair_files("bad", urdf=PAIR.replace("box.obj", "finger.obj"))),
    ("unknown joint", pair_files("bad", actuators=[
        {"name": "motor", "joint": "slid", "closes": True}])),
    ("no actuator closes", pair_files("bad", actuators=[
        {"name": "motor", "joint": "slide"}])),
    ("has no actuator", pair_files("bad", actuators=[])),
    ("two actuators", pair_files("bad", actuators=[
        {"name": "a", "joint": "slide", "closes": True},
        {"name": "b", "joint": "slide", "closes": True}])),
    ("no contact points", pair_files("bad", contact_points=[])),
    ("no link thumb", pair_files("bad", contact_points=[
        {"link": "thumb", "p_L": [0, 0, 0], "nhat_L": [0, 0, 1]}])),
    ("box.obj: ", pair_files("bad", mesh=b"not a mesh")),
    ("not convex", pair_files("bad", mesh=(
        ROOT / "data" / "mug" / "latte.obj").read_bytes())),
], ids=lambda value: value.replace(" ", "-") if isinstance(value, str) else "")
def test_what_is_no_hand_is_a_422_and_nothing_is_stored(hands, what, form):
    problem = hands.call("postHand", 422, files=form)
    assert what in problem["detail"]
    hands.call("getHand", 404, path={"name": "bad"})


def test_a_hand_larger_than_any_is_a_413(hands):
    fine = (ROOT / "data" / "power_drill" / "classic.obj").read_bytes()
    for field, form in (
            ("mesh", pair_files("bad", mesh=fine)),
            ("urdf", pair_files("bad", urdf=PAIR + "<!--" + "x" * (1 << 20) + "-->"))):
        assert hands.call("postHand", 413, files=form)["field"] == field
        hands.call("getHand", 404, path={"name": "bad"})


def test_a_form_without_a_hands_files_is_a_400(hands):
    for field, form in (
            ("hand", pair_files("bad")[1:]), ("urdf", pair_files("bad")[:1]),
            ("skin", pair_files("bad") + [("skin", ("a.png", b"x"))]),
            ("mesh", pair_files("bad") + [("mesh", ("box.obj", BOX))]),
            ("mesh", pair_files("bad") + [("mesh", ("a b.obj", BOX))]),
            ("name", pair_files("No name")),
            ("approach_axis_H", pair_files("bad", approach_axis_H=[0, 0, 2]))):
        problem = hands.call("postHand", 400, files=form)
        assert problem["field"] == field
        hands.call("getHand", 404, path={"name": "bad"})


def test_the_meshes_of_a_hand_are_those_that_its_urdf_names(contract):
    name = contract.call("listHands", 200)["items"][0]["name"]
    urdf = ElementTree.fromstring(
        contract.call("getUrdf", 200, path={"name": name}))
    files = {mesh.attrib["filename"] for mesh in urdf.iter("mesh")}
    assert files
    for file in files:
        folder, _, base = file.rpartition("/")
        assert folder == "meshes"  # So that the relative address is right.
        obj = contract.call("getHandMesh", 200,
                            path={"name": name, "file": base})
        assert obj.count(b"\nf ") >= 4
    for unknown in ("palm.obj", "..", "palm_0", "%2e%2e%2fhand.urdf"):
        contract.call("getHandMesh", 404,
                      path={"name": name, "file": unknown})


def test_categories(contract, world):
    given = {"name": "cup-1", "parts": [{"label": "body"}]}
    category = contract.call("postCategory", 201, body=given)
    assert contract.last.headers["Location"] == "/v1/categories/cup-1"
    path = {"name": "cup-1"}
    assert contract.call("getCategory", 200, path=path) == category
    assert category in contract.call("listCategories", 200)["items"]
    # Once more is nothing new: as after an answer that was lost.
    assert contract.call("postCategory", 200, body=given) == category
    contract.call("postCategory", 409, body={**given, "title": "Others"})
    patched = contract.call("patchCategory", 200, path=path,
                            body={"title": "Cups"})
    assert patched["title"] == "Cups" and patched["parts"] == category["parts"]
    # Pairs follow their labels, or go with them.
    contract.call("patchCategory", 200, path=path, body={
        "parts": [{"label": "a"}, {"label": "b"}, {"label": "c"}],
        "topology": [["a", "b"], ["b", "c"]]})
    fewer = contract.call("patchCategory", 200, path=path, body={
        "parts": [{"label": "c"}, {"label": "b"}]})
    assert fewer["topology"] == [["b", "c"]]
    assert contract.call("getCategory", 200, path=path) == fewer
    contract.call("deleteCategory", 204, path=path)
    for operation, body in (("getCategory", None), ("deleteCategory", None),
                            ("patchCategory", {"title": "x"})):
        problem = contract.call(operation, 404, path=path, body=body)
        assert "mug" in problem["hint"]
    contract.call("deleteCategory", 409, path={"name": "mug"})


@pytest.mark.parametrize("body", [
    {}, {"name": "x"}, {"name": "Not A Name", "parts": [{"label": "a"}]},
    {"name": "x", "parts": []}, {"name": "x", "parts": [{}]},
    {"name": "x", "parts": "body"}, {"name": 3, "parts": [{"label": "a"}]},
    {"name": "x", "parts": [{"label": "a"}], "unknown": 1},
    {"name": "x", "parts": [{"label": "a"}, {"label": "a"}]},
    {"name": "x", "parts": [{"label": "a"}], "topology": [["a", "b"]]},
    {"name": "x", "parts": [{"label": "a"}], "segmentation": {"samples": -1}},
    {"name": "x", "parts": [{"label": "a"}], "segmentation": {"nothing": 1}},
    {"name": "x", "parts": [{"label": "a", "tasks": {f"t{i}": "" for i in range(65)}}]},
    {"name": "x", "parts": [{"label": "a", "tasks": {"use": "t" * 1001}}]},
    {"name": "x", "parts": [{"label": "a", "tasks": {"use": 1}}]},
    {"name": "x", "parts": [{"label": "a"}], "title": "t" * 201},
    {"name": "x", "parts": [{"label": f"p{i}"} for i in range(65)]},
    {"name": "x", "parts": [{"label": "a"}, {"label": "b"}],
     "topology": [["a", "b"]] * 2017},
    [], "name", None, 7,
])
def test_an_unusable_category_is_refused(contract, body):
    contract.call("postCategory", 400, body=json.dumps(body),
                  headers={"Content-Type": "application/json"})


def test_lists_are_paged(contract, world):
    for n in range(3):
        contract.call("postCategory", 201,
                      body={"name": f"page-{n}", "parts": [{"label": "a"}]})
    names, cursor = [], None
    while True:
        query = {"limit": 2, **({"cursor": cursor} if cursor else {})}
        page = contract.call("listCategories", 200, query=query)
        assert len(page["items"]) <= 2
        names += [item["name"] for item in page["items"]]
        cursor = page["next_cursor"]
        if cursor is None:
            break
    assert len(names) == len(set(names)) >= 4
    contract.call("queryGrasps", 400, query={"cursor": "nonsense"})


# ---- Objects -----------------------------------------------------------------


def test_objects(contract, world):
    stored = contract.call("postObject", 201, query={"name": "a box"}, body=BOX)
    path = {"id": stored["id"]}
    assert contract.last.headers["Location"] == f"/v1/objects/{stored['id']}"
    assert stored["bytes"] == len(BOX) and stored["segmentation"] is None
    box = stored["bounding_box"]
    assert box["min"] == [0, 0, 0]
    assert box["max"] == pytest.approx([0.05, 0.06, 0.07])
    assert stored["mass_properties"]["volume"] == pytest.approx(
        0.05 * 0.06 * 0.07)
    again = contract.call("postObject", 200, body=BOX)
    assert again["id"] == stored["id"]
    assert contract.call("getObject", 200, path=path) == stored
    listed = contract.call("listObjects", 200, query={"role": "novel"})["items"]
    assert stored["id"] in [item["id"] for item in listed]
    assert contract.call("getMesh", 200, path=path,
                         query={"format": "original"}) == BOX
    assert contract.call("listParts", 200, path=path)["items"] == []
    contract.call("getMesh", 404, path=path, query={"part": "handle"})
    contract.call("deleteObject", 204, path=path)
    for operation in ("getObject", "deleteObject", "getMesh", "listParts"):
        contract.call(operation, 404, path=path)
    contract.call("postSegmentation", 404, path=path, body={})
    contract.call("postGraspSpaces", 404, path=path, body={})


def test_units_scale_the_mesh(contract):
    stored = contract.call("postObject", 201, query={"units": "mm"},
                           body=meshes.box_stl(50, 60, 70))
    assert stored["bounding_box"]["max"] == pytest.approx([0.05, 0.06, 0.07])


@pytest.mark.parametrize("mesh_format,magic", [
    ("obj", b"v "), ("stl", None), ("ply", b"ply\n"), ("glb", b"glTF")])
def test_a_mesh_comes_back_in_each_format(contract, world, mesh_format, magic):
    example = world["example"]
    content = contract.call("getMesh", 200, path={"id": example["id"]},
                            query={"format": mesh_format})
    assert magic is None or magic in content[:200]
    if mesh_format == "stl":
        assert len(content) == 84 + 50 * example["triangles"]
    part = contract.call("getMesh", 200, path={"id": example["id"]},
                         query={"format": mesh_format, "part": "handle"})
    assert 0 < len(part) < len(content)


def test_a_point_cloud_becomes_a_solid(contract):
    rng = numpy.random.default_rng(1)
    ball = rng.normal(size=(1500, 3))
    ball *= 40 / numpy.linalg.norm(ball, axis=1)[:, None]
    text = "".join("{:.3f} {:.3f} {:.3f}\n".format(*p) for p in ball)
    stored = contract.call("postObject", 201, body=text.encode(),
                           query={"format": "xyz", "units": "mm"})
    assert stored["cloud"]["points"] == 1500
    assert not stored["cloud"]["one_sided"]
    assert stored["cloud"]["seen_share"] > 0.95
    volume = stored["mass_properties"]["volume"]
    assert volume == pytest.approx(4 / 3 * math.pi * 0.04**3, rel=0.1)
    same = contract.call("getObject", 200, path={"id": stored["id"]})
    assert same["cloud"] == stored["cloud"]
    few = contract.call("postObject", 422, body=text[:3000].encode(),
                        query={"format": "xyz", "units": "mm"})
    assert "200" in few["detail"]


def test_search_finds_the_most_similar_objects_first(contract, world):
    before = contract.call("listObjects", 200)["items"]
    found = contract.call("searchByShape", 200, body=world["novel_bytes"],
                          query={"role": "example"})["items"]
    assert found[0]["object"]["category"] == "mug"
    assert found[0]["similarity"] > 0.5
    likeness = [item["similarity"] for item in found]
    assert likeness == sorted(likeness, reverse=True)
    assert contract.call("listObjects", 200)["items"] == before
    example = contract.call("getMesh", 200, path={"id": world["example"]["id"]},
                            query={"format": "stl"})
    same = contract.call("searchByShape", 200, body=example,
                         query={"category": "mug", "limit": 1})["items"]
    assert [item["object"]["id"] for item in same] == [world["example"]["id"]]
    assert same[0]["similarity"] > 0.99
    contract.call("searchByShape", 400, body=example, query={"limit": 0})
    contract.call("searchByShape", 404, body=example, query={"category": "cup"})
    contract.call("searchByShape", 422, body=b"solid nothing\n")
    contract.call("searchByShape", 400)


def test_every_mesh_format_is_taken(contract, world):
    path = {"id": world["example"]["id"]}
    for name in ("obj", "stl", "ply", "glb"):
        content = contract.call("getMesh", 200, path=path,
                                query={"format": name})
        again = contract.call("postObject", (200, 201), body=content,
                              query={"format": name})
        assert again["triangles"] == world["example"]["triangles"]


def test_mesh_refuses_what_makes_no_sense(contract, world):
    path = {"id": world["example"]["id"]}
    contract.call("getMesh", 400, path=path,
                  query={"format": "original", "part": "body"})
    contract.call("getMesh", 400, path=path, query={"format": "fbx"})


def test_an_upload_may_be_a_form(contract):
    stored = contract.call(
        "postObject", 201, files={"mesh": ("form.obj", meshes.box_obj(
            0.04, 0.05, 0.06)), "name": (None, "of a form")})
    assert (stored["name"], stored["file_name"]) == ("of a form", "form.obj")
    contract.call("postObject", 400, files={"picture": ("a.png", b"x")})
    contract.call("postObject", 400, files={"name": (None, "no mesh")})
    contract.call("postObject", 400)


def test_parts(contract, world):
    example = world["example"]
    parts = contract.call("listParts", 200, path={"id": example["id"]})["items"]
    assert [part["label"] for part in parts] == ["body", "handle"]
    faces = [face for part in parts for face in part["faces"]]
    assert sorted(faces) == list(range(example["triangles"]))
    for part in parts:
        assert contract.call("getPart", 200, path={"id": part["id"]}) == part
    contract.call("getPart", 404, path={"id": UNKNOWN_HASH})
    contract.call("patchPart", 404, path={"id": UNKNOWN_HASH},
                  body={"label": "body"})


def test_segmentation_and_relabelling(contract, world):
    body = (ROOT / "data" / "mug" / "square.obj").read_bytes()
    stored = contract.call("postObject", 201, query={"category": "mug"},
                           body=body)
    assert stored["segmentation"]["method"] == "transfer"
    path = {"id": stored["id"]}
    again = contract.call("postSegmentation", 200, path=path,
                          body={"settings": {"pairwise_weight": 0.3}})
    assert again["id"] == stored["id"]
    contract.call("postSegmentation", 400, path=path,
                  body={"settings": {"pairwise_weight": "much"}})
    contract.call("postSegmentation", 400, path=path,
                  body={"face_labels": ["body"]})
    ranges = json.loads((ROOT / "data" / "mug" / "square.labels.json"
                         ).read_text())["faces"]
    labelled = contract.call("postSegmentation", 200, path=path,
                             body={"faces": ranges})
    assert labelled["segmentation"]["method"] == "labels"
    part = labelled["parts"][0]
    contract.call("patchPart", 400, path={"id": part["id"]},
                  body={"label": "lid"})
    contract.call("patchPart", 400, path={"id": part["id"]}, body={})
    changed = contract.call("patchPart", 200, path={"id": part["id"]},
                            body={"label": part["label"]})
    assert changed["id"] == stored["id"]


def test_an_example_that_grasps_depend_on_stays(contract, world, answer):
    problem = contract.call("deleteObject", 409,
                            path={"id": world["example"]["id"]})
    assert "cascade" in problem["hint"]
    contract.call("deleteGraspSpace", 409, path={"id": world["space"]["id"]})


# ---- Learning ----------------------------------------------------------------


def test_grasp_spaces(contract, world):
    space = world["space"]
    path = {"id": space["id"]}
    assert contract.call("getGraspSpace", 200, path=path) == space
    query = {"category": "mug", "part": "body", "hand": "barrett-bh8-280",
             "object": space["object"]}
    listed = contract.call("listGraspSpaces", 200, query=query)["items"]
    assert listed == [space]
    for name, value in (("category", "x"), ("hand", "x"),
                        ("object", UNKNOWN_UUID)):
        contract.call("listGraspSpaces", 404, query={name: value})
    unknown = {"id": UNKNOWN_HASH}
    contract.call("getGraspSpace", 404, path=unknown)
    contract.call("deleteGraspSpace", 404, path=unknown)


def test_nothing_is_learned_twice(contract, world):
    from conftest import QUICK
    spaces = contract.call(
        "postGraspSpaces", 200, path={"id": world["example"]["id"]},
        headers={"Prefer": "wait=150"},
        body={"parameters": QUICK, "parts": ["body"]})
    assert spaces["items"] == [world["space"]]


def test_a_grasp_space_can_be_deleted(contract, world):
    from conftest import QUICK
    path = {"id": world["example"]["id"]}
    spaces = contract.call(
        "postGraspSpaces", 200, path=path, headers={"Prefer": "wait=150"},
        body={"parameters": QUICK, "parts": ["body"], "seed": 5})["items"]
    fresh = [s for s in spaces if s["id"] != world["space"]["id"]]
    assert [s["provenance"]["seed"] for s in fresh] == [5]
    contract.call("deleteGraspSpace", 204, path={"id": fresh[0]["id"]})
    contract.call("getGraspSpace", 404, path={"id": fresh[0]["id"]})


@pytest.mark.parametrize("body", [
    {"parts": ["lid"]}, {"hands": ["shadow"]}, {"parts": "body"},
    {"parameters": {"swarm": {"particles": 0}}}, {"seed": -1}, {"seed": 1.5},
    {"parameters": {"preset": "best"}}, {"unknown": 1}])
def test_an_unusable_learning_order_is_refused(contract, world, body):
    problem = contract.call("postGraspSpaces", (400, 404),
                            path={"id": world["example"]["id"]}, body=body)
    assert problem["detail"]


# ---- Grasps ------------------------------------------------------------------


def test_grasps_come_back_best_first(contract, world, answer):
    assert answer["example"]["id"] == world["example"]["id"]
    assert answer["summary"]["attempted"] == 4
    assert len(answer["grasps"]) + len(answer["rejected"]) == 4
    # Nothing has been simulated yet: by grip, then eps.
    merits = [
        g["quality"]["grip"] + 0.03 * g["quality"]["epsilon"]
        for g in answer["grasps"]
    ]
    assert merits == sorted(merits, reverse=True)
    for grasp in answer["grasps"]:
        assert grasp["part"] == "body" and len(grasp["joints"]) == 8
        assert grasp["stage"] == "assembly"
        q = grasp["X_OH"]["orientation"]
        assert sum(q[k] ** 2 for k in "xyzw") == pytest.approx(1, abs=1e-9)


def test_the_same_request_gives_the_same_bytes(contract, world, answer):
    contract.call("postGrasps", 200, query=transfer_query(),
                  body=world["novel_bytes"])
    first = contract.last.content
    contract.call("postGrasps", 200, query=transfer_query(),
                  body=world["novel_bytes"])
    assert contract.last.content == first
    form = {k: (None, str(v)) for k, v in transfer_query().items()}
    contract.call("postGrasps", 200, files={
        **form, "mesh": ("m.obj", world["novel_bytes"])})
    assert contract.last.content == first


def test_a_stored_object_may_be_asked_for_again(contract, answer):
    query = transfer_query(object=answer["object"]["id"], count=1)
    del query["category"]
    again = contract.call("postGrasps", 200, query=query)
    assert again["transfer_id"] == answer["transfer_id"]
    assert again["grasps"] == answer["grasps"][:1]


def test_stored_grasps_can_be_queried(contract, world, answer):
    learned = contract.call("queryGrasps", 200, query={
        "category": "mug", "part": "body", "stage": "learned", "limit": 5,
        "hand": "barrett-bh8-280", "grasp_space": world["space"]["id"],
        "min_epsilon": 0.001, "sort": "epsilon"})
    assert 0 < len(learned["items"]) <= 5
    epsilons = [g["quality"]["epsilon"] for g in learned["items"]]
    assert epsilons == sorted(epsilons, reverse=True)
    one = contract.call("getGrasp", 200, path={"id": learned["items"][0]["id"]})
    assert one == learned["items"][0]
    transferred = contract.call("queryGrasps", 200, query={
        "transfer": answer["transfer_id"], "stage": "assembly"})
    assert ({g["id"] for g in transferred["items"]} ==
            {g["id"] for g in answer["grasps"]})
    for sort in ("hybrid", "robust", "newest"):
        contract.call("queryGrasps", 200, query={"sort": sort, "limit": 3})
    by_task = contract.call("queryGrasps", 200, query={
        "category": "mug", "task": "handover"})
    assert by_task["items"] == []  # Nothing was learned on the handle.
    for name, value in (("category", "x"), ("hand", "x"), ("part", "lid"),
                        ("object", UNKNOWN_UUID), ("task", "juggle")):
        contract.call("queryGrasps", 404,
                      query={"category": "mug", name: value})


def test_what_the_simulator_found_is_kept_and_can_be_asked_for(
        contract, world, binary, server):
    learned = {"object": world["example"]["id"], "stage": "learned"}
    best = contract.call("queryGrasps", 200, query={**learned, "limit": 2})
    assert [g["quality"]["physical"] for g in best["items"]] == [None, None]
    told = json.loads(subprocess.run(
        [binary, "verify", "--db", server.database, "--stage", "learned",
         "--object", world["example"]["id"], "--limit", "2", "--json"],
        check=True, capture_output=True, timeout=120).stdout)
    assert told["simulator"].startswith("MuJoCo")
    found = {g["id"]: g["physical"] for g in told["grasps"]}
    assert set(found) == {g["id"] for g in best["items"]}
    for grasp_id, physical in found.items():
        grasp = contract.call("getGrasp", 200, path={"id": grasp_id})
        assert grasp["quality"]["physical"] == physical
    held = contract.call("queryGrasps", 200,
                         query={**learned, "verified": "physical"})
    assert ({g["id"] for g in held["items"]} ==
            {grasp_id for grasp_id, value in found.items() if value == 1})


def test_pages_of_grasps_join_to_the_whole(contract, world):
    query = {"grasp_space": world["space"]["id"], "stage": "learned"}
    whole = contract.call("queryGrasps", 200, query={**query, "limit": 1000})
    joined, cursor = [], None
    while True:
        page = contract.call("queryGrasps", 200, query={
            **query, "limit": 7, **({"cursor": cursor} if cursor else {})})
        joined += page["items"]
        cursor = page["next_cursor"]
        if cursor is None:
            break
    assert joined == whole["items"]
    assert len(joined) == world["space"]["grasps"]


def test_grasps_in_other_formats(contract, world, answer):
    query = {"grasp_space": world["space"]["id"], "limit": 2}
    rows = contract.call("queryGrasps", 200, query={**query, "as": "csv"})
    lines = rows.decode().split("\r\n")
    assert lines[0].startswith("id,object,part,hand") and len(lines) == 4
    assert len(lines[0].split(",")) == len(lines[1].split(",")) == 17 + 8
    ros = contract.call("queryGrasps", 200, query={**query, "as": "ros"})
    assert len(ros) == 2 and len(ros[0]["grasp_posture"]["joint_names"]) == 8
    xml = contract.call("queryGrasps", 200, query={**query, "as": "graspit"})
    robots = ElementTree.fromstring(xml).findall("robot")
    assert len(robots) == 2
    assert len(robots[0].findtext("dofValues").split()) >= 1 + 3 * 3
    path = {"id": lines[1].split(",")[0]}
    contract.call("getGrasp", 200, path=path, query={"as": "csv"})
    contract.call("getGrasp", 200, path=path, query={"as": "ros"})
    contract.call("getGrasp", 200, path=path, query={"as": "graspit"})
    for as_format in ("csv", "ros", "graspit"):
        contract.call("postGrasps", 200,
                      query=transfer_query(**{"as": as_format}),
                      body=world["novel_bytes"])


def test_a_grasp_can_be_drawn(contract, world):
    grasp = contract.call("queryGrasps", 200, query={
        "grasp_space": world["space"]["id"], "limit": 1})["items"][0]
    path = {"id": grasp["id"]}
    png = contract.call("drawGrasp", 200, path=path,
                        query={"width": 160, "height": 120})
    assert png.startswith(b"\x89PNG\r\n\x1a\n")
    contract.call("drawGrasp", 200, path=path, query={
        "width": 64, "height": 64, "azimuth": 1.0, "elevation": 0.2})
    contract.call("drawGrasp", 400, path=path, query={"width": 1})
    contract.call("drawGrasp", 404, path={"id": UNKNOWN_HASH})
    contract.call("getGrasp", 404, path={"id": UNKNOWN_HASH})


def test_a_transfer_tells_its_whole_story(contract, answer):
    transfer = contract.call("getTransfer", 200,
                             path={"id": answer["transfer_id"]})
    assert len(transfer["attempts"]) == 4
    assert transfer["summary"] == answer["summary"]
    query = {"object": answer["object"]["id"], "category": "mug", "limit": 1}
    listed = contract.call("listTransfers", 200, query=query)
    ids = []
    while True:
        for item in listed["items"]:
            ids.append(item["id"])
            if item["id"] == transfer["id"]:
                assert item == {key: transfer[key] for key in item}
        if not listed["next_cursor"]:
            break
        listed = contract.call("listTransfers", 200, query={
            **query, "cursor": listed["next_cursor"]})
    assert len(ids) == len(set(ids)) and transfer["id"] in ids
    contract.call("listTransfers", 404, query={"object": UNKNOWN_UUID})
    contract.call("listTransfers", 400, query={"cursor": "1x"})
    contract.call("getTransfer", 404, path={"id": UNKNOWN_HASH})


def test_other_choices_of_a_transfer(contract, world):
    learned_at = contract.call("postGrasps", 200, body=world["novel_bytes"],
                               query=transfer_query(stage="transfer",
                                                    friction=0.8, count=2))
    assert len(learned_at["grasps"]) <= 2
    assert learned_at["summary"]["assembled"] is None
    contract.call("postGrasps", 200, body=world["novel_bytes"],
                  query=transfer_query(
                      category="auto",
                      parameters='{"replan":{"iterations":50}}'))


# ---- Jobs --------------------------------------------------------------------


def wait_for(contract, job_id, *states):
    deadline = time.monotonic() + patient(120)
    while time.monotonic() < deadline:
        job = contract.call("getJob", 200, path={"id": job_id})
        if job["state"] in states:
            return job
        time.sleep(0.1)
    raise AssertionError(f"still {job['state']}")


def test_a_job_can_be_polled(contract, world):
    job = contract.call("postGrasps", 202, query=transfer_query(seed=11),
                        body=world["novel_bytes"],
                        headers={"Prefer": "respond-async"})
    assert contract.last.headers["Location"] == f"/v1/jobs/{job['id']}"
    done = wait_for(contract, job["id"], "succeeded", "failed")
    assert done["state"] == "succeeded", done
    assert done["progress"] == 1
    contract.call("getTransfer", 200,
                  path={"id": done["result"]["transfer"]})
    listed = contract.call("listJobs", 200, query={"state": "succeeded"})
    assert job["id"] in [item["id"] for item in listed["items"]]
    stays = contract.call("cancelJob", 200, path={"id": job["id"]})
    assert stays["state"] == "succeeded"
    contract.call("getJob", 404, path={"id": UNKNOWN_UUID})
    contract.call("cancelJob", 404, path={"id": UNKNOWN_UUID})
    contract.call("listJobs", 400, query={"state": "lost"})


def back_up(binary, server, folder):
    """A copy of the server's database."""
    copy = folder / "copy.db"
    subprocess.run([binary, "backup", str(copy), "--db", str(server.database)],
                   check=True, stdout=subprocess.DEVNULL)
    return copy


def read_events(stream):
    """The (id, event, data) of a text/event-stream, comments left out."""
    events = []
    for block in stream.decode().split("\n\n"):
        fields = dict(line.split(": ", 1) for line in block.split("\n")
                      if line and not line.startswith(":"))
        if fields:
            events.append((fields["id"], fields["event"],
                           json.loads(fields["data"])))
    return events


def grasps_of(events):
    return {data["id"]: data for _, event, data in events if event == "grasp"}


def test_a_job_tells_of_itself_and_of_each_grasp(contract, world):
    job = contract.call("postGrasps", 202, query=transfer_query(seed=14),
                        body=world["novel_bytes"],
                        headers={"Prefer": "respond-async"})
    path = {"id": job["id"]}
    events = read_events(contract.call("streamJob", 200, path=path))
    jobs = [data for _, event, data in events if event == "job"]
    for data in jobs:
        contract.validate(data, {"$ref": "#/components/schemas/Job"})
    assert jobs[-1]["state"] == "succeeded"
    progress = [data["progress"] for data in jobs]
    assert progress == sorted(progress)
    # The grasps told early are those that were stored, word for word.
    told = grasps_of(events)
    stored = contract.call("queryGrasps", 200, query={
        "transfer": jobs[-1]["result"]["transfer"], "stage": "assembly"})
    assert told == {grasp["id"]: grasp for grasp in stored["items"]}
    assert told

    # Who comes late gets them all, and nobody waits for a job that has ended.
    assert grasps_of(read_events(
        contract.call("streamJob", 200, path=path))) == told
    contract.call("streamJob", 200, path=path,
                  headers={"Last-Event-ID": "nonsense"})
    contract.call("streamJob", 404, path={"id": UNKNOWN_UUID})


def test_who_returns_with_the_last_event_id_gets_what_is_new(contract, world):
    job = contract.call("postGrasps", 202,
                        query=transfer_query(seed=15, sources=12),
                        body=world["novel_bytes"],
                        headers={"Prefer": "respond-async"})
    url = f"{contract.base_url}/v1/jobs/{job['id']}/events"
    with requests.get(url, stream=True, timeout=120) as answer:
        first = b""
        for piece in answer.iter_content(chunk_size=None):
            first += piece
            if b"event: grasp" in first and first.endswith(b"\n\n"):
                break
    seen = read_events(first)
    with requests.get(url, stream=True, timeout=120,
                      headers={"Last-Event-ID": seen[-1][0]}) as answer:
        piece = next(answer.iter_content(chunk_size=None))
    resumed = read_events(piece)
    if resumed[-1][2]["state"] == "running":
        assert not set(grasps_of(resumed)) & set(grasps_of(seen))
    wait_for(contract, job["id"], "succeeded")


def test_event_streams_never_take_all_threads(binary, contract, world, server,
                                              tmp_path):
    database = back_up(binary, server, tmp_path)
    live = LiveServer(binary, database, tmp_path, "--http-threads", "4")
    job = requests.post(
        f"{live.url}/v1/objects/{world['example']['id']}/grasp-spaces",
        json={"parts": ["handle"]}, timeout=20).json()
    url = f"{live.url}/v1/jobs/{job['id']}/events"
    streams = [requests.get(url, stream=True, timeout=20) for _ in range(3)]
    assert [stream.status_code for stream in streams] == [200, 200, 503]
    assert streams[2].json()["code"] == "overloaded"
    assert streams[2].headers["Retry-After"]
    assert requests.get(f"{live.url}/healthz", timeout=5).ok
    # A place is free again once its client has gone.
    streams[0].close()
    deadline = time.monotonic() + 30
    while requests.get(url, stream=True, timeout=20).status_code != 200:
        assert time.monotonic() < deadline
        time.sleep(0.2)
    # SIGTERM ends streams.
    assert live.stop() == 0, live.log()


def test_waiting_requests_never_take_all_threads(binary, world, server, tmp_path):
    database = back_up(binary, server, tmp_path)
    live = LiveServer(binary, database, tmp_path, "--http-threads", "4")
    url = f"{live.url}/v1/objects/{world['example']['id']}/grasp-spaces"

    def learn(seed):
        return requests.post(url, json={"parts": ["handle"], "seed": seed}, timeout=120,
                             headers={"Prefer": "wait=100"})

    def count_unfinished():
        jobs = requests.get(f"{live.url}/v1/jobs", params={"limit": 1000},
                            timeout=5).json()["items"]
        return sum(job["state"] in ("queued", "running") for job in jobs)

    # The first two wait, as half of the threads may; the next ones get their job.
    assert count_unfinished() == 0
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        waiting = [pool.submit(learn, seed) for seed in (1, 2)]
        deadline = time.monotonic() + 30
        while count_unfinished() < 2:
            assert time.monotonic() < deadline
            time.sleep(0.1)
        for seed in (3, 4, 5):
            assert learn(seed).status_code == 202
            assert requests.get(f"{live.url}/healthz", timeout=5).ok
        assert not any(one.done() for one in waiting)
        # SIGTERM ends their waiting.
        assert live.stop() == 0, live.log()
        assert [one.result().status_code for one in waiting] == [202, 202]


def test_a_full_queue_is_a_503(binary, contract, world, server, tmp_path):
    database = back_up(binary, server, tmp_path)
    live = LiveServer(binary, database, tmp_path, "--max-queued-jobs", "2")
    url = f"{live.url}/v1/objects/{world['example']['id']}/grasp-spaces"
    answers = [requests.post(url, json={"parts": ["handle"], "seed": seed},
                             timeout=20) for seed in range(1, 6)]
    codes = [answer.status_code for answer in answers]
    assert codes[:2] == [202, 202] and codes[-1] == 503, codes
    assert answers[-1].json()["code"] == "overloaded"
    assert answers[-1].headers["Retry-After"]
    assert live.stop() == 0, live.log()


# So long that no machine ends it, though a look at one grasp ends soon.
ENDLESS = json.dumps({"replan": {"grip_copies": 200, "climb_samples": 1000000}})


def test_a_deadline_cuts_a_transfer_which_says_so(contract, world, answer):
    query = transfer_query(seed=16, sources=40, deadline=patient(10), parameters=ENDLESS)
    cut = contract.call("postGrasps", 200, query=query, body=world["novel_bytes"])
    assert cut["complete"] is False and cut["grasps"]
    assert any("deadline" in warning for warning in cut["warnings"])
    stored = contract.call("getTransfer", 200, path={"id": cut["transfer_id"]})
    assert stored["complete"] is False
    again = contract.call("postGrasps", 200, query=query, body=world["novel_bytes"])
    # Of the same inputs only the one with the most grasps stays.
    kept = contract.call("listTransfers", 200, query={"object": cut["object"]["id"]})["items"]
    assert [t["id"] for t in kept if not t["complete"]] == [again["transfer_id"]]


def test_other_jobs_fail_at_their_deadline(contract, world):
    problem = contract.call(
        "postGraspSpaces", 503, path={"id": world["example"]["id"]},
        query={"deadline": 0.2}, body={"parts": ["handle"], "seed": 9},
        headers={"Prefer": "wait=60"})
    assert problem["code"] == "deadline_exceeded"
    job = contract.call("listJobs", 200, query={"state": "failed"})["items"][0]
    assert job["error"]["code"] == "deadline_exceeded"
    assert job["deadline_at"] <= job["finished_at"]
    for deadline in ("0", "soon", "1e9"):
        contract.call("postGraspSpaces", 400, path={"id": world["example"]["id"]},
                      query={"deadline": deadline}, body={})


def test_segmenting_again_can_be_left_to_a_job(contract, world):
    stored = contract.call("postObject", (200, 201), query={"category": "mug"},
                           body=(ROOT / "data" / "mug" / "bowl.obj").read_bytes())
    job = contract.call("postSegmentation", 202, path={"id": stored["id"]}, body={},
                        headers={"Prefer": "respond-async"})
    done = wait_for(contract, job["id"], "succeeded")
    assert done["kind"] == "segment"
    assert done["result"]["object"] == stored["id"]
    contract.call("postSegmentation", 404, path={"id": UNKNOWN_UUID}, body={},
                  headers={"Prefer": "respond-async"})


def test_a_simulator_judges_stored_grasps(contract, world, answer):
    wanted = {"transfer": answer["transfer_id"], "stage": "assembly"}
    judged = contract.call("postVerification", 200, body=wanted,
                           headers={"Prefer": "wait=150"})["items"]
    verdicts = [grasp["quality"]["physical"] for grasp in judged]
    assert verdicts and None not in verdicts, verdicts
    held = contract.call("queryGrasps", 200, query={
        "transfer": answer["transfer_id"], "verified": "physical"})["items"]
    assert len(held) == verdicts.count(1.0)
    job = contract.call("postVerification", 202, body=wanted | {"parts": ["body"]},
                        headers={"Prefer": "respond-async"})
    done = wait_for(contract, job["id"], "succeeded")
    assert done["kind"] == "verify"
    listed = requests.get(contract.base_url + done["result"]["href"], timeout=20).json()
    assert {g["provenance"]["transfer"] for g in listed["items"]} == {answer["transfer_id"]}


@pytest.mark.parametrize("body, status", [
    ({"category": "spoon"}, 404), ({"transfer": UNKNOWN_HASH}, 404),
    ({"category": "mug", "parts": ["lid"]}, 404), ({"stage": "held"}, 400),
    ({"limit": 0}, 400), ({"parts": ["body"] * 65}, 400), ({"unknown": 1}, 400)])
def test_an_unusable_verification_order_is_refused(contract, world, body, status):
    contract.call("postVerification", status, body=body)


def test_a_running_job_can_be_cancelled(contract, world):
    job = contract.call("postGraspSpaces", 202,
                        path={"id": world["example"]["id"]},
                        body={"parts": ["handle"]})
    cancelled = contract.call("cancelJob", 200, path={"id": job["id"]})
    assert cancelled["state"] in ("running", "cancelled")
    wait_for(contract, job["id"], "cancelled")


def test_a_retry_under_a_key_has_no_second_effect(contract, world):
    headers = {"Idempotency-Key": "key-1", "Prefer": "respond-async"}
    query = transfer_query(seed=12)
    first = contract.call("postGrasps", 202, query=query, headers=headers,
                          body=world["novel_bytes"])
    again = contract.call("postGrasps", (200, 202), query=query,
                          headers=headers, body=world["novel_bytes"])
    assert again.get("id", first["id"]) == first["id"]
    contract.call("postGrasps", 422, query=transfer_query(seed=13),
                  headers=headers, body=world["novel_bytes"])
    key = {"Idempotency-Key": "key-2"}
    category = {"name": "once", "parts": [{"label": "a"}]}
    contract.call("postCategory", 201, body=category, headers=key)
    contract.call("postCategory", 201, body=category, headers=key)
    assert contract.last.headers["Idempotent-Replayed"] == "true"
    contract.call("postCategory", 422, body={**category, "name": "twice"},
                  headers=key)
    contract.call("postCategory", 400, body=category,
                  headers={"Idempotency-Key": "k" * 256})


# ---- Bad input ---------------------------------------------------------------


@pytest.mark.parametrize("name,content,mesh_format", [
    pytest.param(*row, id=row[0]) for row in meshes.unusable()])
def test_unusable_bytes_are_a_422_and_nothing_is_stored(
        contract, world, name, content, mesh_format):
    before = contract.call("getReadiness", 200)["counts"]
    # A header that lies about its counts may exceed a limit first.
    statuses = (413, 422) if "lies" in name else 422
    problem = contract.call("postObject", statuses, body=content,
                            query={"format": mesh_format})
    assert problem["detail"]
    contract.call("postGrasps", statuses, body=content,
                  query={"category": "mug", "format": mesh_format})
    after = contract.call("getReadiness", 200)["counts"]
    assert after["objects"] == before["objects"]


def test_an_empty_file_is_a_422(contract, world):
    contract.call("postObject", 422, files={"mesh": ("empty.obj", b"")})
    contract.call("postGrasps", 422, query={"category": "mug"},
                  files={"mesh": ("empty.obj", b"")})


def test_a_size_that_no_hand_can_grasp_names_the_unit(contract):
    problem = contract.call("postObject", 422, body=meshes.box_obj(50, 60, 70))
    assert "mm" in problem["hint"]


def test_too_large_a_body_is_a_413_naming_the_limit(contract):
    for operation in ("postObject", "postGrasps"):
        problem = contract.call(operation, 413, body=b"#" * (65 << 20))
        assert str(64 << 20) in problem["detail"]


def test_too_many_triangles_are_a_413(contract):
    vertices, faces = meshes.grid_box(0.1, 0.1, 0.1, 190)  # 433,200 faces.
    problem = contract.call("postObject", 413, body=meshes.obj(vertices, faces))
    assert "triangles" in problem["detail"]


@pytest.mark.parametrize("change,field", [
    ({"count": "0"}, "count"), ({"count": "many"}, "count"),
    ({"count": "1001"}, "count"), ({"friction": "-1"}, "friction"),
    ({"friction": "nan"}, "friction"), ({"units": "furlong"}, "units"),
    ({"format": "docx"}, "format"), ({"sources": "0"}, "sources"),
    ({"seed": "-1"}, "seed"), ({"stage": "learned"}, "stage"),
    ({"as": "xml"}, "as"), ({"colour": "red"}, "colour"),
    ({"task": "use"}, "task"), ({"parameters": "{"}, None),
    ({"parameters": '{"replan":{"iterations":-1}}'}, None),
    ({"category": ["mug", "mug"]}, "category"), ({"category": ""}, "category"),
])
def test_an_unusable_parameter_is_a_400_that_names_it(
        contract, world, change, field):
    problem = contract.call("postGrasps", 400, query=transfer_query(**change),
                            body=world["novel_bytes"])
    assert field is None or problem["field"] == field
    assert problem["detail"]


def test_a_mesh_and_a_category_are_required(contract, world):
    problem = contract.call("postGrasps", 400, query={"category": "mug"})
    assert problem["field"] == "mesh"
    problem = contract.call("postGrasps", 400, body=world["novel_bytes"])
    assert problem["field"] == "category"
    contract.call("postGrasps", 400, body=world["novel_bytes"],
                  query=transfer_query(object=world["example"]["id"]))


@pytest.mark.parametrize("change,known", [
    ({"category": "teapot"}, "mug"), ({"hand": "shadow"}, "barrett-bh8-280"),
    ({"part": "lid"}, "handle"), ({"part": None, "task": "juggle"}, "use")])
def test_an_unknown_name_is_a_404_with_the_known_ones(
        contract, world, change, known):
    query = {k: v for k, v in transfer_query(**change).items()
             if v is not None}
    problem = contract.call("postGrasps", 404, query=query,
                            body=world["novel_bytes"])
    assert known in problem["hint"]


def test_an_unknown_object_is_a_404(contract):
    contract.call("postGrasps", 404, query={"object": UNKNOWN_UUID})
    contract.call("postExample", 404, path={"name": "teapot"}, body=BOX)
    contract.call("postObject", 404, query={"category": "teapot"}, body=BOX)
    contract.call("listObjects", 404, query={"category": "teapot"})


def test_a_category_without_learned_grasps_is_a_409_with_the_command(
        contract, world):
    contract.call("postCategory", 201,
                  body={"name": "bare", "parts": [{"label": "body"}]})
    problem = contract.call("postGrasps", 409, query={"category": "bare"},
                            body=BOX)
    assert "graspdb" in problem["hint"]
    problem = contract.call("postGrasps", 409, body=world["novel_bytes"],
                            query=transfer_query(part="handle"))
    assert "learn" in problem["hint"]


def test_a_mesh_that_references_files_opens_none(contract):
    content = b"mtllib /etc/passwd\nusemtl x\n" + meshes.box_obj(
        0.03, 0.04, 0.05)
    contract.call("postObject", 201, body=content)


def test_labels_of_an_example_are_checked(contract, world):
    for labels in (b"{", b"{}", b'{"face_labels":["body"]}',
                   b'{"face_labels":["lid","lid"]}', b"\xff"):
        answer = contract.call(
            "postExample", (202, 400, 422), path={"name": "mug"},
            files={"mesh": ("b.obj", BOX), "labels": ("l.json", labels)},
            query={"learn": "false"}, headers={"Prefer": "wait=150"})
        assert contract.last.status_code != 202, answer


HOSTILE = {
    "empty": b"", "not JSON": b"hello", "open": b'{"a":', "trailing": b"{} {}",
    "deep 65": b"[" * 65 + b"]" * 65, "deep 1e6": b"[" * 1000000,
    "deep objects": b'{"a":' * 100000, "huge number": b'{"seed":1e400}',
    "NaN": b'{"seed":NaN}', "duplicate": b'{"name":"a","name":"b"}',
    "bad UTF-8": b'{"name":"\xff\xfe"}', "lone surrogate": b'{"name":"\\ud800"}',
    "NUL": b'{"name":"a"}\0', "comment": b"/* */{}", "UTF-16": "{}".encode("utf-16"),
    "wide integer": b'{"seed":123456789012345678901234567890}',
}
JSON_OPERATIONS = [("postCategory", {}), ("patchCategory", {"name": "mug"}),
                   ("postSegmentation", "example"),
                   ("postGraspSpaces", "example"), ("patchPart", "part"),
                   ("postVerification", {})]
BODY_IS_OPTIONAL = ("postSegmentation", "postGraspSpaces", "postVerification")
HOSTILE_CASES = [(operation, path, name) for operation, path in JSON_OPERATIONS
                 for name in HOSTILE
                 if name != "empty" or operation not in BODY_IS_OPTIONAL]


@pytest.mark.parametrize("operation,path,name", HOSTILE_CASES,
                         ids=[f"{row[2]}-{row[0]}" for row in HOSTILE_CASES])
def test_hostile_json_is_a_400(contract, world, operation, path, name):
    example = world["example"]
    path = {"example": {"id": example["id"]},
            "part": {"id": example["parts"][0]["id"]}}.get(str(path), path)
    problem = contract.call(operation, 400, path=path, body=HOSTILE[name],
                            headers={"Content-Type": "application/json"})
    assert len(problem["detail"]) < 500


def test_other_content_types_and_codings_are_a_415(contract, world):
    contract.call("postCategory", 415, body="a=b", headers={
        "Content-Type": "application/x-www-form-urlencoded"})
    contract.call("postObject", 415, body=gzip.compress(BOX),
                  headers={"Content-Encoding": "gzip"})


def test_every_operation_refuses_an_unknown_parameter(contract, world):
    values = {"id": UNKNOWN_UUID, "name": "x", "file": "x"}
    for operation_id, method, path, operation, _ in operations(contract.spec):
        if path == "/":  # The page reads its own query.
            continue
        url = path.format(**values)
        reply = contract.session.request(
            method, contract.base_url + url, params={"no-such-thing": "1"},
            headers={"Content-Type": "application/json"}, data=b"{}"
            if "requestBody" in operation else None)
        problem = contract.check(operation_id, operation, reply)
        assert reply.status_code == 400, operation_id
        assert problem["field"] == "no-such-thing"


def test_other_methods_are_a_405_and_other_paths_a_404(contract):
    paths = {}
    for _, method, path, _, _ in operations(contract.spec):
        paths.setdefault(path, set()).add(method.upper())
    for path, methods in paths.items():
        url = contract.base_url + path.replace("{", "").replace("}", "")
        for method in {"GET", "POST", "PUT", "PATCH", "DELETE"} - methods:
            reply = contract.session.request(method, url)
            assert reply.status_code == 405, (method, path)
            assert set(reply.headers["Allow"].split(", ")) == methods
            contract.validate(reply.json(),
                              {"$ref": "#/components/schemas/Problem"})
    for path in ("/v2", "/v1", "/v1/grasps/", "//", "/v1/../etc/passwd",
                 "/v1/objects/%2e%2e/mesh/x"):
        reply = contract.session.get(contract.base_url + path)
        assert reply.status_code == 404, path
        contract.validate(reply.json(),
                          {"$ref": "#/components/schemas/Problem"})


@pytest.mark.parametrize("name", [
    "x" * 2000, "..", "../../etc/passwd", "'; DROP TABLE objects; --", "%00x",
    "a/b", "\u00fc", "-1", " ", "{id}"], ids=ascii)
def test_a_strange_name_in_the_path_is_a_404(contract, name):
    for operation_id, method, path, operation, item in operations(
            contract.spec):
        if "{" not in path or method != "get":
            continue
        if operation_id == "getViewerFile" and name == "..":
            continue  # A client makes / of it, which is a page.
        parameter = path[path.index("{") + 1:path.index("}")]
        contract.call(operation_id, 404, path={parameter: name})


def test_a_backup_is_a_database_that_can_be_served(
        binary, contract, server, world, tmp_path):
    assert contract.call("listBackups", 200)["items"] == []
    made = contract.call("postBackup", 201,
                         headers={"Idempotency-Key": "backup-1"})
    again = contract.call("postBackup", 201,
                          headers={"Idempotency-Key": "backup-1"})
    assert contract.call("listBackups", 200)["items"] == [made] == [again]
    file = pathlib.Path(f"{server.database}.backups") / made["name"]
    content = file.read_bytes()
    assert len(content) == made["bytes"]
    assert hashlib.sha256(content).hexdigest() == made["sha256"]
    copy = tmp_path / "restored.db"
    copy.write_bytes(content)
    restored = LiveServer(binary, copy, tmp_path)
    path = f"/v1/objects/{world['example']['id']}"
    assert (requests.get(restored.url + path, timeout=20).json() ==
            requests.get(contract.base_url + path, timeout=20).json())
    assert restored.stop() == 0, restored.log()
    subprocess.run([binary, "check", "--db", str(copy)], check=True,
                   stdout=subprocess.DEVNULL)


def test_the_command_line_backs_up_a_database_in_use(binary, server, contract,
                                                     tmp_path):
    copy = tmp_path / "copy.db"
    command = [binary, "backup", str(copy), "--db", str(server.database),
               "--json"]
    told = json.loads(subprocess.run(command, check=True,
                                     capture_output=True).stdout)
    content = copy.read_bytes()
    assert hashlib.sha256(content).hexdigest() == told["sha256"]
    assert len(content) == told["bytes"]
    second = subprocess.run(command, capture_output=True)
    assert second.returncode == 2 and b"exists already" in second.stderr
    assert copy.read_bytes() == content


@pytest.mark.parametrize("bytes_sent,status", [
    (b"GET / HTTP/1.1\r\n\r\n", b"400"),
    (b"GET /\0 HTTP/1.1\r\nHost: localhost\r\n\r\n", b"400"),
    (b"GET / HTTP/1.1\r\nHost: localhost\r\nX: " + b"a" * 9000 + b"\r\n\r\n", b"431"),
    (b"GET /" + b"a" * 9000 + b" HTTP/1.1\r\nHost: localhost\r\n\r\n", b"414"),
    (b"GET / HTTP/1.1\r\nHost: localhost\r\n" + b"X: 1\r\n" * 200 + b"\r\n", b"431"),
    (b"POST /v1/grasps HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1\r\n"
     b"Transfer-Encoding: chunked\r\n\r\n0\r\n\r\n", b"400"),
    (b"POST /v1/grasps HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1\r\n"
     b"Content-Length: 2\r\n\r\nab", b"400"),
    (b"POST /v1/grasps?category=mug HTTP/1.1\r\nHost: localhost\r\n"
     b"Transfer-Encoding: chunked\r\n\r\nzz\r\n", b"400"),
    (b"GET /healthz HTTP/1.1\r\nHost: localhost\r\nRange: bytes=" +
     b"0-," * 700 + b"0-\r\n\r\n", b"200"),
], ids=["no host", "NUL", "long field", "long target", "many fields",
        "length and chunked", "two lengths", "broken chunk", "many ranges"])
def test_broken_messages_get_one_answer(server, bytes_sent, status):
    with socket.create_connection(("127.0.0.1", server.port), 20) as client:
        client.sendall(bytes_sent)
        client.shutdown(socket.SHUT_WR)
        received = b""
        while chunk := client.recv(65536):
            received += chunk
    assert received.startswith(b"HTTP/1.1 " + status)
    assert received.count(b"HTTP/1.1 ") == 1


# ---- The end -----------------------------------------------------------------


def test_sigterm_lets_a_waiting_request_end(binary, server, contract, world,
                                            tmp_path):
    """On a second server with a copy of the database."""
    database = back_up(binary, server, tmp_path)
    second = LiveServer(binary, database, tmp_path)
    replies = []
    client = threading.Thread(target=lambda: replies.append(requests.post(
        f"{second.url}/v1/objects/{world['example']['id']}/grasp-spaces",
        json={"parts": ["handle"], "seed": 99},
        headers={"Prefer": "wait=100"}, timeout=120)))
    client.start()
    time.sleep(1.0)
    assert second.stop() == 0
    client.join()
    assert replies[0].status_code == 202
    contract.validate(replies[0].json(), {"$ref": "#/components/schemas/Job"})


def test_zz_every_operation_was_called(contract):
    """Last: the contract has no operation that these tests leave out."""
    called = set(contract.seen)
    assert called == set(contract.by_id)
    without_success = {
        operation_id for operation_id, seen in contract.seen.items()
        if not any(200 <= status < 300 for status in seen)}
    assert not without_success
