// What can be done with jobs, one or several, and what it says before and after.
import { send } from "../api/client";
import { messageOf } from "../api/api_error";
import type { BatchResults, Job, Removal } from "../api/types";
import { isFinal } from "../api/types";
import { bytes, count } from "../base/format";
import { h } from "../base/h";
import { confirmDialog, openDialog } from "../shell/dialog";
import { toast, toastError } from "../shell/toast";

/** Who shows jobs, and is told what has become of them. */
export interface JobKeeper {
  /** A job as an action has answered it. */
  put(job: Job): void;
  remove(ids: readonly string[]): void;
  /** Something has changed: look again. */
  reload(): Promise<void>;
}

export type BatchAction = "cancel" | "pause" | "resume" | "retry" | "delete";

interface ActionWords {
  label: string;
  /** What has become of a job afterwards. */
  done: string;
  possible(job: Job): boolean;
}

export const actions: Readonly<Record<BatchAction, ActionWords>> = {
  cancel: { label: "Cancel", done: "canceled", possible: (job) => job.links.cancel !== undefined },
  pause: { label: "Pause", done: "paused", possible: (job) => job.links.pause !== undefined },
  resume: { label: "Resume", done: "resumed", possible: (job) => job.links.resume !== undefined },
  retry: { label: "Retry", done: "queued again", possible: (job) => job.links.retry !== undefined },
  delete: { label: "Delete", done: "deleted", possible: (job) => isFinal(job.state) },
};

const kBatchMax = 200;
const kAtOnce = 6;

/** Does it to those of `jobs` it can be done to; asks first where something is lost. */
export async function perform(action: BatchAction, jobs: readonly Job[], keeper: JobKeeper): Promise<void> {
  const meant = jobs.filter(actions[action].possible).slice(0, kBatchMax);
  if (meant.length === 0) return;
  try {
    if (action === "delete" && !(await agreeToDelete(meant))) return;
    if (action === "cancel" && !(await agreeToCancel(meant))) return;
    const { results } = await send("post", "/v1/jobs/batch", { json: { ids: meant.map((job) => job.id), action } });
    tell(action, results);
    if (action === "delete") keeper.remove(results.filter(({ status }) => status < 300).map(({ id }) => id));
    await keeper.reload();
  } catch (error) {
    toastError(error, actions[action].label);
  }
}

function tell(action: BatchAction, results: BatchResults["results"]): void {
  const refused = results.filter(({ status }) => status >= 300);
  const done = results.length - refused.length;
  if (done > 0) toast(`${count(done, "job")} ${actions[action].done}`, { kind: "good" });
  const reasons = [...new Set(refused.map(({ detail }) => detail ?? ""))].filter(Boolean).slice(0, 3);
  if (refused.length > 0) toast(`${count(refused.length, "job")} refused: ${reasons.join("; ")}`, { kind: "bad" });
}

/** Asks the service what would be deleted, then the user. */
async function agreeToDelete(jobs: readonly Job[]): Promise<boolean> {
  const removals = await eachOf(jobs, async ({ id }) =>
    (await send("delete", "/v1/jobs/{id}", { path: { id }, query: { dry_run: true } })) as Removal);
  const files = removals.reduce((sum, removal) => sum + removal.files, 0);
  const size = removals.reduce((sum, removal) => sum + removal.bytes, 0);
  const pinned = jobs.filter((job) => job.pinned).length;
  return confirmDialog({
    title: `Delete ${count(jobs.length, "job")}?`,
    body: [
      h("p", null, `${count(files, "file")} (${bytes(size)}) will be removed for good: uploads, radiosity, images, logs. `,
        "Rendering again is the only way back."),
      pinned > 0 ? h("p", { class: "warn" }, `${count(pinned, "job is", "jobs are")} pinned, to be kept.`) : "",
      namesOf(jobs),
    ],
    confirm: `Delete ${count(jobs.length, "job")}`,
    danger: true,
  });
}

/** A queued job loses nothing but its place; one at work may have run for hours. */
async function agreeToCancel(jobs: readonly Job[]): Promise<boolean> {
  const running = jobs.filter((job) => job.state !== "queued" && job.progress.fraction > 0);
  if (running.length === 0 && jobs.length === 1) return true;
  return confirmDialog({
    title: `Cancel ${count(jobs.length, "job")}?`,
    body: [
      h("p", null, running.length === 0 ? "They leave the queue." : `${count(running.length, "job")} at work will be stopped within a second. `,
        "A canceled job keeps its files; Retry goes on from its last checkpoint."),
      namesOf(jobs),
    ],
    confirm: `Cancel ${count(jobs.length, "job")}`,
    danger: true,
  });
}

const kNamesMax = 8;

function namesOf(jobs: readonly Job[]): HTMLElement {
  const more = jobs.length - kNamesMax;
  return h("ul", null, jobs.slice(0, kNamesMax).map((job) => h("li", null, job.name || job.id)), more > 0 ? h("li", null, `and ${more} more`) : null);
}

export async function setPriority(jobs: readonly Job[], keeper: JobKeeper): Promise<void> {
  const meant = jobs.filter((job) => !isFinal(job.state));
  if (meant.length === 0) return;
  const input = h("input", { id: "priority", type: "number", min: 0, max: 100, required: true, value: meant[0]!.priority });
  const answer = await openDialog(`Priority of ${count(meant.length, "job")}`, (close) => [
    h("form", { method: "dialog", onsubmit: (event) => { event.preventDefault(); close("set"); } },
      h("div", { class: "dialog-body field" }, h("label", { for: "priority" }, "0 to 100"), input,
        h("p", { class: "field-help" }, "Higher ones start first; 50 is usual. Jobs that run already go on.")),
      h("div", { class: "dialog-actions" }, h("button", { type: "button", onclick: () => close("") }, "Cancel"), h("button", { class: "primary" }, "Set"))),
  ]);
  if (answer === "set") await change(meant, { priority: Number(input.value) }, keeper);
}

export async function setPinned(jobs: readonly Job[], pinned: boolean, keeper: JobKeeper): Promise<void> {
  await change(jobs, { pinned }, keeper);
}

async function change(jobs: readonly Job[], what: { priority?: number; pinned?: boolean }, keeper: JobKeeper): Promise<void> {
  const failures: unknown[] = [];
  await eachOf(jobs, async ({ id }) => {
    try {
      keeper.put(await send("patch", "/v1/jobs/{id}", { path: { id }, json: what }));
    } catch (error) {
      failures.push(error);
    }
  });
  if (failures.length > 0) toast(`${count(failures.length, "job")} not changed: ${messageOf(failures[0])}`, { kind: "bad" });
  await keeper.reload();
}

/** All, but few at a time: there may be a limit on how often one may ask. */
async function eachOf<T, R>(items: readonly T[], work: (item: T) => Promise<R>): Promise<R[]> {
  const results: R[] = [];
  for (let at = 0; at < items.length; at += kAtOnce)
    results.push(...(await Promise.all(items.slice(at, at + kAtOnce).map(work))));
  return results;
}
