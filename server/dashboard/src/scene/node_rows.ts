// The mesh's matrix as textures: for every place the four patches around its node and their shares, see kNodeFragment.
import type { DataTexture } from "three";
import type { Grids } from "./grids";
import type { ShadingMesh } from "./shading_mesh";
import { floatTexture, uintTexture } from "./texels";

const kFour = 4;

/** By the names of the uniforms; `span` and `row` only where a row has more than four parts: where they begin and end. */
export function rowTextures({ rowFirst, rowPatch, rowWeight }: ShadingMesh, { placeNodes }: Grids): Record<string, DataTexture> {
  const around = new Uint32Array(kFour * placeNodes.length);
  const shares = new Float32Array(kFour * placeNodes.length);
  const span = new Uint32Array(2 * placeNodes.length);
  let more = false;
  placeNodes.forEach((node, place) => {
    const [first, end] = [rowFirst[node]!, rowFirst[node + 1]!];
    const four = Math.min(first + kFour, end);
    around.set(rowPatch.subarray(first, four), kFour * place);
    shares.set(rowWeight.subarray(first, four), kFour * place);
    span.set([four, end], 2 * place);
    more ||= four < end;
  });
  const always = { around: uintTexture(around, 4), shares: floatTexture(shares) };
  return more ? { ...always, span: uintTexture(span, 2), row: uintTexture(entriesOf(rowPatch, rowWeight), 2) } : always;
}

/** Patch and bits of the weight, in turn. */
function entriesOf(patches: Uint32Array, weights: Float32Array): Uint32Array {
  const entries = new Uint32Array(2 * patches.length);
  const bits = new Uint32Array(weights.buffer, weights.byteOffset, weights.length);
  patches.forEach((patch, k) => {
    entries[2 * k] = patch;
    entries[2 * k + 1] = bits[k]!;
  });
  return entries;
}
