"""What stands still around a server: a reader of its log, a disk, a terminal. It goes on, or says so.

    TETSTREAM_BIN=build/dev/bin python3 tests/faults/stuck_test.py [unittest options]
"""

import fcntl
import os
import signal
import subprocess
import tempfile
import unittest

from fault_case import GENEROUS_END, FaultTest, binaries, unused_port, wait_until
from raw_http2 import RawCall, field
from waiting import fetch, samples_of

CALLS = 60
SMALL_PIPE = 4096  # some fifteen lines
DRAIN_SECONDS = 2
GRACE_SECONDS = 300  # for the end itself, which something that hangs would outlast


class StuckTest(FaultTest):
    def launch(self, stderr, *options):
        """A server whose log goes to a descriptor; its address and that of its metrics."""
        port_file = self.folder / "port"
        metrics = f"127.0.0.1:{unused_port()}"
        process = subprocess.Popen(
            [binaries() / "tetstreamd", "--store", self.store, "--listen", "127.0.0.1:0",
             "--port-file", port_file, "--metrics-listen", metrics, "--threads", "1",
             "--lame-duck-seconds", "0", "--drain-seconds", str(DRAIN_SECONDS),
             "--grace-seconds", str(GRACE_SECONDS), *options],
            stdout=subprocess.DEVNULL, stderr=stderr)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        wait_until(port_file.exists)
        return process, f"127.0.0.1:{port_file.read_text().strip()}", metrics

    def call(self, address, *arguments):
        return subprocess.run([binaries() / "tetstream", *map(str, arguments), "--server", address],
                              capture_output=True, text=True, timeout=GENEROUS_END, check=False)

    def ends_in_time(self, process):
        """Its exit code after SIGTERM: 3 if its drain and the grace that it gives itself are not enough."""
        process.send_signal(signal.SIGTERM)
        return process.wait(GENEROUS_END)


class Stuck(StuckTest):
    def launch_unread(self):
        """A server whose log is a small pipe that nobody reads."""
        read, write = os.pipe()
        self.addCleanup(os.close, read)
        fcntl.fcntl(write, fcntl.F_SETPIPE_SZ, SMALL_PIPE)
        launched = self.launch(write)
        os.close(write)
        return launched

    def test_a_log_that_nobody_reads_stops_no_call_and_no_end(self):
        process, address, metrics = self.launch_unread()
        for _ in range(CALLS):
            said = self.call(address, "job", "list")
            self.assertEqual(said.returncode, 0, said.stderr)
        self.assertEqual(samples_of(metrics)["tetstream_log_dropped_lines_total"], 0)
        self.assertEqual(self.ends_in_time(process), 0)

    def test_what_protobuf_says_of_messages_that_strangers_send_stops_no_call(self):
        process, address, _ = self.launch_unread()
        port = int(address.rsplit(":", 1)[1])
        for _ in range(CALLS):  # each of which it has a line of two hundred bytes about
            call = RawCall(port, "/tetstream.v1.GridService/FindMissingGrids")
            call.ask(field(1, b"\xff\xfe"))
            self.assertTrue(call.wait_for_end(), "the server reads no more messages")
            call.close()
        said = self.call(address, "job", "list")
        self.assertEqual(said.returncode, 0, said.stderr)
        self.assertEqual(self.ends_in_time(process), 0)

    def test_what_does_not_fit_is_dropped_and_counted_and_told_when_the_reader_is_back(self):
        read, write = os.pipe()
        fcntl.fcntl(write, fcntl.F_SETPIPE_SZ, SMALL_PIPE)
        process, address, metrics = self.launch(write, "--log-buffer-bytes", "4KiB")
        os.close(write)
        for _ in range(CALLS):
            self.assertEqual(self.call(address, "job", "list").returncode, 0)
        dropped = samples_of(metrics)["tetstream_log_dropped_lines_total"]
        self.assertGreater(dropped, 0)
        log = b""

        def told():
            nonlocal log
            log += os.read(read, 1 << 16)
            return b'"event":"log_dropped","lines":' in log

        self.assertTrue(wait_until(told))
        os.close(read)  # nobody at all: no SIGPIPE ends it
        self.assertEqual(self.call(address, "job", "list").returncode, 0)
        self.assertEqual(self.ends_in_time(process), 0)

    def test_a_client_has_so_many_watches_and_no_more(self):
        process, address, metrics = self.launch(subprocess.DEVNULL, "--max-client-watches", "2")
        watches = [subprocess.Popen(
            [binaries() / "tetstream", "job", "watch", "--server", address],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) for _ in range(2)]
        self.addCleanup(lambda: [(watch.kill(), watch.wait()) for watch in watches])

        def both_watch():
            """Each has been told where to begin, and no other call runs."""
            samples = samples_of(metrics)
            return (samples.get('tetstream_calls_total{code="OK",method="ListJobs"}', 0) >= 2 and
                    samples["tetstream_calls_running"] >= 2)

        wait_until(both_watch)
        said = self.call(address, "job", "watch")
        self.assertNotEqual(said.returncode, 0)
        self.assertIn("watches of jobs", said.stderr)
        for watch in watches:
            watch.kill()
        self.assertEqual(self.ends_in_time(process), 0)

    def test_a_terminal_that_hangs_up_ends_nothing(self):
        process, address, _ = self.launch(subprocess.DEVNULL)
        for number in (signal.SIGHUP, signal.SIGPIPE):
            process.send_signal(number)
        self.assertEqual(self.call(address, "job", "list").returncode, 0)
        self.assertIsNone(process.poll())
        self.assertEqual(self.ends_in_time(process), 0)


