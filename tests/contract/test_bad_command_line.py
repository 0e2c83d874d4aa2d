"""What a bad command line gets: one line, status 2, nothing changed."""

import hashlib
import os
import re
import resource
import shutil
import socket
import sqlite3
import subprocess

import pytest

import meshes
from contract_client import ROOT, SLOWER
from test_bad_input import references

MUG = ROOT / "data" / "mug" / "latte.obj"
BOX = meshes.box_obj(0.03, 0.04, 0.05)
COMMANDS = {
    "serve": ["serve", "--port", "0"],
    "populate": ["populate", str(ROOT / "data"), "--no-learn"],
    "grasp": ["grasp", str(MUG), "--category", "mug"],
    "segment": ["segment", str(MUG), "--category", "mug"],
    "query": ["query"], "check": ["check"],
    "learn": ["learn", "01890000-0000-7000-8000-000000000000"],
    "render": ["render", "--object", "01890000-0000-7000-8000-000000000000"],
}
# Root may write everything, unless it lays that right down.
HUMBLE = ["setpriv", "--bounding-set=-dac_override,-dac_read_search"] if (
    os.geteuid() == 0) else []


@pytest.fixture(scope="module")
def populated(binary, tmp_path_factory):
    """A database with a hand and four examples, closed."""
    database = tmp_path_factory.mktemp("populated") / "a.db"
    subprocess.run([binary, *COMMANDS["populate"], "--db", str(database)],
                   check=True, timeout=120, stdout=subprocess.DEVNULL,
                   stderr=subprocess.DEVNULL)
    return database


@pytest.fixture
def database(populated, tmp_path):
    return shutil.copy(populated, tmp_path / "a.db")


def snapshot(folder):
    """What a folder holds, but for what readers leave beside a database."""
    return {str(path.relative_to(folder)):
            hashlib.sha256(path.read_bytes()).hexdigest()
            for path in folder.rglob("*")
            if path.is_file() and not path.name.endswith(("-shm", "-wal"))}


def complain(binary, arguments, prefix=(), stdin=b"", cwd=None,
             hint=True):
    """Runs what must fail; returns the one line that it says."""
    result = subprocess.run(
        [*prefix, binary, *map(str, arguments)], input=stdin, cwd=cwd,
        capture_output=True, timeout=60, env={"PATH": os.environ["PATH"]})
    line = result.stderr.decode()
    assert result.returncode == 2, (result.returncode, line)
    assert result.stdout == b""
    assert line.startswith("graspdb: ") and line.count("\n") == 1, line
    assert line.endswith(")\n") or not hint, line
    assert "bug" not in line
    return line


@pytest.mark.parametrize("command", ["grasp", "segment"])
@pytest.mark.parametrize("name,words", [
    ("missing.obj", "missing.obj cannot be read"), (".", "is a folder"),
    ("", "cannot be read"), ("a.db/x.obj", "a.db/x.obj cannot be read"),
    ("loop.obj", "loop.obj cannot be read"), ("x" * 5000, "cannot be read")],
    ids=["missing", "folder", "no name", "below a file", "loop", "long name"])
def test_a_mesh_file_that_is_not_there(
        binary, database, tmp_path, command, name, words):
    (tmp_path / "loop.obj").symlink_to("loop.obj")
    before = snapshot(tmp_path)
    line = complain(binary, [command, name, "--category", "mug", "--db",
                             database], cwd=tmp_path)
    assert words in line
    assert snapshot(tmp_path) == before


def test_a_mesh_file_that_may_not_be_read(binary, database, tmp_path):
    mesh = tmp_path / "secret.obj"
    mesh.write_bytes(BOX)
    mesh.chmod(0)
    line = complain(binary, ["segment", mesh, "--category", "mug", "--db",
                             database], prefix=HUMBLE)
    assert "secret.obj cannot be read" in line


@pytest.mark.parametrize("command", ["grasp", "segment"])
def test_an_empty_standard_input(binary, database, tmp_path, command):
    before = snapshot(tmp_path)
    line = complain(binary, [command, "-", "--category", "mug", "--db",
                             database])
    assert "empty" in line
    assert snapshot(tmp_path) == before


def test_standard_input_is_read_as_a_file_is(binary, database):
    result = subprocess.run(
        [binary, "segment", "-", "--category", "mug", "--db", database],
        input=MUG.read_bytes(), capture_output=True, timeout=60, check=True)
    assert b"handle" in result.stdout


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("content", [
    b"hello\n", b"\0" * 5000, b"SQLite format 3\0 and no more",
    b"SQLite format 3\0" + b"x" * 4080], ids=["text", "zeros", "cut", "junk"])
