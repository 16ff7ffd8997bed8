// How far a job is: a segment for each stage, and a sentence.
import type { Job } from "../api/types";
import { duration, percent } from "../base/format";
import { h } from "../base/h";
import { labelOf, stages } from "./stages";
import "./progress.css";

export interface ProgressBar {
  element: HTMLElement;
  show(job: Job): void;
}

const kAtWork: readonly string[] = ["running", "pause_requested", "cancel_requested"];

export function progressBar(): ProgressBar {
  const fills = stages.map(() => h("span", { class: "segment-fill" }));
  const segments = stages.map((stage, i) => {
    const segment = h("span", { class: "segment", title: stage.label }, fills[i]);
    segment.style.flexGrow = String(stage.share);
    return segment;
  });
  const bar = h("div", { class: "segments", role: "progressbar", "aria-valuemin": 0, "aria-valuemax": 100 }, segments);
  const text = h("div", { class: "progress-text" });
  return {
    element: h("div", { class: "progress" }, bar, text),
    show(job) {
      const { stage, stage_fraction, fraction } = job.progress;
      const done = job.state === "succeeded";
      const now = stages.findIndex(({ name }) => name === stage);
      fills.forEach((fill, i) => {
        const full = done || i < now ? 1 : i === now ? stage_fraction : 0;
        fill.style.width = `${(full * 100).toFixed(1)}%`;
      });
      bar.dataset["state"] = job.state;
      bar.setAttribute("aria-valuenow", String(Math.floor((done ? 1 : fraction) * 100)));
      const words = sentenceOf(job);
      bar.setAttribute("aria-valuetext", words);
      bar.setAttribute("aria-label", `Progress of ${job.name || job.id}`);
      text.textContent = words;
    },
  };
}

/** "Direct light · 42 % · 3 min left". */
export function sentenceOf(job: Job): string {
  const { stage, fraction, seconds_left } = job.progress;
  if (job.state === "queued") {
    const place = job.queue_position === null ? "waiting" : job.queue_position === 1 ? "next" : `number ${job.queue_position} in the queue`;
    return fraction > 0 ? `${place} · ${percent(fraction)} done` : place;
  }
  if (job.state === "succeeded")
    return job.started_at && job.finished_at
      ? `done in ${duration((Date.parse(job.finished_at) - Date.parse(job.started_at)) / 1000)}` : "done";
  if (!kAtWork.includes(job.state)) return fraction > 0 ? `stopped at ${percent(fraction)}` : "";
  const left = seconds_left === null || seconds_left === undefined ? "" : ` · ${duration(seconds_left)} left`;
  return `${labelOf(stage)} · ${percent(fraction)}${left}`;
}
