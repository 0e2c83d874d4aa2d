"""A real graspdb on a database of its own, in a temporary folder."""

import os
import pathlib
import re
import signal
import socket
import subprocess
import time

from contract_client import LONGEST_WAIT, SLOWER, patient

ENVIRONMENT = {"LC_ALL": "C"}
if SLOWER > 1:
    ENVIRONMENT["GRASPDB_WAIT"] = str(LONGEST_WAIT)


class LiveServer:
    """Runs `graspdb serve` and ends it as an operator would."""

    def __init__(self, binary, database, folder, *flags, prefix=(), preexec_fn=None):
        self.database = database
        self.log_path = folder / "server.log"
        self.port_file = folder / "port"
        self.port_file.unlink(missing_ok=True)
        with open(self.log_path, "ab") as log:
            self.process = subprocess.Popen(
                [*prefix, binary, "serve", "--db", str(database), "--port", "0",
                 "--port-file", str(self.port_file), *flags],
                stdout=subprocess.DEVNULL, stderr=log, preexec_fn=preexec_fn,
                env=os.environ | ENVIRONMENT)
        self.port = self._wait_for_port()
        self.url = f"http://127.0.0.1:{self.port}"

    def _wait_for_port(self):
        deadline = time.monotonic() + patient(60)
        while time.monotonic() < deadline:
            if self.process.poll() is not None:
                break
            if self.port_file.exists():
                return int(self.port_file.read_text())
            time.sleep(0.02)
        raise RuntimeError(f"graspdb did not start:\n{self.log()}")

    def _wake(self):
        """The thread sanitizer of clang 14 keeps a signal from a thread that waits in
        accept() until that returns."""
        try:
            socket.create_connection(("127.0.0.1", self.port), 1).close()
        except OSError:
            pass  # It has gone already.

    def memory(self, name="VmRSS"):
        """Bytes, by their name in /proc: resident, or VmHWM, the most so far."""
        status = pathlib.Path(f"/proc/{self.process.pid}/status").read_text()
        return 1024 * int(re.search(name + r":\s+(\d+)", status)[1])

    def log(self):
        return self.log_path.read_text(errors="replace")

    def alive(self):
        return self.process.poll() is None

    def stop(self):
        """SIGTERM; answers the exit status."""
        if self.alive():
            self.process.send_signal(signal.SIGTERM)
            if SLOWER > 1:
                self._wake()
        try:
            return self.process.wait(timeout=patient(60))
        except subprocess.TimeoutExpired:
            self.process.kill()
            raise