def test_a_file_that_is_no_database_stays_as_it_is(
        binary, tmp_path, command, content):
    path = tmp_path / "a.db"
    path.write_bytes(content)
    before = snapshot(tmp_path)
    complain(binary, [*COMMANDS[command], "--db", path])
    assert snapshot(tmp_path) == before
    assert [p.name for p in tmp_path.iterdir()] == ["a.db"]


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("kind,words", [
    ("foreign", "another program"), ("newer", "newer graspdb"), ("cut", "")])
def test_a_database_that_is_not_ours_stays_as_it_is(
        binary, database, tmp_path, command, kind, words):
    if kind == "foreign":
        os.remove(database)
        other = sqlite3.connect(database)
        other.executescript("PRAGMA application_id = 7; CREATE TABLE t (x);")
        other.close()
    elif kind == "newer":
        other = sqlite3.connect(database)
        other.execute("PRAGMA user_version = 999")
        other.close()
    else:
        os.truncate(database, os.path.getsize(database) // 2)
    before = snapshot(tmp_path)
    line = complain(binary, [*COMMANDS[command], "--db", database])
    assert words in line
    assert snapshot(tmp_path) == before


@pytest.mark.parametrize("command", COMMANDS)
def test_a_database_that_is_a_folder_or_below_none(binary, tmp_path, command):
    line = complain(binary, [*COMMANDS[command], "--db", tmp_path])
    assert "is a folder" in line
    complain(binary, [*COMMANDS[command], "--db", tmp_path / "no" / "a.db"])
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "command", sorted(set(COMMANDS) - {"serve", "populate"}))
def test_a_database_that_is_missing_is_not_made(binary, tmp_path, command):
    line = complain(binary, [*COMMANDS[command], "--db", tmp_path / "a.db"])
    assert "does not exist" in line and "graspdb populate" in line
    assert list(tmp_path.iterdir()) == []


def test_a_database_in_a_folder_that_may_not_be_written(binary, tmp_path):
    folder = tmp_path / "closed"
    folder.mkdir()
    folder.chmod(0o555)
    for command in ("serve", "populate"):
        line = complain(binary, [*COMMANDS[command], "--db", folder / "a.db"],
                        prefix=HUMBLE)
        assert "writable" in line
    assert list(folder.iterdir()) == []


def test_a_database_that_may_not_be_read(binary, database, tmp_path):
    before = snapshot(tmp_path)
    os.chmod(database, 0)
    for command in COMMANDS.values():
        line = complain(binary, [*command, "--db", database], prefix=HUMBLE)
        assert "permissions" in line or "writable" in line
    os.chmod(database, 0o644)
    assert snapshot(tmp_path) == before


def test_a_database_that_another_program_holds(binary, database, tmp_path):
    before = snapshot(tmp_path)
    holder = sqlite3.connect(database, isolation_level=None)
    holder.execute("PRAGMA locking_mode = EXCLUSIVE")
    holder.execute("BEGIN EXCLUSIVE")
    waiting = [subprocess.Popen(
        [binary, *command, "--db", database], stdout=subprocess.PIPE,
        stderr=subprocess.PIPE, text=True) for command in COMMANDS.values()]
    for process in waiting:
        out, line = process.communicate(timeout=60)
        assert process.returncode == 2 and out == ""
        assert re.fullmatch(r"graspdb: .*locked.*\(.*\)\n", line), line
    holder.execute("ROLLBACK")
    holder.close()
    assert snapshot(tmp_path) == before


def test_a_taken_port_is_left_to_its_owner(binary, database, tmp_path):
    before = snapshot(tmp_path)
    with socket.create_server(("127.0.0.1", 0)) as owner:
        port = str(owner.getsockname()[1])
        result = subprocess.run(
            [binary, "serve", "--db", database, "--port", port],
            capture_output=True, text=True, timeout=60)
    assert result.returncode == 2 and result.stdout == ""
    last = result.stderr.splitlines()[-1]
    assert port in last and "already in use" in last and "--port" in last
    assert snapshot(tmp_path) == before


