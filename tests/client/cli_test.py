"""The tetstream command as a script meets it: messages, exit codes, and files that are whole
or not there.

    TETSTREAM_BIN=build/dev/bin python3 tests/client/cli_test.py [unittest options]
"""

import filecmp
import json
import re
import resource
import unittest

from command_case import CUBE, ENDINGS, LID, REFUSED, USAGE, CommandTest


class Mesh(CommandTest):
    volumes = {"sphere": 0.05, "torus": 0.04, "random-signs": 0.1}

    def mesh_and_report(self, name, *options):
        """The summary and the report."""
        result = self.mesh(name, ".vtu", "--report", self.out / "r.json", *options)
        self.assert_done(result)
        self.assertEqual(len(result.stdout.splitlines()), 1)
        return result.stdout, json.loads((self.out / "r.json").read_text())

    def test_writes_every_format_and_sums_up(self):
        for ending in ENDINGS:
            with self.subTest(ending=ending):
                result = self.mesh("sphere.vdb", ending)
                self.assert_done(result)
                self.assertEqual(result.stderr, "")
                self.assertRegex(
                    result.stdout,
                    rf"mesh{ending}: \d+ vertices, \d+ tets, "
                    r"dihedral angles [\d.]+ to [\d.]+ degrees, [\d.]+ s\n")
        self.assertEqual(len(list(self.out.iterdir())), len(ENDINGS))

    def test_reports_what_scripts_read(self):
        report_path = self.out / "report.json"
        self.assert_done(self.mesh("torus.vdb", ".vtu", "--report", report_path))
        report = json.loads(report_path.read_text())
        self.assertGreaterEqual(report["min_dihedral_deg"], 11.3)
        self.assertLessEqual(report["max_dihedral_deg"], 154.7)
        self.assertAlmostEqual(report["volume"], 2 * 3.14159265**2 * 0.4**2, delta=0.01)
        self.assertEqual(report["boundary"]["components"], 1)
        self.assertEqual(report["boundary"]["euler_characteristic"], 0)
        self.assertEqual(report["boundary"]["non_manifold_edges"], 0)
        self.assertEqual(report["boundary"]["non_manifold_vertices"], 0)
        self.assertEqual(sum(report["dihedral_histogram"]), 6 * report["tets"])
        self.assertEqual(set(report["stages"]), {"reading", "planning", "meshing", "checking", "writing"})
        self.assertLessEqual(sum(report["stages"].values()), report["seconds"] * 1.01)
        self.assertGreater(report["vertices"], 1000)

    def test_leaves_statistics_out_and_the_mesh_as_it_is(self):
        self.assert_done(self.mesh("torus.vdb", ".vtu"))
        measured = (self.out / "mesh.vtu").read_bytes()
        result = self.mesh("torus.vdb", ".vtu", "--skip-statistics")
        self.assert_done(result)
        self.assertRegex(result.stdout, r"mesh\.vtu: \d+ vertices, \d+ tets, [\d.]+ s\n")
        self.assertEqual((self.out / "mesh.vtu").read_bytes(), measured)
        (self.out / "mesh.vtu").unlink()
        result = self.mesh("torus.vdb", ".vtu", "--skip-statistics",
                           "--report", self.out / "r.json")
        self.assert_fails(result, USAGE, "--report")

    def test_meshes_both_sides_up_to_a_box(self):
        line, report = self.mesh_and_report(
            "sphere.vdb", "--preset", "both-sides", "--box", *"-1.6 -1.6 -1.6 1.6 1.6 2".split())
        inside, outside = report["regions"]["inside"], report["regions"]["outside"]
        self.assertIn(f"{report['tets']} tets ({inside['tets']} inside, "
                      f"{outside['tets']} outside), dihedral", line)
        self.assertEqual(inside["tets"] + outside["tets"], report["tets"])
        self.assertAlmostEqual(inside["volume"], 4 / 3 * 3.14159265, delta=0.02)
        self.assertAlmostEqual(inside["volume"] + outside["volume"], 3.2**2 * 3.6, delta=1e-3)
        self.assertEqual(report["boundary"]["components"], 1)
        self.assertEqual(report["boundary"]["euler_characteristic"], 2)
        self.assertGreaterEqual(report["min_dihedral_deg"], 9.4)
        for end, rounded in (("min", [-1.6, -1.6, -1.6]), ("max", [1.6, 1.6, 2])):
            for number, meant in zip(report["box"][end], rounded):
                self.assertAlmostEqual(number, meant, delta=1e-9)

    def test_both_sides_without_a_box_mesh_all_that_is_stored(self):
        _, inside = self.mesh_and_report("sphere.vdb")
        _, both = self.mesh_and_report("sphere.vdb", "--preset", "both-sides")
        self.assertNotIn("regions", inside)
        self.assertGreater(both["tets"], 1.5 * inside["tets"])

    def test_a_box_that_cuts_the_surface_bounds_the_inside_too(self):
        _, report = self.mesh_and_report(
            "sphere.vdb", "--preset", "both-sides", "--box", *"0 -1.6 -1.6 1.6 1.6 1.6".split())
        self.assertAlmostEqual(
            report["regions"]["inside"]["volume"], 2 / 3 * 3.14159265, delta=0.02)
        self.assertEqual(report["boundary"]["components"], 1)
        self.assertEqual(report["boundary"]["euler_characteristic"], 2)

    def test_makes_a_manifold_of_random_signs(self):
        line, report = self.mesh_and_report("random-signs.vdb", "--spacing", "0.2")
        self.assertGreater(report["boundary"]["non_manifold_vertices"], 0)
        self.assertNotIn("restored_nodes", report["boundary"])
        self.assertNotIn("restored", line)
        line, report = self.mesh_and_report("random-signs.vdb", "--spacing", "0.2", "--manifold")
        self.assertEqual(report["boundary"]["non_manifold_edges"], 0)
        self.assertEqual(report["boundary"]["non_manifold_vertices"], 0)
        self.assertGreater(report["boundary"]["restored_nodes"], 0)
        self.assertIn(f", {report['boundary']['restored_nodes']} nodes restored, ", line)

    def test_is_the_same_bytes_for_one_and_two_threads(self):
        for ending in ENDINGS:
            one, two = self.out / f"one{ending}", self.out / f"two{ending}"
            for threads, path in ((1, one), (2, two)):
                self.assert_done(self.tetstream(
                    "mesh", self.inputs / "torus.vdb", "-o", path, "--threads", threads))
            self.assertTrue(filecmp.cmp(one, two, shallow=False), ending)

    def test_replaces_an_older_file(self):
        (self.out / "mesh.vtu").write_text("old")
        self.assert_done(self.mesh())
        self.assertGreater((self.out / "mesh.vtu").stat().st_size, 1000)

    def test_levels_0_has_more_tets_than_the_graded_default(self):
        counts = []
        for levels in ((), ("--levels", "0")):
            result = self.mesh("sphere.vdb", ".vtu", "--spacing", "0.03", *levels)
            self.assert_done(result)
            counts.append(int(re.search(r", (\d+) tets, ", result.stdout)[1]))
        self.assertGreater(counts[1], 2 * counts[0])

    def test_takes_an_iso_value_and_a_spacing(self):
        self.assert_done(self.mesh(
            "sphere.vdb", ".vtu", "--iso", "-0.1", "--spacing", "0.07",
            "--report", self.out / "r.json"))
        report = json.loads((self.out / "r.json").read_text())
        self.assertAlmostEqual(report["volume"], 4 / 3 * 3.14159265 * 0.9**3, delta=0.05)
        self.assertAlmostEqual(report["spacing"], 0.07)

    def test_stores_float64_on_request(self):
        self.assert_done(self.mesh("sphere.vdb", ".vtu", "--coordinates", "float64"))
        self.assertIn(b'type="Float64"', (self.out / "mesh.vtu").read_bytes()[:1000])


