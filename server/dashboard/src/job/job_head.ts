// The top of a job's page: state, progress, what can be done with it.
import type { Job } from "../api/types";
import { ago, bytes, moment } from "../base/format";
import { forecastText } from "../base/forecast";
import { fill, h } from "../base/h";
import { copyCurlButton } from "../shell/copy_curl";
import { menuButton } from "../shell/menu";
import type { JobKeeper } from "../queue/actions";
import { jobEntries, type JobEntry } from "../queue/job_entries";
import { progressBar } from "../queue/progress_bar";
import { stateBadge } from "../queue/state_badge";
import type { JobContext } from "./job_part";

/** "3 min ago" goes on being true. */
const kFactsMs = 20_000;
/** As in shell.css: there the menu has them all. */
const kNarrow = "(max-width: 48rem)";

export function jobHead(context: JobContext, keeper: JobKeeper): HTMLElement {
  const element = h("section", { class: "job-head", "aria-label": "State" });
  const bar = progressBar();
  const facts = h("div", { class: "row muted small" });
  const state = h("div", { class: "row" });
  const buttons = h("div", { class: "row job-buttons" });
  const entries = (): JobEntry[] => jobEntries(context.job.value, keeper);
  const menu = menuButton("Actions for this job", () => entries().filter(({ button }) => !button || matchMedia(kNarrow).matches));
  fill(element, h("div", { class: "job-head-line" }, state, h("div", { class: "row job-actions" }, buttons, menu)), bar.element, facts);
  let shown = "";
  context.lifetime.add(context.job.watch((job) => {
    bar.show(job);
    fill(state, stateBadge(job), job.reason ? h("span", { class: job.state === "failed" ? "bad" : "muted" }, job.reason) : null);
    fill(facts, ...factsOf(job));
    const possible = entries().filter(({ button }) => button);
    const next = possible.map(({ label }) => label).join();
    if (next === shown) return; // a button that is about to be pressed must not be replaced
    shown = next;
    fill(buttons, possible.flatMap(({ label }) => actionButton(label, entries)));
  }));
  const timer = setInterval(() => fill(facts, ...factsOf(context.job.value)), kFactsMs);
  context.lifetime.add(() => clearInterval(timer));
  return element;
}

function factsOf(job: Job): Node[] {
  const facts = [
    h("span", { title: moment(job.created_at) }, `submitted ${ago(job.created_at)}`),
    h("span", null, `${job.frame_count} frames`),
    ...(job.started_at === null && job.forecast ? [h("span", null, `takes ${forecastText(job.forecast)}`)] : []),
    h("span", null, bytes(job.bytes)),
    h("code", null, job.id),
  ];
  return job.owner ? [h("span", null, `by ${job.owner}`), ...facts] : facts;
}

/** What it does is looked up when it is pressed: the job has gone on since. */
function actionButton(label: string, entries: () => JobEntry[]): Node[] {
  const find = (): JobEntry | undefined => entries().find((entry) => entry.label === label);
  const { curl, danger } = find()!;
  return [
    h("button", { class: danger ? "bad" : "", onclick: () => find()?.run() }, label),
    ...(curl ? [copyCurlButton(() => (find()?.curl ?? curl)(), `${label.replace("…", "").toLowerCase()} this job`)] : []),
  ];
}
