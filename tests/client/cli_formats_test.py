"""Formats of mesh files, as users of the command see them: one table, and what each row promises.

    TETSTREAM_BIN=build/release/bin python3 tests/client/cli_formats_test.py [unittest options]
"""

import filecmp
import json
import os
import pathlib
import re
import signal
import subprocess
import unittest

from command_case import REFUSED, USAGE, CommandTest, binaries

PAGE = pathlib.Path(__file__).resolve().parents[2] / "docs" / "formats.md"


class Formats(CommandTest):
    def table(self):
        result = self.tetstream("formats")
        self.assert_done(result)
        return result.stdout

    def rows(self):
        """Name and ending of each format."""
        return re.findall(r"^\| `(\w+)` \| `(\.\w+)`", self.table(), re.MULTILINE)

    def test_are_in_the_document_as_the_command_lists_them(self):
        self.assertGreater(len(self.rows()), 5)
        self.assertIn(self.table(), PAGE.read_text(encoding="utf-8"))

    def test_are_all_named_by_the_help(self):
        for command in (("mesh",), ("job", "fetch")):
            text = " ".join(self.tetstream(*command, "--help").stdout.split())
            for name, ending in self.rows():
                self.assertIn(f"{ending}", text)
                self.assertRegex(text, rf"--format TEXT:{{[^}}]*\b{name}\b")

    def test_are_written_by_their_ending_and_by_their_name(self):
        for name, ending in self.rows():
            with self.subTest(name):
                self.assert_done(self.mesh("sphere.vdb", ending))
                by_ending = self.contents(self.out / f"mesh{ending}")
                self.assert_done(self.tetstream("mesh", self.inputs / "sphere.vdb", "-o", self.out / "mesh",
                                                "--format", name))
                by_name = [content.replace(b"mesh.hdf5", b"mesh.h5") for content in self.contents(self.out / "mesh")]
                self.assertEqual(by_name, by_ending)
                self.assertGreater(sum(map(len, by_ending)), 1000)

    def test_that_take_parts_keep_no_mesh_in_memory(self):
        # What this process has ever held counts for those that it starts: no test reads large files whole.
        for ending in (".vtu", ".vtkhdf", ".msh"):
            with self.subTest(ending):
                file = self.out / f"mesh{ending}"
                program = str(binaries() / "tetstream")
                arguments = ["mesh", str(self.inputs / "sphere.vdb"), "-o", str(file), "--threads", "2",
                             "--levels", "0", "--spacing", "0.02"]
                started = os.posix_spawn(program, [program, *arguments], os.environ)
                _, status, used = os.wait4(started, 0)
                self.assertEqual(os.waitstatus_to_exitcode(status), 0)
                self.assertGreater(file.stat().st_size, 100e6)
                self.assertLess(used.ru_maxrss * 1024, file.stat().st_size / 2)

    def test_have_the_same_bytes_written_while_the_mesh_is_made_and_afterwards(self):
        """A report needs the whole mesh."""
        for ending in (".vtu", ".vtkhdf", ".msh"):
            for options in ((), ("--levels", "0"), ("--preset", "both-sides"), ("--faces",),
                            ("--sizing", '{"coarsest": 0.3, "grade_surface": true}')):
                with self.subTest(ending=ending, options=options):
                    file, before = self.out / f"mesh{ending}", self.out / f"before{ending}"
                    self.assert_done(self.mesh("sphere.vdb", ending, *options))
                    file.rename(before)
                    self.assert_done(self.mesh("sphere.vdb", ending, "--report", self.out / "report.json", *options))
                    self.assertTrue(filecmp.cmp(file, before, shallow=False))

    def contents(self, path):
        """Of the file, or of the files of the folder; removes them."""
        if path.is_dir():
            contents = [file.read_bytes() for file in sorted(path.iterdir())]
            for file in path.iterdir():
                file.unlink()
            path.rmdir()
            return contents
        content = [path.read_bytes()]
        path.unlink()
        return content

    def test_that_there_are_not_are_refused(self):
        self.assert_fails(self.tetstream("mesh", "a.vdb", "-o", self.out / "m.vtu", "--format", "med"),
                          USAGE, "--format", "med")
        self.assert_fails(self.mesh("sphere.vdb", ".med"), REFUSED, ".med", ".inp", ".xdmf")
        self.assert_fails(self.mesh("sphere.vdb", ".h5", "--format", "xdmf"), REFUSED, ".h5", ".xdmf")


