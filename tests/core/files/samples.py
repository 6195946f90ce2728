"""The meshes that write_samples makes: what they hold, and the files that they became."""

import json
import pathlib
import re
import subprocess
import tempfile
import unittest

import numpy

# Coordinates as files have them whose type may be either.
SAMPLES = {
    "one": numpy.float32,
    "near": numpy.float32,
    "moved": numpy.float32,
    "far": numpy.float64,
    "wide": numpy.float64,
    "blocks": numpy.float64,
    "sides": numpy.float32,
    "half": numpy.float32,
    "outside": numpy.float32,
    "field": numpy.float32,
    "fields": numpy.float32,
    "parts": numpy.float32,
    "tissues": numpy.float32,
}
# Of second order: tets have ten nodes, and faces six.
SECOND_SAMPLES = {
    "second_one": numpy.float32,
    "second_far": numpy.float64,
    "second_sides": numpy.float32,
    "second_field": numpy.float64,
    "second_parts": numpy.float32,
}
# Of the sample "parts", as the mesh has them.
PART_NAMES = ['femur "left"', "a/b <c> & d"]


# The labels of regions and parts, by their names as plain() has them.
LABELS = {"inside": 1, "outside": 2, "femur__left_": 1, "a_b__c____d": 2, "bone": 4, "label_7": 7,
          "fat_skin": 9}


def plain(name):
    """As formats have a name that take letters, digits and underscores."""
    name = re.sub(r"\W", "_", name, flags=re.ASCII)
    return name if name[:1].isalpha() else "n" + name


class Read:
    """What a reader found. Nothing of what a format has no place for."""

    def __init__(self, points, tets=None, labels=None, faces=None, fields=None):
        self.points, self.tets, self.labels = points, tets, labels
        self.faces, self.fields = faces or {}, fields or {}


def volumes(points, tets):
    a, b, c, d = (points[tets[:, k]].astype(float) for k in range(4))
    return numpy.einsum("ij,ij->i", b - a, numpy.cross(c - a, d - a)) / 6


def sorted_triangles(triangles):
    """Each from its least vertex on, turned as it was, in an order of their own. Of six nodes the middles, from each
    corner to the next, are turned, too."""
    triangles = numpy.asarray(triangles)
    rows, first = numpy.arange(len(triangles)), triangles[:, :3].argmin(axis=1)
    turned = numpy.stack([triangles[rows, begin + (first + k) % 3]
                          for begin in range(0, triangles.shape[1], 3) for k in range(3)], 1)
    return turned[numpy.lexsort(turned.T)]


class SampleTest(unittest.TestCase):
    """`write_samples` is set by whoever runs the tests."""

    write_samples = None

    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        cls.directory = pathlib.Path(scratch.name)
        subprocess.run([cls.write_samples, cls.directory], check=True)
        cls.formats = json.loads((cls.directory / "formats.json").read_text())
        cls.samples = {}

    def expected(self, name):
        """Read once, and shared: for looking at."""
        if name not in self.samples:
            self.samples[name] = self.read_expected(name)
        return self.samples[name]

    def read_expected(self, name):
        sample = json.loads((self.directory / f"{name}.json").read_text())
        for key in ("points", "tets", "regions", "parts"):
            sample[key] = numpy.array(sample[key])
        sample["labels"] = sample["parts"] if len(sample["parts"]) else sample["regions"]
        sample["faces"] = {label: numpy.array(rows) for label, rows in sample["faces"].items()}
        sample["fields"] = {label: numpy.array(rows, dtype=numpy.float32).squeeze(axis=1)
                            if len(rows[0]) == 1 else numpy.array(rows, dtype=numpy.float32)
                            for label, rows in sample["fields"].items()}
        return sample
