"""A real server among clients that do not read, do not send, or come in crowds.

    TETSTREAM_BIN=build/release/bin python3 tests/server/crowd_test.py [unittest options]
"""

import hashlib
import math
import os
import pathlib
import re
import resource
import signal
import socket
import statistics
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "client"))
from command_case import (
    GENEROUS_END, CommandTest, binaries, processor_seconds, samples_of, unused_port, wait_until)
from cutting_link import CuttingLink
from raw_http2 import RawCall, double_field, field, message

STREAM = "/tetstream.v1.MeshService/StreamMesh"
WATCH = "/grpc.health.v1.Health/Watch"
UPLOAD = "/tetstream.v1.GridService/UploadGrid"
MIB = 1 << 20
MOST_MEMORY = 300 * MIB
FORCED = 3  # the exit code where something does not end
GRACE = round(GENEROUS_END / 2)  # for a thousand streams to end, however slowly; less than the test waits
HUGE_AHEAD = float(os.environ.get("AHEAD", 2))  # seconds of processors


def grid_name(content):
    return "grids/" + hashlib.sha256(content).hexdigest()


class Server:
    """tetstreamd on a free port, stopped at the end of the test while its clients are still there. Whatever
    they do, it then ends by itself, unless it is `by_force` that it ends."""

    def __init__(self, test, by_force=False, **settings):
        folder = tempfile.TemporaryDirectory()
        test.addCleanup(folder.cleanup)
        port_file = pathlib.Path(folder.name, "port")
        self.metrics = f"127.0.0.1:{unused_port()}"
        settings = {"listen": "127.0.0.1:0", "store": folder.name + "/store",
                    "metrics_listen": self.metrics,
                    "port_file": str(port_file), "log_level": os.environ.get("LEVEL", "error"), "lame_duck_seconds": 0, "drain_seconds": 0,
                    "grace_seconds": GRACE, "handshake_seconds": 3600,
                    **settings}
        self.process = subprocess.Popen(
            [os.environ.get("TETSTREAMD", binaries() / "tetstreamd")]
            + [f"--{key.replace('_', '-')}={value}" for key, value in settings.items()])
        test.addCleanup(lambda: test.assertIn(self.stop(), (0, FORCED) if by_force else (0,)))
        wait_until(port_file.exists)
        self.port = int(port_file.read_text())
        self.address = f"127.0.0.1:{self.port}"

    def stop(self):
        """Its exit code."""
        self.process.terminate()
        try:
            return self.process.wait(GENEROUS_END)
        except subprocess.TimeoutExpired:
            self.process.kill()
            return self.process.wait()

    def status(self, key):
        """A number of /proc/.../status, in bytes."""
        text = pathlib.Path(f"/proc/{self.process.pid}/status").read_text()
        return int(re.search(rf"{key}:\s+(\d+)", text)[1]) * 1024

    def peak_memory(self):
        return self.status("VmHWM")

    def streams(self):
        """Those that run."""
        return samples_of(self.metrics)["tetstream_meshes_running"]

    def streams_so_far(self):
        """Those that run, and those that have ended."""
        return sum(value for name, value in samples_of(self.metrics).items()
                   if name == "tetstream_meshes_running"
                   or name.startswith("tetstream_calls_total") and 'method="StreamMesh"' in name)

    def is_alive(self):
        return self.process.poll() is None


class CrowdTest(CommandTest):
    volumes = {"sphere": 0.04}
    spacing = 0.03  # a hundred chunks or so

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        _, most = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))
        cls.grid = (cls.inputs / "sphere.vdb").read_bytes()
        cls.request = cls.stream_request(cls.spacing, levels=0)

    @classmethod
    def stream_request(cls, spacing, levels):
        mesh = field(1, grid_name(cls.grid)) + double_field(3, spacing) + field(5, levels)
        return field(1, mesh)

    def setUp(self):
        super().setUp()
        self.calls = []
        self.addCleanup(lambda: [call.close() for call in self.calls])

    def call(self, server, method, **how):
        self.calls.append(RawCall(server.port, method, **how))
        return self.calls[-1]

    def mesh(self, server, name="m.vtu", spacing=None):
        """Meshes as a healthy client does."""
        done = subprocess.run(self.mesh_command(server, name, spacing or self.spacing),
                              capture_output=True, text=True, timeout=GENEROUS_END)
        self.assertEqual(done.returncode, 0, done.stderr)

    def mesh_command(self, server, name, spacing):  # a Server, or what else has its address
        return [binaries() / "tetstream", "mesh", self.inputs / "sphere.vdb", "--server",
                server.address, "-o", self.out / name, "--levels", "0",
                "--spacing", str(spacing)]


