"""What is written in each format, as the programs take it that the format is for.

    TETSTREAM_BIN=build/release/bin python3 tests/judges/formats_test.py [unittest options]
"""
import json
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

import numpy

ROOT = pathlib.Path(__file__).resolve().parents[2]
BRACKET = ROOT / "docs" / "scenes" / "bracket.json"

# Screwed down by its four holes, and pressed upon in one half of its bore.
CLAMPED = ("--face", "feet=node:holes", "--face", "load=node:bore/halfspace:1,0,0,0", "--face", "bore=node:bore")
BORE_RADIUS, BORE_HEIGHT, HOLE_RADIUS, PLATE = 0.4, 1.3, 0.2, 0.4  # of the bracket

BALL = {"nodes": [{"sphere": {"radius": 1}}]}
# All space that is cut out of it is inside.
BLOCK = {"nodes": [{"half_space": {"normal": [0, 0, 1], "offset": 100}}]}
CUBE = (BLOCK, "--box", "0", "0", "0", "1.6", "1.6", "1.6")
BOTH_SIDES = ("--preset", "both-sides", "--box", "-1.5", "-1.5", "-1.5", "1.5", "1.5", "1.5")


class Judged(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def mesh(self, name, scene=BRACKET, *options, spacing="0.1"):
        """The path of a mesh file of this name."""
        if isinstance(scene, dict):
            path = self.folder / "scene.json"
            path.write_text(json.dumps(scene), encoding="utf-8")
            scene = path
        out = self.folder / name
        program = pathlib.Path(os.environ["TETSTREAM_BIN"], "tetstream")
        subprocess.run([program, "mesh", scene, "-o", out, "--spacing", spacing, *options], check=True,
                       capture_output=True)
        return out

    def run_in(self, folder, *command):
        done = subprocess.run(list(map(str, command)), cwd=folder, capture_output=True, text=True,
                              timeout=600, check=False,
                              env={"WM_PROJECT_DIR": "/usr/share/openfoam", **os.environ})
        return done.returncode, done.stdout + done.stderr


class CalculiX(Judged):
    """A constant stress is what linear tets have exactly: a mesh that is read as it was meant has it."""

    MATERIAL = "*MATERIAL, NAME=steel\n*ELASTIC\n1000, 0.25\n*SOLID SECTION, ELSET=Eall, MATERIAL=steel\n"
    PRINT = "*NODE PRINT, NSET=Nall\nU\n*END STEP\n"

    def solve(self, mesh, model, step):
        """Points and displacements of all nodes."""
        deck = f"*INCLUDE, INPUT={mesh.name}\n{self.MATERIAL}{model}*STEP\n*STATIC\n{step}{self.PRINT}"
        (self.folder / "deck.inp").write_text(deck, encoding="ascii")
        code, text = self.run_in(self.folder, "ccx", "deck")
        self.assertEqual(code, 0, text[-2000:])
        self.assertNotIn("*ERROR", text)
        nodes = mesh.read_text(encoding="ascii").partition("*NODE, NSET=Nall\n")[2].partition("*")[0]
        points = numpy.array([line.split(",")[1:] for line in nodes.splitlines()], dtype=float)
        rows = [line.split() for line in (self.folder / "deck.dat").read_text().splitlines()]
        found = numpy.array([row for row in rows if len(row) == 4 and row[0].isdigit()], dtype=float)
        self.assertEqual(found[:, 0].tolist(), list(range(1, len(points) + 1)))
        return points, found[:, 1:]

    def patch_test(self, scene, *options):
        """The error of displacements inside that are linear on the boundary."""
        mesh = self.mesh("body.inp", scene, *options, spacing="0.2")
        text = mesh.read_text(encoding="ascii")
        boundary = sorted({int(n) for rows in re.findall(r"^\*NSET, NSET=\w+\n([\d\n]*)", text, re.MULTILINE)
                           for n in rows.split()})
        gradient = numpy.array([[1e-3, 2e-4, 0], [0, -5e-4, 3e-4], [4e-4, 0, 2e-4]])
        nodes = text.partition("*NODE, NSET=Nall\n")[2].partition("*")[0].splitlines()
        wanted = {n: gradient @ [float(x) for x in nodes[n - 1].split(",")[1:]] for n in boundary}
        given = "".join(f"{n}, {axis + 1}, {axis + 1}, {value[axis]:.12e}\n"
                        for n, value in wanted.items() for axis in range(3))
        points, moved = self.solve(mesh, "", f"*BOUNDARY\n{given}")
        self.assertLess(len(boundary), len(points))  # there are nodes that were not told
        return numpy.abs(moved - points @ gradient.T).max() / numpy.abs(points @ gradient.T).max()

    def test_passes_a_patch_test(self):
        self.assertLess(self.patch_test(BRACKET), 1e-6)

    def test_passes_a_patch_test_with_tets_of_ten_nodes(self):
        self.assertLess(self.patch_test(*CUBE, "--order", "2"), 1e-6)

    def test_nearly_passes_it_where_their_edges_are_bent(self):
        """A field that is linear in the place is one of theirs, but CalculiX has four points in each tet, whose rule is
        exact for squares; what it adds up in a bent one is a cubic."""
        self.assertLess(self.patch_test(BRACKET, "--order", "2"), 1e-4)

    def sag(self, *options):
        """How far the end of a beam moves, of what Timoshenko says: 10 long, 1 wide and high, pressed from above."""
        mesh = self.mesh("beam.inp", BLOCK, "--box", "0", "0", "0", "10", "1", "1", "--levels", "2", *options,
                         spacing="0.125")
        pressure, modulus, shear, inertia = 1e-3, 1000, 1000 / 2.5, 1 / 12
        wanted = pressure * (10**4 / (8 * modulus * inertia) + 10**2 / (2 * 5 / 6 * shear))
        points, moved = self.solve(mesh, "*BOUNDARY\ncut_x_min, 1, 3, 0\n",
                                   f"*DSLOAD\ncut_z_max, P, {pressure}\n")
        return -moved[points[:, 0] > 10 - 1e-6, 2].mean() / wanted

    def test_bends_a_beam_of_ten_node_tets_as_it_should(self):
        """Within a hundredth, on a mesh whose tets of four nodes are too stiff by a tenth and more."""
        self.assertLess(abs(self.sag("--order", "2") - 1), 0.01)
        self.assertLess(self.sag(), 0.9)

    def test_presses_on_the_surface_from_all_sides(self):
        """A pressure on the whole surface shrinks the body alike everywhere: u = -p (1 - 2 nu) / E x."""
        mesh = self.mesh("ball.inp", BALL, spacing="0.3")
        text = mesh.read_text(encoding="ascii").partition("*NODE, NSET=Nall\n")[2].partition("*")[0]
        points = numpy.array([line.split(",")[1:] for line in text.splitlines()], dtype=float)
        shrink = -2.0 * (1 - 2 * 0.25) / 1000
        # Three nodes are held where they will be, so that it neither moves nor turns.
        held = [int(numpy.argmax(points @ direction)) for direction in numpy.eye(3)]
        given = "".join(f"{n + 1}, {axis + 1}, {axis + 1}, {shrink * points[n][axis]:.12e}\n"
                        for n in held for axis in range(3))
        points, moved = self.solve(mesh, "", f"*BOUNDARY\n{given}*DSLOAD\nsurface, P, 2.0\n")
        self.assertLess(numpy.abs(moved - shrink * points).max(), 1e-6 * abs(shrink))


    def test_holds_a_bracket_by_its_holes_against_a_pressure_in_its_bore(self):
        mesh = self.mesh("bracket.inp", BRACKET, *CLAMPED)
        pressure = 2.0
        self.PRINT = "*NODE PRINT, NSET=feet, TOTALS=ONLY\nRF\n*NODE PRINT, NSET=Nall\nU\n*END STEP\n"
        points, moved = self.solve(mesh, "*BOUNDARY\nfeet, 1, 3\n", f"*DSLOAD\nload, P, {pressure}\n")
        text = (self.folder / "deck.dat").read_text()
        held = numpy.array(text.partition("total force")[2].split("\n")[2].split(), dtype=float)
        # The pressure pushes the half at negative x away from the middle; the feet hold against it.
        force = pressure * 2 * BORE_RADIUS * BORE_HEIGHT
        self.assertAlmostEqual(held[0] / force, 1, delta=0.03)
        self.assertLess(abs(held[1]), 0.02 * force)
        self.assertLess(numpy.abs(moved[:, 0]).argmax() and points[numpy.abs(moved[:, 0]).argmax()][0], 0)
        feet = numpy.abs(numpy.linalg.norm(numpy.abs(points[:, :2]) - (1.6, 0.6), axis=1) - HOLE_RADIUS) < 1e-3
        self.assertTrue((moved[feet & (numpy.abs(points[:, 2]) < 0.15)] == 0).all())


class Gmsh(Judged):
    def check(self, path):
        code, text = self.run_in(self.folder, "gmsh", "-check", path)
        self.assertEqual(code, 0, text)
        self.assertRegex(text, r"\d+ nodes")
        self.assertNotRegex(text, r"(?i)warning|error", text)

    def test_finds_no_fault(self):
        self.check(self.mesh("bracket.msh"))
        self.check(self.mesh("named.msh", BRACKET, *CLAMPED))
        self.check(self.mesh("sides.msh", BALL, *BOTH_SIDES, spacing="0.3"))
        self.check(self.mesh("cut.msh", BALL, "--box", "-0.5", "-2", "-2", "2", "2", "2", spacing="0.2"))


class Dolfinx(Judged):
    """In a process of its own: elasticity.py says what it found in one line of JSON."""

    def elasticity(self, mesh, clamped):
        code, text = self.run_in(self.folder, "/usr/bin/python3", pathlib.Path(__file__).parent / "elasticity.py",
                                 mesh, clamped)
        self.assertEqual(code, 0, text)
        return json.loads(next(line for line in text.splitlines() if line.startswith("{")))

    def test_solves_elasticity_on_a_clamped_bracket(self):
        mesh = self.mesh("bracket.xdmf", BRACKET, "--box", "-9", "-9", "0.05", "9", "9", "9")
        found = self.elasticity(mesh, "cut_z_min")
        self.assertEqual(found["cell_tags"], [1])
        self.assertEqual(set(found["areas"]), {"surface", "cut_z_min"})
        self.assertAlmostEqual(sum(found["areas"].values()) / found["boundary_area"], 1, places=10)
        self.assertLess(found["clamped_outside_of_plane"], 1e-6)
        self.assertLess(found["least_displacement"], -1e-6)  # it sags
        self.assertAlmostEqual(found["reaction"] / found["weight"], 1, places=6)

    def test_solves_elasticity_on_a_bracket_that_is_held_by_its_holes(self):
        found = self.elasticity(self.mesh("bracket.xdmf", BRACKET, *CLAMPED), "feet")
        areas = found["areas"]
        self.assertEqual(set(areas), {"surface", "feet", "load", "bore"})
        self.assertAlmostEqual(sum(areas.values()) / found["boundary_area"], 1, places=10)
        bore = 2 * numpy.pi * BORE_RADIUS * BORE_HEIGHT
        self.assertAlmostEqual((areas["load"] + areas["bore"]) / bore, 1, delta=0.03)
        self.assertAlmostEqual(areas["load"] / areas["bore"], 1, delta=0.03)
        self.assertAlmostEqual(areas["feet"] / (4 * 2 * numpy.pi * HOLE_RADIUS * PLATE), 1, delta=0.05)
        self.assertLess(found["least_displacement"], -1e-6)
        self.assertAlmostEqual(found["reaction"] / found["weight"], 1, places=6)

    def test_reads_the_same_areas_from_a_msh(self):
        self.mesh("bracket.msh", BRACKET, *CLAMPED)
        code, text = self.run_in(self.folder, "/usr/bin/python3", pathlib.Path(__file__).parent / "msh_areas.py",
                                 self.folder / "bracket.msh")
        self.assertEqual(code, 0, text)
        areas = json.loads(next(line for line in text.splitlines() if line.startswith("{")))
        self.assertEqual(set(areas), {"surface", "feet", "load", "bore"})
        self.assertAlmostEqual(areas["feet"] / (4 * 2 * numpy.pi * HOLE_RADIUS * PLATE), 1, delta=0.05)
        self.assertAlmostEqual(areas["load"] / areas["bore"], 1, delta=0.03)

    def test_reads_both_sides_and_what_lies_between(self):
        mesh = self.mesh("sides.xdmf", BALL, *BOTH_SIDES, spacing="0.3")
        found = self.elasticity(mesh, "box_z_min")
        self.assertEqual(found["cell_tags"], [1, 2])
        self.assertEqual(set(found["areas"]), {"interface"} | {f"box_{axis}_{end}" for axis in "xyz"
                                                                for end in ("min", "max")})
        self.assertAlmostEqual(found["areas"]["interface"], 4 * numpy.pi, delta=0.4)

    def test_reads_tets_of_ten_nodes_and_their_curved_faces(self):
        mesh = self.mesh("sides.xdmf", BALL, *BOTH_SIDES, "--order", "2", spacing="0.3")
        found = self.elasticity(mesh, "box_z_min")
        self.assertEqual(found["cell_tags"], [1, 2])
        self.assertAlmostEqual(found["areas"]["interface"], 4 * numpy.pi, delta=0.04)
        self.assertLess(found["clamped_outside_of_plane"], 1e-6)
        self.assertAlmostEqual(found["reaction"] / found["weight"], 1, places=6)


class OpenFoam(Judged):
    DICTIONARIES = {
        "controlDict": "application icoFoam;\nstartFrom startTime;\nstartTime 0;\nstopAt endTime;\nendTime 1;\n"
                       "deltaT 1;\nwriteControl timeStep;\nwriteInterval 1;\n",
        "fvSchemes": "divSchemes {}\ngradSchemes {}\nlaplacianSchemes {}\n",
        "fvSolution": "",
    }

    def check(self, scene, *options, spacing):
        for folder in ("constant", "system"):
            (self.folder / folder).mkdir(exist_ok=True)
        for name, text in self.DICTIONARIES.items():
            header = f"FoamFile\n{{\n version 2.0;\n format ascii;\n class dictionary;\n object {name};\n}}\n"
            (self.folder / "system" / name).write_text(header + text, encoding="ascii")
        self.mesh("constant/polyMesh", scene, *options, spacing=spacing)
        code, text = self.run_in(self.folder, "checkMesh", "-case", self.folder, "-allTopology", "-constant")
        self.assertEqual(code, 0, text)
        self.assertIn("Mesh OK.", text, text)
        return text

    def test_finds_no_fault(self):
        text = self.check(BRACKET, spacing="0.1")
        self.assertRegex(text, r"surface\s+\d+")

    def test_finds_the_zones_of_both_sides(self):
        text = self.check(BALL, *BOTH_SIDES, spacing="0.3")
        for patch in ("box_x_min", "box_z_max"):
            self.assertRegex(text, rf"{patch}\s+\d+")
        self.assertRegex(text, r"face zones:\s+1")
        self.assertRegex(text, r"cell zones:\s+2")


if __name__ == "__main__":
    unittest.main()
