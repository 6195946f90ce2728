"""The settings of docker/compose.yml under its own memory limit, in a control group of the kernel's, with the
worst requests known: nothing is killed, and the server stays within what it was given.

    TETSTREAM_BIN=build/release/bin python3 tests/faults/memory_limit_test.py [unittest options]

Control groups are made by root, of version 1 or 2. Where none can be made it exits with 77, and has shown nothing.
"""

import contextlib
import hashlib
import os
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import time
import unittest

import yaml

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "server"), str(HERE.parent / "farm"), str(HERE.parent / "client")]

import neighbours_test as neighbours  # noqa: E402
from command_case import processor_seconds  # noqa: E402
from raw_http2 import RawCall, field, message  # noqa: E402
from running_server import RunningServer, binaries  # noqa: E402

COMPOSE = HERE.parents[1] / "docker" / "compose.yml"
MESHES, WIDE = neighbours.MESHES, neighbours.WIDE
GIB = 1 << 30
# What each kind of request is given, in seconds of the server's processors, unless all have ended before.
WORK = float(os.environ.get("WORK", 6))
# Who uses nothing for so long has nothing to do, or waits for clients that send nothing.
REST_SECONDS = 5
# Who has answered so many calls, three of each that a crowd has under way, and has taken no more memory for them,
# goes on like that: work that is counted, as time says nothing.
SAME_ANSWERS = 300
PAUSE_SECONDS = 0.05  # between looks at a hundred calls, which take the client's processor
MIB = 1 << 20


class MemoryGroup:
    """A control group that may have so many bytes."""

    V1, V2 = pathlib.Path("/sys/fs/cgroup/memory"), pathlib.Path("/sys/fs/cgroup")

    def __init__(self, limit):
        """Raises OSError where none can be made."""
        name = f"tetstream-test-{os.getpid()}"
        self.is_v1 = (self.V1 / "memory.limit_in_bytes").exists()
        if not self.is_v1 and "memory" not in (self.V2 / "cgroup.subtree_control").read_text():
            raise OSError("no control group may limit memory here")
        self.folder = (self.V1 if self.is_v1 else self.V2) / name
        self.folder.mkdir()
        try:
            (self.folder / ("memory.limit_in_bytes" if self.is_v1 else "memory.max")).write_text(str(limit))
        except OSError:
            self.remove()
            raise

    def remove(self):
        for _ in range(100):  # whoever was in it may not be quite gone
            try:
                return self.folder.rmdir()
            except OSError:
                time.sleep(0.1)

    def number(self, file, key=None):
        text = (self.folder / file).read_text()
        return int(re.search(rf"^{key} (\d+)$", text, re.MULTILINE)[1] if key else text)

    def peak(self):
        """None where the kernel does not tell."""
        file = "memory.max_usage_in_bytes" if self.is_v1 else "memory.peak"
        return self.number(file) if (self.folder / file).exists() else None

    def failures(self):
        """How often there was not room, and how many were killed for that."""
        if self.is_v1:
            return self.number("memory.failcnt"), self.number("memory.oom_control", "oom_kill")
        return self.number("memory.events", "max"), self.number("memory.events", "oom_kill")

    def entered_by(self):
        """What is put before a command so that it runs within."""
        return ("sh", "-c", f'echo $$ > {self.folder}/cgroup.procs && exec "$@"', "sh")


class Spheres(neighbours.Crowd):
    """EstimateMesh of a sphere at 1/1700 of its radius, and at those which are not refused"""

    ASKS_ONCE = True

    def act(self):
        if self.calls:
            return self.listen()
        for number, spacing in enumerate((1 / 1700, 1 / 1700, 1 / 454, 1 / 400, 1 / 333, 1 / 286)):
            text = f"mesh {{ scene {{ nodes {{ sphere {{ radius: 1 }} }} }} spacing: {spacing!r} }}"
            self.calls.append((number, self.asked(
                MESHES + "EstimateMesh", neighbours.encoded("EstimateMeshRequest", text))(number)))

    def listen(self):
        for _, call in self.calls:
            call.listen(0)


class RandomSigns(Spheres):
    """EstimateMesh of a grid of random signs, whose surface goes through all bricks"""

    name = None  # of the grid

    def act(self):
        if self.calls:
            return self.listen()
        for number in range(6):
            mesh = field(1, self.name) + struct.pack("<Bd", 3 << 3 | 1, 0.075 * (1 + 1e-5 * number))
            self.calls.append((number, self.asked(MESHES + "EstimateMesh", field(1, mesh))(number)))


