// Compare: two jobs of the same scene beside each other, and what differs.
import { get } from "../../api/client";
import { messageOf } from "../../api/api_error";
import { fill, h } from "../../base/h";
import { Signal } from "../../base/signal";
import type { OpenPage, PageContext } from "../../shell/page";
import type { JobContext, LightStage } from "../job_part";
import { Playhead } from "../playhead";
import { keepInAddress } from "../deep_link";
import { startPlaying } from "../timeline/play_keys";
import { timeline } from "../timeline/timeline_part";
import { fetchMesh } from "../walk/fetch_mesh";
import { chooser } from "./chooser";
import { compareSights, type Side } from "./compare_sights";
import { rmsePlot } from "./rmse_plot";
import { untilDone } from "./until_done";
import "./compare.css";

export const openComparePage: OpenPage = (context) => {
  context.setTitle("Compare");
  const a = context.query.get("a");
  const b = context.query.get("b");
  const place = h("div", { class: "compare" }, h("p", { class: "muted", role: "status" }, "Fetching…"));
  const content = h("div", null, chooser(context, a, b), place);
  if (!a || !b) fill(place, h("p", { class: "muted" }, "Choose two jobs of the same scene, such as two settings. Or see how well A was interpolated: ",
    "its reference run is the same job with every frame solved."));
  else begin(context, place, a, b).catch((error: unknown) => {
    if (!context.lifetime.ended) fill(place, h("div", { class: "notice" }, h("p", null, messageOf(error))));
  });
  return content;
};

async function openSide(page: PageContext, place: HTMLElement, id: string, playhead: Playhead | null): Promise<Side> {
  const job = new Signal(await get("/v1/jobs/{id}", { path: { id } }));
  await untilDone(job, page.lifetime, place);
  const context: JobContext = {
    id, job, playhead: playhead ?? new Playhead(job.value.frame_count, 24), stage: new Signal<LightStage | null>(null), lifetime: page.lifetime,
  };
  return { ...context, opened: await fetchMesh(context) };
}

async function begin(page: PageContext, place: HTMLElement, idA: string, idB: string): Promise<void> {
  const a = await openSide(page, place, idA, null);
  const b = await openSide(page, place, idB, a.playhead);
  if (page.lifetime.ended) return;
  if (a.job.value.frame_count !== b.job.value.frame_count) throw new Error("The jobs have different numbers of frames: they cannot be compared.");
  a.playhead.fps = a.opened.mesh.fps;
  keepInAddress(a.playhead, page.lifetime);
  startPlaying(a.playhead, page.lifetime);
  const plot = h("div", { class: "compare-plot" });
  fill(place, await compareSights(a, b), timeline(a, b), plot);
  rmsePlot(plot, a, b);
}
