// The queue: all jobs, what they are doing, what can be done with them.
import { messageOf } from "../api/api_error";
import { urlOf } from "../api/client";
import { curlOf } from "../api/curl";
import { forecastOfExample, submitExample } from "../api/examples";
import { isFinal } from "../api/types";
import { forecastText } from "../base/forecast";
import { count } from "../base/format";
import { fill, h } from "../base/h";
import type { Lifetime } from "../base/signal";
import { copyCurlButton } from "../shell/copy_curl";
import { addKeys } from "../shell/keys";
import type { OpenPage } from "../shell/page";
import { navigate } from "../shell/router";
import { toast, toastError } from "../shell/toast";
import { actions, perform, setPinned, setPriority, type JobKeeper } from "./actions";
import { filterOf, filters, isFiltering } from "./filters";
import { JobList, type Filter } from "./job_list";
import { batchEntries } from "./job_row";
import { jobTable } from "./job_table";
import { queueNow, queuePause, queueSummary } from "./queue_state";
import { Selection } from "./selection";
import "./queue.css";

export const openQueuePage: OpenPage = ({ query, lifetime, setTitle, setTools }) => {
  setTitle("Queue");
  let filter = filterOf(query);
  const list = new JobList(filter, lifetime);
  const selection = new Selection();
  const { queue, look } = queueNow(lifetime);
  const keeper: JobKeeper = {
    put: (job) => list.put(job),
    remove: (ids) => list.remove(ids),
    reload: () => {
      look();
      return list.reload();
    },
  };
  const pause = queuePause(queue, lifetime);
  const chosen = filters(filter, (next) => {
    filter = next;
    list.setFilter(next);
  });
  lifetime.add(queue.watch((now) => now && chosen.showCounts(now)));
  setTools(queueSummary(queue, lifetime), pause.button, h("a", { class: "button primary", href: "/new" }, "New job"));

  const table = jobTable(list, keeper, selection, lifetime, (label) => chosen.setLabel(label));
  const message = h("div", { class: "queue-message" });
  const more = h("button", { onclick: () => void loadMore() }, "More");
  const known = h("span", { class: "muted" });
  const showAll = (): void => {
    const { state, jobs } = list;
    const none = jobs.value.length === 0;
    table.hidden = none;
    more.parentElement!.hidden = list.loaded === 0;
    more.hidden = !list.more.value;
    more.disabled = list.searching.value;
    more.textContent = isSearching(filter) ? "Search further" : "More";
    known.textContent = footOf(list, isSearching(filter));
    if (!none) return message.replaceChildren();
    if (state.value === "loading") fill(message, h("p", { class: "muted" }, "Fetching jobs…"));
    else if (state.value === "failed") fill(message, troubleNotice(list));
    else fill(message, isFiltering(filter) ? nothingFits(() => chosen.clear()) : emptyNotice());
  };
  async function loadMore(): Promise<void> {
    more.disabled = true;
    await list.loadMore().catch(toastError);
    showAll();
  }
  const page = h("div", { class: "queue" }, pause.bar, h("div", { class: "queue-bar" }, chosen.element, selectionBar(list, keeper, selection, lifetime)),
    table, message, h("div", { class: "row queue-foot" }, more, known));
  for (const signal of [list.jobs, list.state, list.more, list.searching]) lifetime.add((signal as { watch(listener: () => void): () => void }).watch(showAll));
  addQueueKeys(list, keeper, selection, lifetime, table, () => chosen.focusSearch());
  return page;
};

function isSearching({ text }: Filter): boolean {
  return text !== "";
}

/** How much has been looked at, so that nobody takes what is shown for all there is. */
function footOf(list: JobList, searching: boolean): string {
  const found = list.jobs.value.length;
  if (!searching) return count(found, "job");
  const looked = `${found.toLocaleString("en")} found among the newest ${count(list.loaded, "job")}`;
  if (list.searching.value) return `${looked}, searching…`;
  return list.more.value ? `${looked}; there are older ones` : `${found.toLocaleString("en")} found among all ${count(list.loaded, "job")}`;
}

