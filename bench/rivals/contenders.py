"""Who meshes: each by the way that its own manual shows, from a file to a file.

A Contender's `prepare(solid, size, folder)` writes what it reads and returns the commands to run,
which end with a mesh in the path that it returns beside them; or why it does not take such a
solid. `size` is the length that it is asked for, whatever its manual means by one.
"""
import dataclasses
import importlib.util
import json
import pathlib
import shutil

import numpy as np

import solids

HERE = pathlib.Path(__file__).resolve().parent
PYTHON = "/usr/bin/python3"
NO_LABELS = "takes no image of labels"
SCRIPT = str(HERE / "by_library.py")


@dataclasses.dataclass(frozen=True)
class Contender:
    """package: of Debian that brings it; found: whether it is here; guess: the first size that is
    tried, by the edge of a cube of a tet's mean volume; surface: it makes triangles alone."""
    name: str
    package: str
    prepare: object
    found: object
    guess: float
    surface: bool = False


def has_module(name):
    return lambda: importlib.util.find_spec(name) is not None


def has_program(name):
    return lambda: shutil.which(name) is not None


def write_json(path, what):
    path.write_text(json.dumps(what), encoding="utf-8")
    return str(path)


def write_stl(path, vertices, triangles):
    """Binary STL."""
    record = np.zeros(len(triangles), dtype=[("normal", "<f4", 3), ("at", "<f4", (3, 3)),
                                             ("rest", "<u2")])
    record["at"] = vertices[triangles]
    with open(path, "wb") as file:
        file.write(bytes(80) + np.uint32(len(triangles)).tobytes() + record.tobytes())


def write_off(path, vertices, triangles):
    with open(path, "w", encoding="ascii") as file:
        file.write(f"OFF\n{len(vertices)} {len(triangles)} 0\n")
        np.savetxt(file, vertices, fmt="%.9g")
        np.savetxt(file, np.insert(triangles, 0, 3, axis=1), fmt="%d")


def write_stl_text(path, vertices, triangles):
    """STL as text, which is all that Netgen's Python reads."""
    facet = "facet normal 0 0 0\nouter loop\n" + 3 * "vertex %.9g %.9g %.9g\n" + "endloop\nendfacet"
    with open(path, "w", encoding="ascii") as file:
        file.write("solid\n")
        np.savetxt(file, vertices[triangles].reshape(-1, 9), fmt=facet)
        file.write("endsolid\n")


def write_surface(path, vertices, triangles):
    write = {".stl": write_stl, ".txt": write_stl_text, ".off": write_off}[path.suffix]
    write(path, vertices, triangles)


def surface_of(solid, size, path):
    """(commands, path): triangles for whoever takes no formulas, of a level set with voxels of the
    size, by OpenVDB. Of a scan, too: the bunny's own meet each other, at which TetGen and Gmsh
    stop."""
    return [[PYTHON, SCRIPT, "openvdb", solid.name, f"{size:.6g}", str(path)]], path


def tetstream(*options):
    def prepare(solid, size, folder):
        out, words = folder / "out.vtu", list(options)
        if solid.scene:
            given = write_json(folder / "scene.json", solid.scene)
            words += ["--spacing", f"{size:.6g}"]
        elif solid.triangles:
            given, words = str(solids.BUNNY), [*words, "--voxel", f"{size:.6g}"]
        else:
            given = str(folder / "image.npy")
            np.save(given, solids.grains())
            voxel = str(2 / solids.EDGE)
            words += ["--labels", "all", "--spacing3", voxel, voxel, voxel,
                      "--spacing", f"{size:.6g}"]
        return [[str(PROGRAMS / "tetstream"), "mesh", given, "-o", str(out), *words]], out
    return prepare


def mesh3(solid, size, folder):
    out = folder / "out.mesh"
    if solid.scene:
        return [[str(PROGRAMS / "mesh3_solids"), solid.name, f"{size:.6g}", str(out)]], out
    if solid.labels > 1:
        given = folder / "image.inr"
        write_inr(given, solids.grains())
        return [[str(PROGRAMS / "mesh3_solids"), str(given), f"{size:.6g}", str(out)]], out
    return "triangles: see pygalmesh, which calls Mesh_3 as its manual does for them"


