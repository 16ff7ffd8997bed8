// The view of lighting_view.ts by three.js: draws only when something has changed.
import { Scene, Vector2, Vector3, Vector4, WebGLRenderer } from "three";
import type { DataTexture, RawShaderMaterial } from "three";
import { Lifetime, Signal } from "../base/signal";
import type { CameraState } from "../job/playhead";
import { CameraControl } from "./camera_control";
import { LightPasses } from "./light_passes";
import type { Display, Drawn, LightingView, Picked, Term } from "./lighting_view";
import { paletteTexels } from "./palette";
import { Marks } from "./marks";
import { fromOutside } from "./outside";
import { gridsOf } from "./grids";
import { Picker } from "./picker";
import { cameraAt, type ShadingMesh } from "./shading_mesh";
import { kSurfaceFragment } from "./shaders";
import { boundsOf, buildSurfaces, moves, place, SurfaceMaterials, type Surface } from "./surfaces";
import { byteTexture, rgbTexture, uintTexture } from "./texels";
import { SmoothEdges } from "./smooth_edges";
import { kFilmicScale } from "./tone_curve";
import { DataTexture as Texture, LinearFilter, NoColorSpace, Sphere } from "three";

export class NoWebGl extends Error {}

const kPrefetchFrames = 48;
/** Longer than any frame takes while time goes on, or smoothing would itself make it halt. */
const kStillMs = 400;
const kMovingTint = new Vector3(0.2, 0.55, 1);

const kFirstDisplay: Display = {
  what: "light", tintMoving: false, marks: false, exposureStops: 0, toneMap: "filmic", smooth: true, borders: false,
  scale: { from: 0, to: 1, log: false, signed: false },
};

/** Throws NoWebGl where the browser has no WebGL 2 with float targets. */
export function createLightingView(canvas: HTMLCanvasElement, mesh: ShadingMesh): LightingView {
  return new WebGlView(canvas, mesh);
}

function rendererOn(canvas: HTMLCanvasElement): WebGLRenderer {
  const context = canvas.getContext("webgl2", { antialias: false, alpha: false, powerPreference: "high-performance" });
  if (!context) throw new NoWebGl("this browser shows no WebGL 2");
  if (!context.getExtension("EXT_color_buffer_float")) throw new NoWebGl("this graphics processor cannot draw into floats");
  const renderer = new WebGLRenderer({ canvas, context });
  renderer.autoClear = false;
  renderer.setClearColor(0x000000);
  return renderer;
}

function paletteTexture(): DataTexture {
  const texture = new Texture(paletteTexels(), 256, 2);
  texture.minFilter = texture.magFilter = LinearFilter;
  texture.colorSpace = NoColorSpace;
  texture.needsUpdate = true;
  return texture;
}

class WebGlView implements LightingView {
  readonly camera: Signal<CameraState>;
  readonly following = new Signal<string | null>(null);
  readonly trouble = new Signal<string | null>(null);
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly surfaces: Surface[];
  private readonly bounds: Sphere;
  private readonly smoothEdges: SmoothEdges;
  private readonly passes: LightPasses;
  private readonly marks: Marks;
  private readonly control: CameraControl;
  private readonly picker: Picker;
  private readonly marked: DataTexture;
  private readonly uniforms: Record<string, { value: unknown }>;
  private readonly materials: SurfaceMaterials;
  private readonly lifetime = new Lifetime();
  private display: Display = kFirstDisplay;
  private terms: readonly Term[] = [];
  private time = 0;
  private lightChanged = true;
  private wanted = 0; // of requestAnimationFrame; 0: none
  private lastDrawn = 0;
  private exact = false;
  private still: ReturnType<typeof setTimeout> | undefined;

