// The grids as three.js meshes: four corners for each, one mesh per object, and one for black backs.
import {
  BackSide, BufferAttribute, BufferGeometry, FrontSide, GLSL3, Matrix4, Mesh, RawShaderMaterial, Sphere, Vector3,
} from "three";
import type { Material } from "three";
import type { Grid } from "./grids";
import type { ShadingMesh } from "./shading_mesh";
import { kNoNode } from "./shading_mesh";
import { kSurfaceVertex } from "./shaders";

export interface Surface {
  readonly mesh: Mesh<BufferGeometry, Material>;
  readonly object: number;
  readonly kind: SurfaceKind;
}

export interface SurfaceKind {
  /** The black backs of patches that have nothing on their other side. */
  readonly isBack: boolean;
  /** Cells of several sizes. */
  readonly isMosaic: boolean;
}

/** A material for each kind of surface. */
export class SurfaceMaterials {
  readonly all: readonly RawShaderMaterial[];

  constructor(fragmentShader: string, uniforms: Record<string, { value: unknown }>) {
    const kinds = [0, 1, 2, 3].map((k) => ({ isBack: (k & 1) !== 0, isMosaic: (k & 2) !== 0 }));
    this.all = kinds.map((kind) => surfaceMaterial(fragmentShader, uniforms, kind));
  }

  of({ isBack, isMosaic }: SurfaceKind): RawShaderMaterial {
    return this.all[(isBack ? 1 : 0) + (isMosaic ? 2 : 0)]!;
  }

  dispose(): void {
    for (const material of this.all) material.dispose();
  }
}

/** Uniforms that all surfaces share are the same objects. */
function surfaceMaterial(fragmentShader: string, uniforms: Record<string, { value: unknown }>, { isBack, isMosaic }: SurfaceKind): RawShaderMaterial {
  return new RawShaderMaterial({
    glslVersion: GLSL3, vertexShader: kSurfaceVertex, fragmentShader,
    defines: { WHAT: 0, ...(isBack ? { BACK: 1 } : {}), ...(isMosaic ? { MOSAIC: 1 } : {}) },
    uniforms: { ...uniforms, tint: { value: new Vector3() } },
    side: isBack ? BackSide : FrontSide,
    // At the edges of closed things backs would shine through between the faces: they stand back a little.
    polygonOffset: isBack, polygonOffsetFactor: 1, polygonOffsetUnits: 4,
  });
}

export function cornerCount(mesh: ShadingMesh, patch: number): 3 | 4 {
  return mesh.patchNodes[4 * patch + 3] === kNoNode ? 3 : 4;
}

export function cornerOf(mesh: ShadingMesh, patch: number, corner: number, to: Vector3): Vector3 {
  return to.fromArray(mesh.nodePosition, 3 * mesh.patchNodes[4 * patch + corner]!);
}

/** (first corner), (edge to the second) x (edge to the last). */
export function normalOf(mesh: ShadingMesh, patch: number): Vector3 {
  const p = [0, 1, cornerCount(mesh, patch) - 1].map((corner) => cornerOf(mesh, patch, corner, new Vector3()));
  return p[1]!.sub(p[0]!).cross(p[2]!.sub(p[0]!)).normalize();
}

/** [patch]: does its facet have patches on both sides? */
function haveBothSides(mesh: ShadingMesh): Uint8Array {
  const first = new Map<number, Vector3>();
  const both = new Set<number>();
  for (let patch = 0; patch < mesh.patchCount; ++patch) {
    const facet = mesh.patchFacet[patch]!;
    const known = first.get(facet);
    if (!known) first.set(facet, normalOf(mesh, patch));
    else if (!both.has(facet) && known.dot(normalOf(mesh, patch)) < 0) both.add(facet);
  }
  return Uint8Array.from({ length: mesh.patchCount }, (_, patch) => (both.has(mesh.patchFacet[patch]!) ? 1 : 0));
}

