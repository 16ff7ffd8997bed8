// What the walk sees as a view that the service renders.
import type { AskedView } from "../api/types";
import type { JobContext, LightStage } from "./job_part";

const kDigits = 4;

/** In the job's own units and axes the camera is what it is in metres: `metres_per_unit` converts. */
export function viewCamera(context: JobContext, stage: LightStage): AskedView {
  const frames = [context.playhead.frame];
  const following = stage.view.following.value;
  if (following !== null) return { camera: following, frames };
  const { position, target, verticalFovDeg } = stage.view.camera.value;
  const rounded = (v: readonly number[]): [number, number, number] => {
    const [x = 0, y = 0, z = 0] = v.map((value) => Number((value / stage.mesh.metresPerUnit).toFixed(kDigits)));
    return [x, y, z];
  };
  return {
    camera: { position: rounded(position), target: rounded(target), vertical_fov_degrees: Number(verticalFovDeg.toFixed(3)) },
    frames,
  };
}
