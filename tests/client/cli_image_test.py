"""Images through the tetstream command: read right, and where the world has them.

    TETSTREAM_BIN=build/dev/bin python3 tests/client/cli_image_test.py [unittest options]
"""

import gzip
import json
import math
import unittest

import numpy

from command_case import REFUSED, CommandTest, ServerTest, read_mesh
from image_files import CENTRE, NRRD_TYPES, SEMI_AXES, ellipsoid, meta, nifti, nrrd, oblique

VOLUME = 4 / 3 * math.pi * math.prod(SEMI_AXES)
CUBES = (0.5, 0.5, 0.5)
CT = (0.4, 0.4, 0.8)
ISO = ("--iso", "100", "--inside", "above", "--levels", "0")


def farthest_from_ellipsoid(points):
    """The largest distance of a point on the surface from the ellipsoid, to first order."""
    away = (points - numpy.array(CENTRE)) / numpy.array(SEMI_AXES)
    radius = numpy.linalg.norm(away, axis=1)
    slope = numpy.linalg.norm(away / numpy.array(SEMI_AXES), axis=1) / radius
    return float(numpy.max(numpy.abs(radius - 1) / slope))


# Each class loads of VTK and nibabel what it takes: all of VTK is a second of a processor.


def surface_points(path):
    """Points of the mesh's boundary, by VTK's reader."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkFiltersGeometry import vtkDataSetSurfaceFilter
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    faces = vtkDataSetSurfaceFilter()
    faces.SetInputConnection(reader.GetOutputPort())
    faces.Update()
    return vtk_to_numpy(faces.GetOutput().GetPoints().GetData()).astype(float)


def vtk_image(values, spacing, origin):
    """As VTK has it, with the values as its scalars."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkImageData
    image = vtkImageData()
    image.SetDimensions(values.shape)
    image.SetSpacing(spacing)
    image.SetOrigin(origin)
    image.GetPointData().SetScalars(numpy_to_vtk(values.reshape(-1, order="F"), deep=True))
    return image


class ImageCase(CommandTest):
    volumes = {}

    def write(self, name, data):
        (self.inputs / name).write_bytes(data)
        return self.inputs / name

    def mesh_image(self, path, *options):
        report = self.out / "report.json"
        result = self.tetstream("mesh", path, "-o", self.out / "mesh.vtu", "--report", report,
                                *(options or ISO))
        self.assert_done(result)
        return json.loads(report.read_text())

    def mesh_bytes(self, path, *options):
        """The mesh's file. Without a report, which takes longer than the mesh."""
        self.assert_done(self.tetstream("mesh", path, "-o", self.out / "mesh.vtu", *(options or ISO)))
        return (self.out / "mesh.vtu").read_bytes()

    def assert_is_the_ellipsoid(self, path, spacing, *options):
        """Within a tenth of a spacing of the truth, in the coordinates of the image's file, and
        with every angle within its bound."""
        report = self.mesh_image(path, *options)
        self.assertLess(farthest_from_ellipsoid(surface_points(self.out / "mesh.vtu")),
                        0.1 * spacing)
        # Triangles with their corners on the ellipsoid hold less than it.
        self.assertAlmostEqual(report["volume"], VOLUME, delta=0.02 * VOLUME)
        self.assertGreater(report["min_dihedral_deg"], 11.2)
        self.assertLess(report["max_dihedral_deg"], 154.9)
        return report

    def assert_refused(self, path, *words):
        result = self.tetstream("mesh", path, "-o", self.out / "mesh.vtu", *ISO)
        self.assert_fails(result, REFUSED, path.name, *words)


