// Walk: the radiosity of the whole sequence, on its surfaces, from anywhere.
import { ApiError, messageOf } from "../../api/api_error";
import { fill, h } from "../../base/h";
import { addKeys } from "../../shell/keys";
import { Signal } from "../../base/signal";
import type { LightingView, Term } from "../../scene/lighting_view";
import type { JobContext, LightStage, OpenJobPart } from "../job_part";
import { fetchMesh } from "./fetch_mesh";
import { colourLegend } from "./colour_legend";
import { followPointer } from "./pointer";
import { firstSight, type Sight } from "./sight";
import { walkTools } from "./walk_tools";
import "./walk.css";

export const openWalk: OpenJobPart = (context) => {
  const place = h("div", { class: "walk-place" });
  let begun = false;
  context.lifetime.add(context.job.watch((job) => {
    if (begun) return;
    if (job.state !== "succeeded") {
      fill(place, h("p", { class: "muted walk-wait" }, job.state === "failed" || job.state === "canceled"
        ? "There is no light to walk in: the job has not succeeded."
        : "The lighting can be walked in once the job is done. Its pictures come earlier, under Images and video."));
      return;
    }
    begun = true;
    fill(place, h("p", { class: "muted walk-wait", role: "status" }, "Fetching the surfaces…"));
    begin(context, place).catch((error: unknown) => {
      if (!context.lifetime.ended) fill(place, notice(error));
    });
  }));
  return h("section", { class: "walk", "aria-label": "Walk" }, place);
};

function notice(error: unknown): HTMLElement {
  const old = error instanceof ApiError && error.status === 404;
  return h("div", { class: "notice" },
    h("p", null, old ? "This job was made by a version that kept no mesh to walk in. Retry or submit it again." : messageOf(error)),
    h("p", null, "The rendered pictures are under Images and video."));
}

/** three.js comes with its own chunk, when it is first needed. */
async function begin(context: JobContext, place: HTMLElement): Promise<void> {
  const [{ mesh, source }, { createLightingView }] = await Promise.all([fetchMesh(context), import("../../scene/webgl_view")]);
  if (context.lifetime.ended) return;
  context.playhead.fps = mesh.fps;
  const canvas = h("canvas", {
    class: "walk-canvas", tabindex: "0",
    "aria-label": "The lit scene. Drag to look around, scroll to go ahead, W A S D Q E to walk, click a patch to plot it.",
  });
  const frame = h("div", { class: "walk-frame" }, canvas);
  fill(place, frame);
  const view = createLightingView(canvas, mesh);
  context.lifetime.add(() => view.dispose());
  const sight = new Signal<Sight>(firstSight(mesh));
  const light = new Signal<readonly Term[]>([{ source: source("radiosity"), gain: [1, 1, 1] }]);
  const stage: LightStage = { view, mesh, source, light };
  connect(context, stage, sight);
  const tools = walkTools(context, stage, sight);
  fill(place, tools, frame, trouble(context, view));
  frame.append(colourLegend(context, sight), followPointer(context, stage, sight));
  context.stage.value = stage;
  addKeys(context.lifetime, "Walk", [
    ...[["w", "Ahead"], ["s", "Back"], ["a", "To the left"], ["d", "To the right"], ["e", "Up"], ["q", "Down"]].map(([keys, does]) => (
      { keys: keys!, does: `${does!} (held, in the picture)`, run: () => canvas.focus() })),
    { keys: "c", does: "Back to the job's camera", run: () => view.followCamera(mesh.cameras.names[0] ?? null) },
  ]);
}

function connect(context: JobContext, { view, mesh, source, light }: LightStage, sight: Signal<Sight>): void {
  const { playhead, lifetime } = context;
  if (playhead.camera.value) view.camera.value = playhead.camera.value;
  else if (mesh.cameras.names[0] !== undefined) view.followCamera(mesh.cameras.names[0]);
  const error: readonly Term[] = [{ source: source("radiosity_se"), gain: [1, 1, 1] }];
  const showTerms = (): void =>
    view.setTerms(sight.value.mode === "error" ? error : light.value);
  lifetime.add(
    sight.watch((now) => {
      view.setDisplay(now.display);
      showTerms();
    }),
    light.watch(showTerms),
    playhead.time.watch((time) => view.setTime(time)),
    playhead.pinned.watch((pinned) => view.setHighlighted(pinned)),
    // A camera of the job is not written into the address: there it would stand still.
    view.camera.watch((camera) => (playhead.camera.value = view.following.value === null ? camera : null)),
  );
}

function trouble(context: JobContext, view: LightingView): HTMLElement {
  const line = h("p", { class: "bad small", role: "status" });
  context.lifetime.add(view.trouble.watch((why) => {
    line.textContent = why === null ? "" : `Light is missing: ${why}`;
    line.hidden = why === null;
  }));
  return line;
}
