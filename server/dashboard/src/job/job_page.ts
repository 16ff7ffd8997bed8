// One job: what it is doing, and what it has made, in parts.
import { get } from "../api/client";
import { ApiError, messageOf } from "../api/api_error";
import type { Job } from "../api/types";
import { fill, h } from "../base/h";
import { Signal } from "../base/signal";
import type { OpenPage, PageContext } from "../shell/page";
import type { JobKeeper } from "../queue/actions";
import { navigate } from "../shell/router";
import { tabs, type Tab } from "../shell/tabs";
import { followJob } from "./follow_job";
import { openImages } from "./images/images_part";
import type { JobContext, LightStage, OpenJobPart } from "./job_part";
import { jobHead } from "./job_head";
import { keepInAddress } from "./deep_link";
import { Playhead } from "./playhead";
import { openProbe } from "./probe/probe_part";
import { openRelight } from "./relight/relight_part";
import { openReport } from "./report/report_part";
import { startPlaying } from "./timeline/play_keys";
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
  showNotice(content, gone ? "There is no such job (any more)." : messageOf(error));
}

function showNotice(content: HTMLElement, text: string): void {
  fill(content, h("div", { class: "notice" }, h("p", { role: "status" }, text), h("p", null, h("a", { href: "/" }, "To the queue"))));
}

function showJob(page: PageContext, content: HTMLElement, first: Job): void {
  const job = new Signal(first);
  const look = followJob(job, page.lifetime, () => showNotice(content, "This job was deleted."));
  const keeper: JobKeeper = {
    put: (now) => (job.value = now),
    remove: (ids) => ids.includes(first.id) && navigate("/"),
    reload: look,
  };
  const context: JobContext = {
    id: first.id,
    job,
    playhead: new Playhead(first.frame_count, kUsualFps),
    stage: new Signal<LightStage | null>(null),
    lifetime: page.lifetime,
  };
  page.lifetime.add(job.watch((now) => page.setTitle(now.name || now.id)));
  keepInAddress(context.playhead, page.lifetime);
  startPlaying(context.playhead, page.lifetime);
  content.removeAttribute("aria-busy");
  fill(content, jobHead(context, keeper), tabs("Parts of the job", [
    part("walk", "Walk", context, [openWalk, openTimeline, openProbe, openRelight]),
    part("images", "Images and video", context, [openImages]),
    part("report", "Report", context, [openReport]),
  ]));
}

function part(name: string, label: string, context: JobContext, parts: readonly OpenJobPart[]): Tab {
  return { name, label, open: () => h("div", { class: `job-${name}` }, parts.map((open) => open(context))) };
}
