// One job in the list. Made once and then kept true, so that what somebody is about to press stays where it is.
import type { Job } from "../api/types";
import { ago, moment } from "../base/format";
import { fill, h } from "../base/h";
import { labelText } from "../base/labels";
import { menuButton } from "../shell/menu";
import { actions, type BatchAction, type JobKeeper } from "./actions";
import { jobEntries } from "./job_entries";
import { progressBar } from "./progress_bar";
import type { Selection } from "./selection";
import { stateBadge } from "./state_badge";
import { thumbnail } from "./thumbnail";

export interface JobRow {
  element: HTMLTableRowElement;
  show(job: Job): void;
  setSelected(selected: boolean): void;
  stop(): void;
}

export interface RowContext {
  keeper: JobKeeper;
  selection: Selection;
  /** The ids in the order they are shown. */
  shown(): readonly string[];
  filterByLabel(label: string): void;
}

export function jobRow(first: Job, context: RowContext): JobRow {
  const { id } = first;
  let job = first;
  const check = h("input", {
    type: "checkbox", tabindex: -1, onclick: (event) => {
      if (event.shiftKey) context.selection.extendTo(id, context.shown());
      else context.selection.toggle(id);
    },
  });
  const picture = thumbnail();
  const name = h("a", { class: "job-name", href: `/jobs/${id}` });
  const about = h("div", { class: "job-about" });
  const state = h("div", { class: "job-state" });
  const reason = h("div", { class: "job-reason" });
  const bar = progressBar();
  const priority = h("td", { class: "number cell-priority" });
  const time = h("td", { class: "cell-time" });
  const menu = menuButton(`Actions for ${first.name || id}`, () => jobEntries(job, context.keeper));
  const element = h("tr", { tabindex: -1, "data-id": id },
    h("td", { class: "cell-check" }, check),
    h("td", { class: "cell-picture" }, h("a", { href: `/jobs/${id}`, tabindex: -1, "aria-hidden": "true" }, picture.element)),
    h("td", { class: "cell-name" }, name, about),
    h("td", { class: "cell-state" }, state, reason),
    h("td", { class: "cell-progress" }, bar.element),
    priority, time,
    h("td", { class: "cell-menu" }, menu));
  let shownAbout = "";
  return {
    element,
    show(now) {
      job = now;
      name.textContent = job.name || job.id;
      check.setAttribute("aria-label", `Select ${job.name || job.id}`);
      fill(state, stateBadge(job));
      reason.textContent = job.state === "failed" || job.state === "paused" ? (job.reason ?? "") : "";
      reason.title = job.reason ?? "";
      bar.show(job);
      picture.show(job);
      priority.textContent = String(job.priority);
      time.textContent = ago(job.created_at);
      time.title = moment(job.created_at);
      const next = JSON.stringify([job.labels, job.owner, job.pinned]);
      if (next !== shownAbout) fill(about, aboutOf(job, context));
      shownAbout = next;
    },
    setSelected(selected) {
      check.checked = selected;
      element.classList.toggle("selected", selected);
    },
    stop: () => picture.stop(),
  };
}

function aboutOf(job: Job, context: RowContext): Node[] {
  const labels = Object.entries(job.labels).map(([name, value]) => {
    const label = labelText(name, value);
    return h("button", { class: "label", title: `Show only jobs with ${label}`, onclick: () => context.filterByLabel(label) }, label);
  });
  return [
    h("code", { class: "job-id", title: job.id }, `…${job.id.slice(-6)}`),
    ...(job.owner ? [h("span", { class: "muted" }, job.owner)] : []),
    ...(job.pinned ? [h("span", { class: "muted", title: "Kept whatever its time to live says" }, "pinned")] : []),
    ...labels,
  ];
}

/** What the toolbar offers for several jobs, with how many each would reach. */
export function batchEntries(jobs: readonly Job[]): { action: BatchAction; reach: number }[] {
  return (Object.keys(actions) as BatchAction[]).map((action) => ({ action, reach: jobs.filter(actions[action].possible).length }));
}
