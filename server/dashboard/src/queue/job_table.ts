// The list itself: rows in order, selection by mouse and keyboard.
import type { Job } from "../api/types";
import { h } from "../base/h";
import type { Lifetime } from "../base/signal";
import { navigate } from "../shell/router";
import type { JobKeeper } from "./actions";
import type { JobList } from "./job_list";
import { jobRow, type JobRow, type RowContext } from "./job_row";
import type { Selection } from "./selection";

const kAgoMs = 20_000; // "3 min ago" grows old by itself

export function jobTable(list: JobList, keeper: JobKeeper, selection: Selection, lifetime: Lifetime, filterByLabel: (label: string) => void): HTMLElement {
  const rows = new Map<string, JobRow>();
  const body = h("tbody");
  const shown = (): readonly string[] => list.jobs.value.map((job) => job.id);
  const all = h("input", { type: "checkbox", "aria-label": "Select all that are shown", onclick: () => (all.checked ? selection.setAll(shown()) : selection.clear()) });
  const table = h("table", { class: "jobs", "aria-label": "Jobs" },
    h("thead", null, h("tr", null,
      h("th", { class: "cell-check" }, all), h("th", { class: "cell-picture" }, h("span", { class: "visually-hidden" }, "Picture")), h("th", null, "Job"), h("th", null, "State"),
      h("th", { class: "cell-progress" }, "Progress"), h("th", { class: "number cell-priority" }, "Priority"), h("th", null, "Submitted"),
      h("th", null, h("span", { class: "visually-hidden" }, "Actions")))),
    body);
  const context: RowContext = { keeper, selection, shown, filterByLabel };

  lifetime.add(list.jobs.watch((jobs) => {
    showRows(body, rows, jobs, context);
    selection.keepOnly(jobs.map((job) => job.id));
  }));
  lifetime.add(selection.ids.watch((ids) => {
    for (const [id, row] of rows) row.setSelected(ids.has(id));
    all.checked = ids.size > 0 && ids.size === rows.size;
    all.indeterminate = ids.size > 0 && ids.size < rows.size;
  }));
  lifetime.add(() => rows.forEach((row) => row.stop()));
  const timer = setInterval(() => list.jobs.value.forEach((job) => rows.get(job.id)?.show(job)), kAgoMs);
  lifetime.add(() => clearInterval(timer));
  body.addEventListener("keydown", (event) => onKey(event, body, selection, shown()));
  return table;
}

function showRows(body: HTMLElement, rows: Map<string, JobRow>, jobs: readonly Job[], context: RowContext): void {
  const there = new Set(jobs.map((job) => job.id));
  for (const [id, row] of rows) {
    if (there.has(id)) continue;
    row.stop();
    row.element.remove();
    rows.delete(id);
  }
  jobs.forEach((job, i) => {
    let row = rows.get(job.id);
    if (!row) rows.set(job.id, (row = jobRow(job, context)));
    row.show(job);
    row.setSelected(context.selection.has(job.id));
    // Moving a row that is in its place would take the focus from what is in it.
    if (body.children[i] !== row.element) body.insertBefore(row.element, body.children[i] ?? null);
  });
  // One of them can be reached by Tab, the others by arrows.
  if (!body.querySelector('tr[tabindex="0"]')) body.querySelector("tr")?.setAttribute("tabindex", "0");
}

/** Arrows move, Space chooses, Shift+arrows choose on the way, Enter opens, Ctrl+A takes all, Escape none. */
function onKey(event: KeyboardEvent, body: HTMLElement, selection: Selection, shown: readonly string[]): void {
  const target = event.target as HTMLElement;
  const row = target.closest("tr");
  const id = row?.dataset["id"];
  if (!row || id === undefined || target.closest(".menu")) return;
  const onRow = target === row;
  if (event.key === "ArrowDown" || event.key === "ArrowUp") {
    const next = (event.key === "ArrowDown" ? row.nextElementSibling : row.previousElementSibling) as HTMLElement | null;
    if (!next) return;
    if (event.shiftKey && !selection.has(id)) selection.toggle(id);
    focusRow(body, next);
    if (event.shiftKey) selection.extendTo(next.dataset["id"]!, shown);
  } else if (event.key === " " && onRow) {
    if (event.shiftKey) selection.extendTo(id, shown);
    else selection.toggle(id);
  } else if (event.key === "Enter" && onRow) {
    navigate(`/jobs/${id}`);
  } else if (event.key === "a" && event.ctrlKey) {
    selection.setAll(shown);
  } else if (event.key === "Escape") {
    selection.clear();
  } else {
    return;
  }
  event.preventDefault();
  event.stopPropagation();
}

export function focusRow(body: HTMLElement, row: HTMLElement): void {
  body.querySelector('tr[tabindex="0"]')?.setAttribute("tabindex", "-1");
  row.tabIndex = 0;
  row.focus();
  row.scrollIntoView({ block: "nearest" });
}
