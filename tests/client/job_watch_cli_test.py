"""`tetstream job watch` as a script meets it, with a real server.

    TETSTREAM_BIN=build/release/bin python3 tests/client/job_watch_cli_test.py [unittest options]
"""

import contextlib
import json
import signal
import sqlite3
import unittest

from command_case import GENEROUS_END, REFUSED, wait_until
from cutting_link import CuttingLink
from job_case import JobTest


class PatientLink(CuttingLink):
    """Whoever comes while the server is away waits for it: how long it takes to be back is no matter of attempts."""

    def reach(self):
        return wait_until(super().reach)


class JobWatch(JobTest):
    settings = ("--job-workers", "0")

    def forget_what_was(self):
        """What a purge leaves where other jobs were old: all revisions so far are of no use to who watches all."""
        self.list()  # which gives all changes their revisions
        with sqlite3.connect(self.inputs / "store" / "jobs.sqlite", timeout=GENEROUS_END) as jobs:
            jobs.execute("UPDATE counters SET value = (SELECT value FROM counters WHERE name = 'revision')"
                         " WHERE name = 'compacted'")
        jobs.close()

    def start_patient_watch(self, *arguments):
        link = PatientLink(self.address)
        self.addCleanup(link.close)
        return self.start_job_command("watch", *arguments, "--json", server=link.address)

    def test_several_jobs_are_watched_though_changes_of_others_were_purged(self):
        ball = self.inputs / "sphere.vdb"
        one, two, gone = (self.submit(ball)[0] for _ in range(3))
        self.objects(self.job("cancel", gone, "--json"))
        self.objects(self.job("delete", gone, "--json"))
        self.forget_what_was()
        self.assertEqual(self.job("watch", "--after", "0").returncode, REFUSED)
        process = self.start_job_command("watch", two, one, "--json")
        told = [json.loads(process.stdout.readline()) for _ in range(2)]
        for name in (two, one):
            self.objects(self.job("cancel", name, "--json"))
        rest, errors = process.communicate(timeout=GENEROUS_END)
        self.assertEqual(process.returncode, 0, errors)
        told += [json.loads(line) for line in rest.splitlines()]
        self.assertEqual([(event["name"], event["change"]) for event in told],
                         [(one, "CREATED"), (two, "CREATED"), (two, "FINISHED"), (one, "FINISHED")])
        revisions = [event["revision"] for event in told]
        self.assertEqual(revisions, sorted(set(revisions)))
        self.forget_what_was()
        again = self.objects(self.job("watch", one, two, "--after", revisions[1], "--json"))
        self.assertEqual(again, told[2:])

    def test_what_had_finished_by_a_revision_is_not_waited_for(self):
        one, two = (self.submit(self.inputs / "sphere.vdb")[0] for _ in range(2))
        for name in (one, two):
            self.objects(self.job("cancel", name, "--json"))
        first, last = (self.objects(self.job("watch", name, "--json"))[-1]["revision"] for name in (one, two))
        self.assertEqual(self.objects(self.job("watch", one, "--after", first, "--json")), [])
        rest = self.objects(self.job("watch", one, two, "--after", first, "--json"))
        self.assertEqual([(event["name"], event["change"]) for event in rest], [(two, "FINISHED")])
        self.forget_what_was()
        self.assertEqual(self.objects(self.job("watch", one, two, "--after", last, "--json")), [])
        rest = self.objects(self.job("watch", one, two, "--after", first, "--json"))
        self.assertEqual([event["revision"] for event in rest], [last])

    def test_one_that_was_over_may_be_gone(self):
        over, other = (self.submit(self.inputs / "sphere.vdb")[0] for _ in range(2))
        process = self.start_patient_watch(over, other)
        self.objects(self.job("cancel", over, "--json"))
        told = [json.loads(process.stdout.readline()) for _ in range(3)]
        self.assertEqual((told[-1]["name"], told[-1]["change"]), (over, "FINISHED"))
        # It is purged, with a later change of another's, while nobody watches.
        self.kill_server()
        with contextlib.closing(sqlite3.connect(self.inputs / "store" / "jobs.sqlite")) as jobs:
            for table, column in (("events", "job_id"), ("jobs", "id")):
                jobs.execute(f"DELETE FROM {table} WHERE {column} = ?", [over.removeprefix("jobs/")])
            jobs.execute("UPDATE counters SET value = (SELECT value + 1 FROM counters WHERE name = 'revision')"
                         " WHERE name IN ('revision', 'compacted')")
            jobs.commit()
        self.start_server()
        self.objects(self.job("cancel", other, "--json"))
        rest, errors = process.communicate(timeout=GENEROUS_END)
        self.assertEqual(process.returncode, 0, errors)
        self.assertEqual([json.loads(line)["name"] for line in rest.splitlines()], [other])

    def test_goes_on_when_the_server_is_killed(self):
        process = self.start_patient_watch("--after", "0")

        def told_until(name, change):
            told = []
            while not told or (told[-1]["name"], told[-1]["change"]) != (name, change):
                line = process.stdout.readline()
                if not line:
                    self.fail(process.stderr.read())
                told.append(json.loads(line))
            return told

        one, = self.submit(self.inputs / "sphere.vdb")
        told = told_until(one, "CREATED")
        self.kill_server()
        self.start_server()
        two, = self.submit(self.inputs / "sphere.vdb")
        self.objects(self.job("cancel", two, "--json"))
        told += told_until(two, "FINISHED")
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=GENEROUS_END)
        self.assertEqual([(event["name"], event["change"]) for event in told],
                         [(one, "CREATED"), (two, "CREATED"), (two, "FINISHED")])
        revisions = [event["revision"] for event in told]
        self.assertEqual(revisions, sorted(set(revisions)))

    def test_that_cannot_be_written_ends(self):
        one, = self.submit(self.inputs / "sphere.vdb")
        with open("/dev/full", "w") as full:
            process = self.start_job_command("watch", one, "--json", stdout=full)
        _, errors = process.communicate(timeout=GENEROUS_END)
        self.assertEqual(process.returncode, REFUSED, errors)
        self.assertIn("what it printed cannot be written", errors)

    def test_that_nobody_reads_ends_with_the_next_change(self):
        one, two = (self.submit(self.inputs / "sphere.vdb")[0] for _ in range(2))
        process = self.start_job_command("watch", one, two, "--json")
        for _ in (one, two):
            self.assertTrue(process.stdout.readline())
        process.stdout.close()
        self.objects(self.job("cancel", one, "--json"))
        self.assertEqual(process.wait(GENEROUS_END), 128 + signal.SIGPIPE)
        self.assertEqual(process.stderr.read(), "")
        process.stderr.close()


if __name__ == "__main__":
    unittest.main(verbosity=2)
