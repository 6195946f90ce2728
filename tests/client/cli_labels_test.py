"""Segmentations through the tetstream command: every label in one mesh.

    TETSTREAM_BIN=build/dev/bin python3 tests/client/cli_labels_test.py [unittest options]
"""

import gzip
import json
import pathlib
import unittest

import numpy

from command_case import REFUSED, USAGE, CommandTest, ServerTest, read_mesh
from job_case import JobTest
from image_files import CENTRE, SEMI_AXES, ellipsoid, meta, nifti, nrrd, oblique

CT = (0.5, 0.5, 1.25)
TISSUES = {1: "marrow", 4: "bone", 7: "skin"}
SHARES = {1: 0.5, 4: 0.75, 7: 1.0}  # of the ellipsoid's radius, from one shell to the next
WHOLE_NUMBERS = pathlib.Path(__file__).resolve().parents[1] / "data/whole_numbers"
WHOLE = 4 / 3 * numpy.pi * numpy.prod(SEMI_AXES)
VOLUMES = {1: WHOLE * 0.5**3, 4: WHOLE * (0.75**3 - 0.5**3), 7: WHOLE * (1 - 0.75**3)}

ITK_SNAP = """\
################################################
# ITK-SnAP Label Description File
################################################
    0     0    0    0        0  0  0    "Clear Label"
    1   255    0    0        1  1  1    "marrow"
    4     0  255    0        1  1  1    "bone"
    7     0    0  255        1  1  1    "skin"
"""
SLICER = "# Color table file head.ctbl\n0 Background 0 0 0 0\n1 marrow 128 174 128 255\n" \
    "4 bone 241 214 145 255\n7 skin 177 122 101 255\n"
JSON_TABLE = json.dumps({str(value): name for value, name in TISSUES.items()})


def shells(linear):
    """Labels [x][y][z] of shells one within the other, and the affine."""
    values, affine = ellipsoid(linear)
    share = 1 - (values - 100) / 100  # of the radius
    labels = numpy.zeros(values.shape, "i2")
    for label in sorted(SHARES, reverse=True):
        labels[share < SHARES[label]] = label
    return labels, affine


class LabelCase(CommandTest):
    volumes = {}

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        labels, affine = shells(oblique(CT))
        cls.head = cls.inputs / "head.nii.gz"
        cls.head.write_bytes(gzip.compress(nifti(labels, affine), mtime=0))
        for name, text in (("snap.txt", ITK_SNAP), ("head.ctbl", SLICER),
                           ("names.json", JSON_TABLE)):
            (cls.inputs / name).write_text(text)

    def mesh_labels(self, *options, path=None, ending=".vtu"):
        result = self.tetstream("mesh", path or self.head, "-o", self.out / f"mesh{ending}",
                                *options)
        self.assert_done(result)
        return result

    def report(self, *options, **how):
        report = self.out / "report.json"
        self.mesh_labels("--report", report, *options, **how)
        return json.loads(report.read_text())

    def refuse(self, *options, code=REFUSED, words=()):
        result = self.tetstream("mesh", self.head, "-o", self.out / "mesh.vtu", *options)
        self.assert_fails(result, code, *words)

    def labels_of_file(self):
        mesh = read_mesh(self.out / "mesh.vtu")
        return mesh, numpy.concatenate(mesh.cell_data["label"])


