"""A database that the first release wrote (tests/storage/make_database_fixture.py)
is opened by today's server with all that it holds."""

import contextlib
import shutil
import sqlite3
import subprocess

import pytest

import meshes
from contract_client import ROOT, Contract
from live_server import LiveServer

FIXTURE = ROOT / "tests" / "storage" / "first_release.db"


def rows(database, sql, how="mode=ro"):
    with contextlib.closing(sqlite3.connect(f"file:{database}?{how}", uri=True)) as db:
        return db.execute(sql).fetchall()


def rows_before(sql):
    """Of the fixture, with no file made beside it."""
    return rows(FIXTURE, sql, "immutable=1")


@pytest.fixture(scope="module")
def database(tmp_path_factory):
    path = tmp_path_factory.mktemp("first") / "a.db"
    shutil.copyfile(FIXTURE, path)
    return path


@pytest.fixture(scope="module")
def migrated(binary, database):
    assert rows(database, "PRAGMA user_version") == [(1,)]
    live = LiveServer(binary, database, database.parent)
    yield Contract(live.url)
    assert live.stop() == 0, live.log()
    assert "event=internal" not in live.log(), live.log()


def test_it_has_all_grasps_as_they_were(migrated):
    before = dict(rows_before("SELECT id, epsilon FROM grasps"))
    page = migrated.call("queryGrasps", 200, query={"limit": 1000})
    assert {g["id"]: g["quality"]["epsilon"] for g in page["items"]} == before
    assert len(before) > 10


def test_it_has_all_else(migrated):
    for operation, table in (("listObjects", "objects"), ("listCategories", "categories"),
                             ("listGraspSpaces", "grasp_spaces"), ("listJobs", "jobs"),
                             ("listTransfers", "transfers")):
        stored = rows_before(f"SELECT count(*) FROM {table}")[0][0]
        assert len(migrated.call(operation, 200)["items"]) == stored > 0, operation


def test_what_was_answered_under_a_key_is_answered_again(migrated):
    migrated.call("postCategory", 201, headers={"Idempotency-Key": "category"},
                  body={"name": "box", "title": "Boxes",
                        "parts": [{"label": "body", "tasks": {"use": "hold it"}}]})
    assert migrated.last.headers["Idempotent-Replayed"] == "true"


def test_its_grasps_are_transferred_to_a_new_object(migrated):
    vertices, faces = meshes.grid_box(0.063, 0.068, 0.13, 4)
    answer = migrated.call("postGrasps", 200, query={"category": "box", "sources": 4},
                           headers={"Prefer": "wait=120"}, body=meshes.obj(vertices, faces))
    assert answer["grasps"]


def test_it_is_sound(binary, migrated, database):
    assert rows(database, "PRAGMA user_version") > [(1,)]
    checked = subprocess.run([binary, "check", "--db", str(database)],
                             capture_output=True, text=True)
    assert checked.returncode == 0, checked.stdout + checked.stderr
