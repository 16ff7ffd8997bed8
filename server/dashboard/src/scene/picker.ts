// Which patch is under a point: the scene drawn once more into a single pixel, with numbers as colours.
import { NearestFilter, PerspectiveCamera, Plane, Ray, Scene, UnsignedByteType, Vector2, Vector3, WebGLRenderTarget } from "three";
import type { WebGLRenderer } from "three";
import type { Picked } from "./lighting_view";
import type { ShadingMesh } from "./shading_mesh";
import { kPickFragment } from "./shaders";
import { cornerOf, normalOf, poseAt, SurfaceMaterials, type Surface } from "./surfaces";
import { Matrix4 } from "three";

export class Picker {
  private readonly target = new WebGLRenderTarget(1, 1, {
    type: UnsignedByteType, minFilter: NearestFilter, magFilter: NearestFilter,
  });
  private readonly materials;

  constructor(
    private readonly renderer: WebGLRenderer,
    private readonly mesh: ShadingMesh,
    private readonly surfaces: readonly Surface[],
    uniforms: Record<string, { value: unknown }>,
  ) {
    this.materials = new SurfaceMaterials(kPickFragment, uniforms);
  }

  /** `x`, `y`: of a canvas of `size`, in CSS pixels. */
  pick(scene: Scene, camera: PerspectiveCamera, size: Vector2, x: number, y: number, time: number): Picked | null {
    const bytes = new Uint8Array(4);
    const usual = this.surfaces.map(({ mesh }) => mesh.material);
    for (const { mesh, kind } of this.surfaces) mesh.material = this.materials.of(kind);
    camera.setViewOffset(size.x, size.y, x, y, 1, 1);
    this.renderer.setRenderTarget(this.target);
    this.renderer.setClearColor(0x000000, 0);
    this.renderer.clear();
    this.renderer.setClearColor(0x000000, 1);
    this.renderer.render(scene, camera);
    this.renderer.readRenderTargetPixels(this.target, 0, 0, 1, 1, bytes);
    this.renderer.setRenderTarget(null);
    camera.clearViewOffset();
    this.surfaces.forEach(({ mesh }, k) => (mesh.material = usual[k]!));
    const patch = bytes[0]! + 256 * bytes[1]! + 65536 * bytes[2]! - 1;
    return patch < 0 || patch >= this.mesh.patchCount ? null : this.found(patch, camera, size, x, y, time);
  }

  dispose(): void {
    this.target.dispose();
    this.materials.dispose();
  }

  private found(patch: number, camera: PerspectiveCamera, size: Vector2, x: number, y: number, time: number): Picked {
    const object = this.mesh.patchObject[patch]!;
    const pose = poseAt(this.mesh, object, time, new Matrix4());
    const plane = new Plane()
      .setFromNormalAndCoplanarPoint(normalOf(this.mesh, patch), cornerOf(this.mesh, patch, 0, new Vector3()))
      .applyMatrix4(pose);
    const eye = camera.getWorldPosition(new Vector3());
    const through = new Vector3((2 * x) / size.x - 1, 1 - (2 * y) / size.y, 0.5).unproject(camera);
    const at = new Ray(eye, through.sub(eye).normalize()).intersectPlane(plane, new Vector3()) ?? eye;
    return { patch, object, position: [at.x, at.y, at.z] };
  }
}
