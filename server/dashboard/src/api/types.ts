// Short names of what the service answers; generated from api/openapi.yaml.
import type { components } from "openapi";

type Schemas = components["schemas"];

export type Job = Schemas["Job"];
export type JobState = Schemas["JobState"];
export type JobList = Schemas["JobList"];
export type JobEvent = Schemas["JobEvent"];
export type JobGone = Schemas["JobGone"];
export type JobProgress = Schemas["JobProgress"];
export type Queue = Schemas["Queue"];
export type Removal = Schemas["Removal"];
export type BatchResults = Schemas["BatchResults"];
export type Validation = Schemas["Validation"];
export type View = Schemas["View"];
export type ViewRequest = Schemas["ViewRequest"];
export type PatchSeries = Schemas["PatchSeries"];
export type Frame = Schemas["Frame"];

/** One place to fix, as problem documents name it. */
export interface ProblemError {
  file: string;
  /** JSON pointer into that file. */
  pointer?: string;
  line?: number;
  column?: number;
  code: string;
  detail: string;
}

/** RFC 9457; api/schemas/problem.schema.json. */
export interface Problem {
  type: string;
  title: string;
  status: number;
  detail?: string;
  instance?: string;
  errors: ProblemError[];
}

/** The job, as far as its progress says. */
export function withProgress(job: Job, { attempt, stage, stage_fraction, fraction, seconds_left }: JobProgress): Job {
  return { ...job, attempt, progress: { stage: stage as Job["progress"]["stage"], stage_fraction, fraction, seconds_left } };
}

const kFinal: readonly string[] = ["succeeded", "failed", "canceled"];

export function isFinal(state: JobState): boolean {
  return kFinal.includes(state);
}

export const kJobStates: readonly JobState[] = [
  "queued", "running", "pause_requested", "paused", "cancel_requested", "succeeded", "failed", "canceled",
];

/** A view as it is asked for: what is left out has its default. */
export type AskedView = Pick<ViewRequest, "camera"> & Partial<ViewRequest>;
