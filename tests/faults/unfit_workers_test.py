"""Workers that cannot work: no store, another store, no decoder, a disk that fails. They do no harm.

    TETSTREAM_BIN=build/dev/bin TET_HIDE_ONCE_LIBRARY=build/dev/.../libhide_once.so \\
        python3 tests/faults/unfit_workers_test.py [unittest options]
"""

import hashlib
import json
import os
import signal
import subprocess
import unittest

from fault_case import GENEROUS_END, FaultTest, binaries, wait_until
from postgres import Postgres
from running_server import RunningWorker

JOBS = 20


class UnfitWorkers(FaultTest):
    """Each shard has one attempt: a worker that uses up one that it should not fails a job."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.postgres = cls.enterClassContext(Postgres())

    def setUp(self):
        super().setUp()
        self.postgres.clear()
        self.server = self.start("--jobs", self.postgres.address, "--job-workers", "0")

    def job(self, command, *arguments):
        return self.server.tetstream("job", command, *arguments)

    def submit(self, *options, attempts="1"):
        said = self.job("submit", self.inputs / "sphere.vdb", "--json", "--max-attempts", attempts,
                        "--skip-cache", "--journal", self.folder / os.urandom(8).hex(), *options)
        self.assertEqual(said.returncode, 0, said.stderr)
        return json.loads(said.stdout)["name"]

    def show(self, job):
        return json.loads(self.job("show", job, "--json").stdout)

    def start_worker(self, store=None, *options, lease_seconds=3600, **more):
        """Its leases do not run out, as that would use up an attempt."""
        worker = RunningWorker(store or self.store, self.postgres.address, "--job-workers", "1",
                               "--job-lease-seconds", lease_seconds, *options, **more)
        self.addCleanup(worker.close)
        return worker

    def assert_all_succeed(self):
        waited = self.job("wait", "--all", "--patience", f"{GENEROUS_END:.0f}s")
        self.assertEqual(waited.returncode, 0, waited.stdout + waited.stderr)

    def is_fit(self, worker):
        return worker.samples()["tetstream_worker_fit"] == 1

    def test_one_whose_store_is_not_mounted_claims_nothing_until_it_is(self):
        empty = self.folder / "unmounted"
        empty.mkdir()
        mount = self.folder / "mount"
        mount.symlink_to(empty)
        bad = self.start_worker(mount)
        told = wait_until(lambda: bad.log("worker_quarantined"))
        self.assertEqual(told[0]["reason"], "WRONG_STORE")
        self.assertIn("store-id is missing", told[0]["message"])
        wait_until(lambda: not self.is_fit(bad))  # again and again, as its pause ends
        jobs = [self.submit() for _ in range(JOBS)]
        good = self.start_worker()
        self.assert_all_succeed()
        self.assertEqual(good.samples()['tetstream_worker_shards_total{outcome="failed"}'], 0)
        self.assertEqual(sum(value for name, value in bad.samples().items()
                             if name.startswith("tetstream_worker_shards_total")), 0)
        self.assertEqual(self.show(jobs[0])["given_back_shards"], 0)
        self.assertEqual(
            [self.server.samples()[f'tetstream_workers{{state="{state}"}}']
             for state in ("working", "quarantined")], [1, 1])
        self.assertEqual(list(empty.iterdir()), [])
        # Mounted at last.
        good.close()
        other = self.folder / "mounted"
        other.symlink_to(self.store)
        os.replace(other, mount)
        wait_until(lambda: bad.log("worker_back"))
        self.submit()
        self.assert_all_succeed()
        self.assertTrue(self.is_fit(bad))

    def test_one_whose_store_goes_away_while_it_works_gives_its_shards_back(self):
        mount, away, back = (self.folder / name for name in ("mount", "away", "back"))
        empty = self.folder / "unmounted"
        empty.mkdir()
        mount.symlink_to(self.store)
        bad = self.start_worker(mount)
        self.submit()
        self.assert_all_succeed()
        away.symlink_to(empty)
        back.symlink_to(self.store)
        os.replace(away, mount)
        job = self.submit()
        wait_until(lambda: bad.log("worker_quarantined"))
        self.assertNotEqual(self.show(job)["state"], "FAILED")
        self.assertEqual(bad.samples()['tetstream_worker_shards_total{outcome="failed"}'], 0)
        os.replace(back, mount)
        self.assert_all_succeed()
        self.assertEqual(self.show(job)["state"], "SUCCEEDED")

    def test_one_whose_store_was_away_for_a_moment_looks_again(self):
        """It was away when the grid was opened, and is back when the worker looks whether it is there."""
        mark = self.folder / "away"
        grid = hashlib.sha256((self.inputs / "sphere.vdb").read_bytes()).hexdigest()
        worker = self.start_worker(environment={
            "LD_PRELOAD": os.environ["TET_HIDE_ONCE_LIBRARY"],
            "TET_HIDE_ONCE": str(mark), "TET_HIDE_AT": grid})
        mark.touch()
        job = self.submit()
        self.assert_all_succeed()
        self.assertFalse(mark.exists())  # the grid was opened in vain
        self.assertEqual(worker.samples()['tetstream_worker_shards_total{outcome="failed"}'], 0)
        self.assertEqual(self.show(job)["given_back_shards"], 0)

    def test_a_store_that_is_another_is_refused_by_server_and_worker(self):
        other = self.folder / "other"
        self.store, own = other, self.store
        with self.start("--jobs", "off"):
            pass
        refused = subprocess.run(
            [binaries() / "tetstreamd", "--store", other, "--jobs", self.postgres.address,
             "--listen", "127.0.0.1:0"], capture_output=True, text=True, timeout=GENEROUS_END,
            check=False)
        self.assertEqual(refused.returncode, 3)
        self.assertIn("the jobs belong to store", refused.stderr)
        worker = self.start_worker(other)
        told = wait_until(lambda: worker.log("worker_quarantined"))
        self.assertEqual(told[0]["reason"], "WRONG_STORE")
        # The remedy that it names.
        (other / "store-id").write_text((own / "store-id").read_text())
        wait_until(lambda: worker.log("worker_back"))

    def test_one_without_a_decoder_leaves_the_jobs_to_others_and_the_job_says_so(self):
        bad = self.start_worker(None, "--decoder", "/nowhere/decoder")
        job = self.submit()
        wait_until(lambda: self.show(job)["given_back_shards"] > 0)
        self.assertTrue(bad.told("shard_given_back"))
        told = self.show(job)
        self.assertEqual(told["last_give_back"]["reason"], "DECODER_UNAVAILABLE")
        self.assertIn("worker ", told["last_give_back"]["message"])
        said = self.job("show", job).stdout
        self.assertIn("DECODER_UNAVAILABLE", said)
        wait_until(lambda: not self.is_fit(bad))  # again and again, as its pause ends
        self.start_worker()
        self.assert_all_succeed()
        self.assertEqual(bad.samples()['tetstream_worker_shards_total{outcome="failed"}'], 0)
        pauses = bad.samples()["tetstream_worker_quarantines_total"]
        self.assertGreaterEqual(pauses, 1)

    def test_a_job_of_another_version_is_left_to_its_workers_while_there_are_any(self):
        """What a version 4 left over an upgrade, by its rows: its programs are not there to make them."""
        worker = self.start_worker()

        def submit():
            return self.submit("--spacing", "0.02", attempts="100")  # leases of few seconds may be lost

        job = submit()

        def is_caught_at_work():
            """Stopped, or it would be done by the time that we are told."""
            nonlocal job
            worker.process.send_signal(signal.SIGSTOP)
            progress = self.show(job)["progress"]
            if progress["done_shards"] > 0 and 0 < progress["done_chunks"] < progress["chunk_count"]:
                return True
            worker.process.send_signal(signal.SIGCONT)
            if self.show(job)["state"] == "SUCCEEDED":
                job = submit()
            return False

        wait_until(is_caught_at_work)
        worker.close()
        for table in ("jobs", "queue"):
            self.postgres.rows(f"UPDATE {table} SET algorithm = '4'")
        self.postgres.rows("UPDATE jobs SET state = 2 WHERE state <> 3")
        ready = self.postgres.rows("UPDATE queue SET state = 0, attempt = 0 RETURNING number")
        self.assertGreater(len(ready), 0)
        # Seen an hour ahead, as who is not heard of for a minute is taken for dead.
        self.postgres.rows(
            "INSERT INTO workers SELECT 'old', '4', '', "
            "((extract(epoch FROM clock_timestamp()) + 3600) * 1000000)::bigint")
        worker = self.start_worker(lease_seconds=3)  # looks for them each second
        other = self.submit(attempts="100")  # the worker does it, and so has looked at what there was before it
        waited = self.job("wait", other)
        self.assertEqual(waited.returncode, 0, waited.stdout + waited.stderr)
        self.assertEqual(self.show(job)["replans"], 0)
        self.postgres.rows("DELETE FROM workers WHERE name = 'old'")
        wait_until(lambda: worker.log("jobs_replanned"))
        self.assert_all_succeed()
        told = self.show(job)
        self.assertEqual((told["state"], told["replans"]), ("SUCCEEDED", 1))
        self.assertEqual(told["progress"]["done_chunks"], told["progress"]["chunk_count"])
        self.assertIn("replanned", self.job("show", job).stdout)


if __name__ == "__main__":
    unittest.main(verbosity=2)
