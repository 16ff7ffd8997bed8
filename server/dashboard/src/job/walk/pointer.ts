// What is under the pointer, and the patch that a click chooses.
import { h } from "../../base/h";
import type { Signal } from "../../base/signal";
import type { JobContext, LightStage } from "../job_part";
import { wattsPerSquareMetre } from "./colour_legend";
import type { Sight } from "./sight";

/** A click that moved the pointer further was a drag. */
const kClickPixels = 4;
/** Patches that are plotted at once. */
export const kPinnedMax = 8;
const kLookMs = 80;
/** As many as half floats have. */
const kDigits = 4;

export function followPointer(context: JobContext, stage: LightStage, sight: Signal<Sight>): HTMLElement {
  const { canvas } = stage.view;
  const { lifetime, playhead } = context;
  const line = h("output", { class: "walk-value small", "aria-live": "off" });
  let last: { x: number; y: number } | null = null;
  let timer: ReturnType<typeof setTimeout> | undefined;
  const look = (): void => {
    line.textContent = last === null ? "" : textAt(context, stage, sight, last.x, last.y);
    line.hidden = line.textContent === "";
  };
  const later = (): void => {
    timer ??= setTimeout(() => {
      timer = undefined;
      look();
    }, kLookMs);
  };
  let down: { x: number; y: number } | null = null;
  lifetime.listen(canvas, "pointermove", (event) => {
    last = { x: event.offsetX, y: event.offsetY };
    if (event.buttons === 0) later();
  });
  lifetime.listen(canvas, "pointerleave", () => {
    last = null;
    later();
  });
  lifetime.listen(canvas, "pointerdown", (event) => (down = { x: event.offsetX, y: event.offsetY }));
  lifetime.listen(canvas, "pointerup", (event) => {
    const still = down && Math.hypot(event.offsetX - down.x, event.offsetY - down.y) < kClickPixels;
    down = null;
    if (still && event.button === 0) choose(context, stage, event.offsetX, event.offsetY);
  });
  // Enter chooses what is in the middle: a patch can be plotted without a pointer.
  lifetime.listen(canvas, "keydown", (event) => {
    if (event.code === "Enter") choose(context, stage, canvas.clientWidth / 2, canvas.clientHeight / 2);
  });
  lifetime.add(playhead.time.watch(() => last && later()), () => clearTimeout(timer));
  return line;
}

function textAt(context: JobContext, stage: LightStage, sight: Signal<Sight>, x: number, y: number): string {
  const picked = stage.view.pick(x, y);
  if (!picked) return "";
  const series = sight.value.mode === "error" ? "radiosity_se" : "radiosity";
  const rgb = stage.source(series).value(picked.patch, context.playhead.frame);
  const object = stage.mesh.objectNames[picked.object] ?? "";
  const value = rgb ? ` ${rgb.map((value) => wattsPerSquareMetre(value, kDigits)).join("  ")} W/m²` : "";
  return `${object ? `${object} · ` : ""}patch ${picked.patch}${value}`;
}

/** Another click on a chosen patch lets it go. */
function choose(context: JobContext, stage: LightStage, x: number, y: number): void {
  const picked = stage.view.pick(x, y);
  if (!picked) return;
  const { pinned } = context.playhead;
  pinned.value = pinned.value.includes(picked.patch)
    ? pinned.value.filter((patch) => patch !== picked.patch)
    : [...pinned.value, picked.patch].slice(-kPinnedMax);
}
