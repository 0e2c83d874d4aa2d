"""The front of docker/nginx.conf, by Debian's nginx, before a real server: what a
hostile or slow client may do, and that everyone else does not notice."""

import itertools
import os
import re
import resource
import shutil
import signal
import socket
import subprocess
import threading
import time

import pytest
import requests

from contract_client import ROOT

# At length as many as the reliability figures ask for.
SLOW_CLIENTS = 1500 if "GRASPDB_ROUNDS" in os.environ else 300
NGINX = shutil.which("nginx", path=os.environ.get("PATH", "") + ":/usr/sbin:/sbin")


def find_free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Front:
    def __init__(self, folder, behind):
        assert NGINX, "no nginx; .ci/install gets it"
        self.port = find_free_port()
        self.url = f"http://127.0.0.1:{self.port}"
        text = (ROOT / "docker" / "nginx.conf").read_text()
        for old, new in (("listen 8081", f"listen 127.0.0.1:{self.port}"),
                         ("127.0.0.1:8080", f"127.0.0.1:{behind}"),
                         ("/run/nginx.pid", f"{folder}/nginx.pid"),
                         ("/var/lib/nginx/", f"{folder}/"),
                         ("/dev/stderr", f"{folder}/error.log")):
            assert old in text, old
            text = text.replace(old, new)
        config = folder / "nginx.conf"
        config.write_text(text)
        # Its workers write to the test's folder.
        user = " user root;" if os.getuid() == 0 else ""
        self.process = subprocess.Popen(
            [NGINX, "-c", config, "-p", folder, "-e", folder / "error.log", "-g", "daemon off;" + user])
        deadline = time.monotonic() + 10
        while time.monotonic() < deadline:
            try:
                socket.create_connection(("127.0.0.1", self.port), 1).close()
                return
            except OSError:
                time.sleep(0.05)
        raise RuntimeError((folder / "error.log").read_text())

    def send(self, data, seconds=5, address="127.0.0.1"):
        """All that comes back on one connection until it closes or is silent."""
        with socket.create_connection(("127.0.0.1", self.port), seconds,
                                      source_address=(address, 0)) as link:
            link.settimeout(seconds)
            answer = b""
            try:
                link.sendall(data)
                while True:
                    piece = link.recv(65536)
                    if not piece:
                        break
                    answer += piece
            except OSError:
                pass
            return answer

    def stop(self):
        self.process.send_signal(signal.SIGTERM)
        self.process.wait(timeout=10)


@pytest.fixture(scope="module")
def front(server, tmp_path_factory):
    front = Front(tmp_path_factory.mktemp("nginx"), server.port)
    yield front
    front.stop()


def statuses(answer):
    return [int(s) for s in re.findall(rb"HTTP/1\.1 (\d{3})", answer)]


def test_what_the_server_answers_comes_through(front, server, world):
    for path in ("/", "/healthz", "/v1/hands", "/v1/grasps?limit=2", "/v1/objects/none"):
        through = requests.get(front.url + path, timeout=10)
        direct = requests.get(server.url + path, timeout=10)
        assert through.status_code == direct.status_code, path
        assert through.headers["Content-Type"] == direct.headers["Content-Type"]
        if direct.ok:
            assert through.content == direct.content, path
    created = requests.post(f"{front.url}/v1/objects?category=mug&format=obj",
                            data=world["novel_bytes"], timeout=60)
    assert created.status_code in (200, 201), created.text


def test_events_are_told_while_a_job_runs(front, world):
    job = requests.post(f"{front.url}/v1/grasps?category=mug&part=body&sources=3&format=obj",
                        data=b"# through nginx\n" + world["novel_bytes"],
                        headers={"Prefer": "respond-async"}, timeout=60).json()
    with requests.get(f"{front.url}/v1/jobs/{job['id']}/events", stream=True,
                      timeout=120) as stream:
        assert stream.headers["Content-Type"].startswith("text/event-stream")
        events = [line for line in stream.iter_lines() if line.startswith(b"event:")]
    assert len(events) >= 2


def test_what_only_the_operator_may_is_forbidden(front):
    for path in ("/metrics", "/v1/backups"):
        assert requests.get(front.url + path, timeout=10).status_code == 403
    assert requests.post(front.url + "/v1/backups", timeout=10).status_code == 403
    assert requests.request("TRACE", front.url + "/", timeout=10).status_code == 405


HOST = b"Host: a\r\n"


