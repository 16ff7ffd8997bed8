// The controls above the picture.
import { h } from "../../base/h";
import type { Signal } from "../../base/signal";
import type { JobContext, LightStage } from "../job_part";
import { inMode, kModes, type Mode, type Sight } from "./sight";

export function walkTools(context: JobContext, stage: LightStage, sight: Signal<Sight>): HTMLElement {
  return h("div", { class: "walk-tools row", role: "toolbar", "aria-label": "How the scene is shown" },
    cameraChoice(context, stage), modeChoice(context, stage, sight), exposure(context, sight), toneMap(context, sight),
    tick(context, sight, "smooth", "Smooth", "Blended between patches, as the pictures are; else one colour per patch"),
    tick(context, sight, "borders", "Patch borders", "Draws the edges of the patches"));
}

function cameraChoice(context: JobContext, { view, mesh }: LightStage): HTMLElement {
  const free = "";
  const select = h("select", {
    onchange: () => {
      if (select.value === free) view.followCamera(null);
      else view.followCamera(select.value);
    },
  }, h("option", { value: free }, "free"), mesh.cameras.names.map((name) => h("option", { value: name }, name)));
  context.lifetime.add(view.following.watch((name) => (select.value = name ?? free)));
  return h("label", null, "Camera ", select);
}

function modeChoice(context: JobContext, stage: LightStage, sight: Signal<Sight>): HTMLElement {
  const select = h("select", {
    onchange: () => {
      sight.value = inMode(sight.value, select.value as Mode, stage.mesh);
    },
  }, kModes.map(({ name, label }) => h("option", { value: name }, label)));
  context.lifetime.add(sight.watch(({ mode }) => (select.value = mode)));
  return h("label", null, "Show ", select);
}

function change(sight: Signal<Sight>, display: Sight["display"]): void {
  sight.value = { ...sight.value, display: { ...sight.value.display, ...display } };
}

function exposure(context: JobContext, sight: Signal<Sight>): HTMLElement {
  const shown = h("output", { class: "walk-stops" });
  const slider = h("input", {
    type: "range", min: -8, max: 8, step: 0.25, oninput: () => change(sight, { exposureStops: Number(slider.value) }),
    ondblclick: () => change(sight, { exposureStops: 0 }), title: "In stops on top of the job's own exposure; double-click for 0",
  });
  context.lifetime.add(sight.watch(({ display }) => {
    const stops = display.exposureStops ?? 0;
    slider.value = String(stops);
    shown.textContent = `${stops > 0 ? "+" : ""}${stops} EV`;
    slider.disabled = display.what !== "light";
  }));
  return h("label", { class: "row" }, "Exposure ", slider, shown);
}

function toneMap(context: JobContext, sight: Signal<Sight>): HTMLElement {
  const select = h("select", { onchange: () => change(sight, { toneMap: select.value === "clip" ? "clip" : "filmic" }) },
    h("option", { value: "filmic" }, "filmic"), h("option", { value: "clip" }, "clip"));
  context.lifetime.add(sight.watch(({ display }) => {
    select.value = display.toneMap ?? "filmic";
    select.disabled = display.what !== "light";
  }));
  return h("label", null, "Tone map ", select);
}

function tick(context: JobContext, sight: Signal<Sight>, name: "smooth" | "borders", label: string, title: string): HTMLElement {
  const box = h("input", { type: "checkbox", onchange: () => change(sight, { [name]: box.checked }) });
  context.lifetime.add(sight.watch(({ display }) => (box.checked = display[name] ?? false)));
  return h("label", { title }, box, ` ${label}`);
}
