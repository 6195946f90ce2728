"""SIGTERM while clients are at work: nobody notices.

    TETSTREAM_BIN=build/dev/bin python3 tests/faults/shutdown_test.py [unittest options]
"""

import contextlib
import pathlib
import signal
import subprocess
import threading
import unittest

from fault_case import (
    GENEROUS_END, FaultTest, RunningServer, binaries, unused_port, wait_until)
from cutting_link import CuttingLink


class Clients:
    """Clients that mesh over and over until they are stopped; what each run said."""

    def __init__(self, count, mesh_once):
        self.results = []
        self._begun = []
        self._stop = threading.Event()
        self._changed = threading.Condition()
        self._may_begin = True
        self._threads = [threading.Thread(target=self._work, args=(mesh_once, i))
                         for i in range(count)]
        for thread in self._threads:
            thread.start()

    def _work(self, mesh_once, number):
        while not self._stop.is_set():
            with self._changed:
                self._changed.wait_for(lambda: self._may_begin)
                self._begun.append(number)
            self.results.append(mesh_once(number))

    def at_work(self):
        return len(self._begun) - len(self.results)

    def let_begin(self, whether):
        """Once this has said no, whoever was let in before counts as at work."""
        with self._changed:
            self._may_begin = whether
            self._changed.notify_all()

    def stop(self):
        self._stop.set()
        self.let_begin(True)
        for thread in self._threads:
            thread.join()


def connections_to(address):
    """Established ones, as the server's end sees them."""
    port, established = f"{int(address.rpartition(':')[2]):04X}", "01"
    rows = [line.split() for name in ("tcp", "tcp6")
            for line in pathlib.Path("/proc/net", name).read_text().splitlines()[1:]]
    return sum(row[1].endswith(":" + port) and row[3] == established for row in rows)


class Shutdown(FaultTest):
    volumes = {"sphere": 0.05, "torus": 0.02}

    def setUp(self):
        super().setUp()
        self.lock = threading.Lock()
        self.running = set()

    def run_client(self, addresses, number, kind="sphere"):
        """(exit code, message, whether the mesh is the right one)."""
        out = self.folder / f"{number}.vtu"
        client = subprocess.Popen(
            [binaries() / "tetstream", "mesh", self.inputs / f"{kind}.vdb", "-o", out,
             "--server", addresses],
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        with self.lock:
            self.running.add(client)
        _, errors = client.communicate(timeout=GENEROUS_END)
        with self.lock:
            self.running.discard(client)
        right = out.exists() and out.read_bytes() == self.expected[kind]
        return client.returncode, errors, right

    @contextlib.contextmanager
    def clients_stand_still(self):
        """However long a server takes to start, no client's patience ends meanwhile."""
        with self.lock:
            stopped = list(self.running)
            for client in stopped:
                client.send_signal(signal.SIGSTOP)
        try:
            yield
        finally:
            for client in stopped:
                client.send_signal(signal.SIGCONT)

    def assert_all_right(self, results):
        self.assertGreater(len(results), 8)
        self.assertEqual([result for result in results if result != (0, "", True)], [])

    def test_two_servers_take_turns_in_going_down_and_no_call_fails(self):
        stores = [self.folder / "a", self.folder / "b"]
        addresses = [f"127.0.0.1:{unused_port()}" for _ in stores]
        servers = [RunningServer(store, listen=address)
                   for store, address in zip(stores, addresses)]
        clients = Clients(3, lambda i: self.run_client(",".join(addresses), i))
        try:
            for turn in range(2):
                wait_until(lambda seen=len(clients.results): len(clients.results) > seen + 3)
                self.assertEqual(servers[turn].terminate(), 0)
                servers[turn].close()
                servers[turn] = RunningServer(stores[turn], listen=addresses[turn])
            wait_until(lambda seen=len(clients.results): len(clients.results) > seen + 3)
        finally:
            clients.stop()
            for server in servers:
                server.close()
        self.assert_all_right(clients.results)

    def test_one_server_restarts_and_no_work_under_way_fails(self):
        server = self.start(listen=f"127.0.0.1:{unused_port()}")
        clients = Clients(3, lambda i: self.run_client(server.address, i))
        try:
            wait_until(lambda: len(clients.results) > 3)
            clients.let_begin(False)
            # Who has not reached the server yet has no work under way.
            wait_until(lambda: connections_to(server.address) >= clients.at_work())
            self.assertEqual(server.terminate(), 0)
            with self.clients_stand_still():
                again = self.start(listen=server.address)
            clients.let_begin(True)
            wait_until(lambda seen=len(clients.results): len(clients.results) > seen + 5)
        finally:
            clients.stop()
        again.kill()
        self.assert_all_right(clients.results)

    def long_mesh(self, addresses):
        return subprocess.Popen(
            [binaries() / "tetstream", "mesh", self.inputs / "torus.vdb",
             "-o", self.folder / "long.vtu", "--levels", "0", "--spacing", "0.018",
             "--server", addresses],
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)

    def test_what_runs_longer_than_the_drain_is_handed_back_and_finished_elsewhere(self):
        servers = [RunningServer(self.folder / name, "--drain-seconds", "0") for name in "ab"]
        for server in servers:
            self.addCleanup(server.close)
        link = CuttingLink(servers[0].address, holds_after=2 << 20)  # some chunks, and not all
        self.addCleanup(link.close)
        client = self.long_mesh(f"{link.address},{servers[1].address}")
        self.addCleanup(client.kill)
        self.assertTrue(link.held.wait(GENEROUS_END))
        self.assertGreater(servers[0].samples()["tetstream_sent_chunks_total"], 2)
        self.assertEqual(servers[0].terminate(), 0)  # though its client takes nothing
        link.go_on()
        _, errors = client.communicate(timeout=GENEROUS_END)
        self.assertEqual(client.returncode, 0, errors)
        ended = [line for line in servers[0].log("call") if line["method"] == "StreamMesh"]
        self.assertEqual([(line["status"], line["reason"]) for line in ended],
                         [("UNAVAILABLE", "SHUTTING_DOWN")])
        whole = self.folder / "whole.vtu"
        subprocess.run(
            [binaries() / "tetstream", "mesh", self.inputs / "torus.vdb", "-o", whole,
             "--levels", "0", "--spacing", "0.018"], check=True, stdout=subprocess.DEVNULL)
        self.assertTrue(whole.read_bytes() == (self.folder / "long.vtu").read_bytes())


if __name__ == "__main__":
    unittest.main(verbosity=2)
