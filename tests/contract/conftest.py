"""One server for all contract tests, with a hand, a category and an example."""

import os
import subprocess

import pytest

from contract_client import ROOT, Contract, patient
from live_server import LiveServer

# So little of everything that learning takes seconds.
QUICK = {
    "active_learning": {"seed_samples": 300, "rounds": 1,
                        "queries_per_round": 50, "test_samples": 50},
    "swarm": {"particles": 40, "iterations": 15, "target_grasps": 30},
}


def pytest_configure(config):
    """What goes wrong in a client's thread fails the test."""
    config.addinivalue_line("filterwarnings", "error::pytest.PytestUnhandledThreadExceptionWarning")


@pytest.fixture(scope="session")
def binary():
    path = os.environ.get("GRASPDB_BINARY")
    if not path:
        pytest.fail("GRASPDB_BINARY is not set: run these tests by ctest")
    return path


@pytest.fixture(scope="session")
def server(binary, tmp_path_factory):
    folder = tmp_path_factory.mktemp("contract")
    database = folder / "contract.db"
    (folder / "hands").symlink_to(ROOT / "data" / "hands")
    subprocess.run([binary, "populate", str(folder), "--db", str(database)],
                   check=True, timeout=patient(400))
    live = LiveServer(binary, database, folder)
    yield live
    assert live.alive(), live.log()
    assert live.stop() == 0, live.log()
    assert "event=internal" not in live.log(), live.log()


@pytest.fixture(scope="session")
def copy_database(binary, server, world):
    """Makes a copy of the database with the learned mug."""
    def copy(path):
        subprocess.run([binary, "backup", str(path), "--db", str(server.database)],
                       check=True, stdout=subprocess.DEVNULL)
    return copy


@pytest.fixture(scope="session")
def contract(server):
    return Contract(server.url)


@pytest.fixture(scope="session")
def world(contract):
    """A category of mugs with one learned example; ids by name."""
    mug = ROOT / "data" / "mug"
    contract.call("postCategory", 201, body={
        "name": "mug", "title": "Mugs",
        "parts": [{"label": "body", "tasks": {"use": "hold it"}},
                  {"label": "handle", "tasks": {"handover": "offer it"}}],
        "topology": [["body", "handle"]]})
    example = contract.call(
        "postExample", 200, path={"name": "mug"}, query={"learn": "false"},
        headers={"Prefer": "wait=150"},
        files={"mesh": ("classic.obj", (mug / "classic.obj").read_bytes()),
               "labels": ("l.json", (mug / "classic.labels.json").read_bytes())})
    spaces = contract.call(
        "postGraspSpaces", 200, path={"id": example["id"]},
        headers={"Prefer": "wait=300"}, timeout=320,
        body={"parameters": QUICK, "parts": ["body"]})
    assert spaces["items"][0]["grasps"] > 0
    return {"example": example, "space": spaces["items"][0],
            "novel_bytes": (mug / "latte.obj").read_bytes()}
