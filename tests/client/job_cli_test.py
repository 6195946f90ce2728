"""`tetstream job` as a script meets it, with a real server.

    TETSTREAM_BIN=build/dev/bin python3 tests/client/job_cli_test.py [unittest options]
"""

import filecmp
import json
import os
import shutil
import signal
import subprocess
import unittest

from command_case import (
    CUBE, ENDINGS, GENEROUS_END, LID, REFUSED, SERVER, USAGE, CommandTest, binaries, catches, unused_port,
    wait_until)
from cutting_link import CuttingLink
from job_case import JobTest


class JobUsage(CommandTest):
    volumes = {}

    def test_help_teaches(self):
        for command, *words in (
                ("submit", "--manifest", "--journal", "--label", "--priority", "--ttl", "--timeout",
                 "--max-attempts", "--skip-cache", "--improve", "--voxel", "again"),
                ("list", "--state", "--since"), ("show",), ("watch", "--after"),
                ("wait", "--patience", "Exits with 0"), ("cancel",), ("retry",),
                ("fetch", "--into", "--format"), ("delete",),
                ("workers", "workers.read")):
            with self.subTest(command):
                result = self.tetstream("job", command, "--help")
                self.assert_done(result)
                for word in (*words, "Examples:", f"tetstream job {command}", "--server"):
                    self.assertIn(word, result.stdout)

    def test_what_cannot_be_understood(self):
        server = ("--server", "127.0.0.1:1")
        for arguments, *words in (
                (["job"], "subcommand"),
                (["job", "list"], "--server"),
                (["job", "submit", *server], "INPUT", "--manifest"),
                (["job", "wait", *server], "which jobs"),
                (["job", "list", "--state", "lost", *server], "lost"),
                (["job", "delete", "--state", "succeeded", "--until", "", *server], "--until", "empty"),
                (["job", "submit", "a.vdb", "--name=", "--skip-cache", *server], "--name", "empty"),
                (["job", "delete", "ID", "--state", "failed", *server], "their names", "--state"),
                (["job", "retry", "--journal", "j", "--state", "failed", *server], "--journal", "--state"),
                (["job", "cancel", "--journal", "j", "--all", *server], "--journal", "--all"),
                (["job", "fetch", "ID", "-o", "a.vtu", "--into", "b", *server], "excludes")):
            with self.subTest(arguments):
                self.assert_fails(self.tetstream(*arguments), USAGE, *words)

    def test_ctrl_c_ends_a_command_that_reads_what_a_pipe_brings(self):
        server = ("--server", f"127.0.0.1:{unused_port()}")
        for command in (("wait", "-"), ("submit", "--manifest", "-")):
            process = subprocess.Popen([binaries() / "tetstream", "job", *command, *server], stdin=subprocess.PIPE,
                                       stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            wait_until(lambda: catches(process, signal.SIGINT))  # noqa: B023
            process.stdin.write("a.vdb\n")
            process.stdin.flush()
            process.send_signal(signal.SIGINT)
            with process.stdin:  # which stays open until it has ended
                self.assertEqual(process.wait(GENEROUS_END), 130, process.stderr.read())
            process.stdout.close()
            process.stderr.close()

    def test_what_is_refused_before_the_server_is_asked(self):
        (self.out / "in").mkdir()
        manifest = self.out / "in" / "manifest"
        server = ("--server", f"127.0.0.1:{unused_port()}")
        for text, *words in (
                ("a.vdb --levels 0\na.txt", ":2:", "a.txt"),
                ('{"input": "a.vdb", "level": 0}', ":1:", "--level"),
                ('{"input": "a.vdb"', ":1:", "JSON"),
                ('{"levels": 0}', ":1:", "no input"),
                ("a.vdb --ttl soon", ":1:", "soon"),
                ("# none\n", "has no jobs")):
            with self.subTest(text):
                manifest.write_text(text)
                result = self.tetstream("job", "submit", "--manifest", manifest, *server)
                self.assertEqual(result.returncode, REFUSED, result.stderr)
                for word in words:
                    self.assertIn(word, result.stderr)


class JobSubmit(JobTest):
    """Twenty files, whatever happens while they are submitted."""

    def files(self, count=20):
        paths = [self.out / f"part{i:02}.vdb" for i in range(count)]
        for path in paths:
            shutil.copy(self.inputs / "sphere.vdb", path)
        return paths

    def submit_and_stop(self, signal_number, after_lines, *arguments):
        """The jobs that were told of before the signal."""
        process = self.start_job_command("submit", *arguments, "--parallel", "1")
        names = [process.stdout.readline().split()[0] for _ in range(after_lines)]
        process.send_signal(signal_number)
        rest, errors = process.communicate(timeout=GENEROUS_END)
        names += [line.split()[0] for line in rest.splitlines()]
        return process.returncode, names, errors

    def test_interrupted_and_run_again_makes_each_job_once(self):
        for number, (signal_number, after_lines) in enumerate(
                ((signal.SIGINT, 7), (signal.SIGKILL, 0), (signal.SIGKILL, 3), (signal.SIGKILL, 11),
                 (signal.SIGKILL, 19))):
            with self.subTest(signal=signal_number.name, after=after_lines):
                for attempt in range(20):  # where it was done before the signal came, it is run anew
                    label = f"run={number}.{attempt}"
                    command = [*self.files(), "--label", label]
                    code, told, errors = self.submit_and_stop(signal_number, after_lines, *command)
                    if not told or self.journals():
                        break
                if signal_number == signal.SIGINT:
                    self.assertEqual(code, 130, errors)
                    self.assertIn("run it again", errors)
                names = self.submit(*command)
                self.assertEqual(len(set(names)), 20)
                self.assertLessEqual(set(told), set(names))
                self.assertEqual({job["name"] for job in self.list("--label", label)}, set(names))
                self.assertEqual(self.journals(), [])

    def test_twice_in_a_row_makes_two_jobs_but_not_with_one_journal(self):
        files = self.files(2)
        self.assertFalse(set(self.submit(*files)) & set(self.submit(*files)))
        journal = ("--journal", self.out / "j.jsonl")
        first = self.submit(*files, *journal)
        again = self.objects(self.job("submit", *files, self.inputs / "sphere.vdb", *journal, "--json"))
        self.assertEqual([job["submitted_before"] for job in again].count(True), 2)
        self.assertEqual({job["name"] for job in again if job["submitted_before"]}, set(first))
        by_journal = self.objects(self.job("show", *journal, "--json"))
        self.assertEqual({job["name"] for job in by_journal}, {job["name"] for job in again})

    def test_a_journal_is_of_one_server(self):
        journal = self.out / "j.jsonl"
        self.submit(*self.files(1), "--journal", journal)
        result = self.tetstream("job", "submit", self.inputs / "sphere.vdb", "--journal", journal,
                                "--server", f"127.0.0.1:{unused_port()}")
        self.assertEqual(result.returncode, REFUSED)
        self.assertIn(self.address, result.stderr)

    def test_a_journal_that_was_cut_off_is_gone_on_with(self):
        files, journal = self.files(3), self.out / "j.jsonl"
        names = self.submit(*files, "--journal", journal)
        journal.write_bytes(journal.read_bytes()[:-20])  # as a power cut may leave it
        self.assertEqual(set(self.submit(*files, "--journal", journal)), set(names))

    def test_one_that_is_refused_does_not_stop_the_others(self):
        files = self.files(2)
        result = self.job("submit", self.out / "none.vdb", *files, "--label", "some=bad")
        self.assertEqual(result.returncode, REFUSED)
        self.assertIn("none.vdb", result.stderr)
        self.assertIn("2 of 3 submitted", result.stderr)
        self.assertEqual(len(self.list("--label", "some=bad")), 2)

    def test_says_what_is_wrong_with_the_folder_of_temporary_files(self):
        (self.out / "cube.obj").write_text(CUBE + LID)
        environment = {**self.environment, "TMPDIR": str(self.out / "nowhere")}
        result = self.tetstream("job", "submit", self.out / "cube.obj", "--server", self.address, env=environment)
        self.assertEqual(result.returncode, SERVER, result.stderr)
        self.assertIn("TMPDIR", result.stderr)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)

    def test_takes_all_that_a_job_can_say(self):
        names = self.submit(
            self.inputs / "sphere.vdb", "--name", "ball", "--label", "a=b=c", "--label", "part=ear",
            "--priority", "-7", "--ttl", "12h", "--timeout", "90m", "--max-attempts", "5",
            "--skip-cache", "--levels", "0", "--iso", "0.05", "--preset", "min-angle")
        job, = self.objects(self.job("show", *names, "--json"))
        expected = {"display_name": "ball", "labels": {"a": "b=c", "part": "ear"}, "priority": -7,
                    "ttl_seconds": 43200, "timeout_seconds": 5400, "max_attempts": 5,
                    "skip_cache": True}
        self.assertEqual({key: job[key] for key in expected}, expected)
        self.assertEqual(job["mesh"]["preset"], "PRESET_MIN_ANGLE")
        self.assertEqual(job["mesh"]["iso"], 0.05)

    def test_a_manifest_has_a_job_a_line(self):
        manifest = self.out / "jobs.txt"
        ball = self.inputs / "sphere.vdb"
        manifest.write_text(
            f"# two ways to say it\n\n{ball} --name one --levels 0 --label part=ear\n" +
            json.dumps({"input": str(ball), "name": "two", "max_attempts": 4, "improve": True,
                        "label": {"part": "nose"}, "box": None}) + "\n" +
            json.dumps({"input": str(ball), "name": "three", "preset": "both-sides",
                        "box": [-1.5, -1.5, -1.5, 1.5, 1.5, 1.5]}) + "\n")
        names = self.submit("--manifest", manifest, "--label", "night=monday", "--priority", "3")
        jobs = {job["display_name"]: job for job in self.objects(self.job("show", *names, "--json"))}
        self.assertEqual(set(jobs), {"one", "two", "three"})
        self.assertEqual({job["priority"] for job in jobs.values()}, {3})
        self.assertEqual(jobs["one"]["labels"], {"night": "monday", "part": "ear"})
        self.assertEqual(jobs["two"]["labels"], {"night": "monday", "part": "nose"})
        self.assertTrue(jobs["two"]["mesh"]["improve"])
        self.assertEqual(jobs["three"]["mesh"]["box"]["min"], {"x": -1.5, "y": -1.5, "z": -1.5})


