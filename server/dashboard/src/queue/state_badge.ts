import type { Job, JobState } from "../api/types";
import { h } from "../base/h";
import "./progress.css";

/** A state in words for people; the shape of its mark differs too, not its colour alone. */
export const stateWords: Readonly<Record<JobState, string>> = {
  queued: "Queued",
  running: "Running",
  pause_requested: "Pausing",
  paused: "Paused",
  cancel_requested: "Canceling",
  succeeded: "Succeeded",
  failed: "Failed",
  canceled: "Canceled",
};

export function stateBadge(job: Pick<Job, "state" | "reason">): HTMLElement {
  return h("span", { class: `state state-${job.state}`, title: job.reason ?? undefined }, stateWords[job.state]);
}