class Labels(LabelCase):
    def test_are_all_meshed_with_their_volumes_and_names(self):
        report = self.report("--labels", "all", "--label-names", self.inputs / "snap.txt")
        self.assertEqual([(label["value"], label["name"]) for label in report["labels"]],
                         sorted(TISSUES.items()))
        for label in report["labels"]:
            volume = VOLUMES[label["value"]]
            # Voxels of 0.5 x 0.5 x 1.25 round off a shell three of them thick.
            self.assertAlmostEqual(label["volume"], volume, delta=0.12 * volume)
            self.assertAlmostEqual(label["voxel_volume"], volume, delta=0.06 * volume)
            self.assertEqual(label["parts"], 1)
        self.assertGreater(report["min_dihedral_deg"], 9.3)
        self.assertLess(report["max_dihedral_deg"], 157.6)
        self.assertEqual(sum(label["tets"] for label in report["labels"]), report["tets"])

    def test_lie_where_the_image_has_them(self):
        self.mesh_labels("--labels", "all")
        mesh, labels = self.labels_of_file()
        corners = mesh.points[mesh.cells_dict["tetra"]]
        middle = corners.mean(axis=1)
        share = numpy.linalg.norm((middle - CENTRE) / SEMI_AXES, axis=1)
        expected = numpy.select([share < SHARES[1], share < SHARES[4]], [1, 4], 7)
        self.assertLess(numpy.mean(expected != labels), 0.12)
        for bound in SHARES.values():  # away from interfaces all are right
            share[abs(share - bound) < 0.12] = numpy.nan
        away = ~numpy.isnan(share)
        self.assertGreater(away.sum(), 1000)
        self.assertTrue((expected == labels)[away].all())

    def test_are_improved_within_their_volumes(self):
        before = self.report("--labels", "all", "--spacing", "1")
        after = self.report("--labels", "all", "--spacing", "1", "--improve")
        self.assertEqual(after["tets"], before["tets"])
        self.assertGreater(after["improvement"]["moved_vertices"], 1000)
        self.assertGreater(after["min_dihedral_deg"], 11.99)
        self.assertLess(after["max_dihedral_deg"], 150.01)
        for label, plain in zip(after["labels"], before["labels"]):
            self.assertAlmostEqual(label["volume"], plain["volume"], delta=0.03 * plain["volume"])

    def test_share_their_interfaces(self):
        self.mesh_labels("--labels", "all", "--levels", "0")
        mesh, labels = self.labels_of_file()
        tets = mesh.cells_dict["tetra"]
        faces = numpy.sort(numpy.concatenate(
            [tets[:, [1, 2, 3]], tets[:, [0, 2, 3]], tets[:, [0, 1, 3]], tets[:, [0, 1, 2]]]), 1)
        owner = numpy.tile(labels, 4)
        order = numpy.lexsort(faces.T)
        faces, owner = faces[order], owner[order]
        twice = (faces[1:] == faces[:-1]).all(axis=1)
        pairs = {tuple(sorted(pair)) for pair in zip(owner[1:][twice], owner[:-1][twice])
                 if pair[0] != pair[1]}
        self.assertEqual(pairs, {(1, 4), (4, 7)})
        single = numpy.ones(len(faces), bool)
        single[1:][twice] = single[:-1][twice] = False
        self.assertEqual(set(owner[single]), {7})  # the skin alone ends at the outside

    def test_come_from_every_format(self):
        labels, affine = shells(oblique(CT))
        expected = self.report("--labels", "all")
        for name, data in (("head.nrrd", nrrd(labels, affine)),
                           ("head.mha", meta(labels, affine)),
                           ("float.nii", nifti(labels.astype("f4"), affine))):
            with self.subTest(name):
                path = self.inputs / name
                path.write_bytes(data)
                report = self.report("--labels", "all", path=path)
                # A NIfTI file has its axes in float32.
                self.assertAlmostEqual(report["tets"], expected["tets"],
                                       delta=0.01 * expected["tets"])

    def test_may_be_chosen_and_merged(self):
        report = self.report("--labels", "4,5:9", "--merge", "4,1")
        self.assertEqual([label["value"] for label in report["labels"]], [4, 7])
        self.assertAlmostEqual(report["labels"][0]["voxel_volume"], VOLUMES[1] + VOLUMES[4],
                               delta=0.06 * VOLUMES[4])

    def test_may_have_their_background_meshed(self):
        report = self.report("--labels", "all", "--background", "meshed", "--levels", "max")
        self.assertEqual([label["value"] for label in report["labels"]], [1, 4, 7, 0])
        box = report["bounds"]
        self.assertGreater(report["volume"], 2 * WHOLE)
        self.assertLess(box["min"][0], CENTRE[0] - SEMI_AXES[0])

    def test_may_be_coarse_and_cut_by_a_box(self):
        report = self.report("--labels", "all", "--spacing", "1", "--box", "31", "-30", "-10",
                             "50", "0", "20")
        self.assertEqual(report["spacing"], 1)
        self.assertIn("box", report)
        self.assertLess(report["volume"], 0.95 * WHOLE)

    def test_have_names_from_any_table(self):
        for table in ("snap.txt", "head.ctbl", "names.json"):
            with self.subTest(table):
                report = self.report("--labels", "all", "--label-names", self.inputs / table)
                self.assertEqual([label["name"] for label in report["labels"]],
                                 [TISSUES[value] for value in sorted(TISSUES)])

    def test_that_are_lost_are_told_of(self):
        labels = numpy.zeros((24, 24, 24), "u1")
        labels[4:20, 4:20, 4:20] = 1
        labels[12, 12, 12] = 9
        path = self.inputs / "speck.nrrd"
        path.write_bytes(nrrd(labels, numpy.eye(4)))
        (self.inputs / "speck.json").write_text('[{"value": 9, "name": "speck"}]')
        result = self.mesh_labels("--labels", "all", "--label-names",
                                  self.inputs / "speck.json", "--spacing", "2", path=path)
        self.assertIn("label 9 (speck) is lost", result.stderr)
        self.assertIn("--smooth thin", result.stderr)

    def test_have_names_in_every_format(self):
        names = self.inputs / "names.json"
        for ending, words in ((".inp", (b"ELSET=marrow", b"ELSET=skin", b"NAME=marrow_bone",
                                        b"NAME=bone_skin", b"NAME=skin_surface")),
                              (".msh", (b'3 4 "bone"', b'"skin_surface"')),
                              (".xdmf", (b'Name="4" Value="bone"', b'"bone_skin"')),
                              (".exo", (b"marrow", b"skin_surface")),
                              (".mesh", (b"bone",)), (".usda", (b'"marrow"', b'"bone_skin"')),
                              (".obj", (b"marrow_bone",))):
            with self.subTest(ending):
                self.mesh_labels("--labels", "all", "--label-names", names, ending=ending)
                data = (self.out / f"mesh{ending}").read_bytes()
                for word in words:
                    self.assertIn(word, data)

    def test_give_the_faces_between_them(self):
        report = self.report("--labels", "all", "--label-names", self.inputs / "names.json",
                             "--faces")
        self.assertEqual(set(report["faces"]), {"marrow_bone", "bone_skin", "skin_surface"})
        # The triangles of an interface: an ellipsoid's area is about that of a ball.
        self.assertGreater(report["faces"]["bone_skin"], report["faces"]["marrow_bone"])

    def test_are_told_of_by_info(self):
        result = self.tetstream("info", self.head)
        self.assert_done(result)
        self.assertIn("--labels", result.stdout)