def write_inr(path, image):
    """An image of bytes in the format that CGAL reads; x fastest."""
    nx, ny, nz = image.shape
    voxel = 2 / solids.EDGE
    header = (f"#INRIMAGE-4#{{\nXDIM={nx}\nYDIM={ny}\nZDIM={nz}\nVDIM=1\nTYPE=unsigned fixed\n"
              f"PIXSIZE=8 bits\nCPU=decm\nVX={voxel}\nVY={voxel}\nVZ={voxel}\n")
    header += "\n" * (256 - 4 - len(header)) + "##}\n"
    path.write_bytes(header.encode("ascii") + image.tobytes(order="F"))


def by_pygalmesh(solid, size, folder):
    out = folder / "out.npz"
    words = [PYTHON, SCRIPT, "pygalmesh", solid.name, f"{size:.6g}", str(out)]
    if solid.triangles:
        write_off(folder / "surface.off", *solids.bunny_triangles())
        words.append(str(folder / "surface.off"))
    return [words], out


def gmsh(solid, size, folder):
    if solid.labels > 1:
        return NO_LABELS
    script, out = folder / "solid.geo", folder / "out.msh"
    ring, tube = solids.TORUS
    made = {"ball": "Sphere(1) = {0, 0, 0, 1};", "torus": f"Torus(1) = {{0, 0, 0, {ring}, {tube}}};"}
    commands = []
    if solid.name in made:
        text = f'SetFactory("OpenCASCADE");\n{made[solid.name]}\n'
    else:  # the surface's triangles stay as they are
        commands, surface = surface_of(solid, size, folder / "surface.stl")
        text = f'Merge "{surface}";\nSurface Loop(1) = {{1}};\nVolume(1) = {{1}};\n'
    script.write_text(f"{text}Mesh.MeshSizeMin = {size:.6g};\nMesh.MeshSizeMax = {size:.6g};\n",
                      encoding="ascii")
    return [*commands, ["gmsh", "-3", "-bin", "-format", "msh41", "-o", str(out), str(script)]], out


def netgen(solid, size, folder):
    if solid.labels > 1:
        return NO_LABELS
    out, commands, words = folder / "out.msh", [], []
    if solid.name not in ("ball", "torus"):
        commands, surface = surface_of(solid, size, folder / "surface.txt")
        words = [str(surface)]
    return [*commands, [PYTHON, SCRIPT, "netgen", solid.name, f"{size:.6g}", str(out), *words]], out


def tetgen(solid, size, folder):
    if solid.labels > 1:
        return NO_LABELS
    commands, surface = surface_of(solid, size, folder / "surface.off")
    return [*commands, ["tetgen", "-pq1.414", str(surface)]], folder / "surface.1.ele"


def openvdb_surface(solid, size, folder):
    if solid.labels > 1:
        return NO_LABELS
    out = folder / "out.stl"
    return [[PYTHON, SCRIPT, "openvdb", solid.name, f"{size:.6g}", str(out)]], out


PROGRAMS = HERE.parent.parent / "build" / "release" / "bin"


def built(name):
    return lambda: (PROGRAMS / name).exists()


CONTENDERS = [
    Contender("tetstream", "", tetstream("--levels", "1"), built("tetstream"), 2.0),
    Contender("tetstream uniform", "", tetstream("--levels", "0"), built("tetstream"), 2.2),
    Contender("CGAL Mesh_3", "libcgal-dev", mesh3, built("mesh3_solids"), 2.0),
    Contender("pygalmesh", "python3-pygalmesh", by_pygalmesh, has_module("pygalmesh"), 2.0),
    Contender("Gmsh", "gmsh", gmsh, has_program("gmsh"), 2.0),
    Contender("TetGen", "tetgen", tetgen, has_program("tetgen"), 2.0),
    Contender("Netgen", "python3-netgen", netgen, has_module("netgen"), 3.0),
    Contender("OpenVDB surface alone", "python3-openvdb", openvdb_surface,
              has_module("pyopenvdb"), 2.0, surface=True),
]