  constructor(
    readonly canvas: HTMLCanvasElement,
    private readonly mesh: ShadingMesh,
  ) {
    this.renderer = rendererOn(canvas);
    this.smoothEdges = new SmoothEdges(this.renderer);
    const grids = gridsOf(mesh);
    this.passes = new LightPasses(this.renderer, mesh, grids);
    this.marked = byteTexture(mesh.patchCount);
    this.uniforms = this.makeUniforms(grids.units);
    this.materials = new SurfaceMaterials(kSurfaceFragment, this.uniforms);
    this.surfaces = buildSurfaces(mesh, grids.grids, this.materials);
    place(mesh, this.surfaces, 0);
    this.bounds = boundsOf(this.surfaces);
    this.tintMovingSurfaces();
    this.scene.add(...this.surfaces.map(({ mesh: surface }) => surface));
    this.scene.matrixWorldAutoUpdate = true;
    this.marks = new Marks(mesh, this.bounds.radius);
    this.scene.add(this.marks.group);
    this.control = new CameraControl(canvas, mesh.up, this.bounds, this.firstCamera());
    this.camera = this.control.state;
    this.picker = new Picker(this.renderer, mesh, this.surfaces, this.uniforms);
    this.listen();
  }

  setTerms(terms: readonly Term[]): void {
    if (terms === this.terms) return;
    this.terms = terms;
    this.lightChanged = true;
    this.draw();
  }

  setTime(frame: number): void {
    this.time = Math.min(Math.max(frame, 0), this.mesh.frameCount - 1);
    this.lightChanged = true;
    this.lead();
    this.draw();
  }

  setDisplay(display: Partial<Display>): void {
    this.display = { ...this.display, ...display };
    const { what, exposureStops, toneMap, smooth, borders, scale, tintMoving, marks } = this.display;
    this.marks.group.visible = marks;
    const u = this.uniforms;
    u["exposure"]!.value = (this.mesh.autoExposure * 2 ** exposureStops) / Math.PI;
    (u["scale"]!.value as Vector4).set(scale.from, scale.to, scale.log ? 1 : 0, scale.signed ? 1 : 0);
    this.define({
      WHAT: what === "light" ? 0 : what === "false-colour" ? 1 : 2,
      FILMIC: toneMap === "filmic", SMOOTH: smooth, BORDERS: borders,
    });
    for (const { mesh: surface, object } of this.surfaces) surface.userData["tint"] = tintMoving && moves(this.mesh, object);
    this.draw();
  }

  followCamera(name: string | null): void {
    if (name !== null) this.control.moved.value = false;
    this.following.value = name;
    this.lead();
    this.draw();
  }

  showAll(): void {
    this.following.value = null;
    this.control.state.value = this.fromOutside();
  }

  setHighlighted(patches: readonly number[]): void {
    const texels = this.marked.image.data as unknown as Uint8Array;
    texels.fill(0);
    for (const patch of patches) if (patch < this.mesh.patchCount) texels[patch] = 255;
    this.marked.needsUpdate = true;
    this.define({ MARKED: patches.length > 0 });
    this.draw();
  }

  pick(x: number, y: number): Picked | null {
    const size = new Vector2(this.canvas.clientWidth, this.canvas.clientHeight);
    place(this.mesh, this.surfaces, this.time);
    return this.picker.pick(this.scene, this.control.camera, size, x, y, this.time);
  }

  dispose(): void {
    cancelAnimationFrame(this.wanted);
    clearTimeout(this.still);
    this.smoothEdges.dispose();
    this.lifetime.end();
    this.control.dispose();
    this.picker.dispose();
    this.passes.dispose();
    this.marks.dispose();
    for (const { mesh: surface } of this.surfaces) surface.geometry.dispose();
    this.materials.dispose();
    for (const { value } of Object.values(this.uniforms)) if (value instanceof Texture) value.dispose();
    this.renderer.dispose();
  }

  private makeUniforms(units: Uint32Array): Record<string, { value: unknown }> {
    const reflectance = rgbTexture(this.mesh.patchReflectance, (patch) => this.mesh.materialEmits[this.mesh.patchMaterial[patch]!]!);
    return {
      patches: { value: null }, nodeValues: { value: null }, units: { value: uintTexture(units, 2) },
      palette: { value: paletteTexture() }, reflectance: { value: reflectance }, marked: { value: this.marked },
      scale: { value: new Vector4(0, 1, 0, 0) },
      exposure: { value: this.mesh.autoExposure / Math.PI }, filmicScale: { value: kFilmicScale },
    };
  }

  /** Shaders of another variant; those that were used before are still there. */
  private define(changes: Record<string, number | boolean>): void {
    for (const material of this.materials.all) {
      const now = { ...material.defines, ...changes };
      if (JSON.stringify(now) === JSON.stringify(material.defines)) continue;
      material.defines = now;
      material.needsUpdate = true;
    }
  }

