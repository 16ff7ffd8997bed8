// The line of frames: what was solved, and how well the others are interpolated.
import { svg } from "../../base/svg";
import type { KeyFrames } from "../key_frames";
import type { Playhead } from "../playhead";

/** In units of the drawing, which is stretched to the width there is. */
const kHeight = 40;
const kMarks = 8;
const kStripTop = 16;
const kStripHeight = 22;

type Interval = KeyFrames["intervals"][number];

/** Left edge 0 and right edge 1000 are the middles of the first and last frame. */
function across(frame: number, frameCount: number): number {
  return frameCount > 1 ? (1000 * frame) / (frameCount - 1) : 500;
}

export function percentText(error: number | null | undefined): string {
  return error === null || error === undefined ? "not known" : `${(100 * error).toPrecision(2)} %`;
}

function describe(interval: Interval, tolerance: number | null | undefined): string {
  const promise = interval.kept === true ? "kept" : interval.kept === false ? "not kept" : "nothing promised";
  const limit = tolerance ? `, tolerance ${percentText(tolerance)}: ${promise}` : "";
  return `Frames ${interval.first} to ${interval.last}: error predicted ${percentText(interval.predicted_error)}, ` +
    `observed ${percentText(interval.observed_error)}${limit}`;
}

/** A full strip is the tolerance, or the largest error where nothing was promised. */
function strips(keys: KeyFrames, frameCount: number): SVGElement[] {
  const errors = keys.intervals.flatMap(({ predicted_error, observed_error }) => [predicted_error ?? 0, observed_error ?? 0]);
  const full = keys.tolerance ?? Math.max(...errors, 1e-9);
  return keys.intervals.map((interval) => {
    const x = across(interval.first, frameCount);
    const width = across(interval.last, frameCount) - x;
    const bar = (error: number | null | undefined, name: string, left: number) => {
      const height = Math.min((error ?? 0) / full, 1) * kStripHeight;
      return svg("rect", { class: name, x: x + left, y: kStripTop + kStripHeight - height, width: width / 2, height });
    };
    return svg("g", { class: interval.kept === false ? "interval broken" : "interval" },
      svg("title", {}, describe(interval, keys.tolerance)),
      svg("rect", { class: "interval-room", x, y: kStripTop, width, height: kStripHeight }),
      bar(interval.predicted_error, "predicted", 0), bar(interval.observed_error, "observed", width / 2));
  });
}

/** Keys are diamonds, frames that were solved to check are dots: told apart without colour. */
function marks(keys: KeyFrames, frameCount: number): SVGElement[] {
  return keys.frames.filter(({ kind }) => kind !== "interpolated").map(({ frame, kind }) =>
    svg("line", { class: `mark ${kind}`, x1: across(frame, frameCount), x2: across(frame, frameCount), y1: kMarks, y2: kMarks },
      svg("title", {}, `Frame ${frame}: ${kind === "key" ? "key-frame" : "solved to check an interval"}`)));
}

/** Where the mouse presses, time goes; the slider below is for keys and screen readers. */
export function track(playhead: Playhead, keys: KeyFrames): SVGSVGElement {
  const { frameCount } = playhead;
  const drawing = svg("svg", {
    class: "track", viewBox: `0 0 1000 ${kHeight}`, preserveAspectRatio: "none", role: "img",
    "aria-label": `${keys.frames.filter(({ kind }) => kind === "key").length} key-frames, ` +
      `${keys.frames.filter(({ kind }) => kind === "check").length} frames solved to check, of ${frameCount}`,
  }, ...strips(keys, frameCount), ...marks(keys, frameCount));
  drawing.addEventListener("pointerdown", (event) => {
    const box = drawing.getBoundingClientRect();
    playhead.playing.value = false;
    playhead.time.value = Math.round(((event.clientX - box.left) / box.width) * (frameCount - 1));
  });
  return drawing;
}