class Refusals(CommandTest):
    volumes = {"sphere": 0.05, "fog": 0.1, "torus": 0.05, "empty": 0.1, "vec3": 0.1,
               "points": 0.1}

    def test_missing_file(self):
        self.assert_fails(self.mesh("nowhere.vdb"), REFUSED, "nowhere.vdb")

    def test_truncated_file(self):
        whole = (self.inputs / "sphere.vdb").read_bytes()
        for keep in (0, 10, 200, len(whole) // 2, len(whole) - 1):
            with self.subTest(keep=keep):
                (self.inputs / "cut.vdb").write_bytes(whole[:keep])
                self.assert_fails(self.mesh("cut.vdb"), REFUSED, "cut.vdb")

    def test_file_that_is_no_vdb(self):
        (self.inputs / "text.vdb").write_text("hello\n" * 1000)
        self.assert_fails(self.mesh("text.vdb"), REFUSED, "text.vdb")

    def test_wrong_grid_name(self):
        result = self.mesh("sphere.vdb", ".vtu", "--grid", "density")
        self.assert_fails(result, REFUSED, "density", "sphere")

    def test_grids_that_cannot_be_meshed(self):
        for kind, word in (("vec3", "vec3"), ("points", "point"), ("empty", "empty")):
            with self.subTest(kind=kind):
                result = self.mesh(f"{kind}.vdb")
                self.assert_fails(result, REFUSED)
                self.assertIn(word, result.stderr.lower())

    def test_a_surface_value_that_nothing_crosses(self):
        self.assert_fails(self.mesh("fog.vdb", ".vtu", "--iso", "7"), REFUSED, "7")

    def test_numbers_out_of_range(self):
        for option, value in (("--spacing", "0"), ("--spacing", "-1"), ("--spacing", "nan"),
                              ("--iso", "inf"), ("--levels", "-1"), ("--levels", "99")):
            with self.subTest(option=option, value=value):
                result = self.mesh("sphere.vdb", ".vtu", option, value)
                self.assert_fails(result, REFUSED, value)

    def test_unknown_input_endings(self):
        for name in ("volume.foo", "volume"):
            with self.subTest(name=name):
                self.assert_fails(self.mesh(name), REFUSED, name, ".vdb")

    def test_unknown_output_ending_before_the_input_is_looked_at(self):
        result = self.tetstream("mesh", self.inputs / "sphere.vdb", "-o", self.out / "mesh.med")
        self.assert_fails(result, REFUSED, "mesh.med", ".vtu, .vtkhdf, .msh,")

    def test_output_in_a_directory_that_is_not_there(self):
        result = self.tetstream(
            "mesh", self.inputs / "sphere.vdb", "-o", self.out / "no" / "m.vtu")
        self.assert_fails(result, REFUSED, "No such file or directory")

    def test_output_that_is_a_device(self):
        link = self.inputs / "full.vtu"
        link.symlink_to("/dev/full")
        result = self.tetstream("mesh", self.inputs / "sphere.vdb", "-o", link)
        self.assert_fails(result, REFUSED, "not a regular file")

    def test_a_mesh_that_would_take_the_place_of_what_it_is_made_of(self):
        link = self.inputs / "link.vtu"
        link.symlink_to("sphere.vdb")
        cube = self.inputs / "cube.obj"
        cube.write_text(CUBE + LID)
        sizes = self.inputs / "sizing.ply"
        sizes.write_text('{"growth": 0.5}')
        scene = self.inputs / "scene.json"
        scene.write_text(json.dumps({"nodes": [{"name": "a", "grid": {"name": "sphere.vdb"}}]}))
        sphere = self.inputs / "sphere.vdb"
        before = {path: path.read_bytes() for path in (cube, sphere, sizes)}
        for source, output, *options in ((cube, cube), (sphere, link), (scene, link),
                                         (sphere, sphere, "--format", "vtu"),
                                         (sphere, sizes, "--sizing", sizes)):
            with self.subTest(output=output.name, source=source.name):
                result = self.tetstream("mesh", source, "-o", output, *options)
                self.assert_fails(result, REFUSED, "would take the place of", "name another file")
        for path, text in before.items():
            self.assertEqual(path.read_bytes(), text)

    def test_report_that_cannot_be_written(self):
        result = self.mesh("sphere.vdb", ".vtu", "--report", "/nowhere/report.json")
        self.assert_fails(result, REFUSED, "/nowhere/report.json")

    def test_options_of_the_other_kind_of_input(self):
        self.assert_fails(self.mesh("sphere.vdb", ".vtu", "--voxel", "1"), REFUSED, "--spacing")
        self.assert_fails(self.mesh("part.stl", ".vtu", "--grid", "a"), REFUSED, "no grids")

    def test_a_box_that_is_none(self):
        both = ("--preset", "both-sides")
        for box in (("0", "0", "0", "1", "1", "-1"), ("0", "0", "0", "1", "0", "1"),
                    ("0", "0", "nan", "1", "1", "1")):
            with self.subTest(box=box):
                result = self.mesh("sphere.vdb", ".vtu", *both, "--box", *box)
                self.assert_fails(result, REFUSED, "box")
        result = self.mesh("sphere.vdb", ".vtu", "--box", "0", "0", "0", "1", "1", "1", "--manifold")
        self.assert_fails(result, REFUSED, "manifold does not go with a box that cuts the inside")

    def test_full_disk_leaves_the_old_file_alone(self):
        def limit_file_size():
            hard = resource.getrlimit(resource.RLIMIT_FSIZE)[1]
            resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, hard))

        for ending in ENDINGS:
            with self.subTest(ending=ending):
                old = self.out / f"mesh{ending}"
                old.write_text("old")
                result = self.mesh("torus.vdb", ending, preexec_fn=limit_file_size)
                self.assertEqual(result.returncode, REFUSED, result.stderr)
                self.assertIn("File too large", result.stderr)
                self.assertEqual(old.read_text(), "old")
                old.unlink()
                self.assert_nothing_written()


