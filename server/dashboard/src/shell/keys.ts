// Keyboard commands: single keys ("k"), with modifiers ("Shift+ArrowLeft"), or two in a row ("g q"). "?" lists them.
import { h } from "../base/h";
import type { Lifetime } from "../base/signal";
import { openDialog } from "./dialog";

export interface KeyCommand {
  keys: string;
  /** For the list of commands. */
  does: string;
  run(event: KeyboardEvent): void;
}

interface Group {
  title: string;
  commands: readonly KeyCommand[];
}

const kSecondKeyMs = 1_200;
const groups = new Set<Group>();
let first: { key: string; at: number } | null = null;

/** Until the lifetime ends; later ones win over earlier ones. */
export function addKeys(lifetime: Lifetime, title: string, commands: readonly KeyCommand[]): void {
  const group = { title, commands };
  groups.add(group);
  lifetime.add(() => void groups.delete(group));
}

function isTyping(target: EventTarget | null): boolean {
  if (!(target instanceof HTMLElement)) return false;
  if (target.isContentEditable || target instanceof HTMLTextAreaElement || target instanceof HTMLSelectElement) return true;
  return target instanceof HTMLInputElement && !["checkbox", "radio", "button", "submit", "range", "color", "file"].includes(target.type);
}

/** " " on a button presses it, arrows on a slider move it: those are the control's own. */
function isOfControl(event: KeyboardEvent): boolean {
  const target = event.target;
  if (!(target instanceof HTMLElement)) return false;
  if (event.key === " " || event.key === "Enter") return target.matches("button, a, input, summary, [role=tab], [role=menuitem]");
  return event.key.startsWith("Arrow") && target.matches("input, select, [role=tab], [role=slider], [role=menuitem]");
}

export function nameOf(event: KeyboardEvent): string {
  const named = event.key.length > 1;
  const modifiers = [event.ctrlKey && "Ctrl", event.altKey && "Alt", event.metaKey && "Meta", event.shiftKey && named && "Shift"];
  return [...modifiers.filter(Boolean), event.key === " " ? "Space" : event.key].join("+");
}

function find(keys: string): KeyCommand | undefined {
  for (const group of [...groups].reverse()) {
    const found = group.commands.find((command) => command.keys === keys);
    if (found) return found;
  }
  return undefined;
}

export function startKeys(): void {
  window.addEventListener("keydown", (event) => {
    if (event.defaultPrevented || event.isComposing || isTyping(event.target) || isOfControl(event)) return;
    if (document.querySelector("dialog[open]")) return;
    const name = nameOf(event);
    const both = first && event.timeStamp - first.at < kSecondKeyMs ? find(`${first.key} ${name}`) : undefined;
    first = { key: name, at: event.timeStamp };
    const command = both ?? find(name);
    if (!command) return;
    first = null;
    event.preventDefault();
    command.run(event);
  });
}

export async function showKeys(): Promise<void> {
  await openDialog("Keyboard", (close) => [
    h("div", { class: "dialog-body" },
      [...groups].map((group) => h("section", null, h("h3", null, group.title),
        h("dl", { class: "keys" }, group.commands.flatMap((command) => [
          h("dt", null, command.keys.split(" ").flatMap((key, i) => [i > 0 ? " then " : null, h("kbd", null, key)])),
          h("dd", null, command.does),
        ]))))),
    h("div", { class: "dialog-actions" }, h("button", { onclick: () => close(""), autofocus: true }, "Close")),
  ]);
}
