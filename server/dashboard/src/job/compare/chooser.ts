// Which jobs to compare.
import { get, urlOf } from "../../api/client";
import { messageOf } from "../../api/api_error";
import type { Job } from "../../api/types";
import { ago } from "../../base/format";
import { fill, h } from "../../base/h";
import type { PageContext } from "../../shell/page";
import { navigate } from "../../shell/router";
import { referenceOf } from "./reference";

const kListed = 100;

export function comparePath(a: string, b: string): string {
  return urlOf("/compare", { query: { a, b } });
}

export function chooser({ lifetime }: PageContext, a: string | null, b: string | null): HTMLElement {
  const first = h("select", { name: "a", "aria-label": "Job A" });
  const second = h("select", { name: "b", "aria-label": "Job B" });
  const status = h("span", { class: "small muted", role: "status" });
  const reference = h("button", {
    type: "button", disabled: true, title: "Submits A again with every frame solved, or takes the run of before, and compares the two",
    onclick: () => void compareWithReference(),
  }, "A with a reference run");
  const over = new AbortController();
  lifetime.add(() => over.abort());

  async function compareWithReference(): Promise<void> {
    reference.disabled = true;
    status.textContent = "Submitting it again with every frame solved…";
    try {
      const id = first.value;
      navigate(comparePath(id, (await referenceOf(id, over.signal)).id));
    } catch (error) {
      reference.disabled = false;
      status.textContent = over.signal.aborted ? "" : messageOf(error);
    }
  }
  get("/v1/jobs", { query: { state: "succeeded", limit: kListed } }).then(({ jobs }) => {
    fill(first, optionsOf(jobs, a));
    fill(second, optionsOf(jobs, b));
    first.value = a ?? jobs[0]?.id ?? "";
    second.value = b ?? jobs.find(({ id }) => id !== first.value)?.id ?? "";
    reference.disabled = first.value === "";
    nameOption(first, a);
    nameOption(second, b);
  }, () => {}); // the header says that the service is away
  return h("form", {
    class: "row", onsubmit: (event) => {
      event.preventDefault();
      navigate(comparePath(first.value, second.value));
    },
  }, h("label", null, "A ", first), h("label", null, "B ", second), h("button", { class: "primary" }, "Compare"), reference, status);
}

/** Newest first; the one that the address names also where it is older or not done. */
function optionsOf(jobs: readonly Job[], named: string | null): Node[] {
  const options = jobs.map((job) => h("option", { value: job.id }, nameOf(job)));
  return named === null || jobs.some(({ id }) => id === named) ? options : [h("option", { value: named }, shortName(named)), ...options];
}

function nameOf({ name, id, created_at }: Job): string {
  return `${name || "without a name"} · …${id.slice(-6)} · ${ago(created_at)}`;
}

/** Of a job that was not in the list. */
function nameOption(select: HTMLSelectElement, id: string | null): void {
  const option = [...select.options].find(({ value }) => value === id);
  if (id !== null && option && option.textContent === shortName(id))
    get("/v1/jobs/{id}", { path: { id } }).then((job) => (option.textContent = nameOf(job)), () => {}); // the page says what is wrong with it
}

function shortName(id: string): string {
  return `…${id.slice(-6)}`;
}