/** What can be done with the jobs chosen. */
function selectionBar(list: JobList, keeper: JobKeeper, selection: Selection, lifetime: Lifetime): HTMLElement {
  const bar = h("div", { class: "row selection-bar", role: "toolbar", "aria-label": "Chosen jobs", hidden: true });
  let shown = "";
  const show = (): void => {
    const jobs = [...selection.ids.value].flatMap((id) => list.job(id) ?? []);
    const entries = batchEntries(jobs).filter(({ reach }) => reach > 0);
    const next = `${jobs.map((job) => job.pinned + job.state).join()} ${entries.map(({ action, reach }) => action + reach).join()}`;
    bar.hidden = jobs.length === 0;
    if (next === shown) return;
    shown = next;
    const now = (): typeof jobs => [...selection.ids.value].flatMap((id) => list.job(id) ?? []);
    const [a, b] = jobs;
    const pair = jobs.length === 2 && jobs.every((job) => job.state === "succeeded");
    fill(bar, h("span", null, `${jobs.length} chosen`),
      pair ? h("button", { onclick: () => navigate(urlOf("/compare", { query: { a: a!.id, b: b!.id } })) }, "Compare") : null,
      entries.map(({ action, reach }) => h("button", { class: action === "delete" ? "bad" : "", onclick: () => void perform(action, now(), keeper) },
        `${actions[action].label} ${reach}`)),
      entries.slice(0, 1).map(({ action }) => copyCurlButton(
        () => curlOf("POST", "/v1/jobs/batch", { json: { ids: now().map((job) => job.id), action } }), `${actions[action].label.toLowerCase()} these`)),
      jobs.some((job) => !isFinal(job.state)) ? h("button", { onclick: () => void setPriority(now(), keeper) }, "Priority…") : null,
      h("button", { onclick: () => void setPinned(now(), !jobs.every((job) => job.pinned), keeper) }, jobs.every((job) => job.pinned) ? "Unpin" : "Pin"),
      h("button", { class: "quiet", onclick: () => selection.clear() }, "None"));
  };
  lifetime.add(selection.ids.watch(show), list.jobs.watch(show));
  return bar;
}

function addQueueKeys(list: JobList, keeper: JobKeeper, selection: Selection, lifetime: Lifetime, table: HTMLElement, search: () => void): void {
  const chosen = () => [...selection.ids.value].flatMap((id) => list.job(id) ?? []);
  const first = (): void => (table.querySelector('tr[tabindex="0"]') as HTMLElement | null)?.focus();
  addKeys(lifetime, "Queue", [
    { keys: "/", does: "Search", run: search },
    { keys: "j", does: "To the list; then arrows move, Space chooses, Shift+arrows choose several, Enter opens", run: first },
    { keys: "Ctrl+a", does: "Choose all that are shown", run: () => selection.setAll(list.jobs.value.map((job) => job.id)) },
    { keys: "Escape", does: "Choose none", run: () => selection.clear() },
    { keys: "c", does: "Cancel the chosen jobs", run: () => void perform("cancel", chosen(), keeper) },
    { keys: "p", does: "Pause the chosen jobs", run: () => void perform("pause", chosen(), keeper) },
    { keys: "r", does: "Retry the chosen jobs", run: () => void perform("retry", chosen(), keeper) },
    { keys: "Delete", does: "Delete the chosen jobs, after asking", run: () => void perform("delete", chosen(), keeper) },
  ]);
}

function troubleNotice(list: JobList): HTMLElement {
  return h("div", { class: "notice bad-notice", role: "alert" }, h("h2", null, "The jobs could not be fetched"), h("p", null, messageOf(list.error)),
    h("button", { onclick: () => void list.reload() }, "Try again"));
}

function nothingFits(clear: () => void): HTMLElement {
  return h("div", { class: "notice" }, h("p", null, "No job fits."), h("button", { onclick: clear }, "Show all jobs"));
}

const kExample = "garage";

function emptyNotice(): HTMLElement {
  const start = h("button", { class: "primary", onclick: () => void tryExample() }, "Try the example");
  async function tryExample(): Promise<void> {
    start.disabled = true;
    try {
      const job = await submitExample(kExample);
      toast("The example is on its way", { kind: "good" });
      navigate(`/jobs/${job.id}`);
    } catch (error) {
      toastError(error, "The example");
    }
    start.disabled = false;
  }
  const takes = h("span");
  forecastOfExample(kExample).then((forecast) => (takes.textContent = `Here it takes ${forecastText(forecast)}. `), () => {}); // a reader may not ask
  return h("div", { class: "notice queue-empty" },
    h("img", { src: "/examples/garage/preview.png", alt: "A toy plane above the floor of a garage, its shadow below it", width: 320, height: 180 }),
    h("div", null,
      h("h2", null, "No jobs yet"),
      h("p", null, "The example is an animated scene of a garage: a toy plane flies through it. ", takes, "When it is rendered, you can walk through its light."),
      h("div", { class: "row" }, start, h("a", { class: "button", href: "/new" }, "Submit a scene of your own"))));
}
