// The reference of a job: the same job with every frame solved, nothing interpolated.
import { get, send } from "../../api/client";
import { fetchInputs } from "../../api/job_inputs";
import type { Job } from "../../api/types";
import { formOf, jsonOf, withFiles, withSettings } from "../../new_job/upload";

/** Says which job it is the reference of, so that it is found again. */
const kLabel = "reference_of";
const kLabelsMax = 16;
const kNameBytesMax = 200;
const kSuffix = " reference";

/** One that was submitted before and may yet be of use, or a new one. Errors: ApiError, Error. */
export async function referenceOf(id: string, signal: AbortSignal): Promise<Job> {
  const { jobs } = await get("/v1/jobs", { query: { label: `${kLabel}:${id}` }, signal });
  const before = jobs.find(({ state }) => state !== "failed" && state !== "canceled" && state !== "cancel_requested");
  return before ?? submitReference(await get("/v1/jobs/{id}", { path: { id }, signal }), signal);
}

async function submitReference(job: Job, signal: AbortSignal): Promise<Job> {
  const { parts } = withFiles([], await fetchInputs(job.id, signal));
  const animation = await jsonOf(parts, "animation");
  if (animation === null) throw new Error("The job's animation cannot be read.");
  const { mode } = (animation["lighting"] ?? {}) as { mode?: unknown };
  if (mode === "reference") throw new Error("This job is a reference itself: every frame of it was solved.");
  const labels = { ...Object.fromEntries(Object.entries(job.labels).slice(0, kLabelsMax - 1)), [kLabel]: job.id };
  const options = { name: referenceName(job), priority: job.priority, labels };
  return send("post", "/v1/jobs", { form: formOf(parts, withSettings(animation, { "/lighting/mode": "reference" }), options), signal });
}

function referenceName({ name, id }: Job): string {
  let short = name || id;
  while (new TextEncoder().encode(short + kSuffix).length > kNameBytesMax) short = [...short].slice(0, -1).join("");
  return short + kSuffix;
}