export function buildSurfaces(mesh: ShadingMesh, all: readonly Grid[], materials: SurfaceMaterials): Surface[] {
  const both = haveBothSides(mesh);
  const groups = new Map<string, Grid[]>();
  for (const grid of all) {
    const key = `${mesh.patchObject[grid.patch]} ${both[grid.patch]} ${grid.isMosaic}`;
    const group = groups.get(key);
    if (group) group.push(grid);
    else groups.set(key, [grid]);
  }
  return Array.from(groups.values(), (grids) => {
    const { patch, isMosaic } = grids[0]!;
    const geometry = geometryOf(mesh, grids);
    return (both[patch] === 1 ? [false] : [false, true]).map((isBack) => {
      const surface = new Mesh<BufferGeometry, Material>(geometry, materials.of({ isBack, isMosaic }));
      surface.matrixAutoUpdate = false;
      return { mesh: surface, object: mesh.patchObject[patch]!, kind: { isBack, isMosaic } };
    });
  }).flat();
}

function geometryOf(mesh: ShadingMesh, grids: readonly Grid[]): BufferGeometry {
  const position = new Float32Array(12 * grids.length);
  const corner = new Float32Array(8 * grids.length);
  const cells = new Int32Array(16 * grids.length);
  const index: number[] = [];
  grids.forEach((grid, k) => {
    const { first, stride, place, columns, rows, isTriangle } = grid;
    grid.outline.forEach((node, c) => {
      position.set(mesh.nodePosition.subarray(3 * node, 3 * node + 3), 3 * (4 * k + c));
      corner.set([c === 1 || (c === 2 && !isTriangle) ? columns : 0, c >= 2 ? rows : 0], 2 * (4 * k + c));
    });
    for (let c = 0; c < 4; ++c) cells.set([first, stride, place, isTriangle ? 0 : rows], 4 * (4 * k + c));
    index.push(4 * k, 4 * k + 1, 4 * k + 2);
    if (!isTriangle) index.push(4 * k, 4 * k + 2, 4 * k + 3);
  });
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(position, 3));
  geometry.setAttribute("corner", new BufferAttribute(corner, 2));
  geometry.setAttribute("grid", new BufferAttribute(cells, 4));
  geometry.setIndex(index);
  geometry.computeBoundingSphere();
  return geometry;
}

/** Object -> world at `time` [frames]; between frames the poses are mixed. */
export function poseAt(mesh: ShadingMesh, object: number, time: number, to: Matrix4): Matrix4 {
  const before = Math.min(Math.floor(time), mesh.frameCount - 1);
  const after = Math.min(before + 1, mesh.frameCount - 1);
  const usable = isVisible(mesh, object, before) && isVisible(mesh, object, after);
  const w = usable ? time - before : 0;
  const at = 12 * (object * mesh.frameCount + before);
  const next = 12 * (object * mesh.frameCount + after);
  const m = (k: number) => (1 - w) * mesh.poses[at + k]! + w * mesh.poses[next + k]!;
  return to.set(m(0), m(1), m(2), m(3), m(4), m(5), m(6), m(7), m(8), m(9), m(10), m(11), 0, 0, 0, 1);
}

export function isVisible(mesh: ShadingMesh, object: number, frame: number): boolean {
  return mesh.visible[object * mesh.frameCount + frame] === 1;
}

/** Does the object ever change its place or come and go? */
export function moves(mesh: ShadingMesh, object: number): boolean {
  const first = object * mesh.frameCount;
  for (let frame = 1; frame < mesh.frameCount; ++frame) {
    if (mesh.visible[first + frame] !== mesh.visible[first]) return true;
    for (let k = 0; k < 12; ++k) if (mesh.poses[12 * (first + frame) + k] !== mesh.poses[12 * first + k]) return true;
  }
  return false;
}

/** Puts every surface where its object is. */
export function place(mesh: ShadingMesh, surfaces: readonly Surface[], time: number): void {
  const frame = Math.min(Math.round(time), mesh.frameCount - 1);
  for (const { mesh: surface, object } of surfaces) {
    surface.visible = isVisible(mesh, object, frame);
    poseAt(mesh, object, time, surface.matrix);
    surface.matrixWorldNeedsUpdate = true;
  }
}

/** Around all that is there in frame 0. */
export function boundsOf(surfaces: readonly Surface[]): Sphere {
  const all = new Sphere(new Vector3(), -1);
  for (const { mesh } of surfaces) {
    if (!mesh.visible || !mesh.geometry.boundingSphere) continue;
    const one = mesh.geometry.boundingSphere.clone().applyMatrix4(mesh.matrix);
    if (all.radius < 0) all.copy(one);
    else all.union(one);
  }
  if (all.radius <= 0) all.set(new Vector3(), 1);
  return all;
}
