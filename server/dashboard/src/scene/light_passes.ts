// From frames of half floats to the radiosity of patches and nodes at a moment, on the graphics processor: sums of
// gain x mix(frame before, frame after), then the rows of the mesh's matrix.
import { FloatType, NearestFilter, Vector3, WebGLRenderTarget } from "three";
import type { DataTexture, RawShaderMaterial, WebGLRenderer } from "three";
import type { Grids } from "./grids";
import type { Term } from "./lighting_view";
import type { ShadingMesh } from "./shading_mesh";
import { kNodeFragment, kPatchFragment } from "./shaders";
import { rowTextures } from "./node_rows";
import { fillTexture, halfTexture, kTexelsPerRow, rowsFor } from "./texels";
import { texelShader, WholeTarget } from "./whole_target";

/** A frame on the graphics processor. */
interface Loaded {
  readonly texture: DataTexture;
  source: Term["source"] | null;
  frame: number;
}

function target(count: number): WebGLRenderTarget {
  const made = new WebGLRenderTarget(kTexelsPerRow, rowsFor(count, kTexelsPerRow), {
    type: FloatType, minFilter: NearestFilter, magFilter: NearestFilter, depthBuffer: false, generateMipmaps: false,
  });
  return made;
}

export class LightPasses {
  private readonly sums: [WebGLRenderTarget, WebGLRenderTarget];
  private readonly nodeTarget: WebGLRenderTarget;
  /** Of the first term between frames, of it in a frame, and so of further ones. */
  private readonly patchPasses: readonly RawShaderMaterial[];
  private readonly nodePass: RawShaderMaterial;
  private readonly whole: WholeTarget;
  private readonly rows: readonly DataTexture[];
  /** Two frames for each term: before and after the moment. */
  private loaded: Loaded[] = [];

  constructor(
    renderer: WebGLRenderer,
    private readonly mesh: ShadingMesh,
    grids: Grids,
  ) {
    this.sums = [target(mesh.patchCount), target(mesh.patchCount)];
    this.nodeTarget = target(grids.placeNodes.length);
    const variants: Record<string, number>[] = [{ MIXED: 1 }, {}, { MIXED: 1, FURTHER: 1 }, { FURTHER: 1 }];
    this.patchPasses = variants.map((defines) =>
      texelShader(kPatchFragment, {
        sum: { value: null }, before: { value: null }, after: { value: null }, gain: { value: new Vector3() }, weight: { value: 0 },
      }, defines));
    const rows = rowTextures(mesh, grids);
    this.rows = Object.values(rows);
    const uniforms = Object.fromEntries(Object.entries(rows).map(([name, value]) => [name, { value }]));
    this.nodePass = texelShader(kNodeFragment, { patches: { value: null }, ...uniforms }, "row" in rows ? { MORE: 1 } : {});
    this.whole = new WholeTarget(renderer);
  }

  /** [W/m^2] RGBA, kTexelsPerRow wide; nodes by their places, see grids.ts. */
  get patches() {
    return this.sums[0].texture;
  }
  get nodes() {
    return this.nodeTarget.texture;
  }

  /**
   * Light at `time` [frames], as good as what is loaded allows: where one of the two frames around it is missing, the other
   * stands for it. False, and nothing changes, where a term has neither.
   */
  update(terms: readonly Term[], time: number): boolean {
    const before = Math.floor(time);
    const weight = time - before;
    const frames = terms.map(({ source }) => {
      const last = source.frameCount - 1;
      const a = source.cached(Math.min(before, last));
      const b = weight > 0 ? source.cached(Math.min(before + 1, last)) : a;
      return { a: a ?? b, b: b ?? a, frameA: a ? before : before + 1, frameB: b ? before + (weight > 0 ? 1 : 0) : before };
    });
    if (frames.some(({ a }) => a === null)) return false;
    this.makeRoom(2 * terms.length);
    terms.forEach((term, k) => {
      const { a, b, frameA, frameB } = frames[k]!;
      this.turnOver(k, term, frameA);
      const first = this.load(2 * k, term, frameA, a!);
      const second = frameB === frameA ? first : this.load(2 * k + 1, term, frameB, b!);
      this.add(term, first, second, weight, k === 0);
    });
    this.whole.draw(this.nodePass, { patches: this.patches }, this.nodeTarget);
    return true;
  }

  dispose(): void {
    for (const each of [...this.sums, this.nodeTarget, ...this.patchPasses, this.nodePass, this.whole, ...this.rows])
      each.dispose();
    for (const { texture } of this.loaded) texture.dispose();
  }

  private makeRoom(count: number): void {
    while (this.loaded.length < count)
      this.loaded.push({ texture: halfTexture(this.mesh.patchCount), source: null, frame: -1 });
    for (const { texture } of this.loaded.splice(count)) texture.dispose();
  }

  /** While time goes on, the frame after becomes the frame before: it is not sent again. */
  private turnOver(k: number, term: Term, frame: number): void {
    const [a, b] = [this.loaded[2 * k]!, this.loaded[2 * k + 1]!];
    if (b.source === term.source && b.frame === frame) [this.loaded[2 * k], this.loaded[2 * k + 1]] = [b, a];
  }

  private load(place: number, { source }: Term, frame: number, values: Uint16Array): DataTexture {
    const loaded = this.loaded[place]!;
    if (loaded.source !== source || loaded.frame !== frame) {
      fillTexture(loaded.texture, values);
      loaded.source = source;
      loaded.frame = frame;
    }
    return loaded.texture;
  }

  private add(term: Term, before: DataTexture, after: DataTexture, weight: number, first: boolean): void {
    const gain = new Vector3(...term.gain).multiplyScalar(term.source.halfScale);
    const sum = this.patches;
    this.sums.reverse();
    const pass = this.patchPasses[(first ? 0 : 2) + (weight > 0 ? 0 : 1)]!;
    this.whole.draw(pass, { sum, before, after, weight, gain }, this.sums[0]);
  }
}