@pytest.mark.parametrize("arguments", [
    ["serve", "--port", "70000"], ["serve", "--port", "-1"],
    ["serve", "--port", "http"], ["serve", "--http-threads", "0"],
    ["serve", "--wait", "-1"], ["query", "--limit", "many"],
    ["query", "--sort", "colour"], ["query", "--min-epsilon", "x"],
    ["grasp", str(MUG)], ["grasp", "--category", "mug"],
    ["grasp", str(MUG), "--category", "mug", "--seed", "-1"],
    ["grasp", str(MUG), "--category", "mug", "--parameters", "{"],
    ["grasp", str(MUG), "--category", "mug", "--parameters", "/no/such"],
    ["grasp", str(MUG), "--category", "mug", "--stage", "learned"],
    ["render"], ["render", "--object", "a", "--grasp", "b"],
    ["render", "--object", "a", "--width", "9999999"], ["dance"], ["--dance"]],
    ids=lambda words: " ".join(words[-3:]))
def test_an_unusable_command_line(binary, tmp_path, arguments):
    complain(binary, [a.replace(str(MUG), "m.obj") for a in arguments],
             cwd=tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("more,words", [
    (["--category", "teapot"], "mug"), (["--category", "mug", "--hand", "x"],
                                        "barrett-bh8-280"),
    (["--category", "mug", "--part", "lid"], "handle"),
    (["--category", "mug", "--task", "juggle"], "handover"),
    (["--category", "mug", "--count", "0"], "count"),
    (["--category", "mug", "--sources", "0"], "sources"),
    (["--category", "mug", "--friction", "-1"], "friction"),
    (["--category", "mug", "--friction", "nan"], "friction"),
    (["--category", "mug", "--units", "furlong"], "mm"),
    (["--category", "mug", "--format", "docx"], "stl"),
    (["--category", "mug"], "graspdb learn")],
    ids=lambda v: v if isinstance(v, str) else " ".join(v))
def test_an_unusable_order_stores_nothing(
        binary, database, tmp_path, more, words):
    before = counts(database)
    line = complain(binary, ["grasp", MUG, *more, "--db", database],
                    hint=False)
    assert words in line
    assert counts(database) == before


def counts(database):
    connection = sqlite3.connect(database)
    rows = [connection.execute(f"SELECT count(*) FROM {table}").fetchone()
            for table in ("categories", "objects", "parts", "grasps",
                          "transfers")]
    connection.close()
    return rows


# Only the helper reads a mesh; neither it nor the program follows it elsewhere.
def test_no_file_is_opened_that_a_mesh_refers_to(binary, database, tmp_path):
    tried = subprocess.run(["strace", "true"], capture_output=True, text=True)
    if tried.returncode and "Operation not permitted" in tried.stderr:
        pytest.skip("this container forbids ptrace; that the helper can open nothing "
                    "is shown from inside by decode_test: " + tried.stderr.strip())
    assert tried.returncode == 0, tried.stderr
    secret = tmp_path / "tell-nobody"
    secret.write_text("v 0 0 0\n")
    for n, target in enumerate((str(secret), f"file://{secret}",
                                "../tell-nobody", "http://127.0.0.1:1/x")):
        for k, (mesh_format, content, whole) in enumerate(references(target)):
            mesh = tmp_path / f"{n}-{k}.{mesh_format}"
            mesh.write_bytes(content)
            trace = tmp_path / "trace"
            result = subprocess.run(
                ["strace", "-f", "-o", trace, "-e",
                 "trace=%file,socket,connect", binary, "segment", mesh,
                 "--units", "m", "--category", "mug", "--db", database],
                # No search for leaks works beside strace.
                env={**os.environ, "ASAN_OPTIONS": "detect_leaks=0"},
                capture_output=True, timeout=60)
            assert whole is None or (result.returncode == 0) == whole, (
                mesh, result.stderr)
            calls = trace.read_text()
            assert f'"{mesh}"' in calls and "graspdb-decode" in calls
            assert "tell-nobody" not in calls
            assert "AF_INET" not in calls and "connect(" not in calls


def test_a_free_port_is_served_by_its_number(binary, database):
    with socket.create_server(("127.0.0.1", 0)) as owner:
        port = str(owner.getsockname()[1])
    server = subprocess.Popen([binary, "serve", "--db", database, "--port",
                               port], stdout=subprocess.PIPE)
    try:
        assert server.stdout.readline().endswith(f":{port}\n".encode())
    finally:
        server.terminate()
        assert server.wait(30) == 0


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
    def limit():
        # A sanitizer's shadow takes terabytes of addresses, if not of memory.
        if SLOWER == 1:
            resource.setrlimit(resource.RLIMIT_AS, (2 << 30, 2 << 30))

    result = subprocess.run(
        [binary, "segment", path, "--category", "mug", "--db", database],
        capture_output=True, text=True, timeout=60, preexec_fn=limit)
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
