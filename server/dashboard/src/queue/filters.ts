// What is shown: by state, by label, by words. In the address, so that it can be kept and sent on.
import { kJobStates, type Queue } from "../api/types";
import { h } from "../base/h";
import { labelFilters } from "../base/labels";
import { stateWords } from "./state_badge";
import type { Filter } from "./job_list";

export interface Filters {
  element: HTMLElement;
  setLabel(label: string): void;
  clear(): void;
  showCounts(queue: Queue): void;
  focusSearch(): void;
}

const kTypingMs = 250;

export function filterOf(query: URLSearchParams): Filter {
  const state = query.get("state") ?? "";
  return { state: kJobStates.some((known) => known === state) ? state : "", label: query.get("label") ?? "", text: query.get("q") ?? "" };
}

export function isFiltering(filter: Filter): boolean {
  return filter.state !== "" || filter.label !== "" || filter.text !== "";
}

function keepInAddress(filter: Filter): void {
  const query = new URLSearchParams();
  if (filter.state) query.set("state", filter.state);
  if (filter.label) query.set("label", filter.label);
  if (filter.text) query.set("q", filter.text);
  history.replaceState(history.state, "", query.size > 0 ? `/?${query}` : "/");
}

export function filters(first: Filter, changed: (filter: Filter) => void): Filters {
  const options = kJobStates.map((state) => h("option", { value: state }, stateWords[state]));
  const state = h("select", { "aria-label": "State" }, h("option", { value: "" }, "All states"), options);
  const label = h("input", { type: "search", "aria-label": "Labels", placeholder: "Labels, name=value", maxlength: 256 });
  const text = h("input", { type: "search", "aria-label": "Search in names, ids, owners and labels", placeholder: "Search", maxlength: 128 });
  const markWrong = (): void => {
    const { wrong } = labelFilters(label.value);
    label.setAttribute("aria-invalid", String(wrong.length > 0));
    label.title = wrong.length > 0 ? `No label is called ${wrong.join(", ")}` : "Labels as name=value or a name alone; several with commas between";
  };
  const set = (filter: Filter): void => {
    state.value = filter.state;
    label.value = filter.label;
    text.value = filter.text;
    markWrong();
  };
  set(first);
  let timer: ReturnType<typeof setTimeout> | undefined;
  const tell = (): void => {
    const filter = { state: state.value, label: label.value.trim(), text: text.value.trim() };
    markWrong();
    keepInAddress(filter);
    changed(filter);
  };
  const soon = (): void => {
    clearTimeout(timer);
    timer = setTimeout(tell, kTypingMs);
  };
  state.addEventListener("change", tell);
  label.addEventListener("input", soon);
  text.addEventListener("input", soon);
  return {
    element: h("div", { class: "row filters", role: "search" }, text, state, label),
    setLabel(value) {
      label.value = value;
      tell();
    },
    clear() {
      set({ state: "", label: "", text: "" });
      tell();
    },
    showCounts(queue) {
      options.forEach((option, i) => {
        const known = kJobStates[i]!;
        option.textContent = `${stateWords[known]} (${queue.jobs[known] ?? 0})`;
      });
    },
    focusSearch: () => text.focus(),
  };
}
