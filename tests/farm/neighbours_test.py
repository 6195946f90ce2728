#!/usr/bin/python3
"""Ten hostile clients of each kind beside a polite one, on demand: what the polite one's small meshes take.

    tests/farm/run neighbours [--meshes N] [--seconds S] [--kind KIND]

Prints a table for docs/security.md. Each kind has a server of its own with its default settings; a client is an
address. How long the polite client waits, and how often it is refused, is told, and asserted by nobody: it depends on
the machine.
"""

import argparse
import functools
import hashlib
import itertools
import pathlib
import statistics
import struct
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "server"))

from raw_http2 import RawCall, field, message  # noqa: E402
from running_server import RunningServer, binaries, wait_until  # noqa: E402

CLIENTS = 10
WIDE = 1 << 30
MESHES, GRIDS, JOBS = (f"/tetstream.v1.{name}Service/" for name in ("Mesh", "Grid", "Job"))
ELLIPSOIDS = (
    "mesh { spacing: 0.24 scene { nodes { name: 'g' ellipsoid { semi_axes: 1 "
    "semi_axes: 0.7 semi_axes: 0.5 } } nodes { repeat { of: 'g' count: 16 count: 16 count: 8 step: 1.9 "
    "step: 1.3 step: 0.9 } } } }")
SMALL_BALL = 'mesh { scene { nodes { sphere { radius: 1 } } } spacing: %.9f levels: 0 }'


@functools.lru_cache(maxsize=None)
def encoded(kind, text):
    """A message of the protocol from protobuf's text format."""
    proto = HERE.parents[1] / "proto"
    return subprocess.run(
        ["protoc", f"--proto_path={proto}", f"--encode=tetstream.v1.{kind}",
         *(f"tetstream/v1/{name}.proto" for name in ("meshes", "grids", "jobs"))],
        input=text.encode(), stdout=subprocess.PIPE, check=True).stdout


def at_spacing(kind, text, spacing, number):
    """The message, whose spacing is `spacing` in the text: a little more, so that nobody remembers its mesh."""
    changed = struct.pack("<d", spacing * (1 + 1e-5 * number))
    return encoded(kind, text).replace(struct.pack("<d", spacing), changed)


def small_ball(number):
    """A mesh of some ten thousand tets."""
    return at_spacing("StreamMeshRequest", SMALL_BALL % 0.1, 0.1, number)


class Crowd:
    """What ten clients do; `act` is called again and again."""

    def __init__(self, port):
        self.port = port
        self.calls = []
        self.answered = 0  # calls that ended, and were asked again
        self.numbers = itertools.count()

    def call(self, client, method, **how):
        return RawCall(self.port, method, source=f"127.0.0.{2 + client}", **how)

    def again(self, each, begin):
        """Keeps `each` calls of every client under way."""
        for _, call in self.calls:
            if call.ended:
                call.close()
                self.answered += 1
        self.calls = [call for call in self.calls if not call[1].ended]
        for client in range(CLIENTS):
            for _ in range(each - sum(owner == client for owner, _ in self.calls)):
                self.calls.append((client, begin(client)))
        for _, call in self.calls:
            call.listen(0)

    def asked(self, method, payload, **how):
        """Begins calls with these bytes, or with those that `payload` makes of each call's number."""
        def begin(client):
            call = self.call(client, method, **how)
            call.ask(payload(next(self.numbers)) if callable(payload) else payload)
            return call
        return begin

    def estimates(self, text, spacing):
        return self.asked(MESHES + "EstimateMesh",
                          lambda number: at_spacing("EstimateMeshRequest", text, spacing, number))


class RepeatedEllipsoids(Crowd):
    """EstimateMesh, 10 each: 2048 ellipsoids that look cheap (132 bytes)"""

    def act(self):
        self.again(10, self.estimates(ELLIPSOIDS, 0.24))


class RememberedEllipsoids(Crowd):
    """the same request again and again, whose plan is remembered"""

    def act(self):
        self.again(10, self.asked(MESHES + "EstimateMesh", encoded("EstimateMeshRequest", ELLIPSOIDS)))


class HugePlans(Crowd):
    """EstimateMesh, 10 each: a sphere at 1/1000 of its radius (26 bytes)"""

    def act(self):
        self.again(10, self.estimates("mesh { scene { nodes { sphere { radius: 1 } } } spacing: 0.001 }", 0.001))


class FastStreams(Crowd):
    """StreamMesh, 10 each, read as fast as they come: 1.6 M tets"""

    def act(self):
        self.again(10, self.asked(MESHES + "StreamMesh", encoded(
            "StreamMeshRequest", SMALL_BALL % 0.03), window=WIDE))


class SlowStreams(Crowd):
    """StreamMesh, 32 each, of which nothing is read: they had all places"""

    def act(self):
        self.again(32, self.asked(MESHES + "StreamMesh", encoded(
            "StreamMeshRequest", SMALL_BALL % 0.03), window=20000))