class Readers(CrowdTest):
    def test_a_thousand_slow_readers_stay_within_300_mb_and_others_go_on(self):
        server = Server(self, max_streams=2000, max_client_streams=2000, max_calls=4000,
                        max_client_calls=4000, stall_seconds=3600)
        self.mesh(server)
        before = server.streams_so_far()
        for i in range(1000):
            # Half are stopped by their streams' windows, half by their connections' buffers.
            how = {"window": 20000} if i % 2 else {"window": 1 << 30, "receive_buffer": 4096}
            self.call(server, STREAM, source=f"127.0.0.{2 + i % 20}", **how).ask(self.request)
        # Where others wait for memory, who takes nothing loses its stream: some may have ended.
        wait_until(lambda: server.streams_so_far() >= before + 1000)
        self.mesh(server)
        print(f"peak {server.peak_memory() / MIB:.0f} MiB with 1000 slow readers", file=sys.stderr)
        self.assertLess(server.peak_memory(), MOST_MEMORY)
        self.assertTrue(server.is_alive())

    def test_a_reader_who_takes_nothing_loses_its_stream_in_time(self):
        server = Server(self, stall_seconds=1)
        self.mesh(server)
        reader = self.call(server, STREAM, window=20000)
        reader.ask(self.request)
        self.assertTrue(reader.wait_for_end())
        wait_until(lambda: server.streams() == 0)

    def test_a_client_that_was_stopped_resumes_when_it_goes_on(self):
        server = Server(self, stall_seconds=1, keepalive_seconds=1)
        self.mesh(server, "whole.vtu")
        link = CuttingLink(server.address, holds_after=MIB)  # of 30, which no socket holds
        self.addCleanup(link.close)
        client = subprocess.Popen(self.mesh_command(link, "resumed.vtu", self.spacing),
                                  stderr=subprocess.PIPE)
        self.addCleanup(client.kill)
        self.assertTrue(link.held.wait(GENEROUS_END))
        client.send_signal(signal.SIGSTOP)
        wait_until(lambda: server.streams() == 0)
        client.send_signal(signal.SIGCONT)
        link.go_on()
        _, errors = client.communicate(timeout=GENEROUS_END)
        self.assertEqual(client.returncode, 0, errors)
        self.assertEqual((self.out / "whole.vtu").read_bytes(),
                         (self.out / "resumed.vtu").read_bytes())


class Ending(CrowdTest):
    def hold(self, server):
        """Has a hundred clients ask for streams, and take nothing."""
        self.mesh(server)
        before = server.streams_so_far()
        for i in range(100):
            # What gRPC has begun to write waits for the connection, and that for whoever does not read.
            self.call(server, STREAM, source=f"127.0.0.{2 + i % 20}", window=1 << 30,
                      receive_buffer=4096).ask(self.request)
        wait_until(lambda: server.streams_so_far() >= before + 100)

    def test_connections_that_take_nothing_keep_no_server(self):
        server = Server(self, max_streams=100, stall_seconds=3600)
        self.hold(server)
        self.assertEqual(server.stop(), 0)

    def test_a_server_that_has_too_little_time_to_end_is_ended_by_force(self):
        def is_ended_by_force():
            """Seldom not: its last bytes have two seconds, and the clock of its end may be late."""
            server = Server(self, by_force=True, max_streams=100, stall_seconds=3600, grace_seconds=1)
            self.hold(server)
            return server.stop() == FORCED

        wait_until(is_ended_by_force)

    def test_connections_that_say_nothing_to_the_metrics_keep_no_server(self):
        server = Server(self)
        host, port = server.metrics.rsplit(":", 1)
        for _ in range(40):
            silent = socket.create_connection((host, int(port)))
            self.addCleanup(silent.close)
            silent.sendall(b"GET /metrics HTTP/1.1\r\n")
        self.assertEqual(server.stop(), 0)


class Newcomers(CrowdTest):
    def test_who_never_gets_ready_for_calls_is_sent_away(self):
        server = Server(self, handshake_seconds=1)
        with socket.create_connection(("127.0.0.1", server.port), GENEROUS_END) as silent:
            try:
                while silent.recv(1 << 16):  # what the server has to say of itself comes first
                    pass
            except ConnectionResetError:
                pass
        self.assertTrue(server.is_alive())


class HealthWatchers(CrowdTest):
    def test_crowds_of_watchers_are_counted_and_limited_and_others_go_on(self):
        # They answer no pings, and are to be there until all have come, however slowly.
        server = Server(self, max_health_watches=500, keepalive_seconds=3600)
        self.mesh(server)
        for i in range(1500):
            self.call(server, WATCH, source=f"127.0.0.{2 + i % 20}").ask(b"")

        def seen():
            samples = samples_of(server.metrics)
            return (samples["tetstream_health_watches"],
                    samples["tetstream_health_watches_refused_total"])

        wait_until(lambda: sum(seen()) == 1500)
        self.assertEqual(seen(), (500, 1000))
        self.mesh(server)
        self.assertLess(server.peak_memory(), MOST_MEMORY)
        for call in self.calls:
            call.close()
        wait_until(lambda: seen()[0] == 0)
        self.call(server, WATCH).ask(b"")
        wait_until(lambda: seen()[0] == 1)