class ScatteredLeaves(Spheres):
    """RemeshSession: a frame of 100,000 scattered constant leaves (2.3 MB)"""

    name = None

    def act(self):
        if self.calls:
            return self.listen()
        leaves = b"".join(
            field(2, field(1, 2 * 128 * (i % 300 + 2)) + field(2, 2 * 128 * (i // 300)) + field(4, bytes(4)))
            for i in range(100_000))
        for number in range(4):
            call = self.call(number, MESHES + "RemeshSession", window=WIDE)
            self.calls.append((number, call))
            call.send(message(field(1, field(1, self.name))) + message(field(2, leaves)), seconds=60)


class MemoryLimit(unittest.TestCase):
    def grid(self, server, kind, size):
        """The name of an uploaded grid."""
        path = self.folder / f"{kind}.vdb"
        subprocess.run([binaries() / "make_fixture", kind, size, path], check=True)
        content = path.read_bytes()
        name = "grids/" + hashlib.sha256(content).hexdigest()
        call = RawCall(int(server.address.rsplit(":", 1)[1]), neighbours.GRIDS + "UploadGrid")
        call.send(message(field(1, field(1, name) + field(2, len(content)))))
        for at in range(0, len(content), GIB >> 10):
            call.send(message(field(2, field(1, at) + field(2, content[at:at + (GIB >> 10)]))))
        call.finish()
        self.assertTrue(call.wait_for_end())
        call.close()
        return name

    def attack(self, server, kind):
        """Until the server has worked so much, has answered all or nothing to do, or only repeats itself."""
        crowd = kind(int(server.address.rsplit(":", 1)[1]))
        begin = used = processor_seconds(server.process)
        rested_since = time.monotonic()
        peak, answered = self.resident_peak(server), 0
        while (used < begin + WORK and time.monotonic() < rested_since + REST_SECONDS
               and crowd.answered < answered + SAME_ANSWERS):
            with contextlib.suppress(OSError):  # the server hung up before it was asked
                crowd.act()
            time.sleep(PAUSE_SECONDS)
            if getattr(crowd, "ASKS_ONCE", False) and all(call.ended for _, call in crowd.calls):
                break
            if self.resident_peak(server) > peak + MIB:
                peak, answered = self.resident_peak(server), crowd.answered
            if processor_seconds(server.process) > used + 0.05:
                used, rested_since = processor_seconds(server.process), time.monotonic()
        for _, call in crowd.calls:
            call.close()
        print(f"{kind.__doc__}: {crowd.answered} answered, {used - begin:.1f} s of work", file=sys.stderr)

    def test_the_worst_requests_known_stay_within_that_of_compose(self):
        service = yaml.safe_load(COMPOSE.read_text())["services"]["tetstream"]
        self.assertEqual(service["mem_limit"], "4g")
        group = MemoryGroup(4 * GIB)
        self.addCleanup(group.remove)
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        environment = {key: value for key, value in service["environment"].items()
                       if not key.endswith("_LISTEN")}
        with RunningServer(self.folder / "store", environment=environment,
                           launch=group.entered_by()) as server:
            told = server.samples()
            budgets = told["tetstream_plan_budget_bytes"] + told["tetstream_resident_budget_bytes"]
            self.assertLess(budgets, 4 * GIB)  # divided by the group's limit, not the machine's memory
            RandomSigns.name = self.grid(server, "random-signs", "1")
            ScatteredLeaves.name = self.grid(server, "sphere", "0.125")
            for kind in (Spheres, RandomSigns, ScatteredLeaves, neighbours.RepeatedEllipsoids,
                         neighbours.HugePlans, neighbours.FastStreams, neighbours.SlowStreams,
                         neighbours.Uploads, neighbours.Sessions):
                self.attack(server, kind)
                self.assertIsNone(server.process.poll(), f"the server ended: {kind.__doc__}")
                print(f"resident at most {self.resident_peak(server) >> 20} MiB", file=sys.stderr)
            failures = group.failures()
            print(f"the group had at most {(group.peak() or 0) >> 20} MiB; failures {failures}",
                  file=sys.stderr)
            self.assertEqual(failures, (0, 0))
            self.assertLess(self.resident_peak(server), 4 * GIB)
            self.assertLess(group.peak() or 0, 4 * GIB)
            made = server.tetstream("mesh", self.folder / "sphere.vdb", "-o", self.folder / "m.vtu")
            self.assertEqual(made.returncode, 0, made.stderr)

    @staticmethod
    def resident_peak(server):
        status = pathlib.Path(f"/proc/{server.process.pid}/status").read_text()
        return int(re.search(r"VmHWM:\s+(\d+)", status)[1]) << 10


if __name__ == "__main__":
    try:
        MemoryGroup(GIB).remove()
    except OSError as error:
        print(f"NOT TRIED: no control group can be made here: {error}", file=sys.stderr)
        sys.exit(77)
    unittest.main()