class Uploads(Crowd):
    """UploadGrid, 16 each, that send all but the last byte"""

    def act(self):
        def begin(client):
            content = time.monotonic_ns().to_bytes(8, "big") + bytes(1 << 20)
            call = self.call(client, GRIDS + "UploadGrid")
            name = "grids/" + hashlib.sha256(content).hexdigest()
            start = field(1, field(1, name) + field(2, len(content)))
            call.send(message(start) + message(field(2, field(2, content)))[:-1], seconds=1)
            return call
        self.again(16, begin)


class Lists(Crowd):
    """ListJobs, 50 each at once, again and again"""

    def act(self):
        self.again(50, self.asked(JOBS + "ListJobs", encoded("ListJobsRequest", "page_size: 1000")))


class Watches(Crowd):
    """WatchJobs, 100 each"""

    def act(self):
        self.again(100, self.asked(JOBS + "WatchJobs", encoded("WatchJobsRequest", "")))


class HealthWatches(Crowd):
    """Health/Watch, 100 each"""

    def act(self):
        self.again(100, self.asked("/grpc.health.v1.Health/Watch", b""))


class Sessions(Crowd):
    """RemeshSession, 10 each: a frame after a frame, every second refused"""

    FRAMES = tuple(f"frame {{ scene {{ nodes {{ sphere {{ radius: {radius} }} }} }} }}" for radius in (1.01, -1))

    def act(self):
        start = encoded("RemeshRequest", "tell_refusals: true start { spacing: 0.05 scene { nodes { sphere { "
                        "radius: 1 } } } }")

        def begin(client):
            call = self.call(client, MESHES + "RemeshSession", window=WIDE)
            call.send(message(start), seconds=1)
            return call
        self.again(10, begin)
        for _, call in self.calls:
            for frame in self.FRAMES:
                call.send(message(encoded("RemeshRequest", frame)), seconds=1)


KINDS = (RepeatedEllipsoids, RememberedEllipsoids, HugePlans, FastStreams, SlowStreams, Uploads, Lists, Watches, HealthWatches,
         Sessions)


def be_hostile(kind, port):
    crowd = kind(port)
    told = False
    while True:
        try:
            crowd.act()
        except OSError:
            pass  # the server may hang up
        if not told:
            print("begun", flush=True)
            told = True
        time.sleep(0.01)


def polite_meshes(port, count, first, seconds):
    """Seconds of each mesh from a connection to its last byte, and what was refused."""
    times, refused = [], 0
    end = time.monotonic() + seconds
    for number in range(first, first + count):
        begin = time.monotonic()
        if begin >= end:
            break
        call = RawCall(port, MESHES + "StreamMesh", window=WIDE)
        call.ask(small_ball(number))
        assert call.wait_for_end(), "the polite client waits for ever"
        call.close()
        refused += b"grpc-status\x010" not in call.trailers
        times.append(time.monotonic() - begin)
    return times, refused


def line(what, told, server):
    times, refused = told
    peak = int(next(text.split()[1] for text in pathlib.Path(
        f"/proc/{server.process.pid}/status").read_text().splitlines() if text.startswith("VmHWM")))
    ordered = sorted(times)
    print(f"| {what} | {1e3 * statistics.median(ordered):.0f} ms "
          f"| {1e3 * ordered[len(ordered) * 99 // 100]:.0f} ms | {refused} of {len(ordered)} "
          f"| {peak >> 10} MiB |", flush=True)


def measure(kind, meshes, seconds):
    with tempfile.TemporaryDirectory() as folder, RunningServer(
            pathlib.Path(folder) / "store") as server:
        port = int(server.address.rsplit(":", 1)[1])
        polite_meshes(port, 10, 0, seconds)
        if kind is None:
            return line("nobody", polite_meshes(port, meshes, 1000, seconds), server)
        hostile = subprocess.Popen([sys.executable, __file__, "--hostile", kind.__name__, str(port)],
                                   stdout=subprocess.PIPE)
        try:
            wait_until(hostile.stdout.readline)
            line(kind.__doc__, polite_meshes(port, meshes, 1000, seconds), server)
        finally:
            hostile.kill()
            hostile.wait()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--meshes", type=int, default=300)
    parser.add_argument("--seconds", type=float, default=60, help="of each kind, at most")
    parser.add_argument("--kind", choices=[kind.__name__ for kind in KINDS])
    parser.add_argument("--hostile", nargs=2)
    options = parser.parse_args()
    if options.hostile:
        be_hostile(globals()[options.hostile[0]], int(options.hostile[1]))
    print(f"{options.meshes} meshes beside {CLIENTS} clients that do this; programs in {binaries()}\n")
    print("| ten clients beside it | p50 | p99 | refused | server's peak |\n| --- | --- | --- | --- | --- |")
    for kind in (None, *KINDS):
        if options.kind in (None, kind and kind.__name__):
            measure(kind, options.meshes, options.seconds)


if __name__ == "__main__":
    main()
