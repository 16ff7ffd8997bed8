// The job's own pictures: those that are there already while it runs, all of them once it is done.
import { get } from "../../api/client";
import { curlOf } from "../../api/curl";
import { fill, h } from "../../base/h";
import { copyCurlButton } from "../../shell/copy_curl";
import type { JobContext } from "../job_part";
import { frameSlider, playButton } from "../timeline/play_controls";

const kLookMs = 3000;

interface Picture {
  readonly frame: number;
  readonly camera: string;
  readonly href: string;
}

export function framePlayer(context: JobContext): HTMLElement {
  const { playhead, lifetime } = context;
  let pictures: readonly Picture[] = [];
  let camera = "";
  const image = h("img", { class: "frame-picture", alt: "" });
  const note = h("p", { class: "muted small", role: "status" });
  const choice = h("select", {
    onchange: () => {
      camera = choice.value;
      show();
    },
  });
  const slider = frameSlider(playhead, lifetime, "Frame of the pictures");
  const show = (): void => {
    const picture = nearest(pictures.filter((one) => one.camera === camera), playhead.frame);
    image.hidden = picture === undefined;
    if (!picture) return;
    if (image.getAttribute("src") !== picture.href) image.src = picture.href;
    image.alt = `Frame ${picture.frame} seen by camera ${picture.camera}`;
    note.textContent = picture.frame === playhead.frame ? `Frame ${picture.frame}` : `Frame ${playhead.frame} is not there yet; this is frame ${picture.frame}`;
  };
  const look = async (): Promise<void> => {
    const answer = await get("/v1/jobs/{id}/preview", { path: { id: context.id } });
    pictures = answer.images;
    const cameras = [...new Set(pictures.map((one) => one.camera))];
    if (!cameras.includes(camera)) camera = cameras[0] ?? "";
    fill(choice, cameras.map((name) => h("option", { value: name, selected: name === camera }, name)));
    if (pictures.length === 0) note.textContent = answer.complete ? "The job asked for no pictures. Views can be rendered below." : "There are no pictures yet.";
    show();
  };
  keepLooking(context, look);
  lifetime.add(playhead.time.watch(show));
  return h("section", { "aria-label": "Pictures" },
    h("div", { class: "row" }, h("h2", null, "Pictures"), playButton(playhead, lifetime), h("label", null, "Camera ", choice),
      copyCurlButton(() => curlOf("GET", "/v1/jobs/{id}/frames/{f}/image.png", {
        path: { id: context.id, f: playhead.frame }, query: { camera }, output: `frame_${playhead.frame}.png`,
      }), "fetch this picture")),
    image, slider, note);
}

/** Pictures come while the job runs; the last look is when it is done. */
function keepLooking({ job, lifetime }: JobContext, look: () => Promise<void>): void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  const again = (): void => {
    look().catch(() => {}).finally(() => {
      if (!lifetime.ended && job.value.state === "running") timer = setTimeout(again, kLookMs);
    });
  };
  let state = "";
  lifetime.add(() => clearTimeout(timer), job.watch((now) => {
    if (now.state === state) return;
    state = now.state;
    clearTimeout(timer);
    again();
  }));
}

function nearest(pictures: readonly Picture[], frame: number): Picture | undefined {
  let best: Picture | undefined;
  for (const picture of pictures)
    if (!best || Math.abs(picture.frame - frame) < Math.abs(best.frame - frame)) best = picture;
  return best;
}
