"""Reports of the tetstream command and pages of them, in its own process and on a server.

    TETSTREAM_BIN=build/dev/bin python3 tests/client/cli_report_test.py [unittest options]
"""

import json
import math
import unittest
import xml.dom.minidom

from command_case import REFUSED, USAGE, CommandTest, ServerTest


class Reports(CommandTest):
    volumes = {"sphere": 0.1}

    def report(self, *options):
        path = self.out / "report.json"
        self.assert_done(self.mesh("sphere.vdb", ".vtu", "--report", path, *options))
        return json.loads(path.read_text())

    def test_tell_shapes_and_how_true_the_surface_is(self):
        told = self.report()
        self.assertEqual(sum(told["shapes"]["radius_ratio"]["histogram"]), told["tets"])
        self.assertEqual(sum(told["shapes"]["edge_lengths"]["histogram"]), 6 * told["tets"])
        fidelity = told["fidelity"]
        self.assertAlmostEqual(fidelity["mesh_volume"], told["volume"], delta=1e-6)
        self.assertAlmostEqual(fidelity["enclosed_volume"], 4 / 3 * math.pi, delta=0.03)
        self.assertLess(fidelity["mesh_to_surface"]["rms"], fidelity["hausdorff"])
        self.assertLess(fidelity["hausdorff_spacings"], 0.2)
        self.assertIn("checking", told["stages"])

    def test_become_a_page_that_needs_nothing_else(self):
        self.report()
        page = self.out / "report.html"
        self.assert_done(self.tetstream("report", self.out / "report.json", "-o", page,
                                        "--title", "a <sphere>"))
        text = page.read_text(encoding="utf-8")
        self.assertIn("a &lt;sphere&gt;", text)
        self.assertNotIn("http", text)
        for drawing in text.split("<svg")[1:]:
            xml.dom.minidom.parseString("<svg" + drawing.split("</svg>")[0] + "</svg>")

    def test_stay_where_their_page_would_take_their_place(self):
        self.report()
        report = self.out / "report.json"
        before = report.read_bytes()
        result = self.tetstream("report", report, "-o", report)
        self.assertEqual(result.returncode, REFUSED, result.stderr)
        self.assertIn("take the place of", result.stderr)
        self.assertEqual(report.read_bytes(), before)

    def test_are_refused_where_there_is_none(self):
        page = self.out / "page.html"
        mesh = self.inputs / "sphere.vdb"
        self.assert_fails(self.tetstream("report", mesh, "-o", page), REFUSED, "--report")
        self.assert_fails(self.tetstream("report", self.out / "none.json", "-o", page), REFUSED,
                          "none.json")
        self.assert_fails(self.tetstream("report", mesh), USAGE, "--output")
        self.assert_nothing_written()


class ReportsOnAServer(ServerTest):
    volumes = {"sphere": 0.1}

    def test_are_those_of_meshes_made_here(self):
        told = []
        for options in ((), ("--server", self.address)):
            path = self.out / "report.json"
            self.assert_done(self.mesh("sphere.vdb", ".vtu", "--report", path, *options))
            told.append(json.loads(path.read_text()))
        self.assertEqual(told[0]["fidelity"], told[1]["fidelity"])
        self.assertEqual(told[0]["shapes"], told[1]["shapes"])


if __name__ == "__main__":
    unittest.main()
