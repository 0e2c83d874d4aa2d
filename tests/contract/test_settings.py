"""What a server is told by flag, environment and file, in this order, and that it
keeps to this machine unless told."""

import socket

import live_server
from live_server import LiveServer


def printed(log):
    """The settings of the line that the start prints."""
    line = next(line for line in log.splitlines() if line.startswith("graspdb: host "))
    return dict(pair.split(" ", 1) for pair in line.removeprefix("graspdb: ").split(", "))


def can_connect(address, port):
    try:
        socket.create_connection((address, port), 5).close()
        return True
    except ConnectionRefusedError:
        return False


def test_by_default_only_this_machine_is_listened_to(binary, tmp_path):
    live = LiveServer(binary, tmp_path / "a.db", tmp_path)
    assert can_connect("127.0.0.1", live.port)
    assert not can_connect("127.0.0.2", live.port)
    assert live.stop() == 0, live.log()
    assert printed(live.log())["host"] == "127.0.0.1"


def test_told_so_every_address_is_listened_to(binary, tmp_path):
    live = LiveServer(binary, tmp_path / "a.db", tmp_path, "--host", "0.0.0.0")
    assert can_connect("127.0.0.1", live.port) and can_connect("127.0.0.2", live.port)
    assert live.stop() == 0, live.log()
    assert printed(live.log())["host"] == "0.0.0.0"


def test_a_flag_outdoes_the_environment_and_that_the_file(binary, tmp_path, monkeypatch):
    config = tmp_path / "graspdb.toml"
    config.write_text("max_backups = 3\nhttp_threads = 30\nmax_queued_jobs = 300\n")
    monkeypatch.setitem(live_server.ENVIRONMENT, "GRASPDB_HTTP_THREADS", "20")
    monkeypatch.setitem(live_server.ENVIRONMENT, "GRASPDB_MAX_QUEUED_JOBS", "200")
    live = LiveServer(binary, tmp_path / "a.db", tmp_path, "--config", str(config),
                      "--max-queued-jobs", "100")
    assert live.stop() == 0, live.log()
    settings = printed(live.log())
    assert settings["max-backups"] == "3"
    assert settings["http-threads"] == "20"
    assert settings["max-queued-jobs"] == "100"


def test_a_signal_as_soon_as_the_port_is_known_ends_it_in_good_order(binary, tmp_path):
    for _ in range(10):
        live = LiveServer(binary, tmp_path / "a.db", tmp_path)
        assert live.stop() == 0, live.log()
