// What the patches are drawn as: a facet whose patches are the equal cells of a parallelogram is one quad, however many
// they are, and the shader finds the cell. Any other patch is a quad or a triangle of its own.
import { kNoNode, type ShadingMesh } from "./shading_mesh";

/** Cell (i, j), 0 <= i < columns, 0 <= j < rows, is the patch `first` + j x `stride` + i. */
export interface Grid {
  readonly first: number;
  /** Negative where the rows lie the other way round: on the back of a facet. */
  readonly stride: number;
  readonly columns: number;
  readonly rows: number;
  /** Then it is a single patch. */
  readonly isTriangle: boolean;
  /** Corner (i, j) of the cells is place `place` + j x (columns + 1) + i; a triangle has 3. */
  readonly place: number;
}

export interface Grids {
  readonly grids: readonly Grid[];
  /** [place]: the node there. */
  readonly placeNodes: Uint32Array;
}

type Cells = Omit<Grid, "place">;

export function gridsOf(mesh: ShadingMesh): Grids {
  const grids: Grid[] = [];
  let place = 0;
  for (let first = 0, end = 0; first < mesh.patchCount; first = end) {
    end = endOfFacet(mesh, first);
    for (const cells of cellsOf(mesh, first, end)) {
      grids.push({ ...cells, place });
      place += cells.isTriangle ? 3 : (cells.columns + 1) * (cells.rows + 1);
    }
  }
  const placeNodes = new Uint32Array(place);
  for (const grid of grids) fillPlaces(mesh, grid, placeNodes);
  return { grids, placeNodes };
}

/** Its four corners, that of patch `first` first; of a triangle its three. Counter-clockwise: nodes. */
export function outlineOf({ placeNodes }: Grids, { place, columns, rows, isTriangle }: Grid): number[] {
  const up = rows * (columns + 1);
  const places = isTriangle ? [0, 1, 2] : [0, columns, up + columns, up];
  return places.map((at) => placeNodes[place + at]!);
}

function endOfFacet(mesh: ShadingMesh, first: number): number {
  let end = first + 1;
  while (end < mesh.patchCount && mesh.patchFacet[end] === mesh.patchFacet[first]) ++end;
  return end;
}

/**
 * The patches of a facet, one grid for each of its sides. With cells of several sizes, every patch for itself: strips of
 * them would meet corners in the middle of their edges, and pixels would fall between.
 */
function cellsOf(mesh: ShadingMesh, first: number, end: number): Cells[] {
  const front = largestGrid(mesh, first, end);
  const count = front.columns * front.rows;
  if (first + count === end) return [front];
  const back = largestGrid(mesh, first + count, end);
  if (back.columns === front.columns && back.rows === front.rows && first + 2 * count === end) return [front, back];
  return Array.from({ length: end - first }, (_, k) => single(mesh, first + k));
}

function single(mesh: ShadingMesh, patch: number): Cells {
  return { first: patch, stride: 1, columns: 1, rows: 1, isTriangle: mesh.patchNodes[4 * patch + 3] === kNoNode };
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

function fillPlaces(mesh: ShadingMesh, { first, stride, columns, rows, isTriangle, place }: Grid, nodes: Uint32Array): void {
  if (isTriangle) {
    nodes.set(mesh.patchNodes.subarray(4 * first, 4 * first + 3), place);
    return;
  }
  for (let j = 0; j <= rows; ++j)
    for (let i = 0; i <= columns; ++i) {
      const patch = first + Math.min(j, rows - 1) * stride + Math.min(i, columns - 1);
      const corner = j < rows ? (i < columns ? 0 : 1) : i < columns ? 3 : 2;
      nodes[place + j * (columns + 1) + i] = mesh.patchNodes[4 * patch + corner]!;
    }
}
