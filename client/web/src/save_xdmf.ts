// XDMF with its columns in HDF5, as core/files/write_xdmf.cpp writes them: two files in one .zip.
import { cornersOf, countFaces, faceGroups, type FaceGroup } from "./face_groups";
import { xml } from "./file_names";
import type { FileParts } from "./file_parts";
import { Hdf5Group, writeHdf5 } from "./hdf5";
import { fieldsOf, valuesOf } from "./mesh_columns";
import { tetGroups } from "./tet_groups";
import type { TetMesh } from "./tet_mesh";
import { forEachPoints, isWide } from "./world_points";
import { ZipFile } from "./zip";

const kIndex = "mesh.xdmf", kColumns = "mesh.h5";

function columnsOf(mesh: TetMesh, faces: FaceGroup[]): Hdf5Group {
  const { header, store } = mesh;
  const tets = Number(header.tetCount), triangles = countFaces(faces), groups = tetGroups(header);
  const root = new Hdf5Group(), group = root.group("Mesh");
  group.column("topology", "i32", [tets, 4], (to) => store.forEach((columns) => to.bytes(columns.tets.slice())));
  group.column("geometry", isWide(header) ? "f64" : "f32", [store.vertices, 3],
    (to) => forEachPoints(header, store, (points) => to.bytes(points)));
  group.column("cell_tags", "i32", [tets], (to) => store.forEach((columns) => {
    const of = groups.of(columns);
    to.bytes(Int32Array.from({ length: columns.count }, (_, t) => groups.tags[of(t)]!));
  }));
  if (triangles > 0) {
    group.column("facets", "i32", [triangles, 3], (to) => {
      for (const { faces: some } of faces) {
        const rows = new Int32Array(some.length * 3);
        mesh.forFaces(some, (i, columns, tet, corner) => rows.set(cornersOf(columns, tet, corner), i * 3));
        to.bytes(rows);
      }
    });
    group.column("facet_tags", "i32", [triangles],
      (to) => faces.forEach(({ tag, faces: some }) => to.bytes(new Int32Array(some.length).fill(tag))));
  }
  fieldsOf(header).forEach((field, i) => group.column(`field_${i}`, "f32", [store.vertices, field.components],
    (to) => store.forEach((columns) => to.bytes(valuesOf(field, columns)))));
  return root;
}

function item(dimensions: string, type: string, precision: number, name: string): string {
  return `        <DataItem Dimensions="${dimensions}" NumberType="${type}" Precision="${precision}" Format="HDF">` +
    `${kColumns}:/Mesh/${name}</DataItem>\n`;
}

function topology(cells: string, count: number, nodes: number, name: string): string {
  return `      <Topology TopologyType="${cells}" NumberOfElements="${count}" NodesPerElement="${nodes}">\n` +
    `${item(`${count} ${nodes}`, "Int", 4, name)}      </Topology>\n`;
}

function attribute(name: string, kind: string, center: string, content: string): string {
  return `      <Attribute Name="${xml(name)}" AttributeType="${kind}" Center="${center}">\n${content}      </Attribute>\n`;
}

function names(groups: { tag: number; name: string }[]): string {
  return groups.map(({ tag, name }) => `      <Information Name="${tag}" Value="${xml(name)}"/>\n`).join("");
}

function grid(name: string, content: string): string {
  return `    <Grid Name="${name}" GridType="Uniform">\n${content}    </Grid>\n`;
}

function indexText(mesh: TetMesh, faces: FaceGroup[]): string {
  const { header, store } = mesh;
  const tets = Number(header.tetCount), triangles = countFaces(faces), groups = tetGroups(header);
  const cells = topology("Tetrahedron", tets, 4, "topology");
  const points = '      <Geometry GeometryType="XYZ">\n' +
    `${item(`${store.vertices} 3`, "Float", isWide(header) ? 8 : 4, "geometry")}      </Geometry>\n`;
  const fields = header.fields.map(({ name, components }, i) => attribute(name, components === 1 ? "Scalar" : "Vector",
    "Node", item(`${store.vertices} ${components}`, "Float", 4, `field_${i}`)));
  const tags = (name: string, count: number): string =>
    attribute(name, "Scalar", "Cell", item(String(count), "Int", 4, name));
  return '<?xml version="1.0"?>\n<Xdmf Version="3.0">\n  <Domain>\n' +
    grid("mesh", cells + points + fields.join("")) +
    grid("cell_tags", cells + points + tags("cell_tags", tets) +
      names(groups.names.map((name, i) => ({ tag: groups.tags[i]!, name })))) +
    (triangles === 0 ? "" : grid("facet_tags", topology("Triangle", triangles, 3, "facets") + points +
      tags("facet_tags", triangles) + names(faces))) +
    "  </Domain>\n</Xdmf>\n";
}

export function writeXdmf(mesh: TetMesh, file: FileParts): void {
  const faces = faceGroups(mesh), zip = new ZipFile(file);
  zip.add(kColumns, (to) => writeHdf5(to, columnsOf(mesh, faces)));
  zip.add(kIndex, (to) => to.text(indexText(mesh, faces)));
  zip.end();
}