class ImageVoxels(ImageCase):
    """The same ellipsoid, by voxels of every shape."""

    def test_of_cubes_lie_where_the_file_says(self):
        values, affine = ellipsoid(oblique(CUBES))
        for name, data in (("cubes.nii", nifti(values.astype("f4"), affine)),
                           ("cubes.nrrd", nrrd(values.astype("f4"), affine)),
                           ("cubes.mha", meta(values.astype("f4"), affine))):
            with self.subTest(name):
                self.assert_is_the_ellipsoid(self.write(name, data), 0.5)

    def test_may_be_longer_than_they_are_wide(self):
        values, affine = ellipsoid(numpy.diag(CT))
        path = self.write("upright.nii", nifti(values.astype("f4"), affine))
        report = self.assert_is_the_ellipsoid(path, 0.4)
        self.assertAlmostEqual(report["spacing"], 0.4, places=6)

    def test_may_be_oblique_and_sheared(self):
        for shear in (0.0, 0.3):
            values, affine = ellipsoid(oblique(CT, shear=shear))
            with self.subTest(shear):
                path = self.write("oblique.nrrd", nrrd(values.astype("f4"), affine))
                self.assert_is_the_ellipsoid(path, 0.4)

    def test_may_be_left_handed(self):
        for edges in (CUBES, CT):
            values, affine = ellipsoid(oblique(edges, mirror=-1))
            with self.subTest(edges):
                self.assertLess(numpy.linalg.det(affine), 0)
                path = self.write("left.nii", nifti(values.astype("f4"), affine))
                self.assert_is_the_ellipsoid(path, edges[0])

    def test_that_differ_by_a_hundredth_are_taken_at_their_word(self):
        values, affine = ellipsoid(numpy.diag((0.5, 0.5, 0.505)))
        path = self.write("nearly.nrrd", nrrd(values.astype("f4"), affine))
        self.assert_is_the_ellipsoid(path, 0.5)

    def test_may_be_meshed_more_coarsely(self):
        values, affine = ellipsoid(oblique(CT))
        path = self.write("coarse.nii", nifti(values.astype("f4"), affine))
        self.assert_is_the_ellipsoid(path, 1.0, *ISO, "--spacing", "1")

    def test_of_both_sides_fill_the_image(self):
        values, affine = ellipsoid(numpy.diag(CT))
        path = self.write("both.nii", nifti(values.astype("f4"), affine))
        report = self.mesh_image(path, "--iso", "100", "--inside", "above", "--levels", "max",
                                 "--preset", "both-sides")
        mesh = read_mesh(self.out / "mesh.vtu")
        low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
        last = affine[:3, 3] + numpy.diag(CT) @ (numpy.array(values.shape) - 1)
        self.assertTrue(numpy.all(low <= affine[:3, 3]) and numpy.all(high >= last))
        self.assertGreater(report["min_dihedral_deg"], 9.3)

    def test_give_the_same_bytes_on_any_number_of_threads(self):
        values, affine = ellipsoid(oblique(CT))
        path = self.write("threads.nii", nifti(values.astype("f4"), affine))
        one, two = (self.mesh_bytes(path, *ISO, "--threads", threads) for threads in (1, 2))
        self.assertEqual(one, two)


