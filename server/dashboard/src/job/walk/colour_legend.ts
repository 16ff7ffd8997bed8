// The scale of false colours, with its unit.
import { h } from "../../base/h";
import type { Signal } from "../../base/signal";
import { paletteColour } from "../../scene/palette";
import type { JobContext } from "../job_part";
import type { Sight } from "./sight";

const kSteps = 64;
const kTicks = 5;

/** Without a power of ten where people read better without. */
export function wattsPerSquareMetre(value: number, digits = 3): string {
  if (value === 0) return "0";
  const size = Math.abs(value);
  return size >= 0.001 && size < 100000 ? String(Number(value.toPrecision(digits))) : value.toExponential(digits - 1);
}

export function colourLegend(context: JobContext, sight: Signal<Sight>): HTMLElement {
  const bar = h("canvas", { class: "legend-bar", width: kSteps, height: 1, "aria-hidden": "true" });
  const ticks = h("div", { class: "legend-ticks small" });
  const title = h("div", { class: "small" });
  const element = h("div", { class: "legend" }, title, bar, ticks);
  context.lifetime.add(sight.watch(({ mode, display }) => {
    const { scale } = display;
    element.hidden = display.what !== "false-colour" || !scale;
    if (!scale || element.hidden) return;
    title.textContent = `${mode === "error" ? "Standard error" : "Radiosity"}, luminance [W/m²]`;
    paint(bar, scale.signed);
    const from = scale.signed ? -scale.to : scale.from;
    const at = (t: number) => (scale.log ? from * (scale.to / from) ** t : from + t * (scale.to - from));
    ticks.replaceChildren(...Array.from({ length: kTicks }, (_, k) => h("span", null, wattsPerSquareMetre(at(k / (kTicks - 1))))));
  }));
  return element;
}

function paint(bar: HTMLCanvasElement, signed: boolean): void {
  const context = bar.getContext("2d")!;
  const image = context.createImageData(kSteps, 1);
  for (let x = 0; x < kSteps; ++x) image.data.set([...paletteColour(x / (kSteps - 1), signed), 255], 4 * x);
  context.putImageData(image, 0, 0);
}
