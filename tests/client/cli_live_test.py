"""The tetstream command while it runs: stopped halfway, on a terminal, and with a real server.

    TETSTREAM_BIN=build/dev/bin python3 tests/client/cli_live_test.py [unittest options]
"""

import filecmp
import json
import os
import pty
import signal
import subprocess
import unittest

from command_case import (
    CUBE, DONE, ENDINGS, GENEROUS_END, LID, REFUSED, SERVER, USAGE, CommandTest, ServerTest, binaries,
    catches, processor_seconds, unused_port, wait_until)
from cutting_link import CuttingLink


class Interruption(CommandTest):
    """Ctrl-C at several moments of a mesh that takes long."""

    volumes = {"sphere": 0.05, "gyroid": 0.04}

    def interrupt(self, sent, after_seconds, ending):
        """Once it has used so much of a processor."""
        process = subprocess.Popen(
            [binaries() / "tetstream", "mesh", self.inputs / "gyroid.vdb",
             "-o", self.out / f"m{ending}",
             "--levels", "0", "--spacing", "0.003", "--threads", "1"],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        wait_until(lambda: catches(process, sent))
        wait_until(lambda: processor_seconds(process) >= after_seconds)
        process.send_signal(sent)
        _, errors = process.communicate(timeout=GENEROUS_END)
        return process.returncode, errors

    def test_stops_cleanly_whenever_it_comes(self):
        for after_seconds, ending in ((0.0, ".vtu"), (0.3, ".msh"), (0.8, ".vtkhdf")):
            with self.subTest(after_seconds=after_seconds):
                code, errors = self.interrupt(signal.SIGINT, after_seconds, ending)
                self.assertEqual(code, 130, errors)
                self.assertEqual(len(errors.splitlines()), 1, errors)
                self.assert_nothing_written()

    def test_ends_with_128_and_the_signal(self):
        code, errors = self.interrupt(signal.SIGTERM, 0.2, ".vtu")
        self.assertEqual(code, 128 + signal.SIGTERM, errors)
        self.assert_nothing_written()

    def interrupt_in_time(self, commands, comes):
        """Sends the signal once `comes(process)` says so. Where a command is done before it heeds that, the next one, which takes
        longer, is tried."""
        for command in commands:
            process = subprocess.Popen([binaries() / "tetstream", *map(str, command)],
                                       stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            wait_until(lambda: process.poll() is not None or comes(process))  # noqa: B023
            process.send_signal(signal.SIGINT)
            _, errors = process.communicate(timeout=GENEROUS_END)
            if process.returncode != DONE:
                break
            for file in self.out.iterdir():
                file.unlink()
        self.assertEqual(process.returncode, 130, errors)
        return errors

    def meshes_of_a_ball(self, output, spacings, *options):
        return [("mesh", self.inputs / "sphere.vdb", "-o", output, *options, "--spacing", spacing) for spacing in spacings]

    def test_while_writing_removes_the_unfinished_file(self):
        meshes = self.meshes_of_a_ball(self.out / "m.msh", (0.02, 0.016, 0.012, 0.01), "--levels", "0")
        self.interrupt_in_time(meshes, lambda _: self.unfinished_bytes() > 0)
        self.assert_nothing_written()

    def test_while_measuring_for_the_report_leaves_the_mesh(self):
        mesh = self.out / "m.vtu"  # once it has its file, it must be measuring
        meshes = self.meshes_of_a_ball(mesh, (0.03, 0.02, 0.015, 0.01), "--report", self.out / "r.json")
        errors = self.interrupt_in_time(meshes, lambda _: mesh.exists())
        self.assertIn("m.vtu is there, but no report", errors)
        self.assertEqual(list(self.out.iterdir()), [mesh])

    def test_stops_conversions_at_once(self):
        (self.inputs / "cube.obj").write_text(CUBE + LID)
        for command in (("convert", self.inputs / "cube.obj", self.out / "cube.vdb"),
                        ("mesh", self.inputs / "cube.obj", "-o", self.out / "cube.vtu")):
            with self.subTest(command=command[0]):
                # Some seconds of work, of which a part is done.
                errors = self.interrupt_in_time(
                    [(*command, "--voxel", voxel) for voxel in (0.0015, 0.0012, 0.001)],
                    lambda process: catches(process, signal.SIGINT) and processor_seconds(process) >= 0.3)
                self.assertEqual(len(errors.splitlines()), 1, errors)
                self.assert_nothing_written()

    def unfinished_bytes(self):
        try:
            return sum(path.stat().st_size for path in self.out.glob(".tetstream.*.tmp"))
        except FileNotFoundError:  # it makes one first that it removes at once, to see that it can
            return 0


class Terminal(CommandTest):
    volumes = {"torus": 0.04}

    def mesh_on_terminal(self, environment):
        """Runs with stderr on a terminal and returns what was drawn there."""
        ours, theirs = pty.openpty()
        process = subprocess.Popen(
            [binaries() / "tetstream", "mesh", self.inputs / "torus.vdb",
             "-o", self.out / "m.vtu"],
            stdout=subprocess.PIPE, stderr=theirs, env={**os.environ, **environment})
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

    def test_draws_a_bar_and_erases_it(self):
        drawn = self.mesh_on_terminal({"TERM": "xterm"})
        for stage in ("reading", "planning", "meshing", "writing"):
            self.assertIn(stage, drawn)
        self.assertTrue(drawn.endswith("\r\x1b[K"))

    def test_draws_nothing_where_nothing_can_be_erased(self):
        self.assertEqual(self.mesh_on_terminal({"TERM": "dumb"}), "")


class OnAServer(ServerTest):
    volumes = {"sphere": 0.05, "torus": 0.04, "random-signs": 0.1, "empty": 0.1, "vec3": 0.1}

    def test_health_of_a_serving_server(self):
        result = self.tetstream("health", "--server", self.address)
        self.assert_done(result)
        self.assertEqual(result.stdout, f"{self.address}: serving\n")

    def test_gives_the_same_bytes_as_this_process(self):
        for ending in ENDINGS:
            here, there = self.out / f"here{ending}", self.out / f"there{ending}"
            for path, server in ((here, ()), (there, ("--server", self.address))):
                self.assert_done(self.tetstream(
                    "mesh", self.inputs / "torus.vdb", "-o", path, *server))
            self.assertTrue(filecmp.cmp(here, there, shallow=False), ending)

    def test_gives_the_same_bytes_for_every_option(self):
        options = ("--spacing", "0.08", "--iso", "0.02", "--levels", "1",
                   "--preset", "min-angle", "--coordinates", "float64", "--grid", "sphere")
        here, there = self.out / "here.vtu", self.out / "there.vtu"
        for path, server in ((here, ()), (there, ("--server", self.address))):
            self.assert_done(self.tetstream(
                "mesh", self.inputs / "sphere.vdb", "-o", path, *options, *server))
        self.assertTrue(filecmp.cmp(here, there, shallow=False))

    def test_gives_the_same_bytes_of_both_sides_and_manifolds(self):
        options = ("--preset", "both-sides", "--manifold", "--spacing", "0.15", "--box", *"-1 -1 -1 1 1 .5".split())
        for ending in ENDINGS:
            here, there = self.out / f"here{ending}", self.out / f"there{ending}"
            for path, server in ((here, ()), (there, ("--server", self.address))):
                self.assert_done(self.tetstream(
                    "mesh", self.inputs / "random-signs.vdb", "-o", path, *options, *server))
            self.assertTrue(filecmp.cmp(here, there, shallow=False), ending)

    def test_makes_the_same_bytes_of_packed_and_of_compact_chunks(self):
        here, there = self.out / "here.vtu", self.out / "there.vtu"
        self.assert_done(self.tetstream("mesh", self.inputs / "torus.vdb", "-o", here))
        for encoding in ("--packed", "--compact"):
            self.assert_done(self.tetstream("mesh", self.inputs / "torus.vdb", "-o", there,
                                            "--server", self.address, encoding))
            self.assertTrue(filecmp.cmp(here, there, shallow=False), encoding)

    def test_makes_the_same_bytes_of_packed_chunks_of_any_mesh(self):
        here, there = self.out / "here.vtu", self.out / "there.vtu"
        both = ("--preset", "both-sides", "--box", *"-1 -1 -1 1 1 .5".split())
        graded = ("--sizing", '{"coarsest": 0.2, "grade_surface": true}')
        for options in (("--improve",), both, graded):
            for path, server in ((here, ()), (there, ("--server", self.address, "--packed"))):
                self.assert_done(self.tetstream(
                    "mesh", self.inputs / "torus.vdb", "-o", path, *options, *server))
            self.assertTrue(filecmp.cmp(here, there, shallow=False), options)

    def test_refuses_packed_chunks_without_a_server(self):
        self.assert_fails(self.mesh("torus.vdb", ".vtu", "--packed"), REFUSED, "--server")
        self.assert_fails(self.mesh("torus.vdb", ".vtu", "--packed", "--compact",
                                    "--server", self.address), USAGE, "--packed")

    def test_refuses_compact_chunks_where_there_are_none(self):
        self.assert_fails(self.mesh("torus.vdb", ".vtu", "--compact"), REFUSED, "--server")
        self.assert_fails(self.mesh("torus.vdb", ".vtu", "--compact", "--improve",
                                    "--server", self.address), REFUSED, "--improve")

    def test_reports_the_same_mesh(self):
        box = "-1 -1 -1 1 1 .5".split()
        for name, *options in (["torus.vdb"], ["random-signs.vdb", "--manifold", "--spacing", "0.2"],
                               ["torus.vdb", "--preset", "both-sides", "--box", *box]):
            reports = []
            for server in ((), ("--server", self.address)):
                self.assert_done(self.mesh(
                    name, ".vtu", "--report", self.out / "r.json", *options, *server))
                reports.append(json.loads((self.out / "r.json").read_text()))
            self.assertEqual(set(reports[1].pop("stages")),
                             {"uploading", "planning", "meshing", "checking", "writing"})
            self.assertEqual(reports[1].pop("transport"), "messages")
            del reports[0]["stages"], reports[0]["seconds"], reports[1]["seconds"]
            self.assertEqual(*reports)

    def test_improves_alike(self):
        meshes, reports = [], []
        for server in ((), ("--server", self.address)):
            self.assert_done(self.mesh("torus.vdb", ".vtu", "--improve", "--threads", "2",
                                       "--report", self.out / "r.json", *server))
            meshes.append((self.out / "mesh.vtu").read_bytes())
            reports.append(json.loads((self.out / "r.json").read_text()))
        self.assertTrue(meshes[0] == meshes[1])
        for report in reports:
            self.assertGreater(report["improvement"].pop("seconds"), 0)
        self.assertEqual(reports[0]["improvement"], reports[1]["improvement"])
        self.assertGreaterEqual(reports[0]["improvement"]["min_after_deg"], 20)
        self.assertLess(reports[0]["improvement"]["min_before_deg"], 20)
        self.assertEqual(set(reports[0]["stages"]),
                         {"reading", "planning", "meshing", "improving", "checking", "writing"})

    def test_converts_a_surface_before_it_goes_up(self):
        (self.inputs / "cube.obj").write_text(CUBE + LID)
        here, there = self.out / "here.vtu", self.out / "there.vtu"
        for path, server in ((here, ()), (there, ("--server", self.address))):
            self.assert_done(self.tetstream(
                "mesh", self.inputs / "cube.obj", "-o", path, "--voxel", "0.1", *server))
        self.assertTrue(filecmp.cmp(here, there, shallow=False))

    def test_refusals_are_the_servers_own(self):
        server = ("--server", self.address)
        self.assert_fails(self.mesh("nowhere.vdb", ".vtu", *server), REFUSED, "nowhere.vdb")
        self.assert_fails(self.mesh("empty.vdb", ".vtu", *server), REFUSED)
        self.assert_fails(self.mesh("vec3.vdb", ".vtu", *server), REFUSED, "vec3")
        self.assert_fails(
            self.mesh("sphere.vdb", ".vtu", "--grid", "density", *server), REFUSED, "density")
        self.assert_fails(
            self.mesh("sphere.vdb", ".vtu", "--spacing", "0", *server), REFUSED, "spacing")
        empty_box = ("--preset", "both-sides", "--box", "0", "0", "0", "1", "1", "0")
        self.assert_fails(self.mesh("sphere.vdb", ".vtu", *empty_box, *server), REFUSED, "box")

    def test_ctrl_c_stops_a_stream(self):
        sent = self.sample("tetstream_sent_chunks_total")
        link = CuttingLink(self.address, holds_after=1 << 20)  # of several MiB: it cannot end before the signal
        self.addCleanup(link.close)
        process = subprocess.Popen(
            [binaries() / "tetstream", "mesh", self.inputs / "sphere.vdb",
             "-o", self.out / "m.vtu", "--levels", "0", "--server", link.address],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.assertTrue(link.held.wait(GENEROUS_END))
        wait_until(lambda: self.sample("tetstream_sent_chunks_total") > sent)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=GENEROUS_END)
        self.assertEqual(process.returncode, 130, errors)
        self.assert_nothing_written()


class WithoutAServer(CommandTest):
    def test_an_unreachable_server(self):
        server = ("--server", f"127.0.0.1:{unused_port()}")
        self.assert_fails(self.tetstream("health", *server), SERVER, *server[1:])
        self.assert_fails(self.mesh("sphere.vdb", ".vtu", *server), SERVER)

    def test_a_server_whose_name_means_nothing(self):
        result = self.tetstream("health", "--server", "no-such-host.invalid:1")
        self.assert_fails(result, SERVER, "no-such-host.invalid:1")


if __name__ == "__main__":
    unittest.main(verbosity=2)
