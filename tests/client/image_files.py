"""Images for tests, written byte by byte: no reader of ours has a say in them."""

import gzip
import struct
import zlib

import numpy

NRRD_TYPES = {"i1": "int8", "u1": "uint8", "i2": "int16", "u2": "uint16", "i4": "int32",
              "u4": "uint32", "i8": "int64", "u8": "uint64", "f4": "float", "f8": "double"}
META_TYPES = {"i1": "MET_CHAR", "u1": "MET_UCHAR", "i2": "MET_SHORT", "u2": "MET_USHORT",
              "i4": "MET_INT", "u4": "MET_UINT", "i8": "MET_LONG_LONG",
              "u8": "MET_ULONG_LONG", "f4": "MET_FLOAT", "f8": "MET_DOUBLE"}
NIFTI_TYPES = {"i1": 256, "u1": 2, "i2": 4, "u2": 512, "i4": 8, "u4": 768, "i8": 1024,
               "u8": 1280, "f4": 16, "f8": 64}

SEMI_AXES = (9.0, 7.0, 5.0)
CENTRE = (31.0, -17.0, 4.5)


def oblique(edges, turn=0.3, shear=0.0, mirror=1):
    """Columns are steps along the axes of an image, turned about a slanted axis."""
    axis = numpy.array([1.0, 2.0, 3.0]) / numpy.sqrt(14)
    cross = numpy.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    rotation = numpy.eye(3) + numpy.sin(turn) * cross + (1 - numpy.cos(turn)) * cross @ cross
    sheared = numpy.array([[1, shear, 0], [0, 1, 0], [0, 0, mirror]])
    return rotation @ sheared @ numpy.diag(edges)


def ellipsoid(linear, margin=3.0):
    """Values [x][y][z] of an image around an ellipsoid, 100 at its surface, and the affine that
    leads to the world."""
    reach = numpy.linalg.inv(linear)
    half = [numpy.ceil(sum(abs(reach[i, k]) * (max(SEMI_AXES) + margin) for k in range(3)))
            for i in range(3)]
    size = [int(2 * h + 1) for h in half]
    affine = numpy.eye(4)
    affine[:3, :3] = linear
    affine[:3, 3] = numpy.array(CENTRE) - linear @ numpy.array(half)
    voxels = numpy.stack(numpy.meshgrid(*map(numpy.arange, size), indexing="ij"))
    world = numpy.tensordot(linear, voxels, 1) + affine[:3, 3].reshape(3, 1, 1, 1)
    away = [(world[i] - CENTRE[i]) / SEMI_AXES[i] for i in range(3)]
    radius = numpy.sqrt(sum(a * a for a in away))
    return 100 + 100 * (1 - radius), affine


def nifti(values, affine, slope=0.0, intercept=0.0, order="<", form="sform"):
    header = bytearray(352)
    code = values.dtype.str[1:]
    struct.pack_into(order + "i", header, 0, 348)
    struct.pack_into(order + "8h", header, 40, 3, *values.shape, 1, 1, 1, 1)
    struct.pack_into(order + "2h", header, 70, NIFTI_TYPES[code], 8 * values.dtype.itemsize)
    edges = numpy.linalg.norm(affine[:3, :3], axis=0)
    struct.pack_into(order + "4f", header, 76, 1.0, *edges)
    struct.pack_into(order + "3f", header, 108, 352.0, slope, intercept)
    header[123] = 2
    struct.pack_into(order + "2h", header, 252, 0, 1 if form == "sform" else 0)
    struct.pack_into(order + "12f", header, 280, *affine[:3].reshape(-1))
    header[344:348] = b"n+1\0"
    return bytes(header) + values.astype(order + code).tobytes(order="F")


def nrrd(values, affine, space="right-anterior-superior", encoding="raw", order="<", extra=(),
         data_file=None):
    code = values.dtype.str[1:]
    steps = " ".join(f"({','.join(repr(float(v)) for v in affine[:3, i])})" for i in range(3))
    lines = ["NRRD0004", "# by hand", f"type: {NRRD_TYPES[code]}", "dimension: 3",
             f"sizes: {' '.join(map(str, values.shape))}",
             f"endian: {'little' if order == '<' else 'big'}", f"encoding: {encoding}"]
    if space:
        lines += [f"space: {space}", f"space directions: {steps}",
                  f"space origin: ({','.join(repr(float(v)) for v in affine[:3, 3])})"]
    lines += [*extra]
    if data_file:
        return ("\n".join([*lines, f"data file: {data_file}"]) + "\n").encode()
    return ("\n".join(lines) + "\n\n").encode() + encoded(values, encoding, order)


def encoded(values, encoding, order):
    data = values.astype(order + values.dtype.str[1:]).tobytes(order="F")
    if encoding == "gzip":
        return gzip.compress(data, mtime=0)
    if encoding == "ascii":
        return " ".join(map(repr, values.reshape(-1, order="F").tolist())).encode()
    return data


def meta(values, affine, order="<", compressed=False, data_file="LOCAL"):
    code = values.dtype.str[1:]
    edges = numpy.linalg.norm(affine[:3, :3], axis=0)
    directions = (affine[:3, :3] / edges).T.reshape(-1)  # a line for each of the image's axes
    data = values.astype(order + code).tobytes(order="F")
    if compressed:
        data = zlib.compress(data)
    lines = ["ObjectType = Image", "NDims = 3", "BinaryData = True",
             f"BinaryDataByteOrderMSB = {order == '>'}", f"CompressedData = {compressed}",
             f"TransformMatrix = {' '.join(repr(float(v)) for v in directions)}",
             f"Offset = {' '.join(repr(float(v)) for v in affine[:3, 3])}",
             f"ElementSpacing = {' '.join(repr(float(v)) for v in edges)}",
             f"DimSize = {' '.join(map(str, values.shape))}",
             f"ElementType = {META_TYPES[code]}", f"ElementDataFile = {data_file}"]
    header = ("\n".join(lines) + "\n").encode()
    return header + data if data_file == "LOCAL" else header