class LabelRefusals(LabelCase):
    def test_say_what_there_is(self):
        self.refuse("--labels", "3", words=("3", "0, 1, 4, 7"))
        self.refuse("--labels", "all", "--merge", "4,9", words=("9", "0, 1, 4, 7"))
        self.refuse("--labels", "x", words=("--labels", "1,4,7:12"))
        self.refuse("--labels", "0", words=("background",))

    def test_are_of_what_does_not_go_together(self):
        for options in (("--iso", "3"), ("--inside", "above"), ("--manifold",),
                        ("--preset", "both-sides"), ("--sizing", '{"growth": 0.5}')):
            with self.subTest(options):
                self.refuse("--labels", "all", *options, words=("--labels", options[0]))
        self.refuse("--labels", "all", "--order", "2", words=("--order",))

    def test_are_of_options_without_labels(self):
        for options in (("--merge", "1,4"), ("--background", "meshed"), ("--smooth", "1"),
                        ("--label-names", "x"), ("--background-label", "1")):
            with self.subTest(options):
                self.refuse(*options, code=USAGE, words=("--labels",))

    def test_are_of_tables_that_are_none(self):
        table = self.inputs / "bad.txt"
        for text, word in (("1 2\nfour bone\n", "line 2"), ("1 a\n1 b\n", "already"),
                           ('{"a": "b"}', "member 0"), ("{", "JSON"), ('1 "a', "line 1")):
            with self.subTest(text):
                table.write_text(text)
                self.refuse("--labels", "all", "--label-names", table, words=("bad.txt", word))

    def test_are_of_values_that_are_no_labels(self):
        values, affine = ellipsoid(numpy.diag(CT))
        path = self.inputs / "values.nii"
        path.write_bytes(nifti(values.astype("f4"), affine))
        result = self.tetstream("mesh", path, "-o", self.out / "mesh.vtu", "--labels", "all")
        self.assert_fails(result, REFUSED, "values.nii", "--iso")

    def test_name_labels_where_nobody_says_what_is_inside(self):
        labels, affine = shells(oblique(CT))
        path = self.inputs / "below.nii"
        path.write_bytes(nifti(labels - 3, affine))
        result = self.tetstream("mesh", path, "-o", self.out / "mesh.vtu")
        self.assert_fails(result, REFUSED, "inside must be set", "--labels all")


