"""Two servers over one store and one PostgreSQL: what one was told the other knows, and one may go.

    TETSTREAM_BIN=build/dev/bin python3 tests/faults/several_servers_test.py [unittest options]
"""

import contextlib
import hashlib
import json
import os
import pathlib
import shutil
import signal
import subprocess
import threading
import unittest

from fault_case import GENEROUS_END, FaultTest, RunningServer, binaries, unused_port, wait_until
from postgres import Postgres
from raw_http2 import RawCall, field, message

MIB = 1 << 20
PROXY = pathlib.Path(__file__).parents[2] / "docker" / "haproxy.cfg"
UPLOAD = "/tetstream.v1.GridService/UploadGrid"


class SeveralServers(FaultTest):
    volumes = {"sphere": 0.05, "torus": 0.02}

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.postgres = cls.enterClassContext(Postgres())

    def setUp(self):
        super().setUp()
        self.postgres.clear()
        self.addresses = [f"127.0.0.1:{unused_port()}" for _ in range(2)]
        self.both = ",".join(self.addresses)

    def start_server(self, which, *options, **more):
        return self.start("--jobs", self.postgres.address, "--job-lease-seconds", "1", *options,
                          listen=self.addresses[which], **more)

    def start_both(self, *options):
        return [self.start_server(which, *options) for which in range(2)]

    def client(self, *arguments, servers=None):
        """The command line, under way."""
        return subprocess.Popen(
            [binaries() / "tetstream", *map(str, arguments), "--server", servers or self.both],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def said(self, client):
        """What it wrote to standard output; it must succeed."""
        output, errors = client.communicate(timeout=GENEROUS_END)
        self.assertEqual(client.returncode, 0, errors)
        return output

    def submit(self, grid, *options, servers=None):
        said = self.said(self.client(
            "job", "submit", grid, "--json", "--skip-cache", "--max-attempts", "100", "--journal",
            self.folder / os.urandom(8).hex(), *options, servers=servers))
        return json.loads(said)["name"]

    def assert_made(self, jobs, kind, servers=None):
        self.said(self.client("job", "wait", *jobs, servers=servers))
        for job in jobs:
            mesh = self.folder / "fetched.vtu"
            self.said(self.client("job", "fetch", job, "-o", mesh, servers=servers))
            self.assertTrue(mesh.read_bytes() == self.expected[kind])
            mesh.unlink()

    def uploads(self, server):
        return [line for line in server.log("call") if line["method"] == "UploadGrid"]

    def raw_upload(self, server):
        call = RawCall(int(server.address.rsplit(":", 1)[1]), UPLOAD)
        self.addCleanup(call.close)
        return call

    def stored_bytes(self):
        """Of whole files, all of which were there at one time: no two looks in a row find others."""
        def look():
            files = {}
            for file in self.store.glob("grids/*/*"):
                with contextlib.suppress(FileNotFoundError):
                    files[file] = file.stat()
            return {file: (at.st_ino, at.st_ctime_ns, at.st_size) for file, at in files.items()}

        def seen_twice():
            files = look()
            return (files,) if look() == files else None

        return sum(size for _, _, size in wait_until(seen_twice)[0].values())

    def test_what_came_through_one_is_meshed_and_made_by_the_other(self):
        one, other = self.start_both("--job-workers", "1")
        self.assert_meshed(self.mesh(one))
        self.assert_meshed(self.mesh(other))
        self.assertEqual(self.uploads(other), [])
        job = self.submit(self.inputs / "sphere.vdb", servers=other.address)
        self.assert_made([job], "sphere", servers=one.address)
        # Two jobs' result is in one place, too: a stream of it comes from there.
        self.assert_made([job], "sphere", servers=other.address)
        self.assert_meshed(self.mesh(other))
        wait_until(lambda: other.log("call")[-1].get("cached"))

    def test_a_file_that_comes_through_both_at_once_is_stored_once(self):
        servers = self.start_both()
        mesh = [self.folder / f"{number}.vtu" for number in range(6)]
        clients = [self.client("mesh", self.inputs / "torus.vdb", "-o", file,
                               servers=servers[number % 2].address) for number, file in enumerate(mesh)]
        for number, client in enumerate(clients):
            _, errors = client.communicate(timeout=GENEROUS_END)
            if client.returncode != 0 and "being uploaded by another call" in errors:  # for longer than it waits
                self.said(self.client("mesh", self.inputs / "torus.vdb", "-o", mesh[number],
                                      servers=servers[number % 2].address))
            else:
                self.assertEqual(client.returncode, 0, errors)
        for file in mesh:
            self.assertTrue(file.read_bytes() == self.expected["torus"])
        self.assertEqual(self.stored(), {self.digest("torus")})
        self.assertEqual(list(self.store.glob("uploads/*")), [])

    def test_an_upload_whose_server_was_killed_is_gone_on_with_by_the_other(self):
        one, other = self.start_both()
        content = (self.inputs / "torus.vdb").read_bytes()
        half = len(content) // 2
        call = self.raw_upload(one)
        call.send(message(field(1, field(1, "grids/" + self.digest("torus")) + field(2, len(content)))))
        call.send(message(field(2, field(2, content[:half]))))
        part = self.store / "uploads" / f"{self.digest('torus')}.part"
        wait_until(lambda: part.exists() and part.stat().st_size == half)
        # As long as it is under way there it is nobody else's.
        refused = self.raw_upload(other)
        refused.send(message(field(1, field(1, "grids/" + self.digest("torus")) + field(2, len(content)))))
        wait_until(lambda: self.uploads(other))
        self.assertEqual(self.uploads(other)[0]["reason"], "UPLOAD_IN_PROGRESS")
        one.kill()
        self.assert_meshed(self.mesh(other, "torus"), "torus")
        other.told("call", method="UploadGrid", bytes_in=len(content) - half)
        self.assertEqual(self.stored(), {self.digest("torus")})

    def test_jobs_of_a_server_that_was_killed_are_made_by_the_other(self):
        one, other = self.start_both("--job-workers", "1")
        jobs = [self.submit(self.inputs / "torus.vdb", servers=server.address)
                for server in (one, other) for _ in range(4)]

        def is_caught_at_work():
            """Stopped, or it would be done by the time that we are told."""
            one.process.send_signal(signal.SIGSTOP)
            if self.postgres.rows("SELECT 1 FROM queue WHERE state = 1 AND worker LIKE "
                                  f"'%:{one.process.pid}'"):
                return True
            one.process.send_signal(signal.SIGCONT)
            jobs.append(self.submit(self.inputs / "torus.vdb", servers=one.address))
            return False

        wait_until(is_caught_at_work)
        one.kill()
        self.assert_made(jobs, "torus", servers=other.address)
        self.assertEqual(self.postgres.rows("SELECT id FROM jobs WHERE alarms > 0 OR state <> 3"), [])

    def test_a_grid_that_one_evicts_is_none_that_the_other_reads(self):
        budget = 4 * (self.inputs / "sphere.vdb").stat().st_size + MIB // 10
        one, other = self.start_both("--job-workers", "0", "--store-bytes", budget)
        most, stop, failed = 0, threading.Event(), []

        def read():
            while not stop.is_set():
                said = self.mesh(one)
                if said.returncode != 0:
                    failed.append(said.stderr)

        reader = threading.Thread(target=read)
        reader.start()
        try:
            for number in range(1, 11):
                grid = self.another_grid(number)
                self.said(self.client("mesh", grid, "-o", self.folder / "other.vtu", servers=other.address))
                most = max(most, self.stored_bytes())
        finally:
            stop.set()
            reader.join()
        self.assertEqual(failed, [])
        self.assertLessEqual(most, budget)
        self.assertGreater(other.samples()['tetstream_evictions_total{what="grid_file"}'], 5)
        self.assertEqual(one.samples()["tetstream_store_corrupt_total"], 0)

    def test_a_grid_that_an_unfinished_job_needs_is_evicted_by_neither(self):
        size = (self.inputs / "sphere.vdb").stat().st_size
        one, other = self.start_both("--job-workers", "0", "--store-bytes", size * 3 // 2)
        job = self.submit(self.inputs / "sphere.vdb", servers=one.address)
        # The client goes on asking for a minute, in case that jobs finish; once is enough here.
        client = self.client("mesh", self.another_grid(1), "-o", self.folder / "other.vtu",
                             servers=other.address)
        refused = wait_until(lambda: self.uploads(other))[0]
        self.assertEqual(refused["reason"], "STORE_HELD_BY_JOBS", refused)
        self.assertIn("jobs that are not finished", refused["message"])
        client.send_signal(signal.SIGINT)
        client.communicate(timeout=GENEROUS_END)
        self.assertNotEqual(client.returncode, 0)
        self.assertFalse((self.folder / "other.vtu").exists())
        other.close()
        self.start_server(1, "--job-workers", "1")
        self.assert_made([job], "sphere")

    def test_a_backup_while_both_serve_has_what_was_acknowledged(self):
        one, other = self.start_both("--job-workers", "0")
        stop, acknowledged = threading.Event(), []

        def submit(server, first):
            number = first
            while not stop.is_set():
                number += 2
                grid = self.another_grid(number)
                self.submit(grid, servers=server.address)
                acknowledged.append(hashlib.sha256(grid.read_bytes()).hexdigest())

        clients = [threading.Thread(target=submit, args=(server, first))
                   for first, server in enumerate((one, other))]
        for client in clients:
            client.start()
        try:
            wait_until(lambda: len(acknowledged) > 4)
            before = list(acknowledged)
            said = subprocess.run(
                [binaries() / "tetstreamd", "backup", self.folder / "backup", "--store", self.store,
                 "--jobs", self.postgres.address], capture_output=True, text=True, check=False)
            self.assertEqual(said.returncode, 0, said.stderr)
        finally:
            stop.set()
            for client in clients:
                client.join()
        restored = self.folder / "restored"
        for command in (["restore", self.folder / "backup"], ["check"]):
            said = subprocess.run(
                [binaries() / "tetstreamd", *command, "--store", restored, "--jobs", self.postgres.address],
                capture_output=True, text=True, check=False)
            self.assertEqual(said.returncode, 0, said.stdout + said.stderr)
        self.assertLessEqual(set(before), {file.name for file in restored.glob("grids/*/*")})

    def test_one_after_the_other_is_upgraded_and_no_client_notices(self):
        servers = self.start_both("--job-workers", "1", "--lame-duck-seconds", "1")
        stop, jobs, failed, meshed = threading.Event(), [], [], []

        def stream(servers):
            while not stop.is_set():
                mesh = self.folder / f"{threading.get_ident()}.vtu"
                client = self.client("mesh", self.inputs / "sphere.vdb", "-o", mesh, servers=servers)
                errors = client.communicate(timeout=GENEROUS_END)[1]
                if client.returncode != 0 or mesh.read_bytes() != self.expected["sphere"]:
                    failed.append(errors)
                meshed.append(servers)

        def submit():
            while not stop.wait(0.3) and len(jobs) < 100:  # all are made in the end, each by itself
                jobs.append(self.submit(self.inputs / "sphere.vdb"))

        clients = [threading.Thread(target=stream, args=(self.both,)),
                   threading.Thread(target=stream, args=(",".join(self.addresses[::-1]),)),
                   threading.Thread(target=submit)]
        for client in clients:
            client.start()
        try:
            for which, server in enumerate(servers):
                so_far = len(meshed)
                wait_until(lambda so_far=so_far: len(meshed) > so_far + 2 and jobs)
                self.assertEqual(server.terminate(), 0)
                self.start_server(which, "--job-workers", "1", "--lame-duck-seconds", "1")
        finally:
            stop.set()
            for client in clients:
                client.join()
        self.assertEqual(failed, [])
        self.assert_made(jobs, "sphere")

    @unittest.skipUnless(shutil.which("haproxy"), "haproxy is not installed")
    def test_behind_a_proxy_one_is_killed_and_no_client_notices(self):
        one, other = self.start_both()
        listen = f"127.0.0.1:{unused_port()}"
        metrics = [server.metrics.rsplit(":", 1)[1] for server in (one, other)]
        proxy = subprocess.Popen(
            ["haproxy", "-db", "-f", PROXY], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            env={**os.environ, "TETSTREAM_PROXY_LISTEN": listen,
                 "TETSTREAM_PROXY_SERVER": one.address, "TETSTREAM_PROXY_HEALTH_PORT": metrics[0],
                 "TETSTREAM_PROXY_SECOND": other.address,
                 "TETSTREAM_PROXY_SECOND_HEALTH_PORT": metrics[1]})
        self.addCleanup(proxy.wait)
        self.addCleanup(proxy.kill)
        wait_until(lambda: self.mesh(listen).returncode == 0)

        def both_were_asked():
            self.assert_meshed(self.mesh(listen))
            return one.log("call") and other.log("call")

        wait_until(both_were_asked)  # neither is down for the proxy
        one.kill()
        for _ in range(4):
            self.assert_meshed(self.mesh(listen))

    def test_a_server_that_is_stopped_holds_up_nobody_who_reads(self):
        one, other = self.start_both()
        self.assert_meshed(self.mesh(one))
        one.process.send_signal(signal.SIGSTOP)
        self.addCleanup(one.process.send_signal, signal.SIGCONT)
        self.assert_meshed(self.mesh(other))

    def test_servers_whose_jobs_are_not_in_one_database_share_no_store(self):
        shared = self.start_server(0)
        for jobs in ("off", str(self.folder / "jobs.sqlite"), ""):
            second = subprocess.run(
                [binaries() / "tetstreamd", "--store", self.store, "--listen", "127.0.0.1:0",
                 *(("--jobs", jobs) if jobs else ())],
                capture_output=True, text=True, timeout=GENEROUS_END, check=False)
            self.assertEqual(second.returncode, 3, second.stderr)
            self.assertIn(f"process {shared.process.pid} on ", second.stderr)
            self.assertIn("PostgreSQL", second.stderr)
        shared.close()
        alone = RunningServer(self.store, "--jobs", "off")
        self.addCleanup(alone.close)
        second = subprocess.run(
            [binaries() / "tetstreamd", "--store", self.store, "--listen", "127.0.0.1:0",
             "--jobs", self.postgres.address],
            capture_output=True, text=True, timeout=GENEROUS_END, check=False)
        self.assertEqual(second.returncode, 3, second.stderr)
        self.assertIn("in use by another server", second.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
