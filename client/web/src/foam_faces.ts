// The faces of a mesh in OpenFOAM's order, as core/files/foam_faces.h has them: those between two cells, by the lower of
// them and then the higher; then the boundary's, patch by patch.
import { kFaceCorners, type Columns } from "./chunk_store";
import { faceGroups, type FaceGroup } from "./face_groups";
import { FaceSet } from "./face_set";
import type { TetMesh } from "./tet_mesh";

const kNone = 0xffffffff;

/** Faces of the boundary that lie one behind the other in its list. */
export interface FoamPatch {
  name: string;
  faces: Uint32Array;
}

/** Faces between two cells that have a name: their numbers, rising, each once. */
export interface FoamZone {
  name: string;
  faces: number[];
  /** Faces look out of the lower of their cells, and names are about one of the two. */
  flipped: boolean[];
}

export class FoamFaces {
  /** The tet behind each face of each tet. */
  private readonly behind: Uint32Array;
  readonly innerCount: number;
  readonly patches: FoamPatch[] = [];
  readonly zones: FoamZone[];

  constructor(private readonly mesh: TetMesh) {
    this.behind = new Uint32Array(Number(mesh.header.tetCount) * 4).fill(kNone);
    mesh.tally.add(this.behind.byteLength);
    this.innerCount = this.findNeighbours();
    const groups = faceGroups(mesh);
    this.sortBoundary(groups);
    this.zones = this.findZones(groups);
  }

  get count(): number {
    return this.innerCount + this.patches.reduce((sum, { faces }) => sum + faces.length, 0);
  }

  /** Calls `use` with each face between two tets, in their order; `tet` is the lower one's place in its chunk. */
  forInner(use: (columns: Columns, tet: number, corner: number, behind: number) => void): void {
    this.mesh.store.forEach((columns) => {
      const others = [0, 0, 0, 0], corners = [0, 0, 0, 0];
      for (let t = 0; t < columns.count; ++t) {
        const tet = columns.firstTet + t;
        let found = 0;
        for (let corner = 0; corner < 4; ++corner) {
          const other = this.behind[tet * 4 + corner]!;
          if (other === kNone || other <= tet) continue;
          let place = found++;
          for (; place > 0 && others[place - 1]! > other; --place) {
            others[place] = others[place - 1]!;
            corners[place] = corners[place - 1]!;
          }
          others[place] = other;
          corners[place] = corner;
        }
        for (let i = 0; i < found; ++i) use(columns, t, corners[i]!, others[i]!);
      }
    });
  }

  free(): void {
    this.mesh.tally.drop(this.behind.byteLength);
  }

  private findNeighbours(): number {
    const open = new FaceSet(this.mesh.tally);
    let inner = 0;
    this.mesh.store.forEach(({ tets, firstTet, count }) => {
      for (let t = 0; t < count; ++t) {
        for (let corner = 0; corner < 4; ++corner) {
          const [i, j, k] = kFaceCorners[corner]!, face = (firstTet + t) * 4 + corner;
          const other = open.toggle(tets[t * 4 + i]!, tets[t * 4 + j]!, tets[t * 4 + k]!, face);
          if (other < 0) continue;
          this.behind[face] = other >>> 2;
          this.behind[other] = face >>> 2;
          ++inner;
        }
      }
    });
    open.free();
    return inner;
  }

  /** Each face goes into one patch, whatever the mesh says. */
  private sortBoundary(groups: FaceGroup[]): void {
    const named = new Uint8Array(Math.ceil(this.behind.length / 8));
    const take = (face: number): boolean => {
      const bit = 1 << (face & 7);
      if (this.behind[face] !== kNone || named[face >>> 3]! & bit) return false;
      named[face >>> 3]! |= bit;
      return true;
    };
    for (const { name, faces } of groups) {
      const own = faces.filter(take);
      if (own.length > 0) this.patches.push({ name, faces: own });
    }
    const others = this.mesh.outsideFaces.filter(take);
    if (others.length > 0) this.patches.push({ name: "defaultFaces", faces: others });
  }

  private findZones(groups: FaceGroup[]): FoamZone[] {
    let firsts: Uint32Array | undefined;  // few meshes have faces there that have a name
    return groups.map(({ name, faces }) => {
      const flips = new Map<number, boolean>();
      for (const face of faces) {
        const tet = face >>> 2, other = this.behind[face]!;
        if (other === kNone) continue;
        firsts ??= this.firstsOfTets();
        const number = this.numberOf(firsts, Math.min(tet, other), Math.max(tet, other));
        flips.set(number, (flips.get(number) ?? true) && tet > other);
      }
      const numbers = [...flips.keys()].sort((a, b) => a - b);
      return { name, faces: numbers, flipped: numbers.map((number) => flips.get(number)!) };
    }).filter((zone) => zone.faces.length > 0);
  }

  /** The number of the first face of each tet that it is the lower one of. */
  private firstsOfTets(): Uint32Array {
    const firsts = new Uint32Array(this.behind.length / 4 + 1);
    for (let tet = 0; tet + 1 < firsts.length; ++tet) {
      firsts[tet + 1] = firsts[tet]! + this.countBehind(tet, kNone);
    }
    return firsts;
  }

  private numberOf(firsts: Uint32Array, low: number, high: number): number {
    return firsts[low]! + this.countBehind(low, high);
  }

  /** How many higher tets than this one touch it, below `end`. */
  private countBehind(tet: number, end: number): number {
    let count = 0;
    for (let face = tet * 4; face < tet * 4 + 4; ++face) {
      if (this.behind[face]! > tet && this.behind[face]! < end) ++count;
    }
    return count;
  }
}
