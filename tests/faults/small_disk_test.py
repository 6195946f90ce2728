"""Jobs, their database and their results on one disk that is too small: nothing is wedged.

    TETSTREAM_BIN=build/dev/bin python3 tests/faults/small_disk_test.py [unittest options]

The disk is a tmpfs of its own, which takes root to mount; without root the tests are skipped.
"""

import contextlib
import json
import os
import subprocess
import unittest

from fault_case import FaultTest, wait_until

MIB = 1 << 20
RESERVE = 8 * MIB


@unittest.skipIf(os.getuid() != 0, "only root mounts a disk of its own")
class SmallDisk(FaultTest):
    volumes = {"sphere": 0.05}

    def setUp(self):
        super().setUp()
        self.disk = self.folder / "disk"
        self.disk.mkdir()
        self.store = self.disk / "store"

    def mount(self, mebibytes):
        subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={mebibytes}m", "none", self.disk],
                       check=True)
        self.addCleanup(subprocess.run, ["umount", "-l", self.disk], check=True)

    def start_server(self, *options):
        return self.start("--disk-reserve-bytes", RESERVE, *options)

    def free(self):
        disk = os.statvfs(self.disk)
        return disk.f_bavail * disk.f_frsize

    def fill(self):
        """Somebody else takes every byte that is left; the file to remove."""
        path = self.disk / "others"

        def is_full():
            """The server may have given bytes back meanwhile: those with which it tries the disk."""
            with open(path, "ab", buffering=0) as file, contextlib.suppress(OSError):
                while True:
                    file.write(bytes(4096))
            return self.free() < 4096

        wait_until(is_full)
        return path

    def submit(self, server, *options):
        said = server.tetstream(
            "job", "submit", self.inputs / "sphere.vdb", "--json", "--skip-cache",
            "--journal", self.folder / os.urandom(8).hex(), *options)
        self.assertEqual(said.returncode, 0, said.stderr)
        return json.loads(said.stdout)["name"]

    def show(self, server, job):
        return json.loads(server.tetstream("job", "show", job, "--json").stdout)

    def assert_does_jobs(self, server):
        job = self.submit(server)
        waited = server.tetstream("job", "wait", job)
        self.assertEqual(waited.returncode, 0, waited.stdout + waited.stderr)
        fetched = server.tetstream("job", "fetch", job, "-o", self.folder / "mesh.vtu")
        self.assertEqual(fetched.returncode, 0, fetched.stderr)
        self.assertTrue((self.folder / "mesh.vtu").read_bytes() == self.expected["sphere"])

    def test_a_mesh_larger_than_the_disk_fails_with_its_bytes_and_others_go_on(self):
        self.mount(64)
        server = self.start_server()
        large = self.submit(server, "--spacing", "0.012")
        self.assertNotEqual(server.tetstream("job", "wait", large).returncode, 0)
        told = self.show(server, large)
        self.assertEqual((told["state"], told["error"]["reason"]), ("FAILED", "LIMIT_EXCEEDED"))
        self.assertRegex(told["error"]["message"], r"on the disk of the results.*\d{7,}")
        self.assertGreater(self.free(), RESERVE)
        self.assert_does_jobs(server)
        self.assertEqual(server.tetstream("job", "delete", large).returncode, 0)

    def test_results_stop_before_the_reserve_and_the_oldest_go(self):
        self.mount(64)
        server = self.start_server()
        least = self.free()
        for spacing in ("0.020", "0.021", "0.022", "0.023", "0.024", "0.025", "0.026", "0.027"):
            job = self.submit(server, "--spacing", spacing)
            waited = server.tetstream("job", "wait", job)
            self.assertEqual(waited.returncode, 0, waited.stdout + waited.stderr)
            least = min(least, self.free())
        self.assertGreater(least, RESERVE - MIB)
        self.assertGreater(server.samples()["tetstream_result_evictions_total"], 0)

    def assert_ends_jobs_on_a_full_disk(self, server, jobs):
        for job in jobs[:2]:
            said = server.tetstream("job", "cancel", job)
            self.assertEqual(said.returncode, 0, said.stderr)
            self.assertEqual(self.show(server, job)["state"], "CANCELLED")
        said = server.tetstream("job", "delete", jobs[0])
        self.assertEqual(said.returncode, 0, said.stderr)

    def test_jobs_are_cancelled_and_deleted_on_a_disk_that_others_filled_restart_or_not(self):
        self.mount(64)
        idle = ("--job-workers", "0")
        server = self.start_server(*idle)
        jobs = [self.submit(server) for _ in range(6)]
        others = self.fill()
        self.assert_ends_jobs_on_a_full_disk(server, jobs[:2])
        self.fill()
        server.close()
        server = self.start_server(*idle)
        self.assert_ends_jobs_on_a_full_disk(server, jobs[2:4])
        others.unlink()
        wait_until(lambda: server.samples()["tetstream_jobs_up"] == 1)
        wait_until((self.store / "jobs.sqlite.ballast").exists)
        server.close()
        server = self.start_server()
        waited = server.tetstream("job", "wait", *jobs[4:])
        self.assertEqual(waited.returncode, 0, waited.stdout + waited.stderr)
        self.assert_does_jobs(server)

    def test_a_worker_waits_while_others_fill_the_disk_and_goes_on_by_itself(self):
        self.mount(64)
        server = self.start_server()
        self.assert_does_jobs(server)
        others = self.fill()
        wait_until(lambda: server.log("jobs_down"))
        wait_until(lambda: server.samples()["tetstream_jobs_up"] == 0)
        others.unlink()
        self.assert_does_jobs(server)
        self.assertEqual(server.samples()['tetstream_worker_shards_total{outcome="failed"}'], 0)

    def fill_but(self, mebibytes):
        """Somebody else leaves so much of the disk beyond the reserve; the file to remove."""
        path = self.disk / "others"
        with open(path, "wb") as file:
            os.posix_fallocate(file.fileno(), 0, self.free() - RESERVE - mebibytes * MIB)
        return path

    def test_a_mesh_that_others_leave_no_room_for_waits_and_smaller_ones_do_not(self):
        self.mount(128)
        server = self.start_server("--job-lease-seconds", "3600")  # none runs out, and is an attempt
        self.assert_does_jobs(server)
        others = self.fill_but(6)
        large = self.submit(server, "--spacing", "0.02", "--max-attempts", "1")
        wait_until(lambda: self.show(server, large)["given_back_shards"] > 1)
        told = self.show(server, large)["last_give_back"]
        self.assertEqual(told["reason"], "RESULTS_FULL")
        self.assertRegex(told["message"], r"no room for the mesh's \d{7,} bytes on the disk")
        self.assert_does_jobs(server)
        samples = server.samples()
        self.assertGreater(samples['tetstream_worker_shards_total{outcome="no_room"}'], 1)
        self.assertEqual(samples["tetstream_worker_quarantines_total"], 0)
        self.assertEqual(samples["tetstream_jobs_up"], 1)
        others.unlink()
        waited = server.tetstream("job", "wait", large)
        self.assertEqual(waited.returncode, 0, waited.stdout + waited.stderr)

    def lose_a_chunk(self, server, job):
        """Of a job that has succeeded, which is planned and not finished once it is retried."""
        mesh = self.show(server, job)["header"]["mesh_id"]
        folder, = (self.store / "results").rglob(mesh)
        max(folder.iterdir(), key=lambda file: file.stat().st_size).unlink()
        said = server.tetstream("job", "retry", job)
        self.assertEqual(said.returncode, 0, said.stderr)

    def test_jobs_that_wait_for_a_disk_that_others_filled_all_go_on(self):
        self.mount(128)
        server = self.start_server()
        jobs = [self.submit(server, "--spacing", spacing) for spacing in ("0.030", "0.031")]
        waited = server.tetstream("job", "wait", *jobs)
        self.assertEqual(waited.returncode, 0, waited.stdout + waited.stderr)
        server.close()
        server = self.start_server("--job-workers", "0")
        for job in jobs:
            self.lose_a_chunk(server, job)
        server.close()
        # Room for the store's own files, and for no chunk.
        others = self.fill_but(0)
        server = self.start_server()
        for job in jobs:
            wait_until(lambda: self.show(server, job)["given_back_shards"] > 1)
        others.unlink()
        waited = server.tetstream("job", "wait", *jobs)
        self.assertEqual(waited.returncode, 0, waited.stdout + waited.stderr)

    def test_a_mesh_waits_for_room_no_longer_than_its_timeout(self):
        self.mount(128)
        server = self.start_server()
        self.fill_but(6)
        for seconds in (3, 12, 48, 192, 768):  # until a worker has had the time to try
            job = self.submit(server, "--spacing", "0.02", "--timeout", f"{seconds}s")
            self.assertNotEqual(server.tetstream("job", "wait", job).returncode, 0)
            told = self.show(server, job)
            self.assertEqual((told["state"], told["error"]["reason"]), ("FAILED", "JOB_TIMEOUT"))
            if "last_give_back" in told:
                break
        self.assertEqual(told["last_give_back"]["reason"], "RESULTS_FULL")

    def test_an_upload_leaves_the_reserve_and_evicts_nothing_in_vain(self):
        self.mount(64)
        server = self.start_server("--jobs", "off")
        self.assert_meshed(self.mesh(server))
        self.assertEqual(len(self.stored()), 1)
        with open(self.disk / "others", "wb") as file:
            os.posix_fallocate(file.fileno(), 0, self.free() - RESERVE)
        # Stored already: no room is needed.
        self.assert_meshed(self.mesh(server))
        other = self.inputs / "other.vdb"
        other.write_bytes((self.inputs / "sphere.vdb").read_bytes() + bytes(4 * MIB))
        said = server.tetstream("mesh", other, "-o", self.folder / "other.vtu")
        self.assertNotEqual(said.returncode, 0)
        self.assertIn("no room on the disk for", said.stderr)
        self.assertEqual(len(self.stored()), 1)


if __name__ == "__main__":
    unittest.main(verbosity=2)