class JobResults(JobTest):
    """Jobs that are done, and what is made of them."""

    volumes = {"sphere": 0.08, "torus": 0.04}

    def mesh_here(self, path, *arguments):
        self.assert_done(self.tetstream("mesh", *arguments, "-o", path))

    def test_fetched_files_are_those_of_mesh(self):
        (self.inputs / "cube.obj").write_text(CUBE + LID)
        torus, sphere = self.inputs / "torus.vdb", self.inputs / "sphere.vdb"
        for number, (source, *options) in enumerate((
                [torus], [torus, "--improve"], [self.inputs / "cube.obj", "--voxel", "0.1"],
                [sphere, "--spacing", "0.08", "--levels", "1", "--coordinates", "float64"],
                [sphere, "--preset", "both-sides", "--manifold", "--box", *"-2 -2 -2 2 2 2".split()])):
            ending = ENDINGS[(number + 1) % len(ENDINGS)]
            with self.subTest(source=source.name, options=options):
                name, = self.submit(source, *options)
                here, there = self.out / f"here{ending}", self.out / f"there{ending}"
                self.mesh_here(here, source, *options)
                result = self.job("fetch", name, "-o", there, "--wait")
                self.assert_done(result)
                self.assertRegex(result.stdout, r"there\.\w+: \d+ vertices, \d+ tets")
                self.assertTrue(filecmp.cmp(here, there, shallow=False))

    def test_scenes_are_jobs_too(self):
        scene = self.inputs / "scene.json"
        scene.write_text(json.dumps({"nodes": [
            {"name": "ring", "grid": {"name": "torus.vdb"}}, {"name": "ball", "sphere": {"radius": 1}},
            {"intersection": {"of": ["ring", "ball"]}}]}))
        name, = self.submit(scene, "--spacing", "0.05")
        here, there = self.out / "here.vtu", self.out / "there.vtu"
        self.mesh_here(here, scene, "--spacing", "0.05")
        self.assert_done(self.job("fetch", name, "-o", there, "--wait"))
        self.assertTrue(filecmp.cmp(here, there, shallow=False))

    def peak_memory(self, *arguments):
        """Bytes that `tetstream job` took at most."""
        process = subprocess.Popen([binaries() / "tetstream", "job", *map(str, arguments)],
                                   env=self.environment, stdout=subprocess.DEVNULL)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        self.assertEqual(process.returncode, 0)
        return usage.ru_maxrss * 1024

    def test_a_vtkhdf_file_is_put_together_without_the_mesh_in_memory(self):
        source, spacing = self.inputs / "torus.vdb", ("--spacing", "0.013")
        here, there = self.out / "here.vtkhdf", self.out / "there.vtkhdf"
        name, = self.submit(source, *spacing)
        self.mesh_here(here, source, *spacing)
        self.assert_done(self.job("wait", name))
        peaks = {}
        for streams in (1, 4):
            link = CuttingLink(self.address, [9 << 20, 20 << 20])
            self.addCleanup(link.close)
            peaks[streams] = self.peak_memory("fetch", name, "-o", there, "--streams", streams,
                                              "--server", link.address)
            self.assertTrue(filecmp.cmp(here, there, shallow=False))
            self.assertGreater(len(link.from_server), 1)
        whole = here.stat().st_size
        print(f"{whole >> 20} MiB took at most {[peak >> 20 for peak in peaks.values()]} MiB")
        self.assertGreater(whole, 96 << 20)
        for streams, peak in peaks.items():  # of the program, and of what is on its way
            self.assertLess(peak, (64 << 20) + streams * (6 << 20))

    def test_a_fetch_that_breaks_goes_on_where_it_was(self):
        source, spacing = self.inputs / "torus.vdb", ("--spacing", "0.025")
        name, = self.submit(source, *spacing)
        self.mesh_here(self.out / "here.vtu", source, *spacing)
        self.assert_done(self.job("wait", name))
        link = CuttingLink(self.address, [3 << 20, 4 << 20])
        self.addCleanup(link.close)
        self.assert_done(self.tetstream("job", "fetch", name, "-o", self.out / "there.vtu",
                                        "--server", link.address))
        self.assertTrue(filecmp.cmp(self.out / "here.vtu", self.out / "there.vtu", shallow=False))
        whole = (self.out / "there.vtu").stat().st_size
        self.assertEqual(len(link.from_server), 3)
        self.assertGreater(whole, 10 << 20)
        self.assertLess(link.from_server[2], whole - (6 << 20))

    def test_fetches_many_into_a_folder_and_again_only_the_rest(self):
        sources = [self.inputs / "torus.vdb", self.inputs / "sphere.vdb"]
        self.submit(*sources, "--label", "many=1")
        fetch = ("fetch", "--label", "many=1", "--into", self.out / "meshes", "--format", "msh")
        files = self.objects(self.job(*fetch, "--wait", "--json"))
        self.assertEqual([file["fetched_before"] for file in files], [False, False])
        for source in sources:
            self.mesh_here(self.out / "here.msh", source)
            fetched, = (self.out / "meshes").glob(f"{source.stem}-*.msh")
            self.assertTrue(filecmp.cmp(self.out / "here.msh", fetched, shallow=False))
        fetched.unlink()
        files = self.objects(self.job(*fetch, "--json"))
        self.assertEqual(sorted(file["fetched_before"] for file in files), [False, True])
        self.assertTrue(fetched.exists())

    def test_waits_for_many_and_sums_up(self):
        names = self.submit(self.inputs / "torus.vdb", self.inputs / "sphere.vdb", "--label", "w=1")
        result = self.job("wait", "--label", "w=1")
        self.assert_done(result)
        self.assertEqual(len(result.stdout.splitlines()), 3)
        self.assertIn("2 jobs: 2 succeeded", result.stdout)
        jobs = self.objects(self.job("wait", *names, "--json"))
        self.assertEqual([job["state"] for job in jobs], ["SUCCEEDED"] * 2)
        read = self.job("wait", "-", "--json", input="".join(name + "  file\n" for name in names))
        self.assertEqual({job["name"] for job in self.objects(read)}, set(names))

    def test_a_job_that_fails_says_why_everywhere(self):
        name, = self.submit(self.inputs / "sphere.vdb", "--iso", "50", "--label", "f=1")
        result = self.job("wait", name)
        self.assertEqual(result.returncode, REFUSED, result.stdout)
        self.assertIn("1 job: 1 failed", result.stderr)
        job, = self.objects(self.job("show", name, "--json"))
        self.assertEqual(job["state"], "FAILED")
        self.assertTrue(job["error"]["reason"])
        self.assertEqual(len(job["dead_shards"]), 1)
        self.assertEqual(job["dead_shards"][0]["error"]["reason"], job["error"]["reason"])
        self.assertIn(job["error"]["reason"], self.job("show", name).stdout)
        result = self.job("fetch", name, "-o", self.out / "m.vtu")
        self.assertEqual(result.returncode, REFUSED)
        self.assertIn("FAILED", result.stderr.upper())
        self.assert_nothing_written()

    def test_lists_the_workers_and_what_keeps_them(self):
        wait_until(lambda: self.objects(self.job("workers", "--json")))  # it says so before it claims
        worker, = self.objects(self.job("workers", "--json"))
        self.assertTrue(worker["name"].endswith(f":{self.server.pid}"), worker)
        self.assertEqual((worker["state"], worker["leased_shards"], worker["shards"]), ("WORKING", 0, []))
        header, line = self.job("workers").stdout.splitlines()
        self.assertIn("last seen", header)
        self.assertRegex(line, rf":{self.server.pid} +{worker['algorithm_version']} +WORKING +\d+s +0$")

    def test_watch_tells_a_jobs_whole_story_and_ends(self):
        name, = self.submit(self.inputs / "torus.vdb")
        events = self.objects(self.job("watch", name, "--json"))
        revisions = [event["revision"] for event in events]
        self.assertEqual(revisions, sorted(set(revisions)))
        self.assertEqual([event["version"] for event in events], list(range(1, len(events) + 1)))
        self.assertEqual(events[0]["change"], "CREATED")
        self.assertEqual((events[-1]["change"], events[-1]["state"]), ("FINISHED", "SUCCEEDED"))
        later = self.objects(self.job("watch", name, "--after", revisions[1], "--json"))
        self.assertEqual(later, events[2:])