class ImageJudges(ImageCase):
    """Other libraries say where an image lies in the world."""

    def test_nibabel_writes_what_is_read(self):
        import nibabel
        values, affine = ellipsoid(oblique(CT))
        for name, form in (("sform", "set_sform"), ("qform", "set_qform")):
            image = nibabel.Nifti1Image(numpy.round(values * 10).astype("i2"), affine)
            image.header.set_slope_inter(0.1, 0)
            image.set_sform(None, 0)
            image.set_qform(None, 0)
            getattr(image, form)(affine, 1)
            with self.subTest(name):
                plain, packed = (self.inputs / (name + ending) for ending in (".nii", ".nii.gz"))
                nibabel.save(image, plain)
                self.assert_is_the_ellipsoid(plain, 0.4)
                nibabel.save(image, packed)
                self.assertEqual((self.out / "mesh.vtu").read_bytes(), self.mesh_bytes(packed))
        image = nibabel.Nifti2Image(values.astype("f8"), affine)
        nibabel.save(image, self.inputs / "second.nii")
        self.assert_is_the_ellipsoid(self.inputs / "second.nii", 0.4)

    def test_vtk_writes_what_is_read(self):
        from vtkmodules.vtkIOCore import vtkZLibDataCompressor
        from vtkmodules.vtkIOXML import vtkXMLImageDataWriter
        values, affine = ellipsoid(numpy.diag(CT))
        image = vtk_image(values.astype("f4"), CT, affine[:3, 3])
        image.GetPointData().GetScalars().SetName("density")
        made = set()  # of all of them one mesh: whose points are the ellipsoid's
        for mode in ("Ascii", "Binary", "Appended"):
            for compressed in (False, True):
                for order in ("LittleEndian", "BigEndian"):
                    with self.subTest(f"{mode} {compressed} {order}"):
                        path = self.inputs / "vtk.vti"
                        writer = vtkXMLImageDataWriter()
                        writer.SetFileName(str(path))
                        writer.SetInputData(image)
                        getattr(writer, f"SetDataModeTo{mode}")()
                        getattr(writer, f"SetByteOrderTo{order}")()
                        writer.SetCompressor(vtkZLibDataCompressor() if compressed else None)
                        writer.Write()
                        made.add(self.mesh_bytes(path))
        self.assertEqual(len(made), 1)
        self.assert_is_the_ellipsoid(path, 0.4)

    def test_vtk_turns_an_image_as_its_file_says(self):
        from vtkmodules.vtkIOXML import vtkXMLImageDataWriter
        linear = oblique(CUBES)
        values, affine = ellipsoid(linear)
        image = vtk_image(values, CUBES, affine[:3, 3])
        image.SetDirectionMatrix(*(linear / CUBES[0]).reshape(-1))
        writer = vtkXMLImageDataWriter()
        writer.SetFileName(str(self.inputs / "turned.vti"))
        writer.SetInputData(image)
        writer.EncodeAppendedDataOff()
        writer.Write()
        self.assert_is_the_ellipsoid(self.inputs / "turned.vti", 0.5)

    def test_vtk_reads_the_same_meta_image(self):
        from vtkmodules.vtkIOImage import vtkMetaImageReader
        values, affine = ellipsoid(numpy.diag(CT))
        path = self.write("judged.mha", meta(values.astype("f4"), affine))
        reader = vtkMetaImageReader()
        reader.SetFileName(str(path))
        reader.Update()
        image = reader.GetOutput()
        numpy.testing.assert_allclose(image.GetOrigin(), affine[:3, 3])
        numpy.testing.assert_allclose(image.GetSpacing(), CT)
        self.assert_is_the_ellipsoid(path, 0.4)


