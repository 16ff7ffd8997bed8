// The connection in the header: live, polling or offline, and a bar that says what to do.
import { live } from "../api/live";
import { fill, h } from "../base/h";
import type { ConnectionState } from "../api/live";

interface Words {
  label: string;
  title: string;
}

function wordsOf(state: ConnectionState): Words {
  switch (state.how) {
    case "live":
      return { label: "Live", title: "What happens is shown as it happens" };
    case "polling":
      return { label: "Polling", title: `Looked at every few seconds: ${state.why}` };
    case "offline":
      return { label: "Offline", title: "The service does not answer" };
    case "denied":
      return { label: "Not logged in", title: "A token is needed" };
    case "connecting":
      return { label: "Connecting", title: "Connecting to the service" };
  }
}

export function connectionStatus(): HTMLElement {
  const dot = h("span", { class: "dot", "aria-hidden": "true" });
  const label = h("span", { class: "connection-label" });
  const element = h("div", { class: "connection", role: "status" }, dot, label);
  live.connection.watch((state) => {
    const words = wordsOf(state);
    element.dataset["how"] = state.how;
    element.title = words.title;
    label.textContent = words.label;
  });
  return element;
}

/** Shown while the service does not answer. */
export function offlineBar(): HTMLElement {
  const bar = h("div", { class: "bar bar-bad", role: "alert", hidden: true });
  live.connection.watch((state) => {
    bar.hidden = state.how !== "offline";
    if (state.how !== "offline") return bar.replaceChildren();
    fill(bar, h("span", null, `The service does not answer since ${new Date(state.sinceMs).toLocaleTimeString()}. What you see is from before. `,
      "Is it running (", h("code", null, "server/run"), "), is the network there? The page recovers by itself."),
      h("button", { onclick: () => live.retry() }, "Try now"));
  });
  return bar;
}
