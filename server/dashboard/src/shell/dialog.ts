// Dialogs: modal, closed by Escape, focus returns to where it was.
import { append, h } from "../base/h";

export interface Confirmation {
  title: string;
  /** What will happen, in full: what is lost, what goes on. */
  body: (Node | string)[];
  /** The button that does it; a verb and what it is done to: "Delete 3 jobs". */
  confirm: string;
  danger?: boolean;
}

/** Opens a dialog with `content`; resolves when it is closed. `close` is handed to whoever builds the content. */
export function openDialog(title: string, build: (close: (answer: string) => void) => Node[]): Promise<string> {
  return new Promise((resolve) => {
    const dialog = h("dialog", { "aria-labelledby": "dialog-title" });
    const close = (answer: string): void => dialog.close(answer);
    dialog.append(h("h2", { id: "dialog-title" }, title));
    append(dialog, build(close));
    dialog.addEventListener("click", (event) => event.target === dialog && close(""));
    dialog.addEventListener("close", () => {
      dialog.remove();
      resolve(dialog.returnValue);
    });
    document.body.append(dialog);
    dialog.showModal();
  });
}

/** Asks before something that cannot be undone. Escape, the cancel button and a click beside it mean no. */
export async function confirmDialog(what: Confirmation): Promise<boolean> {
  const answer = await openDialog(what.title, (close) => [
    h("div", { class: "dialog-body" }, what.body),
    h("div", { class: "dialog-actions" },
      // What cannot be undone is not done by a key pressed in passing.
      h("button", { onclick: () => close(""), autofocus: what.danger }, "Cancel"),
      h("button", { class: what.danger ? "danger" : "primary", onclick: () => close("yes"), autofocus: !what.danger }, what.confirm)),
  ]);
  return answer === "yes";
}