class JobQueue(JobTest):
    """A server that queues and does nothing else."""

    settings = ("--job-workers", "0")

    def test_lists_by_what_jobs_are_like(self):
        ball = self.inputs / "sphere.vdb"
        one, = self.submit(ball, "--label", "list=1", "--name", "ear-left")
        two, = self.submit(ball, "--label", "list=1", "--name", "nose")
        mine = ("--label", "list=1")
        self.assertEqual([job["name"] for job in self.list(*mine)], [two, one])
        self.assertEqual([job["name"] for job in self.list(*mine, "--name", "ear")], [one])
        self.assertEqual({job["state"] for job in self.list(*mine, "--state", "queued")}, {"QUEUED"})
        self.assertEqual(self.list(*mine, "--state", "FAILED", "--state", "succeeded"), [])
        self.assertEqual(len(self.list(*mine, "--since", "1h")), 2)
        self.assertEqual(self.list(*mine, "--until", "1h"), [])
        table = self.job("list", *mine).stdout.splitlines()
        self.assertEqual(len(table), 3)
        self.assertIn("nose", table[1])
        job, = self.objects(self.job("show", two, "--json"))
        self.assertIsInstance(job["queue_position"], int)
        self.assertRegex(self.job("show", two).stdout, r"progress +0 of 1 shards done, 0 running\n")

    def test_cancels_retries_and_deletes(self):
        names = self.submit(*[self.inputs / "sphere.vdb"] * 3, "--label", "c=1")
        mine = ("--label", "c=1", "--json")
        self.assertEqual(len(set(names)), 3)
        result = self.job("delete", *mine)
        self.assertEqual(result.returncode, REFUSED)
        refused = [json.loads(line) for line in result.stdout.splitlines()]
        self.assertEqual([job["error"]["reason"] for job in refused], ["JOB_ACTIVE"] * 3)
        self.assertIn("3 of 3", result.stderr)
        for command, state in (("cancel", "CANCELLED"), ("retry", "QUEUED"), ("cancel", "CANCELLED")):
            jobs = self.objects(self.job(command, *mine))
            self.assertEqual([job["state"] for job in jobs], [state] * 3)
        result = self.job("wait", *mine)
        self.assertEqual(result.returncode, REFUSED)
        self.assertIn("3 jobs: 3 cancelled", result.stderr)
        self.assertEqual(len(self.objects(self.job("delete", *mine))), 3)
        self.assertEqual(self.list("--label", "c=1"), [])

    def test_nothing_that_is_asked_for_is_no_success(self):
        for command in (("wait",), ("fetch", "--into", self.out)):
            for which, told in ((("--label", "night=never"), "--label night=never"),
                                (("--state", "failed", "--name", "no"), "--state failed, --name no")):
                result = self.job(*command, *which)
                self.assert_fails(result, REFUSED, "there is no such job", told)
        result = self.job("wait", "-", input="")
        self.assert_fails(result, REFUSED, "there is no such job")

    def test_names_that_are_none(self):
        for command in ("show", "cancel", "retry", "delete", "wait", "watch"):
            with self.subTest(command):
                self.assert_fails(self.job(command, "0" * 24), REFUSED, "0" * 24)
                self.assert_fails(self.job(command, "jobs/nothing"), REFUSED)

    def test_patience_ends_with_3_and_ctrl_c_with_130(self):
        name, = self.submit(self.inputs / "sphere.vdb")
        self.assert_fails(self.job("wait", name, "--patience", "200ms"), SERVER, "deadline")
        for command in (("wait", name), ("watch",)):
            process = self.start_job_command(*command)
            wait_until(lambda: catches(process, signal.SIGINT))
            process.send_signal(signal.SIGINT)
            _, errors = process.communicate(timeout=GENEROUS_END)
            self.assertEqual(process.returncode, 130, errors)


if __name__ == "__main__":
    unittest.main(verbosity=2)
