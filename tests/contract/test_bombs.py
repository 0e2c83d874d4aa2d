"""What is small to send and could be large to hold. Each bomb meets a server of its
own, fresh, so that the kernel's high-water mark tells what the bomb cost; the
figures are told. A body may take as much as the limit of bodies and its copy, JSON
64 MiB, everything else 32 MiB."""

import socket
import struct
import time

import pytest
import requests

import meshes
from contract_client import SLOWER
from live_server import LiveServer

MIB = 1 << 20
BODY_LIMIT = 64 * MIB
BODY_BUDGET = 128 * MIB  # Of all bodies.
HOST = b"Host: localhost\r\n"


def post(path, fields=b"", body=b""):
    return b"POST " + path + b" HTTP/1.1\r\n" + HOST + fields + b"\r\n" + body


def json_of(body, path=b"/v1/categories"):
    return post(path, b"Content-Type: application/json\r\nContent-Length: %d\r\n" % len(body), body)


def upload_of(body, path=b"/v1/objects"):
    return post(path, b"Content-Length: %d\r\n" % len(body), body)


def form_of(body):
    return post(b"/v1/objects", b"Content-Type: multipart/form-data; boundary=x\r\n"
                b"Content-Length: %d\r\n" % len(body), body)


CHUNKED = b"Transfer-Encoding: chunked\r\n"
CHUNK = b"100000\r\n" + b"#" * MIB + b"\r\n"
PLY = (b"ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\n"
       b"property float y\nproperty float z\nelement face 4000000000\n"
       b"property list uchar int vertex_indices\nend_header\n")

LABELS_HEAD = (b'--x\r\nContent-Disposition: form-data; name="mesh"; filename="b.obj"\r\n\r\n'
               + meshes.box_obj(0.04, 0.05, 0.06)
               + b'\r\n--x\r\nContent-Disposition: form-data; name="labels"; filename="l.json"'
               b'\r\n\r\n{"face_labels":[')
LABELS_END = b"[]]}\r\n--x--\r\n"

