#!/usr/bin/python3
"""Writes the images of this folder, and the fuzzer's seeds: small ones, each with one lie.

    tests/data/hostile_image/make_files.py
"""

import gzip
import pathlib
import struct
import sys
import zlib

import numpy

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent.parent / "client"))

from image_files import meta, nifti, nrrd  # noqa: E402

VALUES = numpy.arange(24, dtype="i2").reshape(4, 3, 2) - 7
AFFINE = numpy.array([[0.5, 0, 0, 3], [0, 0.5, 0, -4], [0, 0, 1.5, 5], [0, 0, 0, 1.0]])
NIFTI, NRRD, META = nifti(VALUES, AFFINE), nrrd(VALUES, AFFINE), meta(VALUES, AFFINE)


def numpy_file(descr="'<i2'", shape="(4, 3, 2)", order="False", data=VALUES.tobytes()):
    text = f"{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}\n".encode()
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text + data


def vti(array='type="Int16" Name="a" format="ascii"', data=None, extent="0 3 0 2 0 1",
        head="", rest="", spacing="0.5 0.5 1.5"):
    text = " ".join(map(str, VALUES.reshape(-1, order="F"))) if data is None else data
    return (f'<?xml version="1.0"?>\n<VTKFile type="ImageData" version="1.0" '
            f'byte_order="LittleEndian" header_type="UInt32"{head}>\n<ImageData WholeExtent='
            f'"{extent}" Origin="3 -4 5" Spacing="{spacing}"><Piece Extent="{extent}"><PointData>'
            f'<DataArray {array}>{text}</DataArray></PointData></Piece></ImageData>{rest}'
            f'</VTKFile>\n').encode()


def at(data, offset, form, *numbers):
    changed = bytearray(data)
    struct.pack_into("<" + form, changed, offset, *numbers)
    return bytes(changed)


def blocks(count=1, size=48, last=0, packed=None):
    data = zlib.compress(VALUES.tobytes(order="F"))
    header = struct.pack("<4I", count, size, last, len(data) if packed is None else packed)
    return header + data


RAW = 'type="Int16" Name="a" format="appended" offset="0"'


def appended(data, array=RAW, head=' compressor="vtkZLibDataCompressor"'):
    whole = vti(array, "", head=head)
    end = whole.index(b"</VTKFile>")
    return (whole[:end] + b'<AppendedData encoding="raw">_' + data + b"</AppendedData>\n" +
            whole[end:])


GOOD = {
    "good.nii": NIFTI, "good.nrrd": NRRD, "good.mha": META, "good.npy": numpy_file(),
    "good.vti": vti(), "blocks.vti": appended(blocks()), "good.nii.gz": gzip.compress(NIFTI, mtime=0),
    "gz_members.nii.gz": b"".join(gzip.compress(part, mtime=0)
                                  for part in (NIFTI[:200], NIFTI[200:370], NIFTI[370:], b"")),
    "gz.nrrd": nrrd(VALUES, AFFINE, encoding="gzip"), "big.nii": nifti(VALUES, AFFINE, order=">"),
    "zlib.mha": meta(VALUES, AFFINE, compressed=True),
    "text.nrrd": nrrd(VALUES, AFFINE, encoding="ascii"),
}

