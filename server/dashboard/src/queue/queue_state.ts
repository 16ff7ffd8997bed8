// The queue as a whole: how much is going on, and whether jobs are started at all.
import { get, send } from "../api/client";
import { curlOf } from "../api/curl";
import { live } from "../api/live";
import type { Queue } from "../api/types";
import { count, moment } from "../base/format";
import { fill, h } from "../base/h";
import { Signal, type Lifetime } from "../base/signal";
import { copyCurlButton } from "../shell/copy_curl";
import { openDialog } from "../shell/dialog";
import { toastError } from "../shell/toast";

const kGatherMs = 250;

export interface QueueNow {
  /** Kept true by events; null until it is known. */
  readonly queue: Signal<Queue | null>;
  /** Now, after something was done to jobs. */
  look(): void;
}

export function queueNow(lifetime: Lifetime): QueueNow {
  const queue = new Signal<Queue | null>(null);
  let timer: ReturnType<typeof setTimeout> | undefined;
  let asked = 0;
  const look = (): void => {
    clearTimeout(timer);
    timer = undefined;
    const mine = ++asked;
    get("/v1/queue").then((now) => {
      if (!lifetime.ended && mine === asked) queue.value = now; // an answer from before would count what is gone
    }, () => {});
  };
  // The first of a burst starts the clock: one that goes on and on is not waited out.
  const soon = (): void => void (timer ??= setTimeout(look, kGatherMs));
  live.listen(lifetime, { onState: soon, onRemoved: soon, onRefresh: soon });
  lifetime.add(() => clearTimeout(timer));
  look();
  return { queue, look };
}

/** One line for the head of the page. */
export function queueSummary(queue: Signal<Queue | null>, lifetime: Lifetime): HTMLElement {
  const element = h("span", { class: "muted queue-summary" });
  lifetime.add(queue.watch((now) => {
    if (!now) return;
    const { running, queued } = now.jobs;
    element.textContent = `${running ?? 0} running · ${queued ?? 0} queued · ${now.workers.cores} of ${count(now.workers.cores_max, "core")}`;
  }));
  return element;
}

/** "Pause queue", with a reason; while it is paused, a bar that says so. */
export function queuePause(queue: Signal<Queue | null>, lifetime: Lifetime): { button: HTMLElement; bar: HTMLElement } {
  const pause = h("button", { onclick: () => void askAndPause(queue) }, "Pause queue");
  const bar = h("div", { class: "queue-paused", role: "status", hidden: true });
  lifetime.add(queue.watch((now) => {
    pause.hidden = now === null || now.paused;
    bar.hidden = !now?.paused;
    if (!now?.paused) return bar.replaceChildren();
    fill(bar,
      h("span", null, h("strong", null, "The queue is paused"), now.changed_at ? ` since ${moment(now.changed_at)}` : "", now.reason ? `: ${now.reason}. ` : ". ",
        "Jobs at work go on, no other is started."),
      h("span", { class: "row" }, h("button", { class: "primary", onclick: () => void resume(queue) }, "Resume queue"),
        copyCurlButton(() => curlOf("POST", "/v1/queue/resume"), "resume the queue")));
  }));
  return { button: pause, bar };
}

async function askAndPause(queue: Signal<Queue | null>): Promise<void> {
  const reason = h("input", { id: "pause-reason", maxlength: 200, placeholder: "maintenance" });
  const answer = await openDialog("Pause the queue?", (close) => [
    h("form", { method: "dialog", onsubmit: (event) => { event.preventDefault(); close("pause"); } },
      h("div", { class: "dialog-body" },
        h("p", null, "No more jobs are started, for everybody, until it is resumed; also after a restart of the service. Jobs at work go on."),
        h("div", { class: "field" }, h("label", { for: "pause-reason" }, "Reason, shown to everybody (may be empty)"), reason)),
      h("div", { class: "dialog-actions" }, copyCurlButton(() => curlOf("POST", "/v1/queue/pause", { json: { reason: reason.value } }), "pause the queue"),
        h("button", { type: "button", onclick: () => close("") }, "Cancel"), h("button", { class: "primary" }, "Pause queue"))),
  ]);
  if (answer !== "pause") return;
  try {
    queue.value = await send("post", "/v1/queue/pause", { json: reason.value.trim() ? { reason: reason.value.trim() } : {} });
  } catch (error) {
    toastError(error, "Pause");
  }
}

async function resume(queue: Signal<Queue | null>): Promise<void> {
  try {
    queue.value = await send("post", "/v1/queue/resume");
  } catch (error) {
    toastError(error, "Resume");
  }
}
