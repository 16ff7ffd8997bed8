// The top of a job's page: state, progress, what can be done with it.
import { send } from "../api/client";
import { curlOf } from "../api/curl";
import type { Job } from "../api/types";
import { ago, bytes, moment } from "../base/format";
import { fill, h } from "../base/h";
import { copyCurlButton } from "../shell/copy_curl";
import { toastError } from "../shell/toast";
import type { JobContext } from "./job_part";
import { progressBar } from "../queue/progress_bar";
import { stateBadge } from "../queue/state_badge";

const kActions = ["cancel", "pause", "resume", "retry"] as const;
/** "3 min ago" goes on being true. */
const kFactsMs = 20_000;
type Action = (typeof kActions)[number];

export function jobHead(context: JobContext): HTMLElement {
  const element = h("section", { class: "job-head", "aria-label": "State" });
  const bar = progressBar();
  const facts = h("div", { class: "row muted small" });
  const state = h("div", { class: "row" });
  const actions = h("div", { class: "row" });
  fill(element, h("div", { class: "job-head-line" }, state, actions), bar.element, facts);
  let shown = "";
  context.lifetime.add(context.job.watch((job) => {
    bar.show(job);
    fill(state, stateBadge(job), job.reason ? h("span", { class: job.state === "failed" ? "bad" : "muted" }, job.reason) : null);
    fill(facts, ...factsOf(job));
    const possible = kActions.filter((action) => job.links[action] !== undefined);
    if (possible.join() === shown) return; // a button that is about to be pressed must not be replaced
    shown = possible.join();
    fill(actions, possible.flatMap((action) => actionButton(job, action)));
  }));
  const timer = setInterval(() => fill(facts, ...factsOf(context.job.value)), kFactsMs);
  context.lifetime.add(() => clearInterval(timer));
  return element;
}

function factsOf(job: Job): Node[] {
  const facts = [
    h("span", { title: moment(job.created_at) }, `submitted ${ago(job.created_at)}`),
    h("span", null, `${job.frame_count} frames`),
    h("span", null, bytes(job.bytes)),
    h("code", null, job.id),
  ];
  return job.owner ? [h("span", null, `by ${job.owner}`), ...facts] : facts;
}

function actionButton(job: Job, action: Action): Node[] {
  const label = { cancel: "Cancel", pause: "Pause", resume: "Resume", retry: "Retry" }[action];
  const run = (): void => void send("post", `/v1/jobs/{id}/${action}`, { path: { id: job.id } }).catch(toastError);
  return [
    h("button", { onclick: run }, label),
    copyCurlButton(() => curlOf("POST", `/v1/jobs/{id}/${action}`, { path: { id: job.id } }), `${label.toLowerCase()} this job`),
  ];
}
