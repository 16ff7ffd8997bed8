// What can be done with one job: the same in its row and on its page.
import { urlOf } from "../api/client";
import { curlOf } from "../api/curl";
import { isFinal, type Job } from "../api/types";
import { copyText } from "../shell/copy_curl";
import type { MenuEntry } from "../shell/menu";
import { navigate } from "../shell/router";
import { actions, perform, setPinned, setPriority, type JobKeeper } from "./actions";

export interface JobEntry extends MenuEntry {
  /** Important enough for a button, where there is room. */
  button?: boolean;
}

export function jobEntries(job: Job, keeper: JobKeeper): JobEntry[] {
  return [...stateEntries(job, keeper), ...resultEntries(job), ...settingEntries(job, keeper), ...removalEntries(job, keeper)];
}

function stateEntries(job: Job, keeper: JobKeeper): JobEntry[] {
  const { id } = job;
  return (["cancel", "pause", "resume", "retry"] as const).filter((action) => actions[action].possible(job)).map((action) => ({
    label: actions[action].label, button: true, run: () => void perform(action, [job], keeper),
    curl: () => curlOf("POST", `/v1/jobs/${id}/${action}`),
  }));
}

/** Of what a job has made; its files come back out of its results. */
function resultEntries({ id, state }: Job): JobEntry[] {
  if (state !== "succeeded") return [];
  return [
    { label: "Compare with…", button: true, run: () => navigate(urlOf("/compare", { query: { a: id } })) },
    { label: "Again with these settings", button: true, run: () => navigate(urlOf("/new", { query: { from: id } })) },
  ];
}

function settingEntries(job: Job, keeper: JobKeeper): JobEntry[] {
  const { id, pinned, priority } = job;
  const path = `/v1/jobs/${id}`;
  return [
    ...(isFinal(job.state) ? [] : [{
      label: "Priority…", run: () => void setPriority([job], keeper), curl: () => curlOf("PATCH", path, { json: { priority } }),
    }]),
    { label: pinned ? "Unpin" : "Pin", run: () => void setPinned([job], !pinned, keeper), curl: () => curlOf("PATCH", path, { json: { pinned: !pinned } }) },
    { label: "Copy id", run: () => void copyText(id, "Id copied"), curl: () => curlOf("GET", path) },
    ...(isFinal(job.state) ? [] : [{
      label: "Copy: follow", run: () => void copyText(curlOf("GET", `${path}/events`, { stream: true }), "Command copied"),
    }]),
  ];
}

function removalEntries(job: Job, keeper: JobKeeper): JobEntry[] {
  if (!actions.delete.possible(job)) return [];
  return [{
    label: "Delete…", button: true, danger: true, run: () => void perform("delete", [job], keeper),
    curl: () => curlOf("DELETE", `/v1/jobs/${job.id}`),
  }];
}
