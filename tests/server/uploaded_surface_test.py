"""Files of triangles, uploaded to a real server as its page does, and meshed there.

    TETSTREAM_BIN=build/release/bin python3 tests/server/uploaded_surface_test.py [unittest options]
"""

import hashlib
import itertools
import struct
import unittest

from http_case import HttpTest, field


def box(low, high):
    """Triangles of a box, wound outwards."""
    corners = [tuple((low, high)[bit][axis] for axis, bit in enumerate(bits))
               for bits in itertools.product((0, 1), repeat=3)]
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return [tuple(corners[i] for i in corner) for a, b, c, d in quads for corner in ((a, b, c), (a, c, d))]


def binary_stl(triangles):
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *itertools.chain(*t), 0) for t in triangles)
    return struct.pack("<80sI", b"solid by a test", len(triangles)) + body


class UploadedSurfaces(HttpTest):
    def upload(self, data):
        """The grid's path over HTTP."""
        digest = hashlib.sha256(data).hexdigest()
        status, _, body = self.ask("PUT", f"/v1/grids/{digest}", data)
        self.assertEqual(status, 200, body)
        return f"grids/{digest}"

    def test_are_solids_as_fine_as_their_walls_need(self):
        name = self.upload(binary_stl(box((0, 0, 0), (4, 2, 1))))
        status, file = self.json("GET", f"/v1/{name}")
        self.assertEqual(status, 200, file)
        [grid] = file["grids"]
        self.assertEqual((grid["name"], grid["gridClass"]), ("surface", "level set"))
        self.assertAlmostEqual(grid["voxelSize"], 4 / 128)
        self.assertIn("8 vertices, 12 triangles", grid["madeOf"])
        status, header = self.json("POST", "/v1/meshes:estimate", {"mesh": {"name": name}})
        self.assertEqual(status, 200, header)
        self.assertGreater(int(header["tetCount"]), 10_000)
        messages, trailers = self.call("MeshService/StreamMesh", field(1, field(1, name.encode())))
        self.assertEqual(trailers["grpc-status"], "0", trailers)
        self.assertGreater(len(messages), 2)

    def test_that_are_open_are_refused_with_what_to_do(self):
        name = self.upload(binary_stl(box((0, 0, 0), (1, 1, 1))[2:]))
        status, answer = self.json("GET", f"/v1/{name}")
        self.assertEqual(status, 400, answer)
        self.assertIn("the surface is not closed", answer["error"]["message"])
        self.assertIn("`tetstream convert`", answer["error"]["message"])

    def test_that_are_broken_do_no_harm(self):
        for data in (b"v 0 0 0\nf 1 2 3\n", b"solid a\nfacet\n" * 1000, b"ply\nformat ascii 1.0\n",
                     binary_stl(box((0, 0, 0), (0, 1, 1))), binary_stl(box((-3e38,) * 3, (3e38,) * 3))):
            name = self.upload(data)
            status, answer = self.json("GET", f"/v1/{name}")
            self.assertIn(status, (200, 400), answer)
        self.test_are_solids_as_fine_as_their_walls_need()


if __name__ == "__main__":
    unittest.main()
