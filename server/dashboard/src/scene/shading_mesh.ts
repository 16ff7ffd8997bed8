// What shading_mesh.npz and a preview hold: surfaces, their motion, cameras and lights. Lengths are metres; frames count
// from 0. engine/output/shading_mesh_npz.h documents the arrays.
import { Npz } from "./npz";
import type { CameraState } from "../job/playhead";

export const kNoNode = 0xffffffff;

export interface ShadingMesh {
  readonly nodeCount: number;
  readonly patchCount: number;
  readonly frameCount: number;
  readonly objectCount: number;
  /** (nodes, 3) object space. */
  readonly nodePosition: Float32Array;
  /** Node radiosity = sum of rowWeight[k] x patch radiosity[rowPatch[k]], k from rowFirst[node] to rowFirst[node + 1]. */
  readonly rowFirst: Uint32Array;
  readonly rowPatch: Uint32Array;
  readonly rowWeight: Float32Array;
  /** (patches, 4); the fourth of a triangle is kNoNode. */
  readonly patchNodes: Uint32Array;
  readonly patchObject: Uint32Array;
  readonly patchMaterial: Uint32Array;
  readonly patchFacet: Uint32Array;
  /** (patches, 3) */
  readonly patchReflectance: Float32Array;
  readonly objectNames: readonly string[];
  readonly materialNames: readonly string[];
  readonly materialEmits: Uint8Array;
  /** (objects, frames, 3, 4) object -> world, row-major. */
  readonly poses: Float32Array;
  /** (objects, frames) */
  readonly visible: Uint8Array;
  readonly cameras: Cameras;
  readonly lights: Lights;
  readonly up: readonly [number, number, number];
  readonly fps: number;
  readonly metresPerUnit: number;
  /** Factor on radiance that shows the sequence's mean in middle grey. */
  readonly autoExposure: number;
  readonly halfScale: number;
}

export interface Cameras {
  readonly names: readonly string[];
  /** (cameras, frames, 3) */
  readonly position: Float32Array;
  readonly forward: Float32Array;
  readonly up: Float32Array;
  /** (cameras, frames) */
  readonly verticalFovDeg: Float32Array;
  /** (cameras, 2) pixels; 0 where the job asks for no pictures by it. */
  readonly imageSize: Uint32Array;
}

export const kLightKinds = ["point", "spot", "directional"] as const;

export interface Lights {
  readonly names: readonly string[];
  readonly kind: readonly (typeof kLightKinds)[number][];
  /** (lights, frames, 3) */
  readonly position: Float32Array;
  readonly direction: Float32Array;
}

/** Throws NpzError. */
export function readShadingMesh(buffer: ArrayBuffer): ShadingMesh {
  const npz = new Npz(buffer);
  const number = (name: string) => npz.f64(name)[0] ?? 1;
  const up = npz.f64("up");
  return {
    nodeCount: npz.shape("node_position")[0] ?? 0,
    patchCount: npz.shape("patch_nodes")[0] ?? 0,
    frameCount: npz.shape("poses")[1] ?? 0,
    objectCount: npz.shape("poses")[0] ?? 0,
    nodePosition: npz.f32("node_position"),
    rowFirst: npz.u32("row_first"),
    rowPatch: npz.u32("row_patch"),
    rowWeight: npz.f32("row_weight"),
    patchNodes: npz.u32("patch_nodes"),
    patchObject: npz.u32("patch_object"),
    patchMaterial: npz.u32("patch_material"),
    patchFacet: npz.u32("patch_facet"),
    patchReflectance: npz.f32("patch_reflectance"),
    objectNames: npz.strings("object_names"),
    materialNames: npz.strings("material_names"),
    materialEmits: npz.u8("material_emits"),
    poses: npz.f32("poses"),
    visible: npz.u8("visible"),
    cameras: {
      names: npz.strings("camera_names"),
      position: npz.f32("camera_position"),
      forward: npz.f32("camera_forward"),
      up: npz.f32("camera_up"),
      verticalFovDeg: npz.f32("camera_vertical_fov_deg"),
      imageSize: npz.u32("image_size"),
    },
    lights: {
      names: npz.strings("light_names"),
      kind: Array.from(npz.u8("light_kind"), (kind) => kLightKinds[kind] ?? "point"),
      position: npz.f32("light_position"),
      direction: npz.f32("light_direction"),
    },
    up: [up[0] ?? 0, up[1] ?? 1, up[2] ?? 0],
    fps: number("fps"),
    metresPerUnit: number("metres_per_unit"),
    autoExposure: number("auto_exposure"),
    halfScale: number("half_scale"),
  };
}

/** One of the job's cameras in a frame; the target is the point one metre ahead. */
export function cameraAt(mesh: ShadingMesh, camera: number, frame: number): CameraState {
  const { position, forward, verticalFovDeg } = mesh.cameras;
  const at = camera * mesh.frameCount + Math.min(Math.max(Math.round(frame), 0), mesh.frameCount - 1);
  const p = (k: number) => position[3 * at + k] ?? 0;
  const f = (k: number) => forward[3 * at + k] ?? 0;
  return {
    position: [p(0), p(1), p(2)],
    target: [p(0) + f(0), p(1) + f(1), p(2) + f(2)],
    verticalFovDeg: verticalFovDeg[at] ?? 60,
  };
}
