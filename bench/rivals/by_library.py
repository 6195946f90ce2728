#!/usr/bin/python3
"""Meshes one solid with a library that is called from Python, as its manual shows.

    by_library.py pygalmesh SOLID SIZE OUT.npz [SURFACE.off]
    by_library.py netgen    SOLID SIZE OUT.msh [SURFACE.txt]
    by_library.py openvdb   SOLID SIZE OUT.stl|OUT.txt|OUT.off
"""
import pathlib
import sys

import numpy as np

import solids


def with_pygalmesh(name, size, out, surface=None):
    import pygalmesh
    sizes = {"max_cell_circumradius": size, "max_radius_surface_delaunay_ball": size,
             "max_facet_distance": size / 4, "min_facet_angle": 30,
             "max_circumradius_edge_ratio": 2, "verbose": False}

    class Gyroid(pygalmesh.DomainBase):
        def eval(self, at):
            return solids.gyroid_distance(np.array([at]))[0]

        def get_bounding_sphere_squared_radius(self):
            return 1.1

    if name == "bunny":
        mesh = pygalmesh.generate_volume_mesh_from_surface_mesh(surface, **sizes)
    elif name == "grains":
        sizes.update(max_facet_distance=size / 2, max_radius_surface_delaunay_ball=0.75 * size,
                     max_circumradius_edge_ratio=3)
        mesh = pygalmesh.generate_from_array(solids.grains(), [2 / solids.EDGE] * 3, **sizes)
    else:
        solid = {"ball": lambda: pygalmesh.Ball([0, 0, 0], 1), "gyroid": Gyroid,
                 "torus": lambda: pygalmesh.Torus(*solids.TORUS)}[name]()
        mesh = pygalmesh.generate_mesh(solid, **sizes)
    # What has no label is of the one there is.
    labels = mesh.cell_data.get("medit:ref")
    which = [i for i, block in enumerate(mesh.cells) if block.type == "tetra"]
    tets = np.concatenate([mesh.cells[i].data for i in which])
    given = {} if labels is None else {"labels": np.concatenate([labels[i] for i in which])}
    np.savez(out, vertices=mesh.points, tets=tets, **given)


def with_netgen(name, size, out, surface=None):
    if surface:
        from netgen.stl import LoadSTLGeometry
        geometry = LoadSTLGeometry(surface)
    else:
        from netgen.csg import CSGeometry, Pnt, Sphere, Torus, Vec
        geometry = CSGeometry()
        geometry.Add(Sphere(Pnt(0, 0, 0), 1) if name == "ball" else
                     Torus(Pnt(0, 0, 0), Vec(0, 0, 1), *solids.TORUS))
    geometry.GenerateMesh(maxh=size).Export(out, "Gmsh2 Format")


def with_openvdb(name, size, out):
    """OpenVDB's own surface of a level set with voxels of the size."""
    import pyopenvdb
    import contenders
    if name == "bunny":
        vertices, triangles = solids.bunny_triangles()
        grid = pyopenvdb.FloatGrid.createLevelSetFromPolygons(
            vertices.astype(np.float32), triangles=triangles.astype(np.uint32),
            transform=pyopenvdb.createLinearTransform(voxelSize=size), halfWidth=3)
    else:
        reach = int(np.ceil(1.05 / size)) + 3
        grid = pyopenvdb.FloatGrid(background=3 * size)
        along = np.arange(-reach, reach + 1) * size
        at = np.stack(np.meshgrid(along, along, along, indexing="ij"), axis=-1)
        values = solids.DISTANCES[name](at.reshape(-1, 3)).reshape(at.shape[:3])
        grid.copyFromArray(np.clip(values, -3 * size, 3 * size), ijk=(-reach,) * 3)
        grid.transform = pyopenvdb.createLinearTransform(voxelSize=size)
    points, quads = grid.convertToQuads(isovalue=0)
    # Outwards: OpenVDB turns them the other way.
    triangles = np.concatenate([quads[:, [0, 2, 1]], quads[:, [0, 3, 2]]])
    contenders.write_surface(pathlib.Path(out), points, triangles)


def main():
    ways = {"pygalmesh": with_pygalmesh, "netgen": with_netgen, "openvdb": with_openvdb}
    if len(sys.argv) not in (5, 6) or sys.argv[1] not in ways:
        sys.exit(__doc__)
    ways[sys.argv[1]](sys.argv[2], float(sys.argv[3]), *sys.argv[4:])


if __name__ == "__main__":
    main()
