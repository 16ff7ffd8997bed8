// The video of a job, made when it is first asked for, in step with the timeline.
import { ApiError, messageOf } from "../../api/api_error";
import { fetchBytes, sleep, urlOf } from "../../api/client";
import { curlOf } from "../../api/curl";
import { fill, h } from "../../base/h";
import { Lifetime } from "../../base/signal";
import { copyCurlButton } from "../../shell/copy_curl";
import type { JobContext } from "../job_part";

const kFormats = ["mp4", "webm"] as const;
type Format = (typeof kFormats)[number];
const kWaitSeconds = 1;
/** In frames: the time of a frame is rounded to the clock of the file. */
const kSlack = 0.05;

function pathOf(format: Format): "/v1/jobs/{id}/video.mp4" | "/v1/jobs/{id}/video.webm" {
  return format === "mp4" ? "/v1/jobs/{id}/video.mp4" : "/v1/jobs/{id}/video.webm";
}

export function videoPlayer(context: JobContext): HTMLElement {
  const place = h("div", { class: "video-place" });
  let shown = new Lifetime();
  context.lifetime.add(() => shown.end());
  const remake = (format: Format): void => {
    shown.end();
    shown = new Lifetime();
    void make(context, shown, format, place);
  };
  const buttons = kFormats.map((format) => h("span", { class: "with-curl" },
    h("button", { onclick: () => remake(format) }, `Make ${format}`),
    copyCurlButton(() => curlOf("GET", pathOf(format), { path: { id: context.id }, output: `job.${format}` }), `fetch the video as ${format}`)));
  const row = h("div", { class: "row" }, h("h2", null, "Video"), buttons);
  const element = h("section", { "aria-label": "Video" }, row, place);
  context.lifetime.add(context.job.watch((job) => (element.hidden = job.state !== "succeeded")));
  return element;
}

/** 202 until it is there. */
async function make(context: JobContext, lifetime: Lifetime, format: Format, place: HTMLElement): Promise<void> {
  const url = urlOf(pathOf(format), { path: { id: context.id } });
  const stop = new AbortController();
  lifetime.add(() => stop.abort());
  fill(place, h("p", { class: "muted", role: "status" }, "The video is being made…"));
  try {
    // Only its first byte: the player fetches what it shows, by ranges.
    while ((await fetchBytes(url, { headers: { Range: "bytes=0-0" }, signal: stop.signal })).status === 202)
      await sleep(kWaitSeconds, stop.signal);
    fill(place, player(context, lifetime, url), h("p", null, h("a", { href: url, download: `${context.id}.${format}` }, `Save as ${format}`)));
  } catch (error) {
    if (stop.signal.aborted) return;
    const why = error instanceof ApiError && error.status === 404 ? `${error.message}` : messageOf(error);
    fill(place, h("p", { class: "bad" }, why));
  }
}

/** While it plays it leads, else it follows. */
function player({ playhead }: JobContext, lifetime: Lifetime, url: string): HTMLVideoElement {
  const video = h("video", { src: url, controls: true, muted: true, loop: true, preload: "auto", class: "frame-picture" });
  // The playhead knows the job's own pace only where Walk has been opened.
  const fps = (): number => (video.duration > 0 ? playhead.frameCount / video.duration : playhead.fps);
  const middle = (frame: number): number => (frame + 0.5) / fps();
  const lead = (seconds: number): void => {
    playhead.time.value = Math.min(Math.floor(seconds * fps() + kSlack), playhead.frameCount - 1);
  };
  // Told of every frame that is shown where the browser does so, else a few times a second.
  const eachFrame = (_: number, { mediaTime }: { mediaTime: number }): void => {
    if (!video.paused) lead(mediaTime);
    if (!lifetime.ended) video.requestVideoFrameCallback(eachFrame);
  };
  if ("requestVideoFrameCallback" in video) video.requestVideoFrameCallback(eachFrame);
  else lifetime.listen(video, "timeupdate", () => !(video as HTMLVideoElement).paused && lead((video as HTMLVideoElement).currentTime));
  lifetime.listen(video, "pause", () => lead(video.currentTime));
  lifetime.listen(video, "play", () => (playhead.playing.value = false));
  const follow = (): void => {
    if (video.paused && Math.abs(video.currentTime - middle(playhead.frame)) > 0.5 / fps()) video.currentTime = middle(playhead.frame);
  };
  lifetime.listen(video, "loadedmetadata", follow);
  lifetime.add(playhead.time.watch(follow));
  return video;
}
