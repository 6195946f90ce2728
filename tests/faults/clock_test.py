"""Hosts of a farm whose clocks are wrong: the times that hold are the job store's.

    TETSTREAM_BIN=build/dev/bin TET_SHIFT_CLOCK_LIBRARY=build/dev/.../libshift_clock.so \\
        python3 tests/faults/clock_test.py [unittest options]
"""

import datetime
import json
import os
import unittest

from fault_case import FaultTest, wait_until
from postgres import Postgres
from running_server import RunningWorker

DAYS_AHEAD = 9
SECONDS = DAYS_AHEAD * 86_400


def shifted(seconds):
    return {"LD_PRELOAD": os.environ["TET_SHIFT_CLOCK_LIBRARY"],
            "TET_CLOCK_AHEAD_SECONDS": str(seconds)}


class Clocks(FaultTest):
    """Jobs are kept for a week: less than what the clocks are wrong by."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.postgres = cls.enterClassContext(Postgres())

    def setUp(self):
        super().setUp()
        self.postgres.clear()

    def job_done(self, server):
        said = server.tetstream("job", "submit", self.inputs / "sphere.vdb", "--json", "--ttl", "1h",
                                "--skip-cache", "--journal", self.folder / os.urandom(8).hex())
        self.assertEqual(said.returncode, 0, said.stderr)
        job = json.loads(said.stdout)["name"]
        waited = server.tetstream("job", "wait", job)
        self.assertEqual(waited.returncode, 0, waited.stdout + waited.stderr)
        return job

    def assert_forgets_nothing(self, program, server, job):
        """Once it has looked for what is old: a worker that was heard of two days ago is forgotten."""
        wait_until(lambda: self.postgres.rows("SELECT 1 FROM workers WHERE name = 'long gone'") == [])
        told = wait_until(lambda: program.log("clock_differs"))
        self.assertGreater(abs(told[0]["ahead_seconds"]), SECONDS - 3600)
        shown = server.tetstream("job", "show", job, "--json")
        self.assertEqual(shown.returncode, 0, shown.stderr)
        self.assertEqual(json.loads(shown.stdout)["state"], "SUCCEEDED")

    def test_a_worker_that_is_days_ahead_forgets_nothing_expires_nothing_and_is_told(self):
        server = self.start("--jobs", self.postgres.address, "--job-workers", "1")
        job = self.job_done(server)
        server.close()
        server = self.start("--jobs", self.postgres.address, "--job-workers", "0")
        # Before it starts: it looks for what is old at once, and then seldom.
        self.postgres.rows(
            "INSERT INTO workers SELECT 'long gone', '1', '', "
            "((extract(epoch FROM clock_timestamp()) - 172800) * 1000000)::bigint")
        with RunningWorker(self.store, self.postgres.address, "--job-workers", "1",
                           environment=shifted(SECONDS)) as worker:
            self.assert_forgets_nothing(worker, server, job)
            self.assertAlmostEqual(worker.samples()["tetstream_clock_ahead_seconds"], SECONDS, delta=60)
            self.job_done(server)
            self.assertEqual(server.log("clock_differs"), [])
            results = list(self.store.glob("results/default/meshes/*/*"))
            self.assertGreater(len(results), 0)

    def test_a_server_that_is_days_behind_tells_the_times_of_the_store(self):
        server = self.start("--jobs", self.postgres.address, "--job-workers", "1",
                            environment=shifted(-SECONDS))
        job = self.job_done(server)
        told = json.loads(server.tetstream("job", "show", job, "--json").stdout)
        self.assertGreaterEqual(told["progress"]["chunks_per_second"], 0.001)
        finished = datetime.datetime.fromisoformat(told["finish_time"].replace("Z", "+00:00"))
        age = datetime.datetime.now(datetime.timezone.utc) - finished
        self.assertLess(abs(age.total_seconds()), 3600)
        wait_until(lambda: server.log("clock_differs"))


if __name__ == "__main__":
    unittest.main(verbosity=2)