class ImageFormats(ImageCase):
    """Every way of writing the same numbers is one mesh."""

    def assert_same(self, path, expected):
        self.assertEqual(self.mesh_bytes(path), expected)

    def test_of_all_types_and_both_orders_of_bytes(self):
        values, affine = ellipsoid(numpy.diag((1.0, 1.0, 1.0)), margin=1.5)
        whole = numpy.clip(numpy.round(values), 1, 127)
        expected = self.mesh_bytes(self.write("first.nrrd", nrrd(whole.astype("f4"), affine)))
        for code in NRRD_TYPES:
            for order in "<>":
                typed = whole.astype(code)
                for name, data in ((".nrrd", nrrd(typed, affine, order=order)),
                                   (".nii", nifti(typed, affine, order=order)),
                                   (".mha", meta(typed, affine, order=order))):
                    with self.subTest(f"{code} {order} {name}"):
                        self.assert_same(self.write("typed" + name, data), expected)

    def test_of_all_encodings(self):
        values, affine = ellipsoid(numpy.diag((1.0, 1.0, 1.0)), margin=1.5)
        whole = numpy.clip(numpy.round(values), 1, 127).astype("i2")
        expected = self.mesh_bytes(self.write("raw.nrrd", nrrd(whole, affine)))
        for name, data in (("gz.nrrd", nrrd(whole, affine, encoding="gzip")),
                           ("text.nrrd", nrrd(whole, affine, encoding="ascii")),
                           ("packed.nii.gz", gzip.compress(nifti(whole, affine))),
                           ("packed.mha", meta(whole, affine, compressed=True))):
            with self.subTest(name):
                self.assert_same(self.write(name, data), expected)

    def test_of_two_files_are_joined(self):
        values, affine = ellipsoid(numpy.diag((1.0, 1.0, 1.0)), margin=1.5)
        whole = numpy.clip(numpy.round(values), 1, 127).astype("i2")
        expected = self.mesh_bytes(self.write("one.nrrd", nrrd(whole, affine)))
        data = whole.astype("<i2").tobytes(order="F")
        self.write("part.raw", data)
        self.write("skipped.raw", b"12345" + data)
        self.write("part.raw.gz", gzip.compress(data))
        for z in range(whole.shape[2]):
            self.write(f"slice{z:03}.raw", whole[:, :, z].astype("<i2").tobytes(order="F"))
        count = whole.shape[2] - 1
        for name, header in (
                ("a.nhdr", nrrd(whole, affine, data_file="part.raw")),
                ("b.nhdr", nrrd(whole, affine, data_file="part.raw.gz", encoding="gzip")),
                ("c.nhdr", nrrd(whole, affine, data_file="skipped.raw", extra=["byte skip: 5"])),
                ("d.nhdr", nrrd(whole, affine, data_file="skipped.raw", extra=["byte skip: -1"])),
                ("e.nhdr", nrrd(whole, affine, data_file=f"slice%03d.raw 0 {count} 1")),
                ("f.mhd", meta(whole, affine, data_file="part.raw"))):
            with self.subTest(name):
                self.assert_same(self.write(name, header), expected)

    def test_that_would_be_read_wrong_are_refused(self):
        values, affine = ellipsoid(numpy.diag((1.0, 1.0, 1.0)), margin=1.5)
        whole = numpy.clip(numpy.round(values), 1, 127).astype("i2")
        self.write("skipped.raw.gz", gzip.compress(b"12345" + whole.astype("<i2").tobytes(order="F")))
        header = nrrd(whole, affine, data_file="skipped.raw.gz", encoding="gzip", extra=["byte skip: 5"])
        self.assert_refused(self.write("packed.nhdr", header), "5 bytes of its packed data are to be skipped", "unpack them")
        planes = nrrd(whole, affine).replace(b" (0.0,0.0,1.0)", b" none")
        self.assertIn(b" none", planes)
        self.assert_refused(self.write("planes.nrrd", planes), "directions for 2 axes",
                            f"an axis of {whole.shape[2]} without one")

    def test_reports_take_no_place_of_data_beside_a_header(self):
        values, affine = ellipsoid(numpy.diag((1.0, 1.0, 1.0)), margin=1.5)
        whole = numpy.clip(numpy.round(values), 1, 127).astype("i2")
        count = whole.shape[2]
        raw = self.write("part.raw", whole.astype("<i2").tobytes(order="F"))
        slices = [self.write(f"slice{z:03}.raw", whole[:, :, z].astype("<i2").tobytes(order="F"))
                  for z in range(count)]
        scene = self.write("scene.json", json.dumps({"nodes": [{"grid": {"name": "a.nhdr"}}]}).encode())
        one = self.write("a.nhdr", nrrd(whole, affine, data_file="part.raw"))
        many = self.write("b.nhdr", nrrd(whole, affine, data_file=f"slice%03d.raw 0 {count - 1} 1"))
        other = self.write("c.mhd", meta(whole, affine, data_file="part.raw"))
        for image, report in ((one, raw), (many, slices[7]), (other, raw), (scene, raw)):
            with self.subTest(image=image):
                before = report.read_bytes()
                self.assert_fails(self.tetstream("mesh", image, "-o", self.out / "m.vtu", "--report", report),
                                  REFUSED, "the report would take the place of", report.name)
                self.assertEqual(report.read_bytes(), before)

    def test_of_another_folder_are_not_followed(self):
        values, affine = ellipsoid(numpy.diag((1.0, 1.0, 1.0)), margin=1.5)
        for name in ("/etc/passwd", "../part.raw"):
            header = nrrd(values.astype("f4"), affine, data_file=name)
            self.assert_refused(self.write("far.nhdr", header), name, "beside it")
        (self.inputs / "link.raw").symlink_to("/etc/passwd")
        header = nrrd(values.astype("f4"), affine, data_file="link.raw")
        self.assert_refused(self.write("link.nhdr", header), "link.raw")

    def test_are_told_by_their_bytes_and_not_by_their_names(self):
        values, affine = ellipsoid(numpy.diag((1.0, 1.0, 1.0)), margin=1.5)
        self.assert_is_the_ellipsoid(self.write("odd.vdb", nifti(values.astype("f4"), affine)), 1)

    def test_of_numpy_are_indexed_by_x_y_z(self):
        values, _ = ellipsoid(numpy.diag((1.0, 1.0, 1.0)), margin=1.5)
        for name, array in (("c.npy", numpy.ascontiguousarray(values)),
                            ("f.npy", numpy.asfortranarray(values.astype(">f4")))):
            with self.subTest(name):
                numpy.save(self.inputs / name, array)
                self.mesh_bytes(self.inputs / name)
                box = read_mesh(self.out / "mesh.vtu").points
                extent = (box.max(axis=0) - box.min(axis=0)) / 2
                numpy.testing.assert_allclose(extent, SEMI_AXES, atol=0.2)

    def test_of_numpy_get_their_place_from_convert(self):
        values, affine = ellipsoid(numpy.diag(CT))
        numpy.save(self.inputs / "zyx.npy", values.transpose(2, 1, 0).astype(">f4"))
        image = self.inputs / "placed.nrrd"
        self.assert_done(self.tetstream(
            "convert", self.inputs / "zyx.npy", image, "--axes", "zyx", "--space", "RAS",
            "--spacing3", *CT, "--origin", *affine[:3, 3]))
        self.assert_is_the_ellipsoid(image, 0.4)
        self.assertIn("RAS", self.tetstream("info", image).stdout)
        converted = (self.out / "mesh.vtu").read_bytes()
        place = ("--axes", "zyx", "--spacing3", *CT, "--origin", *affine[:3, 3])
        self.assertEqual(self.mesh_bytes(self.inputs / "zyx.npy", *ISO, *place), converted)
        self.assert_done(self.tetstream("estimate", self.inputs / "zyx.npy", *ISO, *place))
        result = self.tetstream("mesh", image, "-o", self.out / "x.vtu", *place)
        self.assertEqual(result.returncode, REFUSED)
        self.assertIn("give an array (.npy) a place", result.stderr)
        for options, word in ((("--axes", "zyz"), "no order"), (("--space", "XYZ"), "neither"),
                              (("--spacing3", "1", "0", "1"), "no place")):
            result = self.tetstream("convert", self.inputs / "zyx.npy", self.out / "x.nrrd",
                                    *options)
            self.assertEqual(result.returncode, REFUSED)
            self.assertIn(word, result.stderr)
            self.assertFalse((self.out / "x.nrrd").exists())


