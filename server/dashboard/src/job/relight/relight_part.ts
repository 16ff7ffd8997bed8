// Relight: how bright each group of lights is, exact by linearity, in all frames at once.
import { messageOf } from "../../api/api_error";
import { fetchBytes, send, urlOf } from "../../api/client";
import { curlOf } from "../../api/curl";
import type { AskedView } from "../../api/types";
import { fill, h } from "../../base/h";
import type { Rgb, Term } from "../../scene/lighting_view";
import { copyCurlButton } from "../../shell/copy_curl";
import { toast, toastError } from "../../shell/toast";
import type { JobContext, LightStage, OpenJobPart } from "../job_part";
import { viewCamera } from "../view_camera";
import "./relight.css";

const kSeries = /^radiosity_(.+)\.npy$/;
const kStopsMax = 6;

interface Group {
  readonly name: string;
  stops: number;
  off: boolean;
  /** Display colour "#rrggbb". */
  colour: string;
}

export const openRelight: OpenJobPart = (context) => {
  const element = h("section", { class: "relight", "aria-label": "Relight", hidden: true });
  context.lifetime.add(context.stage.watch((stage) => {
    if (!stage) return;
    groupsOf(context).then(
      (names) => {
        if (names.length === 0 || context.lifetime.ended) return;
        element.hidden = false;
        show(context, stage, element, names.map((name) => ({ name, stops: 0, off: false, colour: "#ffffff" })));
      },
      (error: unknown) => toast(`The light groups could not be fetched: ${messageOf(error)}`, { kind: "bad" }),
    );
  }));
  return element;
};

/** Each has a file of its own. */
async function groupsOf(context: JobContext): Promise<string[]> {
  const response = await fetchBytes(urlOf("/v1/jobs/{id}/manifest.json", { path: { id: context.id } }));
  const manifest = (await response.json()) as { artefacts: { path: string }[] };
  return manifest.artefacts.flatMap(({ path }) => kSeries.exec(path)?.[1] ?? []).filter((name) => name !== "se");
}

/** sRGB "#rrggbb" -> linear light (IEC 61966-2-1). */
function linear(colour: string): Rgb {
  const channel = (at: number): number => {
    const value = parseInt(colour.slice(at, at + 2), 16) / 255;
    return value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4;
  };
  return [channel(1), channel(3), channel(5)];
}

function gainOf(group: Group): Rgb {
  const [r, g, b] = linear(group.colour);
  const factor = group.off ? 0 : 2 ** group.stops;
  return [r * factor, g * factor, b * factor];
}

function isAsSolved(groups: readonly Group[]): boolean {
  return groups.every(({ stops, off, colour }) => stops === 0 && !off && colour === "#ffffff");
}

/** As solved, the one sum is sent instead of its parts. */
function termsOf(stage: LightStage, groups: readonly Group[]): Term[] {
  if (isAsSolved(groups)) return [{ source: stage.source("radiosity"), gain: [1, 1, 1] }];
  return groups.map((group) => ({ source: stage.source(`radiosity_${group.name}`), gain: gainOf(group) }));
}

function show(context: JobContext, stage: LightStage, element: HTMLElement, groups: Group[]): void {
  const changed = (): void => {
    stage.light.value = termsOf(stage, groups);
  };
  const list = h("div", { class: "relight-groups" });
  const build = (): void => fill(list, groups.map((group) => controls(group, changed)));
  const reset = (): void => {
    for (const group of groups) Object.assign(group, { stops: 0, off: false, colour: "#ffffff" });
    build();
    changed();
  };
  build();
  fill(element, h("h2", null, "Relight"),
    h("p", { class: "small muted" }, "Light is linear in what emits: this is exact in every frame, and nothing is solved again."),
    list, h("div", { class: "row" }, h("button", { onclick: reset }, "As solved"), ...renderButtons(context, stage, groups)));
}

function controls(group: Group, changed: () => void): HTMLElement {
  const stops = h("output", { class: "relight-stops" }, "0 EV");
  const slider = h("input", {
    type: "range", min: -kStopsMax, max: kStopsMax, step: 0.25, value: group.stops, "aria-label": `Brightness of ${group.name} in stops`,
    oninput: () => {
      group.stops = Number(slider.value);
      stops.textContent = `${group.stops > 0 ? "+" : ""}${group.stops} EV`;
      changed();
    },
  });
  const colour = h("input", {
    type: "color", value: group.colour, "aria-label": `Colour of ${group.name}`,
    oninput: () => {
      group.colour = colour.value;
      changed();
    },
  });
  const on = h("input", {
    type: "checkbox", checked: !group.off,
    onchange: () => {
      group.off = !on.checked;
      changed();
    },
  });
  return h("div", { class: "relight-group" }, h("label", { class: "relight-name" }, on, ` ${group.name}`), slider, stops, colour);
}

function renderButtons(context: JobContext, stage: LightStage, groups: readonly Group[]): Node[] {
  const request = (): AskedView => ({
    ...viewCamera(context, stage),
    light_gains: Object.fromEntries(groups.map((group) => [group.name, [...gainOf(group)] as [number, number, number]])),
  });
  const path = { id: context.id };
  const render = async (): Promise<void> => {
    await send("post", "/v1/jobs/{id}/views", { path, json: request() });
    toast("The view is being rendered; it appears under Images and video.", { kind: "good" });
  };
  return [
    h("button", { onclick: () => void render().catch(toastError) }, "Render with these"),
    copyCurlButton(() => curlOf("POST", "/v1/jobs/{id}/views", { path, json: request() }), "render this view with these lights"),
  ];
}
