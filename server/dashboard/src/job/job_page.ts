// One job: what it is doing, and what it has made, in parts.
import { get } from "../api/client";
import { ApiError, messageOf } from "../api/api_error";
import { live } from "../api/live";
import type { Job } from "../api/types";
import { fill, h } from "../base/h";
import { Signal } from "../base/signal";
import type { OpenPage, PageContext } from "../shell/page";
import { tabs, type Tab } from "../shell/tabs";
import { openImages } from "./images/images_part";
import type { JobContext, LightStage, OpenJobPart } from "./job_part";
import { jobHead } from "./job_head";
import { keepInAddress } from "./deep_link";
import { Playhead } from "./playhead";
import { openProbe } from "./probe/probe_part";
import { openRelight } from "./relight/relight_part";
import { openReport } from "./report/report_part";
import { openTimeline } from "./timeline/timeline_part";
import { openWalk } from "./walk/walk_part";
import "./job.css";

// Until the mesh says what the job's own is.
const kUsualFps = 24;

export const openJobPage: OpenPage = (context) => {
  const id = context.values["id"]!;
  context.setTitle("Job");
  const content = h("div", { class: "job", "aria-busy": "true" }, h("p", { class: "muted" }, "Fetching the job…"));
  const over = new AbortController();
  context.lifetime.add(() => over.abort());
  get("/v1/jobs/{id}", { path: { id }, signal: over.signal }).then(
    (job) => showJob(context, content, job),
    (error: unknown) => showTrouble(content, error),
  );
  return content;
};

function showTrouble(content: HTMLElement, error: unknown): void {
  if (error instanceof DOMException) return;
  content.removeAttribute("aria-busy");
  const gone = error instanceof ApiError && error.status === 404;
  fill(content, h("div", { class: "notice" },
    h("p", null, gone ? "There is no such job (any more)." : messageOf(error)),
    h("p", null, h("a", { href: "/" }, "To the queue"))));
}

function showJob(page: PageContext, content: HTMLElement, first: Job): void {
  const job = new Signal(first);
  keepTrue(page, job);
  const context: JobContext = {
    id: first.id,
    job,
    playhead: new Playhead(first.frame_count, kUsualFps),
    stage: new Signal<LightStage | null>(null),
    lifetime: page.lifetime,
  };
  page.lifetime.add(job.watch((now) => page.setTitle(now.name || now.id)));
  keepInAddress(context.playhead, page.lifetime);
  content.removeAttribute("aria-busy");
  fill(content, jobHead(context), tabs("Parts of the job", [
    part("walk", "Walk", context, [openWalk, openTimeline, openProbe, openRelight]),
    part("images", "Images and video", context, [openImages]),
    part("report", "Report", context, [openReport]),
  ]));
}

function part(name: string, label: string, context: JobContext, parts: readonly OpenJobPart[]): Tab {
  return { name, label, open: () => h("div", { class: `job-${name}` }, parts.map((open) => open(context))) };
}

/** By events between fetches: progress alone is patched in, a change of state is looked up. */
function keepTrue(page: PageContext, job: Signal<Job>): void {
  const { id } = job.value;
  const look = (): void => {
    get("/v1/jobs/{id}", { path: { id } }).then((now) => {
      if (!page.lifetime.ended) job.value = now;
    }, () => {}); // the header says that the service is away; the next refresh looks again
  };
  live.listen(page.lifetime, {
    onState: (event) => event.job === id && look(),
    onRemoved: (gone) => gone.job === id && look(),
    onRefresh: look,
    onProgress: (progress) => {
      if (progress.job !== id) return;
      const { stage, stage_fraction, fraction, seconds_left } = progress;
      job.value = { ...job.value, attempt: progress.attempt, progress: { stage: stage as Job["progress"]["stage"], stage_fraction, fraction, seconds_left } };
    },
  });
}
