// One job in the list. Made once and then kept true, so that what somebody is about to press stays where it is.
import { curlOf } from "../api/curl";
import { isFinal, type Job } from "../api/types";
import { ago, moment } from "../base/format";
import { fill, h } from "../base/h";
import { copyText } from "../shell/copy_curl";
import { menuButton, type MenuEntry } from "../shell/menu";
import { actions, perform, setPinned, setPriority, type BatchAction } from "./actions";
import type { JobList } from "./job_list";
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
  list: JobList;
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
  const menu = menuButton(`Actions for ${first.name || id}`, () => entriesOf(job, context.list));
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
    const label = value === "" ? name : `${name}:${value}`;
    return h("button", { class: "label", title: `Show only jobs with ${label}`, onclick: () => context.filterByLabel(label) }, label);
  });
  return [
    h("code", { class: "job-id", title: job.id }, `…${job.id.slice(-6)}`),
    ...(job.owner ? [h("span", { class: "muted" }, job.owner)] : []),
    ...(job.pinned ? [h("span", { class: "muted", title: "Kept whatever its time to live says" }, "pinned")] : []),
    ...labels,
  ];
}

function entriesOf(job: Job, list: JobList): MenuEntry[] {
  const entries: MenuEntry[] = [];
  const { id } = job;
  for (const action of ["cancel", "pause", "resume", "retry"] as const)
    if (actions[action].possible(job))
      entries.push({ label: actions[action].label, run: () => void perform(action, [job], list), curl: () => curlOf("POST", `/v1/jobs/${id}/${action}`) });
  if (!isFinal(job.state))
    entries.push({ label: "Priority…", run: () => void setPriority([job], list), curl: () => curlOf("PATCH", `/v1/jobs/${id}`, { json: { priority: job.priority } }) });
  entries.push(
    { label: job.pinned ? "Unpin" : "Pin", run: () => void setPinned([job], !job.pinned, list), curl: () => curlOf("PATCH", `/v1/jobs/${id}`, { json: { pinned: !job.pinned } }) },
    { label: "Copy id", run: () => void copyText(id, "Id copied"), curl: () => curlOf("GET", `/v1/jobs/${id}`) },
  );
  if (!isFinal(job.state))
    entries.push({ label: "Copy: follow", run: () => void copyText(curlOf("GET", `/v1/jobs/${id}/events`, { stream: true }), "Command copied") });
  if (actions.delete.possible(job))
    entries.push({ label: "Delete…", danger: true, run: () => void perform("delete", [job], list), curl: () => curlOf("DELETE", `/v1/jobs/${id}`) });
  return entries;
}

/** What the toolbar offers for several jobs, with how many each would reach. */
export function batchEntries(jobs: readonly Job[]): { action: BatchAction; reach: number }[] {
  return (Object.keys(actions) as BatchAction[]).map((action) => ({ action, reach: jobs.filter(actions[action].possible).length }));
}
