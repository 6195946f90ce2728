"""Waiting for what another program does."""

import os
import pathlib
import random
import re
import socket
import time
import urllib.error
import urllib.request

# How long a test waits for what has to come. It is no claim about speed: it only ends tests that would
# wait for ever, and must be long enough for a machine that compiles beside them: of two dozen busy processes
# a server's jobs, which give way to all others, get a four-hundredth.
GENEROUS_END = 900.0


def wait_until(condition, seconds=GENEROUS_END):
    """What `condition` says once it says anything true.

    Asking may take a process, or a page of metrics: it rests for as long as the last answer took.
    """
    deadline = time.monotonic() + seconds
    while True:
        asked = time.monotonic()
        if said := condition():
            return said
        answered = time.monotonic()
        if answered > deadline:
            raise AssertionError("waited in vain")
        time.sleep(min(max(0.01, answered - asked), 1))


def catches(process, signal_number):
    """Whether it has begun to handle the signal; before that one ends it as it ends any program."""
    status = pathlib.Path(f"/proc/{process.pid}/status").read_text()
    caught = next(line for line in status.splitlines() if line.startswith("SigCgt"))
    return int(caught.split()[1], 16) >> (signal_number - 1) & 1 == 1


def processor_seconds(process):
    """What it has used so far, of all its threads: how far it has come, whatever else runs."""
    fields = pathlib.Path(f"/proc/{process.pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def fetch(address, path):
    """(status, body) of http://ADDRESS/PATH, which is asked again where nobody heard the question: the
    server waits for one no longer than it has to."""
    def ask():
        try:
            with urllib.request.urlopen(f"http://{address}{path}", timeout=GENEROUS_END) as response:
                return response.status, response.read().decode()
        except urllib.error.HTTPError as error:
            return error.code, error.read().decode()
        except urllib.error.URLError as error:
            if not isinstance(error.reason, (ConnectionResetError, BrokenPipeError)):
                raise
        except ConnectionResetError:
            pass
        return None

    return wait_until(ask)


def samples_of(address, new=True):
    """{name{labels}: value} of http://ADDRESS/metrics. Unless they need not be `new`, they are asked for
    until those of disks and databases are: where these take long, what was read before is told."""
    def ask():
        text = fetch(address, "/metrics")[1]
        samples = {m[1]: float(m[2]) for m in re.finditer(r"^([^#\s]\S*) (\S+)$", text, re.MULTILINE)}
        return None if new and samples.get("tetstream_readings_old") else samples

    return wait_until(ask)


_reservations = []


def unused_port():
    """A port for a server that may be started on it again: nobody else gets it as long as this
    program lives.

    It lies below those that the system gives to connections, and to whoever asks for any port; other
    tests are kept off by a name.
    """
    lowest = int(pathlib.Path("/proc/sys/net/ipv4/ip_local_port_range").read_text().split()[0])
    while True:
        port = random.randrange(10000, lowest)
        reservation = socket.socket(socket.AF_UNIX)
        try:
            reservation.bind(f"\0tetstream-test-port-{port}")
            with socket.socket() as probe:
                probe.bind(("127.0.0.1", port))
        except OSError:
            reservation.close()
            continue
        _reservations.append(reservation)
        return port
