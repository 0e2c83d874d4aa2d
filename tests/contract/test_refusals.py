"""What every operation may refuse, it does in the form that the contract declares."""

import socket
import time

import pytest

from contract_client import Contract, load_spec, operations, resolve
from live_server import LiveServer

SPEC = load_spec()
OPERATIONS = [op[0] for op in operations(SPEC)]
WITH_BODY = [op[0] for op in operations(SPEC) if "requestBody" in op[3]]
BODY_LIMIT = 2000  # Of uploads, bytes.
JSON_LIMIT = 4 << 20
NAMES = {"id": "a", "name": "a", "file": "a"}


@pytest.fixture(scope="module")
def live(binary, tmp_path_factory):
    """A server of one thread, for which four connections may wait."""
    folder = tmp_path_factory.mktemp("refusals")
    live = LiveServer(binary, folder / "a.db", folder, "--http-threads", "1",
                      "--max-upload-bytes", str(BODY_LIMIT))
    yield live
    assert live.stop() == 0, live.log()
    assert "event=internal" not in live.log(), live.log()


@pytest.fixture
def client(live):
    """Whoever keeps the connection has the only thread."""
    client = Contract(live.url)
    client.session.headers["Connection"] = "close"
    return client


def names_in(client, operation_id):
    return {name: value for name, value in NAMES.items()
            if "{" + name + "}" in client.by_id[operation_id][1]}


@pytest.mark.parametrize("operation_id", OPERATIONS)
def test_a_page_of_another_site(client, operation_id):
    problem = client.call(operation_id, 400, path=names_in(client, operation_id),
                          headers={"Host": "evil.example"})
    assert problem["code"] == "malformed_request"


@pytest.mark.parametrize("operation_id", WITH_BODY)
def test_a_body_over_the_limit(client, operation_id):
    content = resolve(SPEC, client.by_id[operation_id][2]["requestBody"])["content"]
    is_json = "application/octet-stream" not in content and "multipart/form-data" not in content
    headers = {"Content-Type": "application/json"} if is_json else {}
    problem = client.call(operation_id, 413, path=names_in(client, operation_id), headers=headers,
                          body=b" " * ((JSON_LIMIT if is_json else BODY_LIMIT) + 1))
    assert problem["code"] == "too_large"


@pytest.mark.parametrize("operation_id", WITH_BODY)
def test_a_packed_body(client, operation_id):
    problem = client.call(operation_id, 415, path=names_in(client, operation_id), body=b"\x1f\x8b",
                          headers={"Content-Encoding": "gzip"})
    assert problem["code"] == "unsupported_media_type"


def test_more_connections_than_are_waited_for(live, client):
    """One that does not say what it wants, and four that wait for it to."""
    def crowd():
        links = []
        for _ in range(5):
            links.append(socket.create_connection(("127.0.0.1", live.port), 20))
            links[-1].sendall(b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n")
        time.sleep(0.1)
        return links

    links = crowd()
    begin = time.monotonic()
    for operation_id in OPERATIONS:
        # Whoever does not go on is cut off after ten seconds.
        if time.monotonic() - begin > 5:
            for link in links:
                link.close()
            links = crowd()
            begin = time.monotonic()
        if operation_id == "getHealth":
            client.call(operation_id, 200)
            continue
        problem = client.call(operation_id, 503, path=names_in(client, operation_id))
        assert problem["code"] == "overloaded"
        assert client.last.headers["Retry-After"]
    for link in links:
        link.sendall(b"Connection: close\r\n\r\n")
        assert link.recv(100).startswith(b"HTTP/1.1 200 OK")
        link.close()
    client.call("getHealth", 200)
