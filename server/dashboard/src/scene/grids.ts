// What the patches are drawn as: a facet whose patches are the cells of a parallelogram is one quad, however many they are,
// and the shader finds the cell. Any other patch is a quad or a triangle of its own.
import { cornersOf, kUnitsMax, mosaicAt, type Mosaic } from "./mosaic";
import { kNoNode, type ShadingMesh } from "./shading_mesh";

/**
 * Equal cells: cell (i, j), 0 <= i < columns, 0 <= j < rows, is the patch `first` + j x `stride` + i. Of a mosaic's
 * lattice: unit (i, j) belongs to the tile that `units` has at `first` + j x `stride` + i.
 */
export interface Grid {
  readonly first: number;
  /** Negative where the rows lie the other way round: on the back of a facet. */
  readonly stride: number;
  readonly columns: number;
  readonly rows: number;
  /** Then it is a single patch. */
  readonly isTriangle: boolean;
  readonly isMosaic: boolean;
  /** One of its patches. */
  readonly patch: number;
  /** Corner (i, j) of equal cells is place `place` + j x (columns + 1) + i; a triangle has 3. */
  readonly place: number;
  /** The nodes at its corners, counter-clockwise; three of a triangle. */
  readonly outline: readonly number[];
}

export interface Grids {
  readonly grids: readonly Grid[];
  /** [place]: the node there. */
  readonly placeNodes: Uint32Array;
  /** Of mosaics' lattices, in pairs: the patch, and the first place of its corners (0, 0), (1, 0), (0, 1), (1, 1) x 16 + level. */
  readonly units: Uint32Array;
}

type Cells = Omit<Grid, "place" | "outline" | "isMosaic">;

const kLevelBits = 4;
/** What is within the height of textures everywhere. */
const kAllUnitsMax = 2 * kUnitsMax;

export function gridsOf(mesh: ShadingMesh): Grids {
  const maker = new Maker(mesh);
  for (let first = 0, end = 0; first < mesh.patchCount; first = end) {
    end = endOfFacet(mesh, first);
    const cells = cellsOf(mesh, first, end) ?? maker.addMosaics(first, end);
    for (const each of cells) maker.addCells(each);
  }
  return { grids: maker.grids, placeNodes: Uint32Array.from(maker.placeNodes), units: Uint32Array.from(maker.units) };
}

class Maker {
  readonly grids: Grid[] = [];
  readonly placeNodes: number[] = [];
  readonly units: number[] = [];

  constructor(private readonly mesh: ShadingMesh) {}

  addCells(cells: Cells): void {
    const { columns, rows, isTriangle } = cells;
    const place = this.placeNodes.length;
    for (const node of nodesOf(this.mesh, cells)) this.placeNodes.push(node);
    const up = rows * (columns + 1);
    const corners = isTriangle ? [0, 1, 2] : [0, columns, up + columns, up];
    this.grids.push({ ...cells, isMosaic: false, place, outline: corners.map((at) => this.placeNodes[place + at]!) });
  }

  /** Both sides of a facet; what is left where it is no mosaic. */
  addMosaics(first: number, end: number): Cells[] {
    for (let next = first; next < end;) {
      const mosaic = mosaicAt(this.mesh, next, end);
      const room = kAllUnitsMax - this.units.length / 2;
      if (!mosaic || mosaic.columns * mosaic.rows > room) return Array.from({ length: end - next }, (_, k) => single(this.mesh, next + k));
      this.addMosaic(mosaic);
      next += mosaic.tiles.length;
    }
    return [];
  }

  private addMosaic(mosaic: Mosaic): void {
    const { tiles, columns, rows } = mosaic;
    const first = this.units.length / 2;
    const pairs = new Array<number>(2 * columns * rows).fill(0);
    for (const { patch, x, y, level } of tiles) {
      const about = (this.placeNodes.length << kLevelBits) | level;
      for (const corner of [0, 1, 3, 2]) this.placeNodes.push(this.mesh.patchNodes[4 * patch + corner]!);
      for (let j = y; j < y + 2 ** level; ++j)
        for (let i = x; i < x + 2 ** level; ++i) [pairs[2 * (j * columns + i)], pairs[2 * (j * columns + i) + 1]] = [patch, about];
    }
    for (const each of pairs) this.units.push(each);
    this.grids.push({
      first, stride: columns, columns, rows, isTriangle: false, isMosaic: true, patch: tiles[0]!.patch, place: 0,
      outline: cornersOf(this.mesh, mosaic),
    });
  }
}

function endOfFacet(mesh: ShadingMesh, first: number): number {
  let end = first + 1;
  while (end < mesh.patchCount && mesh.patchFacet[end] === mesh.patchFacet[first]) ++end;
  return end;
}

/** The patches of a facet, one grid for each of its sides; null where they are not equal cells. */
function cellsOf(mesh: ShadingMesh, first: number, end: number): Cells[] | null {
  const front = largestGrid(mesh, first, end);
  const count = front.columns * front.rows;
  if (first + count === end) return [front];
  const back = largestGrid(mesh, first + count, end);
  if (back.columns === front.columns && back.rows === front.rows && first + 2 * count === end) return [front, back];
  return null;
}

function single(mesh: ShadingMesh, patch: number): Cells {
  return { first: patch, patch, stride: 1, columns: 1, rows: 1, isTriangle: mesh.patchNodes[4 * patch + 3] === kNoNode };
}

/** From patch `first` on. Cells of a facet that share both ends of an edge are of one size. */
function largestGrid(mesh: ShadingMesh, first: number, end: number): Cells {
  const one = single(mesh, first);
  if (one.isTriangle) return one;
  /** Is node `a` of patch p node `b` of patch q? */
  const same = (p: number, a: number, q: number, b: number) => mesh.patchNodes[4 * p + a] === mesh.patchNodes[4 * q + b];
  const aside = (p: number, q: number) => same(p, 1, q, 0) && same(p, 2, q, 3);
  const above = (p: number, q: number) => same(p, 3, q, 0) && same(p, 2, q, 1);
  let columns = 1;
  while (first + columns < end && aside(first + columns - 1, first + columns)) ++columns;
  const rowFollows = (row: number, follows: typeof above): boolean => {
    if (row + columns > end) return false;
    for (let i = 0; i < columns; ++i) {
      if (!follows(row - columns + i, row + i) || (i > 0 && !aside(row + i - 1, row + i))) return false;
    }
    return true;
  };
  const count = (follows: typeof above): number => {
    let rows = 1;
    while (rowFollows(first + rows * columns, follows)) ++rows;
    return rows;
  };
  const up = count(above);
  const down = count((p, q) => above(q, p));
  return down > up
    ? { ...one, first: first + (down - 1) * columns, stride: -columns, columns, rows: down }
    : { ...one, stride: columns, columns, rows: up };
}

/** [place] of equal cells. */
function nodesOf(mesh: ShadingMesh, { first, stride, columns, rows, isTriangle }: Cells): Uint32Array {
  if (isTriangle) return mesh.patchNodes.subarray(4 * first, 4 * first + 3);
  const nodes = new Uint32Array((columns + 1) * (rows + 1));
  for (let j = 0; j <= rows; ++j)
    for (let i = 0; i <= columns; ++i) {
      const patch = first + Math.min(j, rows - 1) * stride + Math.min(i, columns - 1);
      const corner = j < rows ? (i < columns ? 0 : 1) : i < columns ? 3 : 2;
      nodes[j * (columns + 1) + i] = mesh.patchNodes[4 * patch + corner]!;
    }
  return nodes;
}
