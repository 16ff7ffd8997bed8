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
  const segments = stages.map((stage, i) => h("span", { class: "segment", title: stage.label }, fills[i]));
  const bar = h("div", { class: "segments", role: "progressbar", "aria-valuemin": 0, "aria-valuemax": 100 }, segments);
  const text = h("div", { class: "progress-text" });
  return {
    element: h("div", { class: "progress" }, bar, text),
    show(job) {
      const done = job.state === "succeeded";
      widthsOf(done ? null : job.progress).forEach(({ filled, empty }, i) => {
        segments[i]!.style.flexGrow = (filled + empty).toFixed(4);
        fills[i]!.style.width = `${((100 * filled) / Math.max(filled + empty, 1e-9)).toFixed(1)}%`;
      });
      bar.dataset["state"] = job.state;
      bar.setAttribute("aria-valuenow", String(Math.floor((done ? 1 : job.progress.fraction) * 100)));
      const words = sentenceOf(job);
      bar.setAttribute("aria-valuetext", words);
      bar.setAttribute("aria-label", `Progress of ${job.name || job.id}`);
      text.textContent = words;
    },
  };
}

interface Width {
  filled: number;
  empty: number;
}

/** Of each segment, so that what is filled is the service's own fraction of the job; null: all of it is done. */
export function widthsOf(progress: Job["progress"] | null): Width[] {
  if (progress === null) return stages.map(({ share }) => ({ filled: share, empty: 0 }));
  const now = stages.findIndex(({ name }) => name === progress.stage);
  const usual = stages.map(({ share }, i): Width => {
    const filled = i < now ? share : i === now ? share * progress.stage_fraction : 0;
    return { filled, empty: share - filled };
  });
  const filled = usual.reduce((sum, width) => sum + width.filled, 0);
  const empty = usual.reduce((sum, width) => sum + width.empty, 0);
  const byFilled = filled > 0 ? progress.fraction / filled : 0;
  const byEmpty = empty > 0 ? (1 - progress.fraction) / empty : 0;
  return usual.map((width) => ({ filled: width.filled * byFilled, empty: width.empty * byEmpty }));
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
