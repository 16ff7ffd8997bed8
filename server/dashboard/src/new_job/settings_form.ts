// The form: a control for each setting, with its unit, its meaning, and what is wrong with it beside it.
import type { ProblemError } from "../api/types";
import { h } from "../base/h";
import { kSettings, type SettingsField } from "./settings_fields";
import type { Settings } from "./upload";

export interface SettingsForm {
  readonly element: HTMLElement;
  /** Only what was set. */
  values(): Settings;
  /** Shows those that belong to a control, and answers the others. */
  showErrors(errors: readonly ProblemError[]): ProblemError[];
  /** What the animation says now, as where the form starts. */
  start(animation: Record<string, unknown> | null): void;
}

interface Control {
  readonly field: SettingsField;
  readonly element: HTMLElement;
  readonly input: HTMLInputElement | HTMLSelectElement;
  readonly error: HTMLElement;
}

let nextId = 0;

export function settingsForm(changed: () => void): SettingsForm {
  const controls: Control[] = [];
  const groups = kSettings.map(({ title, fields, folded }) => {
    const own = fields.map((field) => control(field, changed));
    controls.push(...own);
    const body = h("div", { class: "settings-fields" }, own.map(({ element }) => element));
    return folded
      ? h("details", { class: "settings-group" }, h("summary", null, title), body)
      : h("fieldset", { class: "settings-group" }, h("legend", null, title), body);
  });
  const element = h("div", { class: "settings" }, groups);
  return {
    element,
    values: () => Object.fromEntries(controls.map(({ field, input }) => [field.pointer, valueOf(field, input)])),
    showErrors: (errors) => showErrors(controls, errors),
    start: (animation) => {
      for (const { field, input } of controls) setValue(field, input, animation === null ? undefined : inAnimation(animation, field.pointer));
      for (const { input } of controls) input.disabled = animation === null;
    },
  };
}

function control(field: SettingsField, changed: () => void): Control {
  const id = `setting-${++nextId}`;
  const described = `${id}-help ${id}-error`;
  const input = makeInput(field, { id, "aria-describedby": described, onchange: changed, oninput: changed });
  const error = h("div", { class: "bad small", id: `${id}-error` });
  const unit = field.input.kind === "number" ? field.input.unit : "";
  const element = h("div", { class: "setting" },
    h("label", { for: id }, field.label), h("div", { class: "setting-input" }, input, unit ? h("span", { class: "muted small" }, unit) : null),
    h("div", { class: "muted small", id: `${id}-help` }, field.help), error);
  return { field, element, input, error };
}

function makeInput({ input }: SettingsField, attributes: Record<string, unknown>): HTMLInputElement | HTMLSelectElement {
  if (input.kind === "choice")
    return h("select", attributes, h("option", { value: "" }, "as the file says"), input.values.map(([value, label]) => h("option", { value }, label)));
  if (input.kind === "tick")
    return h("select", attributes, h("option", { value: "" }, "as the file says"), h("option", { value: "yes" }, "yes"), h("option", { value: "no" }, "no"));
  return h("input", { ...attributes, type: "number", min: input.least, max: input.most, step: input.step ?? "any", placeholder: input.shown ?? "", inputmode: "decimal" });
}

function valueOf(field: SettingsField, { value }: HTMLInputElement | HTMLSelectElement): unknown {
  if (value.trim() === "") return undefined;
  if (field.input.kind === "number") return Number(value);
  return field.input.kind === "tick" ? value === "yes" : value;
}

function setValue(field: SettingsField, input: HTMLInputElement | HTMLSelectElement, value: unknown): void {
  if (field.input.kind === "tick") input.value = value === true ? "yes" : value === false ? "no" : "";
  else input.value = typeof value === "number" || typeof value === "string" ? String(value) : "";
}

/** Of images the first speaks for all, where they agree. */
function inAnimation(animation: Record<string, unknown>, pointer: string): unknown {
  const [section, name] = pointer.slice(1).split("/") as [string, string];
  const place = animation[section];
  if (section !== "images") return (place as Record<string, unknown> | undefined)?.[name];
  const values = Array.isArray(place) ? place.map((image: Record<string, unknown>) => image[name]) : [];
  return values.every((value) => value === values[0]) ? values[0] : undefined;
}

function showErrors(controls: readonly Control[], errors: readonly ProblemError[]): ProblemError[] {
  const left: ProblemError[] = [];
  const at = new Map<Control, string[]>();
  for (const error of errors) {
    const pointer = error.pointer?.replace(/^\/images\/\d+\//, "/images/");
    const found = error.file === "animation.json" ? controls.find(({ field }) => field.pointer === pointer) : undefined;
    if (found) at.set(found, [...(at.get(found) ?? []), error.detail]);
    else left.push(error);
  }
  for (const one of controls) {
    const texts = at.get(one) ?? [];
    one.error.textContent = [...new Set(texts)].join("; ");
    one.input.setAttribute("aria-invalid", String(texts.length > 0));
  }
  return left;
}
