"""64 clients at once: queries, uploads and transfers mixed. Nothing is answered but
what was asked for, or 429 or 503 with Retry-After; memory and descriptors do not
grow. Neither more clients than can be served nor event streams nor learning nor
backups keep others from their answers. Seconds are GRASPDB_LOAD_SECONDS (default
8); latencies are told, not judged."""

import collections
import concurrent.futures
import multiprocessing
import os
import pathlib
import random
import re
import socket
import sqlite3
import subprocess
import threading
import time

import numpy
import pytest
import requests

import meshes
from conftest import QUICK
from contract_client import ROOT, SLOWER, patient
from live_server import LiveServer

CLIENTS = 64
SECONDS = float(os.environ.get("GRASPDB_LOAD_SECONDS", "8"))
QUEUE = 20  # Jobs that may wait.
FEW_THREADS = CLIENTS // 8
OVERLOAD_SECONDS = max(5.0, SECONDS / 10)
THREADS = 128
STREAMS = 500 if SECONDS > 60 else 80
QUERIES = 2000 if SECONDS > 60 else 100
BACKUPS = 50 if SECONDS > 60 else 3
MOST_GROWTH = 96 << 20  # Bytes, after the first half.
# Descriptors that are no sockets: connections to the database. The slower, the more
# threads are at work at once; each has one.
MOST_FILES = 60 if SLOWER == 1 else 200


def read_descriptors(pid):
    """How many are sockets, and how many anything else."""
    sockets = others = 0
    for descriptor in os.listdir(f"/proc/{pid}/fd"):
        try:
            is_socket = os.readlink(f"/proc/{pid}/fd/{descriptor}").startswith("socket:")
        except FileNotFoundError:
            continue
        sockets += is_socket
        others += not is_socket
    return sockets, others


def watch(server, until):
    """Rows of seconds, resident bytes and descriptors that are no sockets, until then."""
    rows = []
    begin = time.monotonic()
    while not rows or time.monotonic() < until:
        rows.append((time.monotonic() - begin, server.memory(),
                     read_descriptors(server.process.pid)[1]))
        time.sleep(0.25)
    return numpy.array(rows)


@pytest.fixture(scope="module")
def busy(binary, copy_database, tmp_path_factory):
    """A server of its own, with a mug that has been learned."""
    folder = tmp_path_factory.mktemp("load")
    database = folder / "load.db"
    copy_database(database)
    server = LiveServer(binary, database, folder, "--max-queued-jobs", str(QUEUE),
                        "--http-threads", str(THREADS))
    yield server
    assert server.alive(), server.log()
    assert server.stop() == 0, server.log()
    assert "event=internal" not in server.log(), server.log()


def count_low_priority(pid):
    """Threads that give way to others."""
    count = 0
    for task in os.listdir(f"/proc/{pid}/task"):
        stat = pathlib.Path(f"/proc/{pid}/task/{task}/stat").read_text()
        count += int(stat.rsplit(")", 1)[1].split()[16]) > 0
    return count


class Client(threading.Thread):
    """Asks until the end; after a 429 or 503 it waits for a moment."""

    def __init__(self, number, url, end, pause=0.2):
        super().__init__()
        self.number, self.url, self.end, self.pause = number, url, end, pause
        self.random = random.Random(number)
        self.answers = collections.Counter()
        self.query_seconds = []
        self.failures = []

    def run(self):
        session = requests.Session()
        mesh = (ROOT / "data" / "mug" / "latte.obj").read_bytes()
        # Where others take the cores, too, the first answer may come late.
        while time.monotonic() < self.end + (0 if self.answers["query", 200] else patient(30)):
            what = self.random.random()
            try:
                if what < 0.9:
                    self.query(session)
                elif what < 0.95:
                    self.post(session, "/v1/objects?category=mug&format=obj", mesh)
                else:
                    self.post(session, "/v1/grasps?category=mug&part=body&sources=2&count=1"
                                       "&format=obj", mesh)
            except requests.RequestException as error:
                self.failures.append(repr(error))
                return

    def ask(self, method, path, **terms):
        """A connection may end just as its client writes, when the client has been
        silent for too long; it asks once more then, as browsers do."""
        try:
            return method(self.url + path, **terms)
        except requests.ConnectionError:
            self.answers["unheard", 0] += 1
            return method(self.url + path, **terms)

    def query(self, session):
        path = self.random.choice(["/v1/grasps?category=mug&limit=20", "/v1/objects?limit=20",
                                   "/v1/categories", "/healthz", "/v1/jobs?limit=5"])
        start = time.monotonic()
        answer = self.ask(session.get, path, timeout=60)
        self.query_seconds.append(time.monotonic() - start)
        self.count("query", answer, {200})

    def post(self, session, path, mesh):
        fresh = b"# %d %d\n" % (self.number, self.random.getrandbits(60)) + mesh
        answer = self.ask(session.post, path, data=fresh, timeout=120,
                          headers={"Prefer": "respond-async"})
        self.count(path.split("?")[0], answer, {200, 201, 202})

    def count(self, what, answer, expected):
        self.answers[what, answer.status_code] += 1
        if answer.status_code in (429, 503):
            if not answer.headers.get("Retry-After"):
                self.failures.append(f"{what}: no Retry-After")
            time.sleep(self.pause)
        elif answer.status_code not in expected:
            self.failures.append(f"{what}: {answer.status_code} {answer.text[:300]}")