class LabelsServed(LabelCase, ServerTest):
    def expect_the_same_bytes(self, *options):
        self.mesh_labels(*options)
        here = (self.out / "mesh.vtu").read_bytes()
        for how in ((), ("--packed",)):
            with self.subTest(how):
                self.mesh_labels(*options, "--server", self.address, *how)
                self.assertEqual((self.out / "mesh.vtu").read_bytes(), here)

    def test_are_the_same_bytes_as_here(self):
        self.expect_the_same_bytes("--labels", "all", "--label-names", self.inputs / "head.ctbl")

    def test_that_are_improved_are_the_same_bytes_as_here(self):
        self.expect_the_same_bytes("--labels", "all", "--spacing", "1", "--improve")

    def test_of_a_vdb_file_are_the_same_bytes_as_here(self):
        for kind in ("int32", "mask"):
            with self.subTest(kind):
                path = WHOLE_NUMBERS / f"{kind}.vdb"
                options = ("--labels", "1", "--background", "meshed", "--report", self.out / "report.json")
                self.mesh_labels(*options, path=path)
                here = (self.out / "mesh.vtu").read_bytes()
                report = json.loads((self.out / "report.json").read_text())
                # 24 x 29 x 36 voxels, but for one
                self.assertAlmostEqual(report["labels"][0]["voxel_volume"], 25055, delta=1)
                self.assertAlmostEqual(report["labels"][0]["volume"], 25055, delta=600)
                self.mesh_labels(*options, "--server", self.address, path=path)
                self.assertEqual((self.out / "mesh.vtu").read_bytes(), here)

    def test_have_the_same_faces_as_here(self):
        options = ("--labels", "all", "--faces")
        self.mesh_labels(*options, ending=".msh")
        here = (self.out / "mesh.msh").read_bytes()
        for how in ((), ("--packed",)):
            with self.subTest(how):
                self.mesh_labels(*options, "--server", self.address, *how, ending=".msh")
                self.assertEqual((self.out / "mesh.msh").read_bytes(), here)

    def test_are_reported_alike(self):
        here = self.report("--labels", "1,7", "--smooth", "thin")
        served = self.report("--labels", "1,7", "--smooth", "thin", "--server", self.address)
        self.assertEqual(served["labels"], here["labels"])

    def test_are_estimated(self):
        result = self.tetstream("estimate", self.head, "--labels", "all", "--json")
        self.assert_done(result)
        here = json.loads(result.stdout)
        result = self.tetstream("estimate", self.head, "--labels", "all", "--json", "--server",
                                self.address)
        self.assert_done(result)
        self.assertEqual(json.loads(result.stdout)["tets"], here["tets"])

    def test_cannot_be_compact(self):
        result = self.tetstream("mesh", self.head, "-o", self.out / "mesh.vtu", "--labels", "all",
                                "--server", self.address, "--compact")
        self.assert_fails(result, REFUSED, "--compact", "--labels")

    def test_that_there_are_not_are_refused_alike(self):
        result = self.tetstream("mesh", self.head, "-o", self.out / "mesh.vtu", "--labels", "3",
                                "--server", self.address)
        self.assertEqual(result.returncode, REFUSED, result.stderr)
        self.assertIn("0, 1, 4, 7", result.stderr)
        self.assert_nothing_written()


class LabelsOfJobs(LabelCase, JobTest):
    volumes = {}

    def test_are_the_same_bytes_as_here(self):
        options = ("--labels", "all", "--merge", "1,4", "--faces")
        self.mesh_labels(*options)
        here = (self.out / "mesh.vtu").read_bytes()
        job, = self.submit(self.head, *options)
        fetched = self.out / "fetched.vtu"
        self.assert_done(self.job("fetch", job, "-o", fetched, "--wait"))
        self.assertEqual(fetched.read_bytes(), here)


if __name__ == "__main__":
    unittest.main()
