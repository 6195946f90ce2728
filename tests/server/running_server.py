"""A real tetstreamd for tests of whole programs: started on free ports, watched, stopped."""

import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "support"))

from waiting import (  # noqa: E402 (re-exported)
    GENEROUS_END, fetch, samples_of, unused_port, wait_until)

__all__ = ["GENEROUS_END", "RunningProgram", "RunningServer", "RunningWorker", "binaries", "fetch",
           "unused_port", "wait_until"]


def binaries():
    """Where tetstream, tetstreamd and make_fixture are."""
    return pathlib.Path(os.environ["TETSTREAM_BIN"])


# Nobody waits for a balancer of load, and nothing is cut off or given up because the machine is slow.
UNHURRIED = {"TETSTREAM_LAME_DUCK_SECONDS": "0", "TETSTREAM_DRAIN_SECONDS": "600",
             "TETSTREAM_GRACE_SECONDS": "900", "TETSTREAM_STALL_SECONDS": "3600",
             "TETSTREAM_KEEPALIVE_SECONDS": "3600", "TETSTREAM_HANDSHAKE_SECONDS": "3600"}


class RunningProgram:
    """tetstreamd with these arguments, until it is stopped. `metrics` is host:port.

    `launch` is put before its command, and must become it (exec).
    """

    def __init__(self, ready_event, *arguments, environment=None, launch=()):
        self._log = tempfile.TemporaryFile()
        self.process = subprocess.Popen(
            [*launch, binaries() / "tetstreamd", *map(str, arguments),
             "--metrics-listen", "127.0.0.1:0"],
            stdout=subprocess.DEVNULL, stderr=self._log,
            env={**UNHURRIED, **os.environ, **(environment or {})})
        try:
            self.ready = wait_until(lambda: self._line(ready_event))
        except AssertionError:
            said = self.text()
            self.close()
            raise AssertionError(said) from None
        self.metrics = self.ready["metrics"]

    def _line(self, event):
        if self.process.poll() is not None:
            raise AssertionError("tetstreamd ended")
        return next(iter(self.log(event)), None)

    def _written(self):
        return os.pread(self._log.fileno(), 1 << 24, 0)

    def text(self):
        """What it has written to standard error."""
        return self._written().decode(errors="replace")

    def log(self, event=None):
        """Its log lines, whole ones, as dictionaries; all of them are UTF-8."""
        lines = [json.loads(line) for line in self._written().split(b"\n")[:-1]]
        return [line for line in lines if event in (None, line["event"])]

    def told(self, event, **fields):
        """Its log lines of this event and with these values, once there is one: who did what a line
        tells of has not waited for it."""
        return wait_until(lambda: [line for line in self.log(event)
                                   if fields.items() <= line.items()])

    def samples(self):
        """{name{labels}: value} of /metrics."""
        return samples_of(self.metrics)

    def kill(self):
        self.process.kill()
        self.process.wait()

    def close(self):
        self.kill()
        self._log.close()

    def terminate(self):
        """Its exit code after SIGTERM."""
        self.process.send_signal(signal.SIGTERM)
        return self.process.wait(GENEROUS_END)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


class RunningServer(RunningProgram):
    """Serves `store`. `address` is host:port."""

    def __init__(self, store, *options, listen="127.0.0.1:0", **more):
        super().__init__("serving", "--store", store, "--listen", listen, "--threads", "2", *options,
                         **more)
        self.address = self.ready["address"]

    def tetstream(self, *arguments, timeout=GENEROUS_END, **options):
        """Runs the command line; the server's address goes where "--server" ends the arguments."""
        return subprocess.run(
            [binaries() / "tetstream", *map(str, arguments), "--server", self.address],
            capture_output=True, text=True, timeout=timeout, check=False, **options)


class RunningWorker(RunningProgram):
    """Does jobs for the servers of `store` that keep them at `jobs`."""

    def __init__(self, store, jobs, *options, **more):
        super().__init__("working", "worker", "--store", store, "--jobs", jobs, "--threads", "1",
                         *options, **more)
