// How the queue treats the job: api/schemas/job_options.schema.json.
import type { Job } from "../api/types";
import { h } from "../base/h";
import { labelsOf, labelsText } from "../base/labels";

const kSecondsPerDay = 86_400;

export type GivenOptions = Partial<Pick<Job, "name" | "priority" | "labels" | "ttl_seconds" | "pinned">>;

export interface JobOptionsForm {
  readonly element: HTMLElement;
  /** Only what was set. */
  values(): Record<string, unknown>;
  /** As another job has them, or a file of options. */
  start(given: GivenOptions): void;
}

export function jobOptionsForm(changed: () => void): JobOptionsForm {
  const events = { oninput: changed };
  const name = h("input", { ...events, type: "text", maxlength: 200, placeholder: "as the animation says" });
  const priority = h("input", { ...events, type: "number", min: 0, max: 100, step: 1, placeholder: "50" });
  const labels = h("input", { ...events, type: "text", placeholder: "project=garage, take=3" });
  const days = h("input", { ...events, type: "number", min: 0, step: 1, placeholder: "as the operator has chosen" });
  const pinned = h("input", { ...events, type: "checkbox" });
  const line = (label: string, input: HTMLInputElement, help: string): HTMLElement => {
    input.id = `option-${label.toLowerCase().replaceAll(" ", "-")}`;
    input.setAttribute("aria-describedby", `${input.id}-help`);
    return h("div", { class: "setting" }, h("label", { for: input.id }, label), h("div", { class: "setting-input" }, input),
      h("div", { class: "muted small", id: `${input.id}-help` }, help));
  };
  return {
    element: h("fieldset", { class: "settings-group" }, h("legend", null, "In the queue"), h("div", { class: "settings-fields" },
      line("Name", name, "For people."), line("Priority", priority, "0 to 100; higher is sooner. A minute of waiting is worth a point."),
      line("Labels", labels, "To find it by."), line("Keep for", days, "Days after it finished; then it is removed."),
      h("label", { class: "setting" }, h("span", null, pinned, " Pinned"), h("span", { class: "muted small" }, "Never removed by itself.")))),
    start(given) {
      name.value = given.name ?? "";
      priority.value = String(given.priority ?? "");
      labels.value = labelsText(given.labels ?? {});
      days.value = given.ttl_seconds ? String(given.ttl_seconds / kSecondsPerDay) : "";
      pinned.checked = given.pinned ?? false;
    },
    values: () => ({
      ...(name.value.trim() ? { name: name.value.trim() } : {}),
      ...(priority.value ? { priority: Number(priority.value) } : {}),
      ...(labels.value.trim() ? { labels: labelsOf(labels.value) } : {}),
      ...(days.value ? { ttl_seconds: Math.round(Number(days.value) * kSecondsPerDay) } : {}),
      ...(pinned.checked ? { pinned: true } : {}),
    }),
  };
}
