"""Reads packed chunks by docs/wire_format.md alone: what is written there is enough.

The chunks are what the fuzzer starts from: four numbers (flags, first vertex, vertices, tets) and
the packed bytes of a whole mesh of one chunk.
"""
import pathlib
import struct
import unittest

CHUNKS = pathlib.Path(__file__).parents[2] / "fuzz/corpus/packed_chunk_fuzz"
DOUBLES, WIDE_IDS, HAS_REGIONS = 1, 2, 4


class Reader:
    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, size):
        self.at += size
        assert self.at <= len(self.data)
        return self.data[self.at - size:self.at]

    def number(self, size):
        return int.from_bytes(self.take(size), "little")

    def varint(self):
        value = shift = 0
        while True:
            byte = self.number(1)
            value |= (byte & 0x7f) << shift
            shift += 7
            if byte < 0x80:
                return value

    def patterns(self, count):
        """The pattern of each row."""
        listed = [self.number(2) for _ in range(self.varint())]
        return [listed[row] for row in self.take(count)]


def read_vertices(reader, count, size):
    rows = [(0, 0, 0)] * 4
    for pattern in reader.patterns(count):
        row = []
        for c in range(3):
            kind, pattern = pattern % 8, pattern // 8
            before = rows[-1][c]
            if kind < 4:
                row.append(rows[-1 - kind][c])
            elif kind == 4:
                row.append(reader.number(size // 2) << 4 * size)
            elif kind == 5:
                step = reader.number(size // 2) - (1 << 4 * size - 1)
                row.append((before + step) % (1 << 8 * size))
            elif kind == 6:
                row.append(before >> 6 * size << 6 * size | reader.number(size // 4 * 3))
            else:
                row.append(reader.number(size))
        rows.append(tuple(row))
    bits, real = ("<3Q", "<3d") if size == 8 else ("<3I", "<3f")
    return [struct.unpack(real, struct.pack(bits, *row)) for row in rows[4:]]


def read_tets(reader, count):
    at, jumped_from, tets = [0] * 4, [0] * 4, []
    for pattern in reader.patterns(count):
        for k in range(4):
            kind, pattern, was = pattern % 6, pattern // 6, at[k]
            if kind < 3:
                at[k] += kind
            elif kind == 3:
                at[k] += reader.number(1) - 128
            elif kind == 4:
                at[k] = jumped_from[k] + reader.number(1) - 128
            else:
                at[k] += reader.number(2)
            at[k] %= 1 << 16
            if kind > 3:
                jumped_from[k] = was
        tets.append(tuple(at))
    return tets


def read_chunk(path):
    data = path.read_bytes()
    flags, first_vertex, vertex_count, tet_count = struct.unpack("<4H", data[:8])
    reader = Reader(data[8:])
    ids = list(range(first_vertex, first_vertex + vertex_count))
    last = 0
    for _ in range(reader.varint()):
        last += reader.varint()
        ids.append(last)
    vertices = read_vertices(reader, vertex_count, 8 if flags & DOUBLES else 4)
    tets = [tuple(ids[corner] for corner in tet) for tet in read_tets(reader, tet_count)]
    bits = reader.take((tet_count + 7) // 8 if flags & HAS_REGIONS else 0)
    regions = [1 + (byte >> i & 1) for byte in bits for i in range(8)][:tet_count]
    reader.take(16)
    assert reader.at == len(reader.data)
    return vertices, tets, regions


def six_volumes(vertices, tets):
    for tet in tets:
        a, b, c, d = (vertices[i] for i in tet)
        u, v, w = ([p[i] - a[i] for i in range(3)] for p in (b, c, d))
        yield (u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0])
               + u[2] * (v[0] * w[1] - v[1] * w[0]))


class PackedReader(unittest.TestCase):
    def test_reads_meshes_whose_every_tet_is_positive(self):
        meshes = {}
        for name in ("ball", "ball-wide", "ball-both-sides"):
            vertices, tets, regions = meshes[name] = read_chunk(CHUNKS / name)
            self.assertEqual({i for tet in tets for i in tet}, set(range(len(vertices))))
            self.assertGreater(min(six_volumes(vertices, tets)), 0)
            self.assertEqual(set(regions), {1, 2} if name.endswith("sides") else set())
        # The same ball, in doubles: its tets are the same, and its vertices but for rounding.
        (vertices, tets, _), (wide, same_tets, _) = meshes["ball"], meshes["ball-wide"]
        self.assertEqual(tets, same_tets)
        for row, wide_row in zip(vertices, wide):
            self.assertEqual(row, struct.unpack("<3f", struct.pack("<3f", *wide_row)))


if __name__ == "__main__":
    unittest.main(verbosity=2)