class Printed(CommandTest):
    """What is printed may be the answer."""

    def test_that_cannot_be_written_is_a_failure(self):
        for command in (("tetstream", "formats"), ("tetstream", "--help"),
                        ("tetstream", "info", self.inputs / "sphere.vdb", "--json"),
                        ("tetstreamd", "--print-config"), ("tetstreamd", "--new-token", "alice"),
                        ("tetstream-load", "--help")):
            with self.subTest(command), open("/dev/full", "w") as full:
                result = subprocess.run([binaries() / command[0], *command[1:]], stdout=full,
                                        stderr=subprocess.PIPE, text=True, check=False)
                self.assertEqual(result.returncode, REFUSED, result.stderr)
                self.assertIn(f"{command[0]}: what it printed cannot be written", result.stderr)

    def test_that_nobody_reads_ends_as_by_a_broken_pipe(self):
        for command in (("formats",), ("info", self.inputs / "sphere.vdb", "--json")):
            with self.subTest(command):
                reader, writer = os.pipe()
                os.close(reader)
                result = subprocess.run([binaries() / "tetstream", *command], stdout=writer, stderr=subprocess.PIPE,
                                        text=True, check=False)
                os.close(writer)
                self.assertEqual((result.returncode, result.stderr), (128 + signal.SIGPIPE, ""))

    def test_report_takes_no_meshs_place(self):
        link = self.inputs / "link.vtu"
        link.symlink_to(self.out / "mesh.vtu")
        for report in (self.out / "mesh.vtu", link):
            self.assert_fails(self.mesh("sphere.vdb", ".vtu", "--report", report), REFUSED, "mesh.vtu")
        self.assertFalse((self.out / "mesh.vtu").exists())

    def test_report_takes_no_place_of_a_meshs_second_file(self):
        for output, second in ((("mesh.xdmf",), "mesh.h5"), (("mesh", "--format", "xdmf"), "mesh.hdf5")):
            self.assert_fails(self.tetstream("mesh", self.inputs / "sphere.vdb", "-o", self.out / output[0], *output[1:],
                                             "--report", self.out / second), REFUSED, second)

    def test_report_takes_no_place_of_what_the_mesh_is_made_of(self):
        ball, names = self.inputs / "sphere.vdb", self.inputs / "names.json"
        scene, sizing = self.inputs / "part.json", self.inputs / "sizing.json"
        scene.write_text(json.dumps({"nodes": [{"sphere": {"radius": 1}}]}))
        sizing.write_text(json.dumps({"coarsest": 0.5}))
        names.write_text("{}")
        (self.inputs / "other.json").symlink_to(scene)
        bore, by_grid = self.inputs / "bore.json", self.inputs / "by_grid.json"
        bore.write_text(json.dumps({"regions": [{"name": "bore", "ball": {"centre": [1, 0, 0], "radius": 0.5}}]}))
        by_grid.write_text(json.dumps({"nodes": [{"grid": {"name": "sphere.vdb"}}]}))
        for report, *arguments in (
                (ball, ball), (scene, scene), (self.inputs / "other.json", scene), (sizing, ball, "--sizing", sizing),
                (ball, scene, "--sizing-grid", ball), (ball, scene, "--field", f"v={ball}:sphere"),
                (bore, ball, "--face", bore), (ball, by_grid),
                (names, ball, "--labels", "all", "--grid", "a", "--grid", "b", "--label-names", names)):
            with self.subTest(report=report, arguments=arguments):
                before = report.read_bytes()
                self.assert_fails(self.tetstream("mesh", *arguments, "-o", self.out / "mesh.vtu", "--report", report),
                                  REFUSED, "the report would take the place of", report.resolve().name)
                self.assertEqual(report.read_bytes(), before)

    def test_report_takes_no_place_in_a_folder_of_the_mesh(self):
        ball, folder = self.inputs / "sphere.vdb", self.inputs / "mesh.polyMesh"
        self.assert_done(self.tetstream("mesh", ball, "-o", folder))
        before = (folder / "owner").read_bytes()
        for output in (folder, f"{folder}/"):
            self.assert_fails(self.tetstream("mesh", ball, "-o", output, "--format", "polymesh",
                                             "--report", folder / "owner"),
                              REFUSED, "the report would take the place of the mesh")
        self.assertEqual((folder / "owner").read_bytes(), before)


class FormatNames(CommandTest):
    volumes = {"parts": 0.1}

    def test_that_a_format_has_to_change_are_noted(self):
        changed = self.mesh("parts.vdb", ".inp", "--all-grids")
        self.assert_done(changed)
        for line in changed.stderr.splitlines():
            self.assertIn("note: the file calls the ", line)
        kept = self.mesh("parts.vdb", ".vtu", "--all-grids")
        self.assertNotIn("note: the file calls", kept.stderr)


if __name__ == "__main__":
    unittest.main()
