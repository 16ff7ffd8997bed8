// Waits for a job, and shows meanwhile how far it is.
import type { Job } from "../../api/types";
import { isFinal } from "../../api/types";
import { forecastText } from "../../base/forecast";
import { fill, h } from "../../base/h";
import { Lifetime, type Signal } from "../../base/signal";
import { progressBar } from "../../queue/progress_bar";
import { stateBadge } from "../../queue/state_badge";
import { followJob } from "../follow_job";

/** Errors: Error where it ends otherwise than well. Does not resolve where the page is left before. */
export function untilDone(job: Signal<Job>, page: Lifetime, place: HTMLElement): Promise<void> {
  if (job.value.state === "succeeded") return Promise.resolve();
  const waiting = new Lifetime();
  page.add(() => waiting.end());
  show(job, waiting, place);
  return new Promise((resolve, reject) => {
    const fail = (why: string): void => {
      waiting.end();
      reject(new Error(why));
    };
    const look = followJob(job, waiting, () => fail("The job was deleted."));
    waiting.add(job.watch(({ state, name, reason }) => {
      if (state === "succeeded") {
        waiting.end();
        resolve();
      } else if (isFinal(state)) {
        fail(`${name || "The job"} has ${state === "failed" ? `failed: ${reason ?? ""}` : "been canceled"}.`);
      }
    }));
    void look(); // it may have ended before anybody listened
  });
}

function show(job: Signal<Job>, waiting: Lifetime, place: HTMLElement): void {
  const bar = progressBar();
  const state = h("span");
  const { id, name, forecast } = job.value;
  fill(place, h("div", { class: "notice compare-wait" },
    h("p", { role: "status" }, h("a", { href: `/jobs/${id}` }, name || id), " is not done yet", forecast ? ` (it takes ${forecastText(forecast)})` : "", ". The comparison opens by itself. ", state),
    bar.element));
  waiting.add(job.watch((now) => {
    bar.show(now);
    fill(state, stateBadge(now));
  }));
}
