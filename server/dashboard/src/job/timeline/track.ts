// The line of frames: what was solved, and how well the others are interpolated.
import { svg } from "../../base/svg";
import type { KeyFrames } from "../key_frames";
import type { Playhead } from "../playhead";

/** In units of the drawing, which is stretched to the width there is. */
const kMarks = 8;
/** What another job beside it takes. */
const kRow = 14;
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
function strips(keys: KeyFrames, frameCount: number, top: number): SVGElement[] {
  const errors = keys.intervals.flatMap(({ predicted_error, observed_error }) => [predicted_error ?? 0, observed_error ?? 0]);
  const full = keys.tolerance ?? Math.max(...errors, 1e-9);
  return keys.intervals.map((interval) => {
    const x = across(interval.first, frameCount);
    const width = across(interval.last, frameCount) - x;
    const bar = (error: number | null | undefined, name: string, left: number) => {
      const height = Math.min((error ?? 0) / full, 1) * kStripHeight;
      return svg("rect", { class: name, x: x + left, y: top + kStripHeight - height, width: width / 2, height });
    };
    return svg("g", { class: interval.kept === false ? "interval broken" : "interval" },
      svg("title", {}, describe(interval, keys.tolerance)),
      svg("rect", { class: "interval-room", x, y: top, width, height: kStripHeight }),
      bar(interval.predicted_error, "predicted", 0), bar(interval.observed_error, "observed", width / 2));
  });
}

/**
 * Keys are squares, frames that were solved to check are dots, those of another job hollow: told apart without colour. A line
 * without length, with the cap of its stroke, keeps its shape where the drawing is stretched.
 */
function marks(keys: KeyFrames, frameCount: number, y: number, other: boolean): SVGElement[] {
  const whose = other ? " of B" : "";
  return keys.frames.filter(({ kind }) => kind !== "interpolated").map(({ frame, kind }) => {
    const x = across(frame, frameCount);
    const dot = (name: string) => svg("line", { class: `mark ${name}`, x1: x, x2: x, y1: y, y2: y });
    return svg("g", {}, svg("title", {}, `Frame ${frame}: ${kind === "key" ? "key-frame" : "solved to check an interval"}${whose}`),
      dot(kind), ...(other ? [dot(`${kind} hollow`)] : []));
  });
}

function solvedText({ frames }: KeyFrames): string {
  const number = (wanted: string): number => frames.filter(({ kind }) => kind === wanted).length;
  return `${number("key")} key-frames, ${number("check")} frames solved to check`;
}

/** Where the mouse presses, time goes; the slider is for keys and screen readers. `others`: of a job beside it. */
export function track(playhead: Playhead, keys: KeyFrames, others: KeyFrames | null): SVGSVGElement {
  const { frameCount } = playhead;
  const top = kMarks * 2 + (others ? kRow : 0);
  const drawing = svg("svg", {
    class: others ? "track track-two" : "track", viewBox: `0 0 1000 ${top + kStripHeight + 2}`, preserveAspectRatio: "none", role: "img",
    "aria-label": others ? `A: ${solvedText(keys)}; B: ${solvedText(others)}; of ${frameCount}` : `${solvedText(keys)}, of ${frameCount}`,
  }, ...strips(keys, frameCount, top), ...marks(keys, frameCount, kMarks, false),
    ...(others ? marks(others, frameCount, kMarks + kRow, true) : []));
  drawing.addEventListener("pointerdown", (event) => {
    const box = drawing.getBoundingClientRect();
    playhead.playing.value = false;
    playhead.time.value = Math.round(((event.clientX - box.left) / box.width) * (frameCount - 1));
  });
  return drawing;
}
