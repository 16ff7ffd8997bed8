// The video of a job, made when it is first asked for, in step with the timeline.
import { ApiError, messageOf } from "../../api/api_error";
import { fetchBytes, sleep, urlOf } from "../../api/client";
import { curlOf } from "../../api/curl";
import { fill, h } from "../../base/h";
import { copyCurlButton } from "../../shell/copy_curl";
import type { JobContext } from "../job_part";

const kFormats = ["mp4", "webm"] as const;
type Format = (typeof kFormats)[number];
const kWaitSeconds = 1;

function pathOf(format: Format): "/v1/jobs/{id}/video.mp4" | "/v1/jobs/{id}/video.webm" {
  return format === "mp4" ? "/v1/jobs/{id}/video.mp4" : "/v1/jobs/{id}/video.webm";
}

export function videoPlayer(context: JobContext): HTMLElement {
  const place = h("div");
  const buttons = kFormats.flatMap((format) => [
    h("button", { onclick: () => void make(context, format, place) }, `Make ${format}`),
    copyCurlButton(() => curlOf("GET", pathOf(format), { path: { id: context.id }, output: `job.${format}` }), `fetch the video as ${format}`),
  ]);
  const row = h("div", { class: "row" }, h("h2", null, "Video"), buttons);
  const element = h("section", { "aria-label": "Video" }, row, place);
  context.lifetime.add(context.job.watch((job) => (element.hidden = job.state !== "succeeded")));
  return element;
}

/** 202 until it is there. */
async function make(context: JobContext, format: Format, place: HTMLElement): Promise<void> {
  const url = urlOf(pathOf(format), { path: { id: context.id } });
  const stop = new AbortController();
  context.lifetime.add(() => stop.abort());
  fill(place, h("p", { class: "muted", role: "status" }, "The video is being made…"));
  try {
    // Only its first byte: the player fetches what it shows, by ranges.
    while ((await fetchBytes(url, { headers: { Range: "bytes=0-0" }, signal: stop.signal })).status === 202)
      await sleep(kWaitSeconds, stop.signal);
    fill(place, player(context, url), h("p", null, h("a", { href: url, download: `${context.id}.${format}` }, `Save as ${format}`)));
  } catch (error) {
    if (stop.signal.aborted) return;
    const why = error instanceof ApiError && error.status === 404 ? `${error.message}` : messageOf(error);
    fill(place, h("p", { class: "bad" }, why));
  }
}

function player({ playhead, lifetime }: JobContext, url: string): HTMLVideoElement {
  const video = h("video", { src: url, controls: true, muted: true, loop: true, preload: "auto", class: "frame-picture" });
  const middle = (frame: number): number => (frame + 0.5) / playhead.fps;
  lifetime.listen(video, "timeupdate", () => {
    if (!video.paused) playhead.time.value = Math.min(Math.floor(video.currentTime * playhead.fps), playhead.frameCount - 1);
  });
  lifetime.add(playhead.time.watch(() => {
    if (video.paused && Math.abs(video.currentTime - middle(playhead.frame)) > 0.5 / playhead.fps) video.currentTime = middle(playhead.frame);
  }));
  return video;
}
