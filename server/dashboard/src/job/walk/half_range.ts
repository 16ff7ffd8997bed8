// Ranges of a job's radiosity as half floats.
import { fetchBytes, urlOf } from "../../api/client";
import { HalfSource } from "../../scene/half_source";
import type { ShadingMesh } from "../../scene/shading_mesh";

/** `series`: "radiosity", "radiosity_se", "radiosity_GROUP". */
export function openSeries(job: string, series: string, mesh: ShadingMesh): HalfSource {
  const url = urlOf(`/v1/jobs/{id}/half/{series}.npy`, { path: { id: job, series } });
  const fetchRange = async (first: number, last: number, signal: AbortSignal): Promise<ArrayBuffer> => {
    const response = await fetchBytes(url, { headers: { Range: `bytes=${first}-${last}` }, signal });
    const bytes = await response.arrayBuffer();
    return response.status === 206 ? bytes : bytes.slice(first, last + 1);
  };
  return new HalfSource(`${series}.npy`, fetchRange, mesh.frameCount, mesh.patchCount, mesh.halfScale);
}