def probe(url, end):
    """Seconds of a query now and then, in a process of its own: who shares one with
    64 clients waits for them as well."""
    session = requests.Session()
    seconds = []
    while time.monotonic() < end:
        start = time.monotonic()
        session.get(url + "/v1/grasps?category=mug&limit=20", timeout=60).raise_for_status()
        seconds.append(time.monotonic() - start)
        time.sleep(0.01)
    return seconds


def join(clients):
    """What they were answered, once all have ended; fails with the first failures."""
    for client in clients:
        client.join()
    failures = [failure for client in clients for failure in client.failures]
    assert not failures, failures[:5]
    answers = sum((client.answers for client in clients), collections.Counter())
    assert answers["unheard", 0] <= len(clients), answers
    return answers


def quantile_ms(seconds, q):
    return f"{1e3 * numpy.quantile(seconds, q):.1f} ms"


def test_sixty_four_clients_get_what_they_ask_for_or_are_told_to_wait(busy):
    start = time.monotonic()
    pid = busy.process.pid
    clients = [Client(i, busy.url, start + SECONDS) for i in range(CLIENTS)]
    spawn = multiprocessing.get_context("spawn")
    with concurrent.futures.ProcessPoolExecutor(1, mp_context=spawn) as pool:
        probing = pool.submit(probe, busy.url, start + SECONDS)
        for client in clients:
            client.start()
        rows = watch(busy, start + SECONDS)
        answers = join(clients)
        probed = probing.result()

    seconds = numpy.concatenate([client.query_seconds for client in clients])
    # What is kept in memory fills up first: five minutes, at full length.
    late = rows[len(rows) // 2:]
    slope = numpy.polyfit(late[:, 0] / 60, late[:, 1] / (1 << 20), 1)[0]
    print(f"\n{SECONDS:.0f} s, {sum(answers.values())} answers: {dict(answers)}\n"
          f"queries: p50 {quantile_ms(seconds, .5)}, p99 {quantile_ms(seconds, .99)}; "
          f"one client apart p50 {quantile_ms(probed, .5)}, p99 {quantile_ms(probed, .99)}\n"
          f"resident {late[0, 1] / (1 << 20):.0f} -> {late[-1, 1] / (1 << 20):.0f} MiB, "
          f"{slope:+.2f} MiB/min; descriptors that are no sockets "
          f"{rows[:, 2].min():.0f} to {rows[:, 2].max():.0f}")
    assert answers["query", 200] > CLIENTS
    assert answers["/v1/objects", 201] + answers["/v1/objects", 202] > 0
    assert late[-1, 1] - late[0, 1] < MOST_GROWTH
    # Two that work on jobs, and whoever helps them on other cores.
    assert count_low_priority(pid) >= 2 + min(1, os.cpu_count() - 1)

    # Once they have gone it is as it was: of all sockets the listening one stays.
    deadline = time.monotonic() + 30
    while read_descriptors(pid)[0] > 1 and time.monotonic() < deadline:
        time.sleep(0.5)
    sockets, others = read_descriptors(pid)
    assert sockets == 1
    assert rows[:, 2].max() < MOST_FILES
    assert others <= rows[:, 2].max() + 8  # Between two looks some come and go.
    assert requests.get(busy.url + "/healthz", timeout=5).status_code == 200


def count_turned_away(url):
    metrics = requests.get(url + "/metrics", timeout=20).text
    dropped = re.search(r"^graspdb_http_connections_dropped_total (\d+)$", metrics, re.M)
    turned_away = re.findall(r'^graspdb_http_requests_total{.*route="turned away".*} (\d+)$',
                             metrics, re.M)
    return sum(map(int, turned_away)), int(dropped[1])


def test_far_more_than_can_be_served_is_told_to_wait_and_soon_forgotten(
        binary, copy_database, tmp_path):
    """Eight clients for each thread that serves them, and none of them waits."""
    database = tmp_path / "overload.db"
    copy_database(database)
    live = LiveServer(binary, database, tmp_path, "--max-queued-jobs", "4",
                      "--http-threads", str(FEW_THREADS))
    end = time.monotonic() + patient(OVERLOAD_SECONDS)
    clients = [Client(i, live.url, end, pause=0) for i in range(CLIENTS)]
    for client in clients:
        client.start()
    time.sleep(patient(OVERLOAD_SECONDS) / 3)
    rows = watch(live, end)
    answers = join(clients)
    begin = time.monotonic()
    box = meshes.box_obj(0.04, 0.05, 0.06)
    while not (requests.get(live.url + "/v1/grasps?category=mug&limit=20", timeout=60).ok
               and requests.post(live.url + "/v1/objects?format=obj", data=box, timeout=60).ok):
        assert time.monotonic() - begin < patient(60)
        time.sleep(0.05)
    recovered = time.monotonic() - begin
    least = min(client.answers["query", 200] for client in clients)
    turned_away, dropped = count_turned_away(live.url)
    print(f"\n{CLIENTS} clients on {FEW_THREADS} threads for {OVERLOAD_SECONDS:.0f} s: "
          f"{dict(answers)}, at least {least} queries each; {turned_away} turned away, "
          f"{dropped} dropped; resident "
          f"{rows[:, 1].min() / (1 << 20):.0f} to {rows[:, 1].max() / (1 << 20):.0f} MiB; "
          f"answers as before {recovered:.2f} s after")
    # Nobody was left out.
    assert least > 0
    assert turned_away > 0 and dropped == 0
    assert answers["/v1/grasps", 503] > 0
    assert rows[-1, 1] - rows[0, 1] < MOST_GROWTH
    assert live.stop() == 0, live.log()
    assert "event=internal" not in live.log(), live.log()


def test_learning_keeps_nobody_waiting_and_says_how_long_it_takes(busy):
    example = requests.get(busy.url + "/v1/objects?category=mug&role=example", timeout=20)
    alone = time_queries(busy, QUERIES), time_queries(busy, QUERIES, "/healthz")
    job = requests.post(
        f"{busy.url}/v1/objects/{example.json()['items'][0]['id']}/grasp-spaces",
        json={"parts": ["handle"], "seed": 7,
              # Under a sanitizer little takes long enough.
              "parameters": QUICK if SLOWER > 1 else {}}, timeout=20).json()
    url = f"{busy.url}/v1/jobs/{job['id']}"
    while job["eta_s"] is None:
        assert job["state"] in ("queued", "running"), job
        time.sleep(0.1)
        job = requests.get(url, timeout=20).json()
    assert 0 < job["progress"] < 1 and job["eta_s"] > 0
    beside = time_queries(busy, QUERIES), time_queries(busy, QUERIES, "/healthz")
    later = requests.get(url, timeout=20).json()
    assert later["state"] == "succeeded" or later["progress"] >= job["progress"]
    requests.delete(url, timeout=20)
    print(f"\nalone: queries p99 {quantile_ms(alone[0], .99)}, health p99 "
          f"{quantile_ms(alone[1], .99)}; while it learns: queries p99 "
          f"{quantile_ms(beside[0], .99)}, health p99 {quantile_ms(beside[1], .99)}")


def open_stream(server, path):
    """A connection that has asked for events, and the status it was answered."""
    connection = socket.create_connection(("127.0.0.1", server.port), timeout=30)
    connection.sendall(f"GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
    head = b""
    while b"\r\n\r\n" not in head:
        piece = connection.recv(4096)
        assert piece, head
        head += piece
    status = int(head.split()[1])
    assert status == 200 or b"\r\nRetry-After:" in head, head
    return connection, status


def time_queries(server, count, path="/v1/grasps?category=mug&limit=20"):
    """Seconds of each of so many queries."""
    session = requests.Session()
    seconds = []
    for _ in range(count):
        start = time.monotonic()
        answer = session.get(server.url + path, timeout=30)
        seconds.append(time.monotonic() - start)
        assert answer.status_code == 200, answer.text
    return seconds


def test_event_streams_do_not_keep_others_waiting(busy):
    example = requests.get(busy.url + "/v1/objects?category=mug&role=example", timeout=20)
    job = requests.post(
        f"{busy.url}/v1/objects/{example.json()['items'][0]['id']}/grasp-spaces",
        json={"parts": ["handle"]}, timeout=20).json()
    alone = time_queries(busy, QUERIES)
    streams = [open_stream(busy, f"/v1/jobs/{job['id']}/events") for _ in range(STREAMS)]
    beside = time_queries(busy, QUERIES)
    answers = collections.Counter(status for _, status in streams)
    # Half of the threads are left to others, and all get an answer.
    assert answers == {200: THREADS // 2, 503: STREAMS - THREADS // 2}, answers
    for connection, _ in streams:
        connection.close()
    requests.delete(f"{busy.url}/v1/jobs/{job['id']}", timeout=20)
    print(f"\n{STREAMS} streams; queries alone p99 {quantile_ms(alone, .99)}, "
          f"beside them {quantile_ms(beside, .99)}")


def read_new_rows(path, other):
    """Rows that one database has and the other lacks."""
    database = sqlite3.connect(f"file:{path}?mode=ro", uri=True)
    database.execute("ATTACH ? AS other", (f"file:{other}?mode=ro",))
    tables = [row[0] for row in database.execute(
        "SELECT name FROM main.sqlite_master WHERE type = 'table' AND name NOT LIKE 'sqlite_%'")]
    rows = []
    for table in tables:
        rows += database.execute(f"SELECT * FROM main.{table} EXCEPT SELECT * FROM other.{table}")
    database.close()
    return rows


def test_backups_beside_writers_hold_all_that_was_acknowledged(
        binary, copy_database, tmp_path):
    database = tmp_path / "written.db"
    copy_database(database)
    live = LiveServer(binary, database, tmp_path)
    acknowledged = []
    end = threading.Event()

    def write(number):
        session = requests.Session()
        chance = random.Random(number)
        while not end.is_set():
            answer = session.post(live.url + "/v1/objects?format=obj", timeout=60,
                                  data=meshes.box_obj(*(chance.uniform(0.03, 0.08)
                                                        for _ in range(3))))
            assert answer.status_code == 201, answer.text
            acknowledged.append(answer.json()["id"])

    kept = []
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        writers = [pool.submit(write, number) for number in range(4)]
        try:
            for i in range(BACKUPS):
                while len(acknowledged) < 5 * i + 5:
                    assert not any(writer.done() for writer in writers)
                    time.sleep(0.01)
                before = list(acknowledged)
                begin = time.monotonic()
                answer = requests.post(live.url + "/v1/backups", timeout=120)
                seconds = time.monotonic() - begin
                assert answer.status_code == 201, answer.text
                copy = tmp_path / f"{i}.db"
                # The server removes the oldest ones.
                os.link(f"{database}.backups/{answer.json()['name']}", copy)
                kept.append((copy, before, seconds, answer.json()["bytes"]))
        finally:
            end.set()
    for writer in writers:
        writer.result()
    assert live.stop() == 0, live.log()
    for copy, before, _, _ in kept:
        check = subprocess.run([binary, "check", "--db", str(copy)], capture_output=True, text=True)
        assert check.returncode == 0, check.stdout + check.stderr
        restored = sqlite3.connect(copy)
        ids = {row[0] for row in restored.execute("SELECT id FROM objects")}
        restored.close()
        assert set(before) <= ids
        assert read_new_rows(copy, database) == []
    # The comparison finds a difference where there is one.
    assert read_new_rows(database, kept[0][0]) != []
    seconds = [row[2] for row in kept]
    print(f"\n{len(kept)} backups beside {len(acknowledged)} writes, each compared: median "
          f"{quantile_ms(seconds, .5)}, slowest {quantile_ms(seconds, 1)}, "
          f"{kept[0][3] / 1e6:.1f} to {kept[-1][3] / 1e6:.1f} MB")