class Uploads(CrowdTest):
    MESSAGE = 4 * MIB - 100

    def begin(self, server, number, **how):
        """Begins an upload, and all but the last byte of its first piece, as large as may be."""
        content = number.to_bytes(8, "big") + bytes(3 * self.MESSAGE)
        upload = self.call(server, UPLOAD, **how)
        start = field(1, field(1, grid_name(content)) + field(2, len(content)))
        piece = field(2, field(2, content[:self.MESSAGE - 20]))
        upload.send(message(start) + message(piece)[:-1])
        return upload

    def test_fifty_unfinished_uploads_stay_within_300_mb_and_others_go_on(self):
        server = Server(self, max_client_uploads=64)
        for number in range(50):
            self.begin(server, number, source="127.0.0.2")
        self.mesh(server)
        print(f"peak {server.peak_memory() / MIB:.0f} MiB with 50 unfinished uploads",
              file=sys.stderr)
        self.assertLess(server.peak_memory(), MOST_MEMORY)

    def test_an_uploader_who_sends_nothing_is_told_in_time_and_can_resume(self):
        server = Server(self, stall_seconds=3)
        content = os.urandom(3 * MIB)
        start = field(1, field(1, grid_name(content)) + field(2, len(content)))
        upload = self.call(server, UPLOAD)
        upload.send(message(start) + message(field(2, field(2, content[:MIB]))))
        self.assertTrue(upload.wait_for_end())
        store = pathlib.Path(server.process.args[2].split("=")[1])
        part = store / "uploads" / (hashlib.sha256(content).hexdigest() + ".part")

        def is_stored():
            """Sends the rest: where this test is held up for 3 s the call ends, and the next one goes on."""
            rest = self.call(server, UPLOAD)
            rest.send(message(start))
            for at in range(part.stat().st_size, len(content), MIB // 16):  # each is soon sent
                piece = content[at:at + MIB // 16]
                if not rest.send(message(field(2, field(1, at) + field(2, piece)))):
                    break
            self.assertTrue(rest.wait_for_end())
            return not part.exists()

        wait_until(part.exists)
        wait_until(is_stored)
        self.assertTrue([file.read_bytes() for file in store.glob("grids/*/*")] == [content])


class Fairness(CrowdTest):
    def small_mesh(self, server, number):
        """What the server works from the request for one that nobody remembers to its last byte.

        In seconds of processors: whatever else the machine does is not counted.
        """
        mesh = self.call(server, STREAM, window=1 << 30)
        before = processor_seconds(server.process)
        mesh.ask(self.stream_request(0.1 + 1e-6 * number, levels=0))
        self.assertTrue(mesh.wait_for_end())
        return processor_seconds(server.process) - before

    def works(self, server, first, enough=math.inf):
        """What each of some small meshes takes; more than enough may be of this test's own standing
        still, while the server works on for others, and is measured again."""
        works = []
        for i in range(20):
            works.append(self.small_mesh(server, first + i))
            if works[-1] > enough:
                works[-1] = min(works[-1], self.small_mesh(server, first + 100 + i))
            for call in self.calls:
                if not call.ended:
                    call.listen(0)  # and answers pings
        return works

    def test_small_meshes_do_not_wait_for_a_huge_one(self):
        server = Server(self, threads=2)
        self.mesh(server)
        alone = statistics.median(self.works(server, 100))
        # Planned for longer than all this takes.
        huge = self.call(server, STREAM, source="127.0.0.2")
        huge.ask(self.stream_request(0.005, levels=24))
        before = processor_seconds(server.process)

        def is_ahead():
            huge.listen(0)
            return huge.ended or processor_seconds(server.process) >= before + HUGE_AHEAD

        wait_until(is_ahead)
        self.assertFalse(huge.ended, "it was refused, or is not huge")
        beside = self.works(server, 300, enough=5 * alone + 4)
        huge.listen(0)
        print(f"the server works {alone:.2f} s for a small mesh; beside a huge one, on both, median "
              f"{statistics.median(beside):.2f} s, most {max(beside):.2f} s", file=sys.stderr)
        self.assertFalse(huge.ended)
        # Two processors do so much in half a second and in two.
        self.assertLess(statistics.median(beside), 5 * alone + 1)
        self.assertLess(max(beside), 5 * alone + 4)


if __name__ == "__main__":
    unittest.main()
