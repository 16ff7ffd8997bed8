// What all plots have in common: the theme's colours, the width there is, axes.
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { Lifetime } from "./signal";

/** Colours that people who see few colours can tell apart. Source: M. Okabe and K. Ito, "Color Universal Design", 2008. */
export const kLineColours = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#999999", "#b3a500"] as const;


export function axis(label: string, side: "x" | "y"): uPlot.Axis {
  const colour = (): string => resolvedColour("--muted");
  const line = (): string => resolvedColour("--line");
  return {
    label, labelSize: side === "x" ? 22 : 26, size: side === "x" ? 34 : 62, stroke: colour,
    grid: { stroke: line, width: 1 }, ticks: { stroke: line, width: 1 },
  };
}

/** light-dark() is not known to a canvas: an element is asked what it comes to. */
export function resolvedColour(name: string): string {
  const probe = document.createElement("span");
  probe.style.color = `var(${name})`;
  document.body.append(probe);
  const colour = getComputedStyle(probe).color;
  probe.remove();
  return colour;
}

/** As wide as `place`, for as long as `lifetime` lasts. */
export function fitWidth(plot: uPlot, place: HTMLElement, lifetime: Lifetime): void {
  const watcher = new ResizeObserver(() => {
    if (place.clientWidth > 0) plot.setSize({ width: place.clientWidth, height: plot.height });
  });
  watcher.observe(place);
  lifetime.add(() => watcher.disconnect(), () => plot.destroy());
}

export { uPlot };
