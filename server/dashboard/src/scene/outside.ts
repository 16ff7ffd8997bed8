// A camera that sees the whole scene from outside.
import { Box3, Vector3 } from "three";
import type { CameraState } from "../job/playhead";
import type { Surface } from "./surfaces";

const kVerticalFovDeg = 50;
/** Of the distance, so that nothing touches the edge of the picture. */
const kMargin = 1.06;

/** The corners of boxes around the surfaces that are there, where they are now. */
function cornersOf(surfaces: readonly Surface[]): Vector3[] {
  return surfaces.filter(({ mesh }) => mesh.visible).flatMap(({ mesh }) => {
    mesh.geometry.computeBoundingBox();
    const { min, max } = mesh.geometry.boundingBox!;
    return Array.from({ length: 8 }, (_, k) =>
      new Vector3(k & 1 ? max.x : min.x, k & 2 ? max.y : min.y, k & 4 ? max.z : min.z).applyMatrix4(mesh.matrix));
  });
}

/** Askance from above, as near as it goes with all in sight. `aspect`: width / height of the picture. */
export function fromOutside(surfaces: readonly Surface[], worldUp: readonly [number, number, number], aspect: number): CameraState {
  const up = new Vector3(...worldUp);
  const aside = new Vector3(up.y, up.z, up.x);
  const away = up.clone().multiplyScalar(0.9).add(aside).addScaledVector(up.clone().cross(aside), 0.6).normalize();
  const right = up.clone().cross(away).normalize();
  const above = away.clone().cross(right);
  const corners = cornersOf(surfaces);
  const target = new Box3().setFromPoints(corners).getCenter(new Vector3());
  const tangent = Math.tan((kVerticalFovDeg * Math.PI) / 360);
  const distance = corners.reduce((most, corner) => {
    const p = corner.clone().sub(target);
    return Math.max(most, p.dot(away) + Math.max(Math.abs(p.dot(above)), Math.abs(p.dot(right)) / aspect) / tangent);
  }, 1e-3);
  const eye = target.clone().addScaledVector(away, kMargin * distance);
  return { position: [eye.x, eye.y, eye.z], target: [target.x, target.y, target.z], verticalFovDeg: kVerticalFovDeg };
}
