"""Servers whose jobs find no room: the disk of their database or of their results is full for a while.

    TETSTREAM_BIN=build/dev/bin TET_FAIL_WRITES_LIBRARY=build/dev/.../libfail_writes.so \\
        python3 tests/faults/full_jobs_test.py [unittest options]
"""

import os
import subprocess
import unittest

from fault_case import GENEROUS_END, FaultTest, binaries, wait_until


class FullJobDisk(FaultTest):
    def setUp(self):
        super().setUp()
        self.full = self.folder / "full"  # the disk is full while this is there
        self.job_options = ["--jobs", self.folder / "jobs.sqlite"]

    def start_on(self, *places):
        environment = {"LD_PRELOAD": os.environ["TET_FAIL_WRITES_LIBRARY"],
                       "TET_FULL_WHILE": str(self.full), "TET_FULL_AT": ":".join(places)}
        return self.start(*self.job_options, "--job-lease-seconds", "3600", environment=environment)

    def submit(self, server, *options):
        """A submission, which goes on for as long as the server asks for patience."""
        return subprocess.Popen(
            [binaries() / "tetstream", "job", "submit", self.inputs / "sphere.vdb", *options,
             "--server", server.address], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            env={**os.environ, "XDG_STATE_HOME": str(self.folder)})

    def assert_submitted(self, submission):
        _, said = submission.communicate(timeout=GENEROUS_END)
        self.assertEqual(submission.returncode, 0, said)

    def assert_fetched(self, server):
        waited = server.tetstream("job", "wait", "--all")
        self.assertEqual(waited.returncode, 0, waited.stdout + waited.stderr)
        fetched = server.tetstream("job", "fetch", "--all", "--into", self.folder / "meshes")
        self.assertEqual(fetched.returncode, 0, fetched.stderr)
        mesh = next((self.folder / "meshes").glob("*.vtu"))
        self.assertTrue(mesh.read_bytes() == self.expected["sphere"])

    def is_up(self, server):
        return server.samples()["tetstream_jobs_up"] == 1

    def health(self, server):
        return server.tetstream("health", "--service", "jobs").returncode

    def test_a_server_starts_and_streams_and_takes_jobs_when_there_is_room_again(self):
        self.full.touch()
        server = self.start_on("jobs.sqlite", "/results")
        self.assert_meshed(self.mesh(server))
        self.assertFalse(self.is_up(server))
        self.assertEqual(self.health(server), 3)
        server.told("jobs_down", reason="JOB_STORE_FULL")
        submission = self.submit(server)
        refused = server.told("call", method="CreateJob", status="RESOURCE_EXHAUSTED",
                              reason="JOB_STORE_FULL")
        self.assertNotIn(str(self.folder), refused[0]["message"])
        self.full.unlink()
        self.assert_submitted(submission)
        self.assertTrue(wait_until(lambda: self.is_up(server)))
        server.told("jobs_up")
        self.assert_fetched(server)

    def test_jobs_wait_for_room_for_their_results_and_lose_no_attempt(self):
        server = self.start_on("/results")
        wait_until(lambda: self.is_up(server))
        wait_until(lambda: self.health(server) == 0)
        self.full.touch()
        submission = self.submit(server, "--max-attempts", "1")
        self.assert_submitted(submission)
        given_back = wait_until(lambda: server.log("shard_given_back"))
        self.assertEqual(given_back[0]["reason"], "DISK_FULL")
        self.assert_meshed(self.mesh(server))
        self.full.unlink()
        self.assert_fetched(server)

    def test_a_database_that_fills_loses_nothing(self):
        server = self.start_on("jobs.sqlite")
        submission = self.submit(server, "--max-attempts", "1")
        self.assert_submitted(submission)
        self.full.touch()
        self.assert_meshed(self.mesh(server))
        self.full.unlink()
        self.assert_fetched(server)


if __name__ == "__main__":
    unittest.main(verbosity=2)