@unittest.skipIf(os.getuid() != 0, "only root freezes a disk of its own")
class FrozenDisk(StuckTest):
    """Nothing that writes to a frozen file system goes on before it thaws."""

    def setUp(self):
        super().setUp()
        image, self.disk = self.folder / "image", self.folder / "disk"
        self.disk.mkdir()
        with open(image, "wb") as file:
            file.truncate(128 << 20)
        subprocess.run(["mkfs.ext4", "-q", image], check=True)
        if subprocess.run(["mount", "-o", "loop", image, self.disk], check=False).returncode != 0:
            self.skipTest("no file system may be mounted here")
        self.addCleanup(subprocess.run, ["umount", "-l", self.disk], check=True)
        self.store = self.disk / "store"
        self.log = tempfile.TemporaryFile()
        self.addCleanup(self.log.close)

    def freeze(self):
        subprocess.run(["fsfreeze", "-f", self.disk], check=True)
        self.addCleanup(subprocess.run, ["fsfreeze", "-u", self.disk], check=False,
                        stderr=subprocess.DEVNULL)  # which has thawed, unless the test failed

    def thaw(self):
        subprocess.run(["fsfreeze", "-u", self.disk], check=True)

    def is_ready(self, address):
        return self.call(address, "health").returncode == 0

    def test_health_tells_within_seconds_and_metrics_are_answered(self):
        process, address, metrics = self.launch(self.log)
        wait_until(lambda: self.is_ready(address))
        self.freeze()
        wait_until(lambda: fetch(metrics, "/readyz")[0] == 503)
        wait_until(lambda: not self.is_ready(address))
        for _ in range(5):
            self.assertEqual(fetch(metrics, "/healthz")[0], 200)
            self.assertEqual(samples_of(metrics, new=False)["tetstream_store_up"], 0)
        self.thaw()
        wait_until(lambda: fetch(metrics, "/readyz")[0] == 200)
        wait_until(lambda: self.is_ready(address))
        wait_until(lambda: samples_of(metrics)["tetstream_store_up"] == 1)
        self.assertEqual(self.ends_in_time(process), 0)


if __name__ == "__main__":
    unittest.main(verbosity=2)
