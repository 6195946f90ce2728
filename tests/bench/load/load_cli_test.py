"""The program tetstream-load as its user meets it, with real servers.

    TETSTREAM_BIN=build/dev/bin python3 tests/bench/load/load_cli_test.py [unittest options]
"""

import json
import os
import pathlib
import pty
import signal
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "client"))
from command_case import (  # noqa: E402  pylint: disable=wrong-import-position
    DONE, GENEROUS_END, REFUSED, SERVER, USAGE, CommandTest, ServerTest, binaries, catches, unused_port,
    wait_until)


class LoadTest(CommandTest):
    def load(self, *arguments, **options):
        return subprocess.run(
            [binaries() / "tetstream-load", *map(str, arguments)],
            capture_output=True, text=True, timeout=GENEROUS_END, check=False, **options)


class Usage(LoadTest):
    volumes = {}

    def test_help_teaches(self):
        result = self.load("--help")
        self.assert_done(result)
        for word in ("--rate", "--workers", "--find-rate", "--target", "--spacing", "Exit codes",
                     "tetstream-load bunny.vdb --rate 20"):
            self.assertIn(word, result.stdout)

    def test_says_what_cannot_be_understood(self):
        for arguments, *words in (
                (["--rate", "5"], "GRID"),
                (["a.vdb"], "--rate", "--workers"),
                (["a.vdb", "--rate", "0"], "rate 0"),
                (["a.vdb", "--rate", "fast"], "fast"),
                (["a.vdb", "--rate", "5", "--workers", "2"], "exclude"),
                (["a.vdb", "--rate", "5", "--duration", "soon"], "--duration", "soon"),
                (["a.vdb", "--rate", "5", "--duration", "0"], "--duration"),
                (["a.vdb", "--rate", "5", "--target", "p99"], "p99"),
                (["a.vdb", "--find-rate"], "--target"),
                (["a.vdb", "--find-rate", "--target", "p99=1s", "--trials", "2"], "odd"),
                (["a.vdb", "--rate=", "--fresh"], "--rate", "empty"),
                (["a.vdb", "--rate", "5", "--json", ""], "--json", "empty"),
                (["a.vdb", "--rate", "5", "--fast"], "--fast")):
            with self.subTest(arguments):
                self.assert_fails(self.load(*arguments), USAGE, *words)

    def test_a_mix_with_an_option_that_has_no_value(self):
        mix = self.inputs / "mix.txt"
        mix.write_text("a.vdb --levels 1\na.vdb --iso= --levels 3\n")
        self.assert_fails(self.load("--mix", mix, "--rate", "5"), USAGE, "mix.txt:2", "--iso", "empty")

    def test_an_output_that_cannot_be_written(self):
        self.assert_fails(
            self.load("a.vdb", "--rate", "5", "--json", "/nowhere/load.json"), REFUSED, "/nowhere")

    def test_a_server_that_is_not_there(self):
        (self.out / "a.vdb").write_text("grid")
        address = f"127.0.0.1:{unused_port()}"
        result = self.load(self.out / "a.vdb", "--rate", "5", "--server", address)
        self.assertEqual(result.returncode, SERVER, result.stderr)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)


class OnAServer(ServerTest, LoadTest):
    """A server with a ball, and what a run says of it."""

    volumes = {"sphere": 0.1}
    # However far the machine falls behind the rate: what a run sends at most waits, and is not refused.
    settings = ("--max-queued", "1000", "--max-client-queued", "1000", "--queue-seconds", "3600")

    def load_here(self, *arguments, report="load.json"):
        """A run that waits for its last answers, however late they come."""
        return self.load("--server", self.address, "--json", self.out / report, "--drain", f"{GENEROUS_END}s",
                         *arguments)

    def load_ball(self, *arguments, **options):
        return self.load_here(self.inputs / "sphere.vdb", *arguments, **options)

    def report(self, name="load.json"):
        return json.loads((self.out / name).read_text())

    def load_until(self, is_enough, *arguments, seconds, report="load.json"):
        """(seconds, result, report) of a run that is so long, or ten or a hundred times as long where the
        machine was too busy for `is_enough(report)`."""
        for longer in (1, 10, 100):
            result = self.load_ball("--duration", f"{longer * seconds}s", *arguments, report=report)
            self.assert_done(result)
            if is_enough(measured := self.report(report)):
                return longer * seconds, result, measured
        raise AssertionError(f"never enough: {measured}")

    def find_rate(self, *arguments):
        """What a search says whose first caller had time to ask: a busy machine may take all of a short trial."""
        for duration in ("300ms", "3s", "30s"):
            result = self.load_ball("--find-rate", "--duration", duration, "--warm-up", "0", *arguments)
            if "not one request was answered" not in result.stderr:
                break
        return result


