// Exodus II, .exo, as core/files/write_exodus.cpp writes it: byte for byte the same.
import { faceGroups, verticesOf, type FaceGroup } from "./face_groups";
import { columnNames, namesInFile } from "./file_names";
import type { FileParts } from "./file_parts";
import { fieldsOf, valuesOf } from "./mesh_columns";
import { bigEndian, floatAttribute, intAttribute, NetcdfFile, textAttribute } from "./netcdf";
import { GroupedTets, tetGroups, type TetGroups } from "./tet_groups";
import type { TetMesh } from "./tet_mesh";
import { forEachPoints, isWide } from "./world_points";

const kMostNameBytes = 32;
const kVersion = 8.03;  // of the format and of the library that it is like
/** The side opposite each corner. */
const kSides = [2, 3, 1, 4];

/** Those groups that have tets, and where each begins once tets are sorted by group. */
interface Blocks {
  groups: TetGroups;
  tets: GroupedTets;
  numbers: number[];
  firsts: number[];
}

function blocksOf(mesh: TetMesh): Blocks {
  const groups = tetGroups(mesh.header), tets = new GroupedTets(groups, mesh.store);
  let next = 0;
  const firsts = tets.counts.map((count) => (next += count) - count);
  return { groups, tets, firsts, numbers: tets.there };
}

/** Where each tet is once they are sorted by group. */
function sortedPlaces(mesh: TetMesh, { groups, firsts }: Blocks): Uint32Array {
  const places = new Uint32Array(Number(mesh.header.tetCount)), next = [...firsts];
  mesh.store.forEach((columns) => {
    const of = groups.of(columns);
    for (let t = 0; t < columns.count; ++t) places[columns.firstTet + t] = next[of(t)]!++;
  });
  return places;
}

/** Numbers of the vertices of some faces from 1 on, rising. */
function nodesOf(mesh: TetMesh, faces: Uint32Array): Int32Array {
  return Int32Array.from(verticesOf(mesh, faces), (vertex) => vertex + 1);
}

class ExodusFile {
  private readonly netcdf = new NetcdfFile();
  private readonly blocks: Blocks;
  private readonly surfaces: FaceGroup[];
  private readonly wide: boolean;
  private readonly real: "float" | "double";
  private readonly nameBytes: number;
  private readonly step: number;
  private readonly space: number;
  private readonly nodes: number;
  private readonly elements: number;

  constructor(private readonly mesh: TetMesh) {
    const { header, store } = mesh, netcdf = this.netcdf;
    this.blocks = blocksOf(mesh);
    this.surfaces = faceGroups(mesh);
    this.wide = isWide(header);
    this.real = this.wide ? "double" : "float";
    netcdf.attribute(floatAttribute("api_version", kVersion));
    netcdf.attribute(floatAttribute("version", kVersion));
    netcdf.attribute(intAttribute("floating_point_word_size", this.wide ? 8 : 4));
    netcdf.attribute(intAttribute("file_size", 1));  // offsets of 64 bits
    netcdf.attribute(intAttribute("maximum_name_length", kMostNameBytes));
    netcdf.attribute(intAttribute("int64_status", 0));
    netcdf.attribute(textAttribute("title", "a mesh, written by tetstream"));
    netcdf.dimension("len_string", 33);
    netcdf.dimension("len_line", 81);
    netcdf.dimension("four", 4);
    this.nameBytes = netcdf.dimension("len_name", kMostNameBytes + 1);
    this.step = netcdf.stepDimension("time_step", header.fields.length > 0 ? 1 : 0);
    this.space = netcdf.dimension("num_dim", 3);
    this.nodes = netcdf.dimension("num_nodes", store.vertices);
    this.elements = netcdf.dimension("num_elem", Number(header.tetCount));
  }

  write(file: FileParts): void {
    this.addBlocks();
    this.addCoordinates();
    if (this.surfaces.length > 0) this.addSets();
    this.addValues();
    this.netcdf.write(file);
  }

  private ints(name: string, dimension: number, numbers: () => ArrayLike<number>): void {
    this.netcdf.variable(name, "int", [dimension], (to) => to.bytes(bigEndian(Int32Array.from(numbers()))));
  }

  /** Each in a row as long as any may be, and one for the end. */
  private names(name: string, dimension: number, list: string[]): void {
    this.netcdf.variable(name, "char", [dimension, this.nameBytes],
      (to) => to.text(list.map((one) => one.padEnd(kMostNameBytes + 1, "\0")).join("")));
  }

