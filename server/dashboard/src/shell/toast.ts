// Short messages at the edge, read out by screen readers.
import { messageOf } from "../api/api_error";
import { h } from "../base/h";

export interface ToastOptions {
  kind?: "info" | "good" | "bad";
  action?: { label: string; run: () => void };
}

const kShownMs = 6_000;
const kShownAtOnceMax = 4;

/** Two lists, both there from the start: a region that appears together with its text is not read out. */
export function toastRegion(): HTMLElement {
  return h("div", { class: "toasts" },
    h("div", { id: "toasts-polite", role: "status", "aria-live": "polite" }),
    h("div", { id: "toasts-urgent", role: "alert" }));
}

/** Shows `text` for a while; what went wrong stays until it is dismissed. */
export function toast(text: string, options: ToastOptions = {}): void {
  const bad = options.kind === "bad";
  const region = document.getElementById(bad ? "toasts-urgent" : "toasts-polite");
  if (!region) return;
  const item = h("div", { class: `toast toast-${options.kind ?? "info"}` }, h("span", null, text));
  const remove = (): void => item.remove();
  const { action } = options;
  if (action)
    item.append(h("button", { class: "quiet", onclick: () => { remove(); action.run(); } }, action.label));
  item.append(h("button", { class: "quiet icon", "aria-label": "Dismiss", onclick: remove }, "×"));
  while (region.children.length >= kShownAtOnceMax) region.firstChild!.remove();
  region.append(item);
  if (!bad) setTimeout(remove, kShownMs);
}

export function toastError(error: unknown, what = ""): void {
  if (error instanceof DOMException && error.name === "AbortError") return;
  toast(what ? `${what}: ${messageOf(error)}` : messageOf(error), { kind: "bad" });
}
