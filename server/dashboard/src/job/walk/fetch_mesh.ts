// The surfaces of a job, and its light by series.
import { fetchBytes, urlOf } from "../../api/client";
import type { FrameSource } from "../../scene/lighting_view";
import { readShadingMesh, type ShadingMesh } from "../../scene/shading_mesh";
import type { JobContext } from "../job_part";
import { openSeries } from "./half_range";

export interface Fetched {
  readonly mesh: ShadingMesh;
  /** The same source for the same name; fetched when it is wanted. */
  source(series: string): FrameSource;
}

/** Errors: ApiError; 404 where the job has no mesh (yet). */
export async function fetchMesh({ id, lifetime }: JobContext): Promise<Fetched> {
  const stop = new AbortController();
  lifetime.add(() => stop.abort());
  const url = urlOf("/v1/jobs/{id}/shading_mesh.npz", { path: { id } });
  const response = await fetchBytes(url, { signal: stop.signal });
  const mesh = readShadingMesh(await response.arrayBuffer());
  const sources = new Map<string, FrameSource>();
  return {
    mesh,
    source: (series) => {
      let source = sources.get(series);
      if (!source) {
        const opened = openSeries(id, series, mesh);
        lifetime.add(() => opened.close());
        sources.set(series, (source = opened));
      }
      return source;
    },
  };
}