class Usage(CommandTest):
    def test_unknown_option(self):
        self.assert_fails(self.tetstream("mesh", "--frobnicate"), USAGE, "--frobnicate")

    def test_unknown_command_and_none(self):
        self.assert_fails(self.tetstream("frobnicate"), USAGE)
        self.assert_fails(self.tetstream(), USAGE)

    def test_commands_that_are_spelt_nearly_so(self):
        for words, meant in ((["mehs"], "mesh"), (["conver"], "convert"), (["inof"], "info"),
                             (["job", "wiat"], "wait")):
            self.assert_fails(self.tetstream(*words), USAGE,
                              f"unknown command {words[-1]}; did you mean {meant}?")
        self.assert_fails(self.tetstream("frobnicate"), USAGE, "unknown command frobnicate;")

    def test_servers_have_a_port(self):
        for server in ("127.0.0.1", "localhost", "localhost:1,farm", "::1", "localhost:", "h:http"):
            self.assert_fails(self.tetstream("health", "--server", server), REFUSED, "port")

    def test_an_option_whose_value_is_empty_as_of_a_variable_that_is_not_set(self):
        for words, option in ((["--report=", "--improve"], "--report"), (["--iso", ""], "--iso"),
                              (["--server", ""], "--server"), (["--labels", ""], "--labels"), ([""], "INPUT")):
            with self.subTest(words):
                source = () if option == "INPUT" else (self.inputs / "sphere.vdb",)
                result = self.tetstream("mesh", *source, "-o", self.out / "m.vtu", *words)
                self.assert_fails(result, USAGE, option, "it is empty")

    def test_missing_arguments(self):
        self.assert_fails(self.tetstream("mesh", "a.vdb"), USAGE, "--output")
        self.assert_fails(self.tetstream("health"), USAGE, "--server")

    def test_values_that_are_no_numbers_or_no_choice(self):
        for option, value in (("--spacing", "wide"), ("--levels", "x"), ("--threads", "-1"),
                              ("--preset", "best"), ("--coordinates", "int8"),
                              ("--box", "1")):
            with self.subTest(option=option):
                self.assert_fails(self.mesh("sphere.vdb", ".vtu", option, value), USAGE, option)

    def test_a_box_of_fewer_numbers_or_of_more(self):
        box = ("--preset", "both-sides", "--box", "-.5", "-1", "0", "1", "1")
        self.assert_fails(self.mesh("sphere.vdb", ".vtu", *box), USAGE, "--box", "6 required")
        self.assert_fails(self.mesh("sphere.vdb", ".vtu", *box, "1", "1"), USAGE, "1")

    def test_help_teaches_by_example(self):
        for command in ([], ["mesh"], ["info"], ["convert"], ["health"]):
            result = self.tetstream(*command, "--help")
            self.assert_done(result)
            self.assertRegex(result.stdout, rf"Examples?:\n +tetstream {'.*'.join(command)}")

    def test_version(self):
        result = self.tetstream("--version")
        self.assert_done(result)
        self.assertRegex(result.stdout, r"^tetstream \d+\.\d+\.\d+\n$")


class Info(CommandTest):
    volumes = {"sphere": 0.05, "fog": 0.1, "vec3": 0.1}

    def test_prints_a_table(self):
        result = self.tetstream("info", self.inputs / "sphere.vdb")
        self.assert_done(result)
        self.assertRegex(result.stdout, r"sphere +float +level set +0\.05 +\d+ +[\d x]+ +scalar +-?[\d.]+ to [\d.]+ +[\d.]+ +below +yes")

    def test_says_why_a_grid_cannot_be_meshed(self):
        result = self.tetstream("info", self.inputs / "vec3.vdb")
        self.assert_done(result)
        self.assertIn("no: ", result.stdout)

    def test_prints_json(self):
        result = self.tetstream("info", self.inputs / "fog.vdb", "--json")
        self.assert_done(result)
        (grid,) = json.loads(result.stdout)
        self.assertEqual(grid["name"], "fog")
        self.assertEqual(grid["class"], "fog volume")
        self.assertEqual(grid["value_type"], "float")
        self.assertTrue(grid["meshable"])

    def test_of_a_missing_file(self):
        self.assert_fails(self.tetstream("info", "nowhere.vdb"), REFUSED, "nowhere.vdb")


if __name__ == "__main__":
    unittest.main(verbosity=2)