class ImageInfo(ImageCase):
    """What `info` says of an image."""

    def info(self, path):
        result = self.tetstream("info", path, "--json")
        self.assert_done(result)
        (grid,) = json.loads(result.stdout)
        return grid

    def test_has_its_voxels_axes_and_values(self):
        values, affine = ellipsoid(oblique(CT, turn=0.1))
        affine[0] *= -1
        scan = self.write("scan.nii", nifti(values.astype("f4"), affine))
        grid = self.info(scan)
        self.assertIn("NIfTI", grid["place"])
        self.assertIn("0.4 x 0.4 x 0.8", grid["place"])
        self.assertIn("run to LAS, coordinates are RAS in mm", grid["place"])
        self.assertAlmostEqual(grid["values"]["max"], 200, delta=2)
        affine[:2] *= -1
        same = self.info(self.write("same.nrrd", nrrd(values.astype("f4"), affine,
                                                      space="left-posterior-superior")))
        self.assertIn("run to LAS, coordinates are LPS", same["place"])
        self.assertIn("0.4 x 0.4 x 0.8", self.tetstream("info", scan).stdout)

    def test_agrees_with_nibabel_on_the_axes(self):
        import nibabel
        generator = numpy.random.default_rng(7)
        for _ in range(8):
            order, signs = generator.permutation(3), generator.choice([-1.0, 1.0], 3)
            affine = numpy.eye(4)
            affine[:3, :3] = (oblique((1, 1, 1), turn=0.2)[:, order] * signs) @ numpy.diag(CT)
            values = numpy.arange(24, dtype="i2").reshape(2, 3, 4)
            path = self.inputs / "axes.nii"
            nibabel.save(nibabel.Nifti1Image(values, affine), path)
            self.assertIn("run to " + "".join(nibabel.aff2axcodes(affine)),
                          self.info(path)["place"])

    def test_counts_labels(self):
        labels = numpy.zeros((20, 21, 22), dtype="u2")
        labels[3:9, 4:8, 5:7] = 7
        labels[12:15, 12:16, 9:14] = 14015
        grid = self.info(self.write("labels.nrrd", nrrd(labels, numpy.eye(4))))
        known = {entry["label"]: entry["voxels"] for entry in grid["labels"]}
        self.assertEqual(known, {0: labels.size - 48 - 60, 7: 48, 14015: 60})
        boxes = {entry["label"]: (entry["box"]["min"], entry["box"]["max"]) for entry in grid["labels"]}
        self.assertEqual(boxes, {0: ([0, 0, 0], [19, 20, 21]), 7: ([3, 4, 5], [8, 7, 6]),
                                 14015: ([12, 12, 9], [14, 15, 13])})
        shown = self.tetstream("info", self.inputs / "labels.nrrd").stdout
        self.assertIn("3 labels (voxels): 0 (", shown)

    def test_of_a_left_handed_world_says_how_it_is_turned(self):
        values, affine = ellipsoid(numpy.diag(CT))
        affine[0] *= -1
        path = self.write("las.nrrd", nrrd(values.astype("f4"), affine,
                                           space="left-anterior-superior"))
        self.assertIn("left-handed: x is turned round", self.info(path)["place"])
        self.assert_is_the_ellipsoid(path, 0.4)


