// Timeline: the moment, playing, key-frames, and the error of every interval.
import { fill, h } from "../../base/h";
import { keyFramesOf, type KeyFrames } from "../key_frames";
import type { JobContext, OpenJobPart } from "../job_part";
import { frameSlider, playButton } from "./play_controls";
import { stepBy } from "./player";
import { track } from "./track";
import "./timeline.css";

export const openTimeline: OpenJobPart = (context) => timeline(context, null);

/** `other`: a job beside it, whose key-frames are shown as well. */
export function timeline(context: JobContext, other: JobContext | null): HTMLElement {
  const { playhead, lifetime } = context;
  const lines = h("div", { class: "timeline-track" });
  showTrack(context, other, lines);
  const element = h("section", { class: "timeline", "aria-label": "Timeline" },
    h("div", { class: "timeline-row row" }, buttons(context), moment(context)), frameSlider(playhead, lifetime), lines);
  lifetime.add(context.job.watch(({ state }) => (element.hidden = state !== "succeeded"))); // before, there is nothing to go through
  return element;
}

function buttons({ playhead, lifetime }: JobContext): Node[] {
  const loop = h("input", { type: "checkbox", onchange: () => (playhead.loop.value = loop.checked) });
  lifetime.add(playhead.loop.watch((on) => (loop.checked = on)));
  return [
    h("button", { "aria-label": "−1, one frame back", onclick: () => stepBy(playhead, -1) }, "−1"),
    playButton(playhead, lifetime),
    h("button", { "aria-label": "+1, one frame on", onclick: () => stepBy(playhead, 1) }, "+1"),
    h("label", null, loop, " Loop"),
  ];
}

function moment({ playhead, lifetime }: JobContext): HTMLElement {
  const text = h("output", { class: "timeline-moment", "aria-live": "off" });
  const show = (): void => {
    const seconds = (playhead.frame / playhead.fps).toFixed(2);
    const speed = playhead.speed.value / playhead.fps;
    const pace = playhead.playing.value && speed !== 1 ? ` · ${speed}×` : "";
    text.textContent = `Frame ${playhead.frame} of ${playhead.frameCount - 1} · ${seconds} s${pace}`;
  };
  lifetime.add(playhead.time.watch(show), playhead.speed.watch(show), playhead.playing.watch(show));
  return text;
}

/** Known once the job has succeeded. */
function showTrack(context: JobContext, other: JobContext | null, place: HTMLElement): void {
  let begun = false;
  context.lifetime.add(context.job.watch((job) => {
    if (begun || job.state !== "succeeded") return;
    begun = true;
    Promise.all([keyFramesOf(context), other && keyFramesOf(other)]).then(
      ([keys, others]) => fill(place, track(context.playhead, keys, others), legend(keys, others)),
      () => (begun = false), // the next change of the job asks again
    );
  }));
}

function legend({ tolerance }: KeyFrames, others: KeyFrames | null): HTMLElement {
  const full = tolerance ? `full height is the tolerance, ${100 * tolerance} %` : "full height is the largest";
  const entry = (name: string, text: string): HTMLElement => h("span", null, h("span", { class: `swatch ${name}`, "aria-hidden": "true" }), ` ${text}`);
  const of = others ? " of A" : "";
  return h("p", { class: "timeline-legend small muted" }, entry("key", `key-frame${of}`), entry("check", `solved to check${of}`),
    others ? [entry("other key", "key-frame of B"), entry("other check", "solved to check of B")] : null,
    entry("predicted", `error${of} predicted`), entry("observed", `observed; ${full}`));
}