  /** Whether there is anything in each, ids and names, of blocks or sets. */
  private list(prefix: string, counted: string, tags: number[], names: string[]): void {
    const sets = this.netcdf.dimension(counted, tags.length);
    this.ints(`${prefix}_status`, sets, () => tags.map(() => 1));
    this.netcdf.variable(`${prefix}_prop1`, "int", [sets], (to) => to.bytes(bigEndian(Int32Array.from(tags))),
      [textAttribute("name", "ID")]);
    this.names(`${prefix}_names`, sets, names);
  }

  private addBlocks(): void {
    const { groups, numbers, tets: grouped } = this.blocks, { netcdf } = this;
    this.list("eb", "num_el_blk", numbers.map((i) => groups.tags[i]!),
      namesInFile(numbers.map((i) => groups.names[i]!), { mostBytes: kMostNameBytes }));
    numbers.forEach((group, i) => {
      const tets = netcdf.dimension(`num_el_in_blk${i + 1}`, grouped.counts[group]!);
      const corners = netcdf.dimension(`num_nod_per_el${i + 1}`, 4);
      netcdf.variable(`connect${i + 1}`, "int", [tets, corners], (to) => grouped.forEach(group, ({ tets: all }, own) => {
        const rows = new Int32Array(own.length * 4);
        own.forEach((t, row) => {
          for (let k = 0; k < 4; ++k) rows[row * 4 + k] = all[t * 4 + k]! + 1;
        });
        to.bytes(bigEndian(rows));
      }), [textAttribute("elem_type", "TETRA")]);
    });
    netcdf.variable("elem_num_map", "int", [this.elements], (to) => numbers.forEach((group) =>
      grouped.forEach(group, ({ firstTet }, own) =>
        to.bytes(bigEndian(Int32Array.from(own, (t) => firstTet + t + 1))))));
  }

  private addCoordinates(): void {
    const { header, store } = this.mesh;
    ["x", "y", "z"].forEach((name, axis) => this.netcdf.variable(`coord${name}`, this.real, [this.nodes],
      (to) => forEachPoints(header, store, (points) => {
        const one = this.wide ? new Float64Array(points.length / 3) : new Float32Array(points.length / 3);
        for (let v = 0; v < one.length; ++v) one[v] = points[v * 3 + axis]!;
        to.bytes(bigEndian(one));
      })));
    this.names("coor_names", this.space, ["x", "y", "z"]);
  }

  private addSets(): void {
    const { mesh, netcdf, surfaces } = this;
    const tags = surfaces.map(({ tag }) => tag);
    const names = namesInFile(surfaces.map(({ name }) => name), { mostBytes: kMostNameBytes });
    this.list("ss", "num_side_sets", tags, names);
    this.list("ns", "num_node_sets", tags, names);
    // Sides name elements, which are numbered block by block.
    const places = this.blocks.numbers.length > 1 ? sortedPlaces(mesh, this.blocks) : undefined;
    surfaces.forEach(({ faces }, i) => {
      const count = netcdf.dimension(`num_side_ss${i + 1}`, faces.length), nodes = nodesOf(mesh, faces);
      this.ints(`elem_ss${i + 1}`, count, () => faces.map((face) => (places ? places[face >>> 2]! : face >>> 2) + 1));
      this.ints(`side_ss${i + 1}`, count, () => faces.map((face) => kSides[face & 3]!));
      this.ints(`node_ns${i + 1}`, netcdf.dimension(`num_nod_ns${i + 1}`, nodes.length), () => nodes);
    });
  }

  private addValues(): void {
    const { netcdf } = this, { header, store } = this.mesh;
    const Real = this.wide ? Float64Array : Float32Array;
    netcdf.variable("time_whole", this.real, [this.step], (to) => to.bytes(new Real(1)));
    const fields = fieldsOf(header);
    if (fields.length === 0) return;
    // Two bytes are for what tells the components of a vector.
    const names = columnNames(fields, { mostBytes: kMostNameBytes - 2 });
    const values = fields.flatMap((field, i) => names[i]!.map((name, c) =>
      ({ name, one: { ...field, components: 1, at: field.at + c } })));
    this.names("name_nod_var", netcdf.dimension("num_nod_var", values.length), values.map(({ name }) => name));
    values.forEach(({ one }, i) => netcdf.variable(`vals_nod_var${i + 1}`, this.real, [this.step, this.nodes],
      (to) => store.forEach((columns) => to.bytes(bigEndian(Real.from(valuesOf(one, columns)))))));
  }
}

export function writeExodus(mesh: TetMesh, file: FileParts): void {
  new ExodusFile(mesh).write(file);
}