class Live(OnAServer):
    def test_measures_every_request(self):
        seconds, result, report = self.load_until(
            lambda report: report["rates"]["tets_s"] > 0, "--rate", "20,40", "--warm-up", "200ms",
            "--arrivals", "constant", "--check", "--quiet", seconds=0.5)
        self.assertEqual(result.stderr, "")
        offered = int(60 * seconds)
        self.assertEqual(report["requests"]["offered"], offered)
        self.assertEqual(report["requests"]["done"], offered)
        self.assertEqual(report["errors"], {})
        latency = report["latency_ms"]
        for quantile in ("p50", "p99", "max"):
            self.assertLessEqual(latency["header"][quantile], latency["first_chunk"][quantile])
            self.assertLessEqual(latency["first_chunk"][quantile], latency["whole"][quantile])
        self.assertEqual([step["requests"]["offered"] for step in report["by_step"]],
                         [offered // 3, 2 * offered // 3])
        self.assertIn(f"{offered} offered", result.stdout)

    def test_sends_the_same_requests_for_the_same_seed(self):
        offered = []
        for _ in range(2):
            self.assert_done(self.load_ball("--rate", "50", "--duration", "300ms", "--warm-up",
                                            "0", "--seed", "7", "--vary-iso", "0", "0.05"))
            offered.append(self.report()["requests"]["offered"])
        self.assertEqual(*offered)

    def test_works_back_to_back(self):
        _, _, report = self.load_until(lambda report: report["requests"]["done"] > 2, "--workers", "2",
                                       "--warm-up", "0s", "--fresh", seconds=0.5)
        self.assertEqual(report["plan"]["mode"], "workers")
        self.assertIn("spacing", report["mix"][0]["request"])

    def test_asks_for_another_encoding(self):
        bytes_of_a_tet = []
        for encoding in ((), ("--packed",), ("--compact",)):
            _, _, report = self.load_until(lambda report: report["rates"]["tets_s"] > 0, "--rate", "20",
                                           "--warm-up", "0", "--check", *encoding, seconds=0.3)
            self.assertEqual(report["requests"]["failed"], 0)
            bytes_of_a_tet.append(report["rates"]["bytes_s"] / report["rates"]["tets_s"])
            self.assertEqual(report["encoding"], (encoding or ("--plain",))[0].strip("-"))
        plain, packed, compact = bytes_of_a_tet
        self.assertLess(packed, plain / 3)
        self.assertLess(compact, packed / 3)

    def test_takes_a_mix_of_files_and_digests(self):
        self.assert_done(self.load_ball("--rate", "10", "--duration", "200ms", "--warm-up", "0"))
        name = self.report()["mix"][0]["request"]["name"]
        mix = self.out / "mix.txt"
        mix.write_text(f"--weight 3 {self.inputs / 'sphere.vdb'} --levels 0\n"
                       f"{name} --preset min-angle\n{name.split('/')[1]} --spacing 0.2\n")
        self.assert_done(self.load_here("--mix", mix, "--rate", "40", "--duration", "500ms", "--warm-up", "0"))
        report = self.report()
        self.assertEqual([entry["weight"] for entry in report["mix"]], [3, 1, 1])
        self.assertEqual(report["requests"]["failed"], 0)
        by_request = [entry["requests"]["offered"] for entry in report["by_request"]]
        self.assertEqual(sum(by_request), report["requests"]["offered"])
        self.assertEqual(max(by_request), by_request[0])

    def test_mixes_streams_and_jobs(self):
        ball = self.inputs / "sphere.vdb"
        mix = self.out / "mix.txt"
        mix.write_text(f"--weight 2 {ball}\n--weight 1 {ball} --job --fresh\n{ball} --job\n")
        self.assert_done(self.load_here("--mix", mix, "--rate", "20", "--duration", "1s", "--warm-up", "0",
                                        "--check"))
        report = self.report()
        self.assertEqual([entry["kind"] for entry in report["mix"]], ["stream", "job", "job"])
        self.assertEqual(report["requests"]["done"], report["requests"]["offered"],
                         [report["requests"], report["errors"]])
        for entry in report["by_request"]:
            self.assertGreater(entry["requests"]["done"], 0)
            self.assertLessEqual(entry["latency_ms"]["header"]["max"],
                                 entry["latency_ms"]["first_chunk"]["max"])

    def test_exits_with_1_when_a_target_is_missed(self):
        target = ("--rate", "20", "--duration", "300ms", "--warm-up", "0", "--target")
        self.assert_done(self.load_ball(*target, "p99=900s"))
        result = self.load_ball(*target, "p50=1us")
        self.assertEqual(result.returncode, REFUSED)
        self.assertIn("NOT held", result.stdout)
        self.assertIn("p50=0.001ms was missed", result.stderr)

    def test_refusals_are_the_servers_own(self):
        for arguments, *words in (
                ([self.inputs / "none.vdb", "--rate", "5"], "none.vdb"),
                (["0" * 64, "--rate", "5"], "0" * 64),
                ([self.inputs / "sphere.vdb", "--rate", "5", "--grid", "density"], "density"),
                ([self.inputs / "sphere.vdb", "--rate", "5", "--spacing", "0"], "spacing"),
                (["--mix", self.inputs / "none.txt", "--rate", "5"], "none.txt")):
            with self.subTest(arguments):
                self.assert_fails(
                    self.load(*arguments, "--server", self.address), REFUSED, *words)

    def test_ctrl_c_ends_early_with_a_whole_report(self):
        process = subprocess.Popen(
            [binaries() / "tetstream-load", self.inputs / "sphere.vdb", "--server", self.address,
             "--workers", "1", "--duration", "10m", "--warm-up", "0", "--json",
             self.out / "load.json"],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        answered = 'tetstream_calls_total{code="OK",method="StreamMesh"}'
        before = self.sample(answered)
        # One caller asks again only when it has counted the answer before.
        wait_until(lambda: catches(process, signal.SIGINT) and self.sample(answered) >= before + 3)
        process.send_signal(signal.SIGINT)
        out, errors = process.communicate(timeout=GENEROUS_END)
        self.assertEqual(process.returncode, 130, errors)
        self.assertIn("latency", out)
        report = self.report()
        self.assertTrue(report["interrupted"])
        self.assertGreater(report["requests"]["done"], 0)

    def drawn_by_load(self, *arguments):
        """What a run draws on a terminal."""
        ours, theirs = pty.openpty()
        process = subprocess.Popen(
            [binaries() / "tetstream-load", self.inputs / "sphere.vdb", "--server", self.address, *arguments],
            stdout=subprocess.PIPE, stderr=theirs, env={**os.environ, "TERM": "xterm"})
        os.close(theirs)
        drawn = b""
        try:
            while chunk := os.read(ours, 65536):
                drawn += chunk
        except OSError:  # how Linux tells that the other end is closed
            pass
        os.close(ours)
        process.communicate(timeout=GENEROUS_END)
        self.assertEqual(process.returncode, DONE)
        return drawn.decode()

    def test_draws_one_screen_on_a_terminal_and_erases_it(self):
        for duration in ("1200ms", "12s", "120s"):  # it draws twice a second, where the machine lets it
            text = self.drawn_by_load("--rate", "20", "--duration", duration, "--warm-up", "0", "--drain",
                                      f"{GENEROUS_END}s")
            if "measuring" in text:
                break
        for word in ("measuring", "outstanding", "first chunk", "errors"):
            self.assertIn(word, text)
        self.assertTrue(text.endswith("\x1b[J"), text[-50:])

    def test_finds_a_rate(self):
        for target in ("p90=300ms", "p90=3000ms", "p90=30000ms", "p90=300000ms"):  # what the machine can hold
            result = self.find_rate("--target", target, "--precision", "1", "--trials", "1")
            if result.returncode == DONE:
                break
        self.assert_done(result)
        report = self.report()
        self.assertGreater(report["search"]["per_second"], 0)
        self.assertEqual(report["search"]["targets"], [target])
        self.assertGreater(len(report["trials"]), 1)
        self.assertEqual(report["best"]["targets"][0]["held"], True)
        self.assertIn(f"holds {target}", result.stdout)

    def test_says_when_no_rate_holds(self):
        result = self.find_rate("--target", "p90=1us", "--quiet")
        self.assertEqual(result.returncode, REFUSED)
        self.assertIn("no rate was found", result.stdout)
        self.assertIsNone(self.report()["search"]["per_second"])


class OneMeshAtATime(OnAServer):
    volumes = {"sphere": 0.02}
    settings = ("--max-streams", "1", "--max-queued", "0")

    def test_counts_what_the_server_refuses(self):
        _, _, report = self.load_until(lambda report: report["errors"], "--workers", "3", "--warm-up", "0", seconds=1)
        self.assertGreater(report["requests"]["done"], 0)
        self.assertEqual(list(report["errors"]), ["RESOURCE_EXHAUSTED"])
        self.assertGreater(report["errors"]["RESOURCE_EXHAUSTED"]["count"], 0)


if __name__ == "__main__":
    unittest.main()
