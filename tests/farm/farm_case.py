"""What every test of a farm stands on: PostgreSQL, a server and workers that share a store."""

import argparse
import collections
import json
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "server"))

from postgres import Postgres  # noqa: E402
from running_server import GENEROUS_END, RunningServer, RunningWorker, binaries, wait_until  # noqa: E402

__all__ = ["Farm", "FarmTest", "Lease", "GENEROUS_END", "Postgres", "RunningServer", "RunningWorker", "binaries",
           "main", "wait_until"]

LEASE_SECONDS = 1
COUNT_BRICKS = 64  # so that large grids are counted in shards

Lease = collections.namedtuple("Lease", "job phase number token")


class Farm:
    """A store that does no jobs itself, jobs in PostgreSQL, and a folder of inputs.

    `launch` is put before the commands of what runs on the server's host.
    """

    def __init__(self, host="", launch=(), **postgres):
        self._scratch = tempfile.TemporaryDirectory(prefix="tetstream-farm-")
        self.folder = pathlib.Path(self._scratch.name)
        self.launch = launch
        self.postgres = Postgres(host, launch, **postgres)
        self.workers = []
        self.server = None
        self.listen = "127.0.0.1:0"
        self.start_server()

    def start_server(self):
        """Again on the port it had."""
        self.server = RunningServer(
            self.folder / "store", "--jobs", self.postgres.address, "--job-workers", "0",
            "--job-lease-seconds", LEASE_SECONDS, listen=self.listen, launch=self.launch)
        self.listen = self.server.address

    def start_worker(self, *options, launch=(), count_bricks=COUNT_BRICKS, **more):
        worker = RunningWorker(
            self.folder / "store", self.postgres.address, "--job-lease-seconds", LEASE_SECONDS,
            "--job-count-bricks", count_bricks, *(options or ("--job-workers", "1")), launch=launch, **more)
        self.workers.append(worker)
        return worker

    def end_worker(self, worker):
        self.workers.remove(worker)
        worker.close()

    def tetstream(self, *arguments):
        return subprocess.run([*self.launch, binaries() / "tetstream", *map(str, arguments)],
                              capture_output=True, text=True, timeout=2 * GENEROUS_END, check=False)

    def job(self, command, *arguments):
        return self.tetstream("job", command, *arguments, "--server", self.server.address)

    def make_grid(self, kind, voxel):
        """The file of a fixture, and beside it the mesh that no server made."""
        grid = self.folder / f"{kind}-{voxel}.vdb"
        subprocess.run([binaries() / "make_fixture", kind, str(voxel), grid], check=True)
        subprocess.run([binaries() / "tetstream", "mesh", grid, "-o", grid.with_suffix(".vtu")],
                       check=True, stdout=subprocess.DEVNULL)
        return grid

    def leases(self, worker):
        """What a worker holds now."""
        rows = self.postgres.rows(
            "SELECT job_id, phase, number, token FROM queue WHERE state = 1 AND "
            f"worker LIKE '%:{worker.process.pid}'")
        return {Lease(job, *map(int, numbers)) for job, *numbers in rows}

    def committed(self):
        """The claim of each shard that is done."""
        rows = self.postgres.rows("SELECT job_id, phase, number, token FROM shards WHERE outcome = 1")
        return {Lease(job, *map(int, numbers)) for job, *numbers in rows}

    def close(self):
        for running in [*self.workers, self.server, self.postgres]:
            if running is not None:
                running.close()
        self._scratch.cleanup()


class FarmTest(unittest.TestCase):
    """Meshes grids on a farm, and checks that what came out is what it should be."""

    seed, runs = None, 4

    def setUp(self):
        self.seed = self.seed if self.seed is not None else random.randrange(1 << 32)
        self.chance = random.Random(self.seed)
        print(f"seed {self.seed}", flush=True)

    def make_farm(self, *arguments, **options):
        farm = Farm(*arguments, **options)
        self.addCleanup(farm.close)
        return farm

    def submit(self, farm, grid, *options):
        """The id of a job that makes its mesh anew, acknowledged however often that takes."""
        journal = farm.folder / f"journal{time.monotonic_ns()}"

        def acknowledged():
            said = farm.job("submit", grid, "--skip-cache", "--max-attempts", 100, "--journal", journal,
                            "--json", *options)
            self.assertIn(said.returncode, (0, 3), said.stderr)
            return said.stdout if said.returncode == 0 else None

        return json.loads(wait_until(acknowledged).splitlines()[0])["name"].removeprefix("jobs/")

    def assert_done(self, farm, jobs):
        """{id: grid}: they succeed, each shard committed once, with the right bytes."""
        def finished():
            said = farm.job("wait", *jobs, "--patience", f"{GENEROUS_END:.0f}s")
            return said if said.returncode != 3 else None

        said = wait_until(finished)
        self.assertEqual(said.returncode, 0, said.stdout + said.stderr)
        listed = ", ".join(f"'{job}'" for job in jobs)
        self.assertEqual(farm.postgres.rows(
            f"SELECT id, alarms FROM jobs WHERE id IN ({listed}) AND (alarms > 0 OR state <> 3 OR "
            "done_shards <> shard_count OR done_chunks <> chunk_count)"), [])
        # An event for each commit; one number of done shards for each of them, since that only grows
        # while the mesh is counted, when it has no chunks yet, and while it is made.
        self.assertEqual(farm.postgres.rows(
            "SELECT job_id, chunk_count, done_shards, count(*) FROM events WHERE change = 4 AND "
            f"job_id IN ({listed}) GROUP BY 1, 2, 3 HAVING count(*) <> 1"), [])
        self.assertEqual(farm.postgres.rows(
            "SELECT jobs.id FROM jobs WHERE shard_count <> (SELECT count(*) FROM events WHERE change = 4 "
            f"AND chunk_count > 0 AND job_id = jobs.id) AND jobs.id IN ({listed})"), [])
        for job, grid in jobs.items():
            mesh = farm.folder / f"{job}.vtu"
            fetched = farm.job("fetch", job, "-o", mesh)
            self.assertEqual(fetched.returncode, 0, fetched.stderr)
            self.assertTrue(mesh.read_bytes() == grid.with_suffix(".vtu").read_bytes())
            mesh.unlink()


def main(test):
    """Runs the tests of a file; --runs N and --seed S are for those that go by chance."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--runs", type=int, default=test.runs)
    parser.add_argument("--seed", type=int)
    options, rest = parser.parse_known_args()
    test.runs, test.seed = options.runs, options.seed
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # by way of what cleans up
    unittest.main(module=sys.modules["__main__"], argv=[sys.argv[0], *rest], verbosity=2, failfast=True)