BAD = {
    "header_cut.nii": (NIFTI[:347], "no image"),
    "data_cut.nii": (NIFTI[:-1], "it is truncated"),
    "dimensions.nii": (at(NIFTI, 40, "h", 9), "it has 9 dimensions"),
    "negative_size.nii": (at(NIFTI, 42, "h", -4), "no axis may be that short"),
    "four_dimensions.nii": (at(NIFTI, 40, "5h", 4, 2, 2, 2, 3), "more than 3 dimensions"),
    "colours.nii": (at(NIFTI, 70, "2h", 128, 24), "colours"),
    "bits.nii": (at(NIFTI, 72, "h", 64), "are said to have 64 bits"),
    "offset_nan.nii": (at(NIFTI, 108, "f", float("nan")), "vox_offset is nan"),
    "offset_far.nii": (at(NIFTI, 108, "f", 1e30), "begin at byte 1e+30"),
    "offset_before.nii": (at(NIFTI, 108, "f", 8), "begin at byte 8"),
    "sform_nan.nii": (at(NIFTI, 280, "f", float("nan")), "sform is nan"),
    "sform_zero.nii": (at(NIFTI, 280, "12f", *[0] * 12), "not usable"),
    "flat.nii": (at(NIFTI, 280, "12f", 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0), "sheared flat"),
    "quaternion.nii": (at(at(NIFTI, 252, "2h", 1, 0), 256, "3f", 1, 1, 1), "longer than 1"),
    "pair.nii": (at(NIFTI, 344, "4s", b"ni1\0"), "in another file"),
    "analyze.nii": (at(NIFTI, 344, "4s", b"\0\0\0\0"), "Analyze"),
    "scaled_away.nii": (at(NIFTI, 112, "2f", 3e38, 0), "no finite floats"),
    "not_nifti.nii.gz": (gzip.compress(b"hello" * 200, mtime=0), "only NIfTI"),
    "claims_much.nii.gz": (gzip.compress(NIFTI, mtime=0)[:-4] + b"\xff\xff\xff\xff",
                           "more than gzip can have packed"),
    "cut.nii.gz": (gzip.compress(NIFTI, mtime=0)[:-12] + struct.pack("<I", len(NIFTI)), "broken"),
    "cut_members.nii.gz": (gzip.compress(NIFTI[:370], mtime=0) + gzip.compress(b"", mtime=0),
                           "it is truncated"),
    "short.nii.gz": (gzip.compress(NIFTI[:-1], mtime=0), "it is truncated"),
    "longer.nii.gz": (gzip.compress(NIFTI + b"0", mtime=0), "unpacks to more"),
    "followed.nii.gz": (gzip.compress(NIFTI, mtime=0) + b"\0" * 8, "foreign bytes"),
    "gz_far.nii.gz": (gzip.compress(at(NIFTI, 40, "4h", 3, 5000, 5000, 5000), mtime=0),
                      "it is truncated"),
    "no_end.nrrd": (NRRD[:60], "its header has no end"),
    "no_type.nrrd": (NRRD.replace(b"type: int16\n", b""), "no field 'type'"),
    "block_type.nrrd": (NRRD.replace(b"int16", b"block"), "of the type 'block'"),
    "twice.nrrd": (NRRD.replace(b"dimension: 3\n", b"dimension: 3\ndimension: 3\n"), "twice"),
    "sizes.nrrd": (NRRD.replace(b"sizes: 4 3 2", b"sizes: 4 3"), "it has 2 sizes"),
    "sizes_huge.nrrd": (NRRD.replace(b"sizes: 4 3 2", b"sizes: 99999 99999 99999"),
                        "are not read"),
    "sizes_overflow.nrrd": (NRRD.replace(b"sizes: 4 3 2", b"sizes: 4294967297 4294967297 1"),
                            "are not read"),
    "sizes_text.nrrd": (NRRD.replace(b"sizes: 4 3 2", b"sizes: 4 3 two"), "no integer"),
    "vectors.nrrd": (NRRD.replace(b"dimension: 3", b"dimension: 4").replace(
        b"sizes: 4", b"sizes: 3 4").replace(b"directions: ", b"directions: none "),
        "have 3 values each"),
    "space_time.nrrd": (NRRD.replace(b"right-anterior-superior", b"right-anterior-superior-time"),
                        "no time"),
    "direction.nrrd": (NRRD.replace(b"(0.5,0.0,0.0)", b"(0.5,0.0)"), "a world has 3 axes"),
    "direction_nan.nrrd": (NRRD.replace(b"(0.5,0.0,0.0)", b"(nan,0.0,0.0)"), "no finite number"),
    "endian.nrrd": (NRRD.replace(b"endian: little", b"endian: middle"), "its endian is 'middle'"),
    "bzip2.nrrd": (NRRD.replace(b"encoding: raw", b"encoding: bzip2"), "its encoding is 'bzip2'"),
    "detached.nrrd": (NRRD.replace(b"encoding: raw", b"encoding: raw\ndata file: x.raw"),
                      "in another file"),
    "text_short.nrrd": (nrrd(VALUES, AFFINE, encoding="ascii")[:-4], "fewer than the 24 values"),
    "text_claims.nrrd": (nrrd(VALUES, AFFINE, encoding="ascii").replace(
        b"sizes: 4 3 2", b"sizes: 4000 3000 2000"), "bytes hold fewer"),
    "gz_claims.nrrd": (nrrd(VALUES, AFFINE, encoding="gzip").replace(
        b"sizes: 4 3 2", b"sizes: 4000 3000 2000"), "bytes hold fewer"),
    "claims.vti": (vti(extent="0 3999 0 2999 0 1999"), "bytes hold fewer"),
    "text_long.nrrd": (nrrd(VALUES, AFFINE, encoding="ascii") + b" 7", "more than the 24 values"),
    "text_range.nrrd": (nrrd(VALUES, AFFINE, encoding="ascii").replace(b" 16", b" 70000"),
                        "'70000'"),
    "gz_broken.nrrd": (nrrd(VALUES, AFFINE, encoding="gzip")[:-8] + b"wrong" * 2, "broken"),
    "gz_long.nrrd": (nrrd(VALUES, AFFINE, encoding="gzip").replace(
        b"sizes: 4 3 2", b"sizes: 4 3 1"), "unpacks to more"),
    "no_data.mha": (META[:META.index(b"ElementDataFile")], "no ElementDataFile"),
    "data_cut.mha": (META[:-1], "it is truncated"),
    "dims.mha": (META.replace(b"NDims = 3", b"NDims = 2"), "its NDims is 2"),
    "spacing.mha": (META.replace(b"ElementSpacing = 0.5 ", b"ElementSpacing = 0 "), "not usable"),
    "spacing_short.mha": (META.replace(b"ElementSpacing = 0.5 ", b"ElementSpacing = "),
                          "has 2 numbers and not 3"),
    "channels.mha": (META.replace(b"NDims", b"ElementNumberOfChannels = 3\nNDims"),
                     "values each"),
    "type.mha": (META.replace(b"MET_SHORT", b"MET_STRING"), "MET_STRING"),
    "detached.mha": (META.replace(b"= LOCAL", b"= x.raw"), "in another file"),
    "zlib_cut.mha": (meta(VALUES, AFFINE, compressed=True)[:-9], "broken"),
    "objects.npy": (numpy_file("'|O'"), "of the type"),
    "record.npy": (numpy_file("[('a', '<i2')]"), "of the type"),
    "shape.npy": (numpy_file(shape="(4, 6)"), "an image has 3 axes"),
    "shape_huge.npy": (numpy_file(shape="(99999, 99999, 99999)"), "are not read"),
    "shape_text.npy": (numpy_file(shape="(4, 3, x)"), "no integer"),
    "order.npy": (numpy_file(order="Maybe"), "fortran_order"),
    "version.npy": (at(numpy_file(), 6, "b", 9), "its version is 9"),
    "length.npy": (at(numpy_file(), 8, "H", 65535), "truncated"),
    "cut.npy": (numpy_file()[:-1], "it is truncated"),
    "dtd.vti": (vti().replace(b"<VTKFile", b'<!DOCTYPE a [<!ENTITY b "c">]><VTKFile', 1), "DTD"),
    "entity.vti": (vti('type="Int16" Name="&b;" format="ascii"'), "the entity"),
    "no_end.vti": (vti()[:-60], "its XML has no end"),
    "tag.vti": (vti().replace(b"<Piece ", b"<Piece = "), "the tag"),
    "grid.vti": (vti().replace(b'"ImageData"', b'"PolyData"'), "PolyData"),
    "pieces.vti": (vti().replace(b'<Piece Extent="0 3', b'<Piece Extent="0 2'), "several pieces"),
    "extent.vti": (vti(extent="0 99999999999 0 2 0 1"), "its extent is"),
    "extent_backwards.vti": (vti(extent="3 0 0 2 0 1"), "no axis may be that short"),
    "spacing.vti": (vti(spacing="0.5 0.5 inf"), "no finite number"),
    "lz4.vti": (vti(head=' compressor="vtkLZ4DataCompressor"'), "vtkLZ4DataCompressor"),
    "two_arrays.vti": (vti().replace(b"</PointData>", b'<DataArray type="Int8" Name="a" '
                                     b'format="ascii">1</DataArray></PointData>'), "two arrays"),
    "offset.vti": (appended(blocks(), RAW.replace('"0"', '"99999999999"')), "beyond its end"),
    "offset_negative.vti": (appended(blocks(), RAW.replace('"0"', '"-4"')), "before its data"),
    "blocks_many.vti": (appended(blocks(count=1 << 30)), "packed blocks"),
    "blocks_zero.vti": (appended(blocks(count=0)), "packed blocks"),
    "blocks_last.vti": (appended(blocks(last=47)), "packed blocks"),
    "block_size.vti": (appended(blocks(size=49)), "packed blocks"),
    "block_long.vti": (appended(blocks(packed=1 << 31)), "longer than what it holds"),
    "block_broken.vti": (appended(blocks(packed=7)), "broken"),
    "raw_length.vti": (appended(struct.pack("<I", 47) + VALUES.tobytes(), head=""),
                       "take 48 bytes, and 47 are stored"),
}


def main():
    seeds = HERE.parent.parent / "fuzz" / "corpus" / "image_fuzz"
    lines = ["# What the readers say of each file: accepted, or a part of their refusal."]
    for name, data in GOOD.items():
        (HERE / name).write_bytes(data)
        (seeds / name).write_bytes(data)
        lines.append(f"{name}\taccepted")
    for name, (data, words) in BAD.items():
        (HERE / name).write_bytes(data)
        lines.append(f"{name}\t{words}")
    (HERE / "MANIFEST.tsv").write_text("\n".join(sorted(lines)) + "\n")


if __name__ == "__main__":
    main()
