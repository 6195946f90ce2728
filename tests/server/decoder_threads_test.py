"""That every thread of a process that parses a file others wrote is in the sandbox.

Libraries start threads before main: log4cplus, which OpenVDB brings along, starts four. Grids on
sheared voxels take OpenVDB, others none.

    TETSTREAM_BIN=build/dev/bin python3 tests/server/decoder_threads_test.py [unittest options]
"""

import itertools
import os
import pathlib
import re
import signal
import subprocess
import tempfile
import unittest
import uuid

from running_server import GENEROUS_END, RunningServer, binaries, wait_until

KINDS = ("sphere", "sheared")
VOXEL = "0.005"  # a file that is decoded for milliseconds at least


def children(pid):
    found = []
    for task in pathlib.Path(f"/proc/{pid}/task").glob("*"):
        try:
            found += map(int, (task / "children").read_text().split())
        except OSError:
            continue
    return found


def custody(task):
    """(Seccomp, NoNewPrivs) of a thread, as the system tells."""
    status = (task / "status").read_text()
    return tuple(int(re.search(rf"^{name}:\s+(\d+)", status, re.MULTILINE)[1])
                 for name in ("Seccomp", "NoNewPrivs"))


def threads_while_decoding(decoder):
    """{thread: custody} of a process that has begun to decode; empty if this one has not."""
    main = pathlib.Path(f"/proc/{decoder}/task/{decoder}")
    try:
        if custody(main)[0] != 2:
            return {}
        os.kill(decoder, signal.SIGSTOP)
        try:
            return {int(task.name): custody(task) for task in main.parent.glob("*")}
        finally:
            os.kill(decoder, signal.SIGCONT)
    except OSError:  # it has ended
        return {}


class DecoderThreadsTest(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.numbers = itertools.count()
        self.files = {kind: self.folder / f"{kind}.vdb" for kind in KINDS}
        for kind, file in self.files.items():
            subprocess.run([binaries() / "make_fixture", kind, VOXEL, file], check=True)

    def mesh(self, file, *options):
        return subprocess.Popen([binaries() / "tetstream", "mesh", file, "--spacing", "0.1",
                                 "-o", self.folder / "m.vtu", *options],
                                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def custody_seen(self, parent, command):
        """Lets the command end, and looks at every thread of every decoder of `parent` meanwhile."""
        seen = []
        while command.poll() is None:
            for child in children(parent):
                if threads := threads_while_decoding(child):
                    seen.append(threads)
        self.assertEqual(command.wait(GENEROUS_END), 0)
        for threads in seen:
            self.assertEqual(set(threads.values()), {(2, 1)}, threads)
        return seen

    def expect_custody(self, kind, run):
        """What a run of the command shows, of a file that nobody has decoded yet: decoders are at work
        for milliseconds, and whoever looks may have been put aside meanwhile."""
        def looked():
            file = self.folder / f"{next(self.numbers)}.vdb"
            # Its UUID makes it another file; before that come a magic number, three versions and a flag.
            content = bytearray(self.files[kind].read_bytes())
            content[21:57] = str(uuid.uuid4()).encode("ascii")
            file.write_bytes(content)
            try:
                return self.custody_seen(*run(file))
            finally:
                file.unlink()

        return wait_until(looked)


class Command(DecoderThreadsTest):
    def run_alone(self, file):
        command = self.mesh(file)
        return command.pid, command

    def test_filters_every_thread(self):
        for kind in KINDS:
            seen = self.expect_custody(kind, self.run_alone)
            if kind == "sheared":
                # There are some to filter; with none this test would show nothing.
                self.assertGreater(max(map(len, seen)), 1)


class Server(DecoderThreadsTest):
    def test_filters_every_thread(self):
        server = self.enterContext(RunningServer(self.folder / "store"))
        for kind in KINDS:
            self.expect_custody(kind, lambda file: (
                server.process.pid, self.mesh(file, "--server", server.address)))


if __name__ == "__main__":
    unittest.main()
