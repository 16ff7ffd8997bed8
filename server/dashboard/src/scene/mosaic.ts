// Cells of several sizes on one side of a facet: each is a square of 2^level units of a lattice, at a multiple of its size.
// Told from the corners of the patches; the engine quarters its cells so.
import type { ShadingMesh } from "./shading_mesh";

export interface Tile {
  readonly patch: number;
  /** In units of the lattice. */
  readonly x: number;
  readonly y: number;
  readonly level: number;
}

export interface Mosaic {
  readonly tiles: readonly Tile[];
  /** Units of the lattice; the tiles cover all of them. */
  readonly columns: number;
  readonly rows: number;
}

/** Of its size: a corner may be as far from the lattice. */
const kOff = 0.02;
const kLevelMax = 15;
/** More would be a lattice far too fine for its few tiles. */
export const kUnitsMax = 1 << 22;

interface Place {
  readonly x: number;
  readonly y: number;
  /** Of its first edge, and of the edge to its last corner. */
  readonly width: number;
  readonly height: number;
}

/** Of the patches from `first` on that face as it does; null where they are no such squares. */
export function mosaicAt(mesh: ShadingMesh, first: number, end: number): Mosaic | null {
  const places: Place[] = [];
  const placeOf = frameOf(mesh, first);
  for (let patch = first; patch < end; ++patch) {
    const place = placeOf(patch);
    if (!(place.height > 0)) break; // the other side, whose patches turn the other way round
    places.push(place);
  }
  if (places.length === 0) return null;
  const least = (of: (place: Place) => number) => places.reduce((low, place) => Math.min(low, of(place)), Infinity);
  const unit = least(({ width }) => width);
  const [left, bottom] = [least(({ x }) => x), least(({ y }) => y)];
  const tiles: Tile[] = [];
  for (const [k, { x, y, width, height }] of places.entries()) {
    const level = Math.round(Math.log2(width / unit));
    const tile = { patch: first + k, x: Math.round((x - left) / unit), y: Math.round((y - bottom) / unit), level };
    const size = 2 ** level;
    const misses = [width / unit - size, height / unit - size, (x - left) / unit - tile.x, (y - bottom) / unit - tile.y];
    const off = Math.max(...misses.map(Math.abs));
    if (!(off <= kOff * size) || !(level <= kLevelMax) || tile.x % size !== 0 || tile.y % size !== 0) return null;
    tiles.push(tile);
  }
  return coveredBy(tiles);
}

/** Where patches are, in edges of patch `first`. */
function frameOf(mesh: ShadingMesh, first: number): (patch: number) => Place {
  const p = (patch: number, corner: number, k: number) => mesh.nodePosition[3 * mesh.patchNodes[4 * patch + corner]! + k]!;
  const span = (patch: number, from: number, to: number) => [0, 1, 2].map((k) => p(patch, to, k) - p(patch, from, k));
  const dot = (a: readonly number[], b: readonly number[]) => a[0]! * b[0]! + a[1]! * b[1]! + a[2]! * b[2]!;
  const [u, v] = [span(first, 0, 1), span(first, 0, 3)];
  const [uu, uv, vv] = [dot(u, u), dot(u, v), dot(v, v)];
  const area = uu * vv - uv * uv;
  const along = (d: readonly number[]) => (dot(d, u) * vv - dot(d, v) * uv) / area;
  const up = (d: readonly number[]) => (dot(d, v) * uu - dot(d, u) * uv) / area;
  return (patch) => {
    const from = [0, 1, 2].map((k) => p(patch, 0, k) - p(first, 0, k));
    return { x: along(from), y: up(from), width: along(span(patch, 0, 1)), height: up(span(patch, 0, 3)) };
  };
}

function coveredBy(tiles: readonly Tile[]): Mosaic | null {
  const columns = tiles.reduce((most, { x, level }) => Math.max(most, x + 2 ** level), 0);
  const rows = tiles.reduce((most, { y, level }) => Math.max(most, y + 2 ** level), 0);
  const covered = tiles.reduce((sum, { level }) => sum + 4 ** level, 0);
  return covered === columns * rows && covered <= kUnitsMax ? { tiles, columns, rows } : null;
}

/** The nodes at its four corners, counter-clockwise from the origin. */
export function cornersOf(mesh: ShadingMesh, { tiles, columns, rows }: Mosaic): number[] {
  const nodeAt = (corner: number, atX: number, atY: number): number => {
    const tile = tiles.find(({ x, y, level }) =>
      x + (corner === 1 || corner === 2 ? 2 ** level : 0) === atX && y + (corner >= 2 ? 2 ** level : 0) === atY)!;
    return mesh.patchNodes[4 * tile.patch + corner]!;
  };
  return [nodeAt(0, 0, 0), nodeAt(1, columns, 0), nodeAt(2, columns, rows), nodeAt(3, 0, rows)];
}
