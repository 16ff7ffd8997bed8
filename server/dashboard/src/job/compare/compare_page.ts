// Compare: two jobs of the same scene beside each other, and what differs.
import { get } from "../../api/client";
import { messageOf } from "../../api/api_error";
import type { Job } from "../../api/types";
import { ago } from "../../base/format";
import { fill, h } from "../../base/h";
import { Signal } from "../../base/signal";
import type { OpenPage, PageContext } from "../../shell/page";
import { navigate } from "../../shell/router";
import type { JobContext, LightStage } from "../job_part";
import { Playhead } from "../playhead";
import { keepInAddress } from "../deep_link";
import { openTimeline } from "../timeline/timeline_part";
import { fetchMesh } from "../walk/fetch_mesh";
import { compareSights } from "./compare_sights";
import { rmsePlot } from "./rmse_plot";
import "./compare.css";

export const openComparePage: OpenPage = (context) => {
  context.setTitle("Compare");
  const a = context.query.get("a");
  const b = context.query.get("b");
  const place = h("div", { class: "compare" }, h("p", { class: "muted", role: "status" }, "Fetching…"));
  const content = h("div", null, chooser(a, b), place);
  if (!a || !b) fill(place, h("p", { class: "muted" }, "Choose two jobs of the same scene: one interpolated and one with every frame solved, or two settings."));
  else begin(context, place, a, b).catch((error: unknown) => {
    if (!context.lifetime.ended) fill(place, h("div", { class: "notice" }, h("p", null, messageOf(error))));
  });
  return content;
};

const kListed = 100;

function chooser(a: string | null, b: string | null): HTMLElement {
  const first = h("select", { name: "a", "aria-label": "Job A" });
  const second = h("select", { name: "b", "aria-label": "Job B" });
  const form = h("form", {
    class: "row", onsubmit: (event) => {
      event.preventDefault();
      navigate(`/compare?a=${encodeURIComponent(first.value)}&b=${encodeURIComponent(second.value)}`);
    },
  }, h("label", null, "A ", first), h("label", null, "B ", second), h("button", { class: "primary" }, "Compare"));
  get("/v1/jobs", { query: { state: "succeeded", limit: kListed } }).then(({ jobs }) => {
    const options = (): Node[] => jobs.map((job) => h("option", { value: job.id }, `${job.name || "without a name"} · …${job.id.slice(-6)} · ${ago(job.created_at)}`));
    fill(first, options());
    fill(second, options());
    first.value = a ?? jobs[0]?.id ?? "";
    second.value = b ?? jobs[1]?.id ?? "";
  }, () => {}); // the header says that the service is away
  return form;
}

async function openSide(page: PageContext, id: string, playhead: Playhead | null): Promise<JobContext & { opened: Omit<LightStage, "view" | "light"> }> {
  const job: Job = await get("/v1/jobs/{id}", { path: { id } });
  const context: JobContext = {
    id, job: new Signal(job), playhead: playhead ?? new Playhead(job.frame_count, 24), stage: new Signal<LightStage | null>(null), lifetime: page.lifetime,
  };
  return { ...context, opened: await fetchMesh(context) };
}

async function begin(page: PageContext, place: HTMLElement, idA: string, idB: string): Promise<void> {
  const a = await openSide(page, idA, null);
  const b = await openSide(page, idB, a.playhead);
  if (page.lifetime.ended) return;
  if (a.job.value.frame_count !== b.job.value.frame_count) throw new Error("The jobs have different numbers of frames: they cannot be compared.");
  a.playhead.fps = a.opened.mesh.fps;
  keepInAddress(a.playhead, page.lifetime);
  const plot = h("div", { class: "compare-plot" });
  fill(place, await compareSights(a, b), openTimeline(a), plot);
  rmsePlot(plot, a, b);
}