  /** The tint is set just before a surface is drawn: surfaces share their materials. */
  private tintMovingSurfaces(): void {
    const none = new Vector3();
    for (const { mesh: surface } of this.surfaces)
      surface.onBeforeRender = (_renderer, _scene, _camera, _geometry, material) => {
        const tint = (material as RawShaderMaterial).uniforms["tint"];
        if (!tint) return;
        tint.value = surface.userData["tint"] ? kMovingTint : none;
        (material as RawShaderMaterial).uniformsNeedUpdate = true;
      };
  }

  private listen(): void {
    this.lifetime.add(
      this.control.state.watch(() => this.draw()),
      this.control.moved.watch((moved) => moved && (this.following.value = null)),
    );
    const resized = new ResizeObserver(() => this.resize());
    resized.observe(this.canvas);
    this.lifetime.add(() => resized.disconnect());
    this.resize();
    this.setDisplay({});
  }

  private firstCamera(): CameraState {
    return this.mesh.cameras.names.length > 0 ? cameraAt(this.mesh, 0, 0) : this.fromOutside();
  }

  private fromOutside(): CameraState {
    const { clientWidth, clientHeight } = this.canvas;
    return fromOutside(this.surfaces, this.mesh.up, clientWidth > 0 && clientHeight > 0 ? clientWidth / clientHeight : 1);
  }

  private lead(): void {
    const camera = this.following.value === null ? -1 : this.mesh.cameras.names.indexOf(this.following.value);
    if (camera >= 0) this.control.state.value = cameraAt(this.mesh, camera, this.time);
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.canvas;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.control.camera.aspect = clientWidth / clientHeight;
    this.control.camera.updateProjectionMatrix();
    this.draw();
  }

  private draw(): void {
    if (this.wanted === 0 && !this.lifetime.ended) this.wanted = requestAnimationFrame((now) => this.drawNow(now));
  }

  private drawNow(now: number): void {
    this.wanted = 0;
    if (this.lightChanged) this.updateLight();
    if (this.control.walking) this.control.walk(Math.min((now - this.lastDrawn) / 1000, 0.1));
    place(this.mesh, this.surfaces, this.time);
    if (this.display.marks) this.marks.place(this.time);
    this.renderer.clear();
    this.renderer.render(this.scene, this.control.camera);
    this.smoothLater();
    this.lastDrawn = now;
    const drawn: Drawn = { time: this.time, exact: this.exact };
    this.canvas.dispatchEvent(new CustomEvent("drawn", { detail: drawn }));
    if (this.control.walking) this.draw();
  }

  /** Smooth edges cost software as much again as all else: they come when nothing has changed for a moment. */
  private smoothLater(): void {
    clearTimeout(this.still);
    this.still = setTimeout(() => this.smoothEdges.draw(this.scene, this.control.camera), kStillMs);
  }

  private updateLight(): void {
    this.lightChanged = false;
    if (this.terms.length === 0) {
      this.uniforms["patches"]!.value = this.uniforms["nodeValues"]!.value = null; // black
      return;
    }
    if (this.passes.update(this.terms, this.time)) {
      this.uniforms["patches"]!.value = this.passes.patches;
      this.uniforms["nodeValues"]!.value = this.passes.nodes;
    }
    this.exact = this.fetchMissing() === 0;
  }

  /** How many frames are still to come. */
  private fetchMissing(): number {
    let count = 0;
    const before = Math.floor(this.time);
    const frames = this.time > before ? [before, before + 1] : [before];
    for (const { source } of this.terms) {
      const missing = frames.filter((frame) => frame < source.frameCount && source.cached(frame) === null);
      count += missing.length;
      if (missing.length === 0) source.prefetch(before, 1, kPrefetchFrames);
      for (const frame of missing) source.load(frame).then(() => this.arrived(), (error: unknown) => this.failed(error));
    }
    return count;
  }

  private arrived(): void {
    this.trouble.value = null;
    this.lightChanged = true;
    this.draw();
  }

  private failed(error: unknown): void {
    if (this.lifetime.ended) return;
    this.trouble.value = error instanceof Error ? error.message : String(error);
  }
}
