// Which frames of a job were solved, fetched once for all parts that show it.
import { get, type Answer } from "../api/client";
import type { JobContext } from "./job_part";

export type KeyFrames = Answer<"/v1/jobs/{id}/key-frames", "get">;

const fetched = new WeakMap<JobContext, Promise<KeyFrames>>();

/** Of a job that has succeeded. Errors: ApiError. */
export function keyFramesOf(context: JobContext): Promise<KeyFrames> {
  let coming = fetched.get(context);
  if (!coming) {
    coming = get("/v1/jobs/{id}/key-frames", { path: { id: context.id } });
    coming.catch(() => fetched.delete(context));
    fetched.set(context, coming);
  }
  return coming;
}
