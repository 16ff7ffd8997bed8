// Probe: the radiosity of chosen patches over time, with its error and the frames that were solved.
import { messageOf } from "../../api/api_error";
import { send } from "../../api/client";
import { curlOf } from "../../api/curl";
import type { PatchSeries } from "../../api/types";
import { fill, h } from "../../base/h";
import { kLineColours } from "../../base/plot";
import { Lifetime } from "../../base/signal";
import { copyCurlButton } from "../../shell/copy_curl";
import { toastError } from "../../shell/toast";
import { keyFramesOf } from "../key_frames";
import type { JobContext, OpenJobPart } from "../job_part";
import { channelOf, kChannels, type Channel } from "./channels";
import { wattsPerSquareMetre } from "../walk/colour_legend";
import { probePlot } from "./probe_plot";
import { saveFile } from "../../base/save_file";
import "./probe.css";

const kDigits = 4;
const kPath = "/v1/jobs/{id}/patches/series";

export const openProbe: OpenJobPart = (context) => {
  const { playhead, lifetime } = context;
  const known = new Map<number, PatchSeries>();
  const place = h("div", { class: "probe-plot" });
  const chips = h("ul", { class: "probe-chips", "aria-label": "Chosen patches" });
  const tools = h("div", { class: "row" });
  let channel: Channel = "luminance";
  let shown = new Lifetime();
  lifetime.add(() => shown.end());

  const show = (): void => {
    shown.end();
    shown = new Lifetime();
    const patches = playhead.pinned.value;
    const valueAt = (patch: number): string => {
      const rgb = known.get(patch)?.radiosity[playhead.frame];
      return rgb ? `${wattsPerSquareMetre(channelOf(rgb, channel), kDigits)} W/m²` : "";
    };
    const values = patches.map((patch, k) => chip(context, patch, k));
    fill(chips, values.map(({ element }) => element));
    const tellValues = (): void => patches.forEach((patch, k) => (values[k]!.value.textContent = valueAt(patch)));
    tools.hidden = patches.length === 0;
    if (patches.length === 0) {
      fill(place, h("p", { class: "muted" }, "Click patches in the picture to plot their radiosity over time (or press Enter for the one in the middle)."));
      return;
    }
    const mine = shown;
    fetchMissing(context, patches, known)
      .then(() => keyFramesOf(context))
      .then((keys) => {
        if (mine.ended) return;
        mine.add(playhead.time.watch(tellValues));
        const series = patches.flatMap((patch) => known.get(patch) ?? []);
        probePlot(place, { series, channel, keys, playhead }, mine);
      })
      .catch((error: unknown) => {
        if (!mine.ended) fill(place, h("p", { class: "bad" }, messageOf(error)));
      });
  };
  const select = h("select", {
    onchange: () => {
      channel = select.value as Channel;
      show();
    },
  }, kChannels.map(({ name, label }) => h("option", { value: name }, label)));
  fill(tools, h("label", null, "Plot ", select), csvButtons(context));
  lifetime.add(playhead.pinned.watch(show), context.job.watch((job) => job.state === "succeeded" && known.size === 0 && show()));
  const element = h("section", { class: "probe", "aria-label": "Probe" }, h("h2", null, "Probe"), chips, tools, place);
  lifetime.add(context.job.watch(({ state }) => (element.hidden = state !== "succeeded"))); // before, there is no picture to click into
  return element;
};

async function fetchMissing(context: JobContext, patches: readonly number[], known: Map<number, PatchSeries>): Promise<void> {
  const missing = patches.filter((patch) => !known.has(patch));
  if (missing.length === 0) return;
  const answer = await send("post", kPath, { path: { id: context.id }, json: { patches: missing } });
  for (const series of answer.series) known.set(series.patch, series);
}

/** `value`: at the moment that is shown. */
function chip({ playhead }: JobContext, patch: number, k: number): { element: HTMLElement; value: HTMLElement } {
  const swatch = h("span", { class: "probe-swatch", "aria-hidden": "true" });
  swatch.style.background = kLineColours[k % kLineColours.length]!;
  const drop = (): void => {
    playhead.pinned.value = playhead.pinned.value.filter((other) => other !== patch);
  };
  const value = h("output", { class: "probe-value", "aria-live": "off" });
  return {
    value,
    element: h("li", { class: "probe-chip" }, swatch, `patch ${patch}`, value,
      h("button", { class: "quiet icon", "aria-label": `Let patch ${patch} go`, onclick: drop }, "×")),
  };
}

function csvButtons(context: JobContext): Node[] {
  const request = () => ({ patches: [...context.playhead.pinned.value], format: "csv" as const });
  const save = async (): Promise<void> => {
    const response = await fetch(`/v1/jobs/${encodeURIComponent(context.id)}/patches/series`, {
      method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(request()), credentials: "same-origin",
    });
    if (!response.ok) throw new Error(`the service answered ${response.status}`);
    saveFile(await response.blob(), "patches.csv");
  };
  return [
    h("button", { onclick: () => void save().catch(toastError) }, "Save as CSV"),
    copyCurlButton(() => curlOf("POST", kPath, { path: { id: context.id }, json: request(), output: "patches.csv" }), "save these patches as CSV"),
  ];
}