class ImageRefusals(ImageCase):
    """What is wrong with an image is said, with what to do."""

    def test_tell_the_values_where_nothing_is_inside(self):
        for edges in (CUBES, CT):
            values, affine = ellipsoid(numpy.diag(edges))
            path = self.write("far.nii", nifti(values.astype("f4"), affine))
            result = self.tetstream("mesh", path, "-o", self.out / "mesh.vtu", "--iso", "500",
                                    "--inside", "above")
            self.assert_fails(result, REFUSED, "nothing is inside at iso 500", "values are from",
                              "--inside")

    def test_are_of_files_that_are_cut_or_broken(self):
        values, affine = ellipsoid(numpy.diag((1.0, 1.0, 1.0)), margin=1.5)
        floats = values.astype("f4")
        for name, data in (("cut.nii", nifti(floats, affine)[:-1]),
                           ("cut.nrrd", nrrd(floats, affine)[:-1]),
                           ("cut.mha", meta(floats, affine)[:-1]),
                           ("cut.nii.gz", gzip.compress(nifti(floats, affine))[:-9]),
                           ("cutgz.nrrd", nrrd(floats, affine, encoding="gzip")[:-30]),
                           ("cut2.mha", meta(floats, affine, compressed=True)[:-30])):
            with self.subTest(name):
                self.assert_refused(self.write(name, data), "is not a readable image")

    def test_are_of_more_than_three_dimensions(self):
        import nibabel
        for shape in ((4, 4, 4, 2), (4, 4, 4, 1, 3)):
            nibabel.save(nibabel.Nifti1Image(numpy.zeros(shape, "f4"), numpy.eye(4)),
                         self.inputs / "time.nii")
            self.assert_refused(self.inputs / "time.nii", "more than 3 dimensions",
                                "write one volume of it")

    def test_are_of_voxels_without_a_size(self):
        values, affine = ellipsoid(numpy.diag((1.0, 1.0, 1.0)), margin=1.5)
        for step, word in ((0.0, "not usable"), (1e-5, "times the shortest")):
            flat = affine.copy()
            flat[2, 2] = step
            self.assert_refused(self.write("flat.nrrd", nrrd(values.astype("f4"), flat)), word)

    def test_are_of_numbers_that_are_none(self):
        values, affine = ellipsoid(numpy.diag((1.0, 1.0, 1.0)), margin=1.5)
        values[3, 4, 5] = math.nan
        self.assert_refused(self.write("nan.nii", nifti(values.astype("f4"), affine)),
                            "1 of its", "(3, 4, 5)", "nan_to_num")

    def test_are_of_sizes_that_nothing_holds(self):
        header = nrrd(numpy.zeros((2, 2, 2), "f4"), numpy.eye(4))
        for sizes in (b"100000 100000 100000", b"2000000000 1 1", b"-1 2 2", b"0 2 2"):
            path = self.write("huge.nrrd", header.replace(b"sizes: 2 2 2", b"sizes: " + sizes))
            self.assert_refused(path, "is not a readable image")


