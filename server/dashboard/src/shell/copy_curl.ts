// "Copy as curl": beside every action there is the command that does the same.
import { h } from "../base/h";
import { openDialog } from "./dialog";
import { toast } from "./toast";

/** Copies, or shows what to copy where the browser does not allow it (a page that did not come by https). */
export async function copyText(text: string, what = "Copied"): Promise<void> {
  try {
    await navigator.clipboard.writeText(text);
    toast(what);
  } catch {
    await openDialog("Copy this", (close) => [
      h("textarea", { class: "mono", rows: 4, readonly: true, "aria-label": "Text to copy", onfocus: (event) => (event.target as HTMLTextAreaElement).select() }, text),
      h("div", { class: "dialog-actions" }, h("button", { onclick: () => close("") }, "Close")),
    ]);
  }
}

/** A small button that copies the command; `command` is made when it is pressed. `what`: the action in words. */
export function copyCurlButton(command: () => string, what: string): HTMLButtonElement {
  return h("button", {
    class: "quiet copy-curl",
    title: `Copy as curl: ${what}`,
    "aria-label": `Copy as curl: ${what}`,
    onclick: () => void copyText(command(), "Command copied"),
  }, "curl");
}
