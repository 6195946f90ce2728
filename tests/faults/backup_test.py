"""Backups of a store at work, stores made of them, and what a check finds.

    TETSTREAM_BIN=build/dev/bin python3 tests/faults/backup_test.py [unittest options]
"""

import itertools
import json
import os
import pathlib
import subprocess
import threading
import unittest

from fault_case import GENEROUS_END, FaultTest, RunningServer, binaries, wait_until


class Backups(FaultTest):
    def setUp(self):
        super().setUp()
        self.backup = self.folder / "backup"

    def upkeep(self, command, *arguments, store=None):
        return subprocess.run(
            [binaries() / "tetstreamd", command, *map(str, arguments), "--store",
             store or self.store], capture_output=True, text=True, timeout=GENEROUS_END, check=False)

    def assert_done(self, said):
        self.assertEqual(said.returncode, 0, said.stdout + said.stderr)
        return said.stdout

    def submit(self, server, grid, *options):
        return server.tetstream("job", "submit", grid, "--json", "--skip-cache", "--journal",
                                self.folder / os.urandom(8).hex(), *options)

    def submit_for_ever(self, server, acknowledged, stop):
        """Jobs of grids that are new each time, by the name of the job."""
        for number in itertools.count():
            if stop.is_set():
                return
            said = self.submit(server, self.another_grid(number), "--max-attempts", "100")
            if said.returncode == 0:
                acknowledged.append(json.loads(said.stdout)["name"])

    def test_what_was_acknowledged_before_a_backup_under_load_is_in_what_is_made_of_it(self):
        # What it has leased when the backup is made and it is killed is soon anybody's.
        server = self.start("--job-workers", "1", "--job-lease-seconds", "1")
        acknowledged, stop = [], threading.Event()
        clients = [threading.Thread(target=self.submit_for_ever, args=(server, acknowledged, stop))]
        clients[0].start()
        try:
            wait_until(lambda: len(acknowledged) > 5)
            self.assert_done(self.upkeep("backup", self.backup))
            wait_until(lambda: len(acknowledged) > 10)
            before = list(acknowledged)
            self.assert_done(self.upkeep("backup", self.backup))
        finally:
            stop.set()
            clients[0].join()
        server.kill()
        restored = self.folder / "restored"
        self.assert_done(self.upkeep("restore", self.backup, store=restored))
        self.assert_done(self.upkeep("check", store=restored))
        with RunningServer(restored, "--job-workers", "2") as second:
            waited = second.tetstream("job", "wait", *before)
            self.assertEqual(waited.returncode, 0, waited.stdout + waited.stderr)
            for job in before[:3]:
                mesh = self.folder / "mesh.vtu"
                fetched = second.tetstream("job", "fetch", job, "-o", mesh)
                self.assertEqual(fetched.returncode, 0, fetched.stderr)

    def test_the_next_backup_takes_only_what_is_new_and_drops_what_is_gone(self):
        with self.start("--job-workers", "0") as server:
            self.assert_meshed(self.mesh(server))
            self.assert_done(self.upkeep("backup", self.backup))
            grid = next(self.backup.glob("grids/*/*"))
            self.assertEqual(grid.stat().st_ino, next(self.store.glob("grids/*/*")).stat().st_ino)
            self.assertIn(", 0 of them new", self.assert_done(self.upkeep("backup", self.backup)))
        next(self.store.glob("grids/*/*")).unlink()
        self.assertIn("1 removed", self.assert_done(self.upkeep("backup", self.backup)))
        self.assertFalse(grid.exists())

    def test_an_upload_that_broke_off_goes_on_in_the_store_that_is_restored(self):
        with self.start("--jobs", "off") as server:
            self.assert_meshed(self.mesh(server))
        digest = self.digest()
        grid = next(self.store.glob("grids/*/*"))
        part = self.store / "uploads" / f"{digest}.part"
        part.write_bytes(grid.read_bytes()[:1000])
        grid.unlink()
        self.assert_done(self.upkeep("backup", self.backup))
        kept = self.backup / "uploads" / f"{digest}.part"
        self.assertNotEqual(kept.stat().st_ino, part.stat().st_ino)
        restored = self.folder / "restored"
        self.assert_done(self.upkeep("restore", self.backup, store=restored))
        self.store = restored
        with self.start("--jobs", "off") as server:
            self.assert_meshed(self.mesh(server))

    def test_nothing_is_restored_over_a_store_and_no_backup_over_another(self):
        with self.start():
            pass
        self.assert_done(self.upkeep("backup", self.backup))
        said = self.upkeep("restore", self.backup)
        self.assertEqual(said.returncode, 3)
        self.assertIn("is not empty", said.stderr)
        other = self.folder / "other"
        RunningServer(other).close()
        said = self.upkeep("backup", self.backup, store=other)
        self.assertEqual(said.returncode, 3)
        self.assertIn("is the backup of store", said.stderr)
        said = self.upkeep("restore", self.folder / "nothing", store=self.folder / "new")
        self.assertIn("is no backup that was finished", said.stderr)

    def test_no_database_is_restored_beside_what_is_left_of_another(self):
        with self.start("--job-workers", "0") as server:
            self.assertEqual(self.submit(server, self.inputs / "sphere.vdb").returncode, 0)
            self.assert_done(self.upkeep("backup", self.backup))
        restored, jobs = self.folder / "restored", self.folder / "elsewhere" / "jobs.sqlite"
        jobs.parent.mkdir()
        for ending in ("-wal", "-shm", "-journal"):
            left = jobs.with_name(jobs.name + ending)
            left.write_bytes(b"of another database")
            said = self.upkeep("restore", self.backup, "--jobs", jobs, store=restored)
            self.assertEqual(said.returncode, 3)
            self.assertIn(f"{left} is left of a database", said.stderr)
            self.assertIn("move it away", said.stderr)
            self.assertFalse(jobs.exists())
            left.unlink()
        self.assert_done(self.upkeep("restore", self.backup, "--jobs", jobs, store=restored))
        self.assertTrue(jobs.exists())

    def test_a_check_finds_a_flipped_bit_wherever_it_is(self):
        with self.start() as server:
            self.assertEqual(self.submit(server, self.inputs / "sphere.vdb").returncode, 0)
            self.assertEqual(server.tetstream("job", "wait", "--all").returncode, 0)
        self.assertIn(" 0 problems", self.assert_done(self.upkeep("check")))
        chunks = [path for path in self.store.glob("results/*/meshes/*/*/*") if len(path.name) == 64]
        shards = list(self.store.glob("results/*/meshes/*/*/shard-*"))
        plans = list(self.store.glob("results/*/plans/*"))
        for path in (next(self.store.glob("grids/*/*")), chunks[0], shards[0], plans[0]):
            whole = path.read_bytes()
            path.write_bytes(whole[:-1] + bytes([whole[-1] ^ 1]))
            said = self.upkeep("check")
            self.assertEqual(said.returncode, 1, path)
            self.assertIn(str(pathlib.Path(path).relative_to(self.store)), said.stdout)
            path.write_bytes(whole)
        self.assert_done(self.upkeep("check"))


if __name__ == "__main__":
    unittest.main(verbosity=2)