class ImagesServed(ServerTest):
    """An image goes up as it is, and the mesh that comes back is the one of this machine."""

    volumes = {}

    def test_are_told_of_as_here(self):
        labels = numpy.zeros((20, 21, 22), dtype="u2")
        labels[3:9, 4:8, 5:7] = 7
        values, affine = ellipsoid(oblique(CT))
        for name, data in (("labels.nrrd", nrrd(labels, numpy.eye(4))),
                           ("scan.nii.gz", gzip.compress(nifti(values.astype("f4"), affine)))):
            path = self.inputs / name
            path.write_bytes(data)
            for options in ((), ("--json",), ("--no-values", "--json")):
                with self.subTest(name, options=options):
                    here = self.tetstream("info", path, *options)
                    self.assert_done(here)
                    there = self.tetstream("info", path, *options, "--server", self.address)
                    self.assert_done(there)
                    self.assertEqual(there.stdout, here.stdout)

    def test_are_meshed_as_they_are_here(self):
        values, affine = ellipsoid(oblique(CT))
        raw = values.astype("<f4").tobytes(order="F")
        files = {"scan.nii.gz": gzip.compress(nifti(values.astype("f4"), affine)),
                 "scan.nrrd": nrrd(values.astype("f4"), affine, encoding="gzip"),
                 "scan.raw": raw,
                 "scan.nhdr": nrrd(values.astype("f4"), affine, data_file="scan.raw")}
        for name, data in files.items():
            (self.inputs / name).write_bytes(data)
        for name in ("scan.nii.gz", "scan.nrrd", "scan.nhdr"):
            with self.subTest(name):
                here, there = self.out / "here.vtu", self.out / "there.vtu"
                for path, options in ((here, ()), (there, ("--server", self.address))):
                    result = self.tetstream("mesh", self.inputs / name, "-o", path, *ISO,
                                            *options)
                    self.assertEqual(result.returncode, 0, result.stderr)
                self.assertEqual(here.read_bytes(), there.read_bytes())

    def test_are_refused_there_with_the_same_words(self):
        (self.inputs / "cut.nrrd").write_bytes(
            nrrd(numpy.zeros((9, 9, 9), "f4"), numpy.eye(4))[:-5])
        result = self.tetstream("mesh", self.inputs / "cut.nrrd", "-o", self.out / "m.vtu",
                                *ISO, "--server", self.address)
        self.assertNotEqual(result.returncode, 0)
        self.assertIn("truncated", result.stderr)


if __name__ == "__main__":
    unittest.main()