@pytest.mark.parametrize("message", [
    b"POST /v1/search HTTP/1.1\r\n" + HOST + b"Content-Length: 4\r\nTransfer-Encoding: chunked\r\n\r\n"
    b"0\r\n\r\nGET /healthz HTTP/1.1\r\n" + HOST + b"\r\n",
    b"POST /v1/search HTTP/1.1\r\n" + HOST + b"Content-Length: 0\r\nContent-Length: 38\r\n\r\n"
    b"GET /healthz HTTP/1.1\r\n" + HOST + b"X: y\r\n\r\n",
    b"GET /healthz HTTP/1.1\r\n" + HOST + b"Transfer-Encoding: xchunked\r\n\r\n"
    b"0\r\n\r\nGET /healthz HTTP/1.1\r\n" + HOST + b"\r\n",
    b"GET /healthz HTTP/1.1\r\n" + HOST + b"X: y\r\n folded: on\r\n\r\n",
    b"GET /health\x00z HTTP/1.1\r\n" + HOST + b"\r\n",
    b"GET /healthz HTTP/1.1\r\n" + HOST + b"X: a\x00b\r\n\r\n",
    b"GET /healthz HTTP/1.1\r\n" + HOST + HOST + b"\r\n",
    b"GET /healthz HTTP/1.1\r\n\r\n",
], ids=["length-and-chunked", "two-lengths", "unknown-coding", "folded", "nul-in-path",
        "nul-in-field", "two-hosts", "no-host"])
def test_a_message_of_two_meanings_gets_one_answer_and_that_is_no(front, message):
    found = statuses(front.send(message, seconds=3))
    assert len(found) == 1 and 400 <= found[0] < 502, found


def test_what_is_too_large_is_refused_before_it_is_kept(front, server):
    before = server.memory()
    long_field = b"GET /healthz HTTP/1.1\r\n" + HOST + b"X: " + b"a" * 40000 + b"\r\n\r\n"
    assert statuses(front.send(long_field)) in ([400], [431], [494])
    many = b"".join(b"X%d: y\r\n" % i for i in range(5000))
    assert statuses(front.send(b"GET /healthz HTTP/1.1\r\n" + HOST + many + b"\r\n")) in ([400], [431])
    announced = (b"POST /v1/objects HTTP/1.1\r\n" + HOST + b"Content-Length: 99999999999\r\n\r\n")
    assert statuses(front.send(announced)) == [413]
    link = socket.create_connection(("127.0.0.1", front.port), 30)
    link.settimeout(30)
    link.sendall(b"POST /v1/objects HTTP/1.1\r\n" + HOST + b"Transfer-Encoding: chunked\r\n\r\n")
    chunk = b"100000\r\n" + b"v" * 0x100000 + b"\r\n"
    try:
        for _ in range(80):
            link.sendall(chunk)
    except OSError:
        pass  # Refused while it was still coming.
    assert statuses(link.recv(4096)) == [413]
    link.close()
    packed = requests.post(f"{front.url}/v1/objects", data=b"\x1f\x8b" + b"0" * 100,
                           headers={"Content-Encoding": "gzip"}, timeout=10)
    assert packed.status_code == 415
    ranges = "bytes=" + ",".join(f"{i}-" for i in range(300))
    page = requests.get(front.url + "/", headers={"Range": ranges}, timeout=10)
    assert page.status_code == 200
    assert server.memory() - before < 32 << 20


def open_slow(front, address, what):
    """A head or a body that will come a byte at a time, or an answer that is read so."""
    link = socket.socket()
    if what == "reading":
        link.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1024)
    link.bind((address, 0))
    link.settimeout(5)
    link.connect(("127.0.0.1", front.port))
    link.sendall({
        "head": b"GET /healthz HTTP/1.1\r\nHost: a\r\nX-",
        "body": b"POST /v1/objects HTTP/1.1\r\nHost: a\r\nContent-Length: 5000\r\n\r\nv",
        "reading": b"GET /openapi.json HTTP/1.1\r\nHost: a\r\n\r\n"}[what])
    link.setblocking(False)
    return link


def test_slow_clients_do_not_slow_others(front):
    """Heads and bodies that come, and answers that are taken, a byte at a time, on
    many connections from many addresses."""
    count = SLOW_CLIENTS
    _, most = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))
    slow = [(open_slow(front, f"127.0.1.{i // 10 % 250}", what), what)
            for i, what in zip(range(count), itertools.cycle(["head", "body", "reading"]))]
    stop = threading.Event()

    def drip():
        while not stop.wait(0.5):
            for link, what in slow:
                try:
                    if what == "reading":
                        link.recv(1)
                    else:
                        link.send(b"a")
                except OSError:
                    pass

    dripping = threading.Thread(target=drip)
    dripping.start()
    seconds = []
    for _ in range(100):
        begin = time.monotonic()
        assert statuses(front.send(
            b"GET /healthz HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n",
            address="127.0.0.2")) == [200]
        seconds.append(time.monotonic() - begin)
    print(f"\n{count} slow clients: health p99 {1e3 * sorted(seconds)[98]:.1f} ms")
    stop.set()
    dripping.join()
    for link, _ in slow:
        link.close()


def test_whoever_asks_too_much_is_told_to_wait(front):
    session = requests.Session()
    found = [session.post(f"{front.url}/v1/categories", json={}, timeout=10).status_code
             for _ in range(120)]
    assert set(found) <= {400, 429} and 429 in found
    assert requests.get(front.url + "/healthz", timeout=5).status_code == 200