# What is sent, what it repeats until it is answered, the statuses, the most bytes.
BOMBS = {
    "announced-without-end": (post(b"/v1/objects", b"Content-Length: 99999999999\r\n"), b"", {413}, 32),
    "chunks-without-end": (post(b"/v1/objects", CHUNKED), CHUNK, {413}, 2 * BODY_LIMIT // MIB + 16),
    "json-chunks-without-end": (post(b"/v1/categories", b"Content-Type: application/json\r\n"
                                     + CHUNKED), CHUNK, {413}, 32),
    "chunks-of-one-byte": (post(b"/v1/objects", CHUNKED, b"1\r\n#\r\n" * 500_000 + b"0\r\n\r\n"),
                           b"", {422}, 32),
    "chunk-size-without-end": (post(b"/v1/objects", CHUNKED), b"0" * MIB, {400}, 32),
    "chunk-extension": (post(b"/v1/objects", CHUNKED, b"1;"), b"a=" * MIB, {400}, 32),
    "chunk-trailers": (post(b"/v1/objects", CHUNKED, b"1\r\n#\r\n0\r\n"), b"X-Y: z\r\n" * 10_000,
                       {400, 422, 431}, 32),
    "packed": (post(b"/v1/objects", b"Content-Encoding: gzip\r\nContent-Length: 4\r\n",
                    b"\x1f\x8b\x08\0"), b"", {415}, 32),
    "a-field-without-end": (b"GET /healthz HTTP/1.1\r\n" + HOST + b"X: ", b"a" * MIB, {431}, 32),
    "fields-without-end": (b"GET /healthz HTTP/1.1\r\n" + HOST, b"X: y\r\n" * 10_000, {431}, 32),
    "a-target-without-end": (b"GET /", b"a" * MIB, {414, 431}, 32),
    "many-ranges": (b"GET /openapi.json HTTP/1.1\r\n" + HOST + b"Range: bytes="
                    + b"0-," * 2000 + b"0-\r\n\r\n", b"", {200, 404}, 32),
    "many-parameters": (b"GET /v1/objects?" + b"&" * 7000 + b" HTTP/1.1\r\n" + HOST + b"\r\n", b"",
                        {200, 400}, 32),
    "form-of-many-parts": (form_of(b'--x\r\nContent-Disposition: form-data; name="a"\r\n\r\n\r\n'
                                   * 100_000 + b"--x--"), b"", {400, 413}, 32),
    "form-of-many-ends": (form_of(b"--x\r\n" * MIB), b"", {400, 413}, 32),
    "form-with-a-head-without-end": (form_of(b"--x\r\nX: " + b"a" * 8 * MIB), b"", {400, 413}, 64),
    "form-with-millions-of-labels": (
        post(b"/v1/categories/mug/examples", b"Content-Type: multipart/form-data; boundary=x\r\n"
             b"Content-Length: %d\r\n" % (len(LABELS_HEAD) + 60 * MIB + len(LABELS_END)),
             LABELS_HEAD + b"[]," * (20 * MIB) + LABELS_END), b"", {400, 413},
        3 * BODY_LIMIT // MIB),
    "deep-json": (json_of(b"[" * 1_000_000), b"", {400}, 64),
    "wide-json": (json_of(b"[" + b"[]," * 330_000 + b"[]]"), b"", {400, 413}, 64),
    "json-of-one-field-many-times": (json_of(b"{" + b'"a":0,' * 160_000 + b'"a":0}'), b"", {400}, 64),
    "json-of-many-fields": (json_of(b"{" + b",".join(b'"%x":0' % i for i in range(90_000)) + b"}"),
                            b"", {400, 413}, 64),
    "json-of-a-long-number": (json_of(b'{"name":1' + b"0" * 1_000_000 + b"}"), b"", {400}, 64),
    "json-of-a-long-text": (json_of(b'{"name":"' + b"\\u00e9" * 160_000 + b'"}'), b"", {400}, 64),
    "json-of-a-small-number": (json_of(b'{"name":1e-' + b"9" * 1_000_000 + b"}"), b"", {400}, 64),
    "ply-that-lies": (upload_of(PLY, b"/v1/objects?format=ply"), b"", {413, 422}, 32),
    "stl-that-lies": (upload_of(b"\0" * 80 + struct.pack("<I", 4_000_000_000),
                                b"/v1/objects?format=stl"), b"", {413, 422}, 32),
}


def throw(port, sent, more):
    """Sends, and goes on until an answer comes; its status."""
    with socket.create_connection(("127.0.0.1", port), 60) as link:
        try:
            link.sendall(sent)
            link.settimeout(0.001 if more else 60)
            left = 1000
            while left:
                try:
                    answer = link.recv(65536)
                    break
                except TimeoutError:
                    left -= 1
                    link.settimeout(60)
                    link.sendall(more)
                    link.settimeout(0.001)
            assert left, "it is still read"
        except (ConnectionResetError, BrokenPipeError):
            link.settimeout(60)
            answer = link.recv(65536)
    assert answer.startswith(b"HTTP/1.1 "), answer[:200]
    return int(answer[9:12])


@pytest.mark.parametrize("name", BOMBS)
def test_what_is_small_to_send_is_small_to_hold(binary, tmp_path, name):
    sent, more, statuses, most = BOMBS[name]
    live = LiveServer(binary, tmp_path / "a.db", tmp_path)
    requests.get(live.url + "/healthz", timeout=20)
    before = live.memory()
    begin = time.monotonic()
    status = throw(live.port, sent, more)
    seconds = time.monotonic() - begin
    grown = live.memory("VmHWM") - before
    assert requests.get(live.url + "/healthz", timeout=20).status_code == 200
    assert live.stop() == 0, live.log()
    print(f"\n{name}: {status} after {1e3 * seconds:.0f} ms, {grown / MIB:.1f} MiB")
    assert status in statuses
    assert grown < most * MIB or SLOWER > 1


def test_many_at_once_are_held_within_the_budget_of_bodies(binary, tmp_path):
    """Forty bodies without end, more than all that may be held."""
    live = LiveServer(binary, tmp_path / "a.db", tmp_path)
    requests.get(live.url + "/healthz", timeout=20)
    before = live.memory()
    links = [socket.create_connection(("127.0.0.1", live.port), 60) for _ in range(40)]
    for link in links:
        link.sendall(post(b"/v1/objects", CHUNKED))
    sending = list(links)
    for _ in range(20):
        for link in list(sending):
            try:
                link.sendall(CHUNK)
            except OSError:
                sending.remove(link)  # It has been refused.
    grown = live.memory("VmHWM") - before
    assert requests.get(live.url + "/healthz", timeout=20).status_code == 200
    refused = 0
    for link in links:
        link.settimeout(0.05)
        try:
            answer = link.recv(65536)
            assert not answer or answer.startswith(b"HTTP/1.1 503 "), answer[:200]
            refused += 1
        except TimeoutError:
            pass  # Still read.
        except OSError:
            refused += 1
        link.close()
    assert 0 < refused < len(links)
    box = meshes.box_obj(0.04, 0.05, 0.06)
    assert requests.post(live.url + "/v1/objects?format=obj", data=box, timeout=60).ok
    assert live.stop() == 0, live.log()
    print(f"\nforty bodies, {refused} refused: {grown / MIB:.1f} MiB")
    # What grows is copied at times.
    assert grown < 3 * BODY_BUDGET or SLOWER > 1
