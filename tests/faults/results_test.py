"""Results on a disk that fills or tears: a worker gives its shard back with the reason, it is done
elsewhere, and what is damaged is noticed.

    TETSTREAM_BIN=build/dev/bin TET_FAIL_WRITES_LIBRARY=build/dev/.../libfail_writes.so \\
        python3 tests/faults/results_test.py [unittest options]
"""

import json
import os
import shutil
import unittest

from fault_case import GENEROUS_END, FaultTest, wait_until
from postgres import Postgres
from running_server import RunningWorker


class Results(FaultTest):
    """Jobs are not on the disk that fills: their database would be the first to miss the room."""

    step = 1 if "TET_EVERY_CHANGE" in os.environ else 60

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.postgres = cls.enterClassContext(Postgres())

    def setUp(self):
        super().setUp()
        self.postgres.clear()
        self.server = self.start("--jobs", self.postgres.address, "--job-workers", "0")
        self.mark = self.folder / "mark"

    def job(self, command, *arguments):
        return self.server.tetstream("job", command, *arguments)

    def submit(self, *options):
        said = self.job("submit", self.inputs / "sphere.vdb", "--json",
                        "--journal", self.folder / f"{os.urandom(8).hex()}", *options)
        self.assertEqual(said.returncode, 0, said.stderr)
        return json.loads(said.stdout)["name"]

    def show(self, job):
        return json.loads(self.job("show", job, "--json").stdout)

    def start_worker(self, full_at=None):
        """A worker; on a disk that is full from its n-th change on, if it is told when."""
        environment = {} if full_at is None else {
            "LD_PRELOAD": os.environ["TET_FAIL_WRITES_LIBRARY"], "TET_FAIL_AT": str(full_at),
            "TET_FAIL_MARK": str(self.mark)}
        return RunningWorker(self.store, self.postgres.address, "--job-workers", "1",
                             environment=environment)

    def assert_made(self, job):
        mesh = self.folder / "mesh.vtu"
        with self.start_worker():
            self.assertEqual(self.job("wait", job, "--patience", f"{GENEROUS_END:.0f}s").returncode, 0)
        fetched = self.job("fetch", job, "-o", mesh)
        self.assertEqual(fetched.returncode, 0, fetched.stderr)
        self.assertTrue(mesh.read_bytes() == self.expected["sphere"])
        mesh.unlink()

    def forget_results(self):
        shutil.rmtree(self.store / "results" / "default", ignore_errors=True)

    def fills_at(self, change):
        """Whether a worker's disk becomes full at this change, while a job is made that is made anyway."""
        self.forget_results()
        job = self.submit("--max-attempts", "100")
        try:
            with self.start_worker(change) as worker:
                wait_until(lambda: self.mark.exists() or self.show(job)["state"] == "SUCCEEDED")
                if self.mark.exists():
                    told = wait_until(lambda: worker.log("shard_given_back") or
                                      worker.log("worker_quarantined"))
                    self.assertEqual({line["reason"] for line in told}, {"DISK_FULL"})
        except AssertionError as error:
            self.assertIn("No space left on device", str(error))  # it did not even start
        self.assert_made(job)
        full = self.mark.exists()
        self.mark.unlink(missing_ok=True)
        return full

    def test_a_worker_whose_disk_fills_leaves_the_job_to_be_done(self):
        change = 1
        while self.fills_at(change):
            change += self.step
        print(f"the disk was full at every {self.step}. of {change - self.step} changes")
        self.assertGreater(change, self.step)

    def stored(self, pattern):
        return sorted(self.store.glob(f"results/default/meshes/*/*/{pattern}"))

    def test_a_torn_chunk_is_told_and_made_again(self):
        job = self.submit("--skip-cache")
        self.assert_made(job)
        chunk = max(self.stored("[0-9a-f]*"), key=lambda path: path.stat().st_size)
        os.truncate(chunk, chunk.stat().st_size // 2)
        fetched = self.job("fetch", job, "-o", self.folder / "mesh.vtu")
        self.assertIn("is damaged; retry the job to make it again", fetched.stderr)
        self.assertFalse((self.folder / "mesh.vtu").exists())
        self.assertEqual(len(self.server.told("stored_chunk_damaged")), 1)
        self.assertEqual(self.job("retry", job).returncode, 0)
        self.assert_made(job)

    def test_a_torn_shard_is_not_believed(self):
        self.assert_made(self.submit("--skip-cache"))
        for shard in self.stored("shard-*"):
            os.truncate(shard, shard.stat().st_size - 1)
        job = self.submit()
        self.assert_made(job)
        self.assertFalse(self.show(job)["cached"])


if __name__ == "__main__":
    unittest.main(verbosity=2)
