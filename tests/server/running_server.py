"""A real tetstreamd for tests of whole programs: started on free ports, watched, stopped."""

import json
import os
import pathlib
import re
import signal
import subprocess
import tempfile
import time
import urllib.error
import urllib.request


def binaries():
    """Where tetstream, tetstreamd and make_fixture are."""
    return pathlib.Path(os.environ["TETSTREAM_BIN"])


def wait_until(condition, seconds=20.0):
    """What `condition` says once it says anything true."""
    deadline = time.monotonic() + seconds
    while not (said := condition()):
        if time.monotonic() > deadline:
            raise AssertionError("waited in vain")
        time.sleep(0.01)
    return said


def fetch(address, path):
    """(status, body) of http://ADDRESS/PATH."""
    try:
        with urllib.request.urlopen(f"http://{address}{path}", timeout=5) as response:
            return response.status, response.read().decode()
    except urllib.error.HTTPError as error:
        return error.code, error.read().decode()


class RunningServer:
    """Serves `store` until it is stopped. `address` and `metrics` are host:port."""

    def __init__(self, store, *options, listen="127.0.0.1:0", environment=None):
        self._log = tempfile.TemporaryFile()
        self.process = subprocess.Popen(
            [binaries() / "tetstreamd", "--store", store, "--listen", listen,
             "--metrics-listen", "127.0.0.1:0", "--threads", "2", *options],
            stdout=subprocess.DEVNULL, stderr=self._log,
            env={**os.environ, **(environment or {})})
        try:
            serving = wait_until(self._serving)
        except AssertionError:
            self.kill()
            raise AssertionError(self.text()) from None
        self.address, self.metrics = serving["address"], serving["metrics"]

    def _serving(self):
        if self.process.poll() is not None:
            raise AssertionError("tetstreamd ended")
        return next((line for line in self.log() if line["event"] == "serving"), None)

    def text(self):
        """What it has written to standard error."""
        return os.pread(self._log.fileno(), 1 << 24, 0).decode()

    def log(self, event=None):
        """Its log lines, whole ones, as dictionaries."""
        lines = [json.loads(line) for line in self.text().splitlines(True) if line.endswith("\n")]
        return [line for line in lines if event in (None, line["event"])]

    def samples(self):
        """{name{labels}: value} of /metrics."""
        text = fetch(self.metrics, "/metrics")[1]
        return {m[1]: float(m[2]) for m in re.finditer(r"^([^#\s]\S*) (\S+)$", text, re.MULTILINE)}

    def tetstream(self, *arguments, **options):
        """Runs the command line; the server's address goes where "--server" ends the arguments."""
        return subprocess.run(
            [binaries() / "tetstream", *map(str, arguments), "--server", self.address],
            capture_output=True, text=True, timeout=120, check=False, **options)

    def kill(self):
        self.process.kill()
        self.process.wait()

    def terminate(self):
        """Its exit code after SIGTERM."""
        self.process.send_signal(signal.SIGTERM)
        return self.process.wait(60)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.kill()
        self._log.close()
