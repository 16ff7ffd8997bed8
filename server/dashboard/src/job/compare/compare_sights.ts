// Two pictures from one camera, one over the other, with an edge to draw across; or the difference of the two.
import { h } from "../../base/h";
import { Signal } from "../../base/signal";
import type { LightingView, Term } from "../../scene/lighting_view";
import type { ShadingMesh } from "../../scene/shading_mesh";
import type { JobContext } from "../job_part";
import type { Playhead } from "../playhead";
import { colourLegend } from "../walk/colour_legend";
import type { Fetched } from "../walk/fetch_mesh";
import { firstSight, meanRadiosity, type Sight } from "../walk/sight";

export type Side = JobContext & { readonly opened: Fetched };

/** The same patches at the same places: only then is there a difference patch by patch. */
export function sameMesh(a: ShadingMesh, b: ShadingMesh): boolean {
  return a.patchCount === b.patchCount && a.nodeCount === b.nodeCount && a.nodePosition.every((x, k) => x === b.nodePosition[k]);
}

const kOne = [1, 1, 1] as const;
const kMinusOne = [-1, -1, -1] as const;
/** The scale of differences, as a share of the mean radiosity. */
const kShares = [0.01, 0.05, 0.2, 1] as const;

export async function compareSights(a: Side, b: Side): Promise<HTMLElement> {
  const { createLightingView } = await import("../../scene/webgl_view");
  const canvas = (label: string) => h("canvas", { class: "walk-canvas compare-canvas", tabindex: "0", "aria-label": label });
  const [below, above] = [canvas("Job A on the left of the edge, job B on the right"), canvas("Job B")];
  above.classList.add("compare-above");
  above.tabIndex = -1;
  const frame = h("div", { class: "walk-frame" }, below, above);
  const viewA = createLightingView(below, a.opened.mesh);
  const viewB = createLightingView(above, b.opened.mesh);
  a.lifetime.add(() => viewA.dispose(), () => viewB.dispose());
  viewB.setTerms([{ source: b.opened.source("radiosity"), gain: kOne }]);
  join(a.playhead, viewA, viewB, a);
  const same = sameMesh(a.opened.mesh, b.opened.mesh);
  const edge = edgeSlider(frame);
  const sight = new Signal<Sight>(firstSight(a.opened.mesh));
  const tools = h("div", { class: "walk-tools row" }, edge, same ? differenceTools(a, b, viewA, above, edge, sight) : cannotDiffer());
  a.lifetime.add(sight.watch((now) => viewA.setDisplay(now.display)));
  frame.append(colourLegend(a, sight));
  if (!same) viewA.setTerms([{ source: a.opened.source("radiosity"), gain: kOne }]);
  return h("section", { "aria-label": "Pictures" }, tools, frame);
}

/** One moment, one camera: the lower picture takes the pointer, the upper one follows. */
function join(playhead: Playhead, lower: LightingView, upper: LightingView, { lifetime, opened }: Side): void {
  const camera = opened.mesh.cameras.names[0];
  if (playhead.camera.value) lower.camera.value = playhead.camera.value;
  else if (camera !== undefined) lower.followCamera(camera);
  lifetime.add(
    playhead.time.watch((time) => {
      lower.setTime(time);
      upper.setTime(time);
    }),
    lower.camera.watch((state) => {
      upper.camera.value = state;
      playhead.camera.value = lower.following.value === null ? state : null;
    }),
  );
}

function edgeSlider(frame: HTMLElement): HTMLElement {
  const move = (): void => frame.style.setProperty("--edge", `${slider.value}%`);
  const slider = h("input", { type: "range", min: 0, max: 100, value: 50, oninput: move, "aria-label": "Edge between A and B" });
  move();
  return h("label", { class: "row" }, "A ", slider, " B");
}

function cannotDiffer(): HTMLElement {
  return h("span", { class: "muted small" }, "The jobs have different patches: their difference cannot be shown.");
}

function differenceTools(a: Side, b: Side, view: LightingView, above: HTMLElement, edge: HTMLElement, sight: Signal<Sight>): HTMLElement {
  const light: readonly Term[] = [{ source: a.opened.source("radiosity"), gain: kOne }];
  const difference: readonly Term[] = [...light, { source: b.opened.source("radiosity"), gain: kMinusOne }];
  const mean = meanRadiosity(a.opened.mesh);
  const share = h("select", { onchange: () => show(), "aria-label": "Scale of the difference" },
    kShares.map((s) => h("option", { value: s, selected: s === 0.05 }, `±${100 * s} % of the mean`)));
  const box = h("input", { type: "checkbox", onchange: () => show() });
  const show = (): void => {
    const on = box.checked;
    above.hidden = edge.hidden = on;
    share.disabled = !on;
    view.setTerms(on ? difference : light);
    const scale = { from: 0, to: Number(share.value) * mean, log: false, signed: true };
    sight.value = { mode: on ? "false-colour" : "light", display: { ...sight.value.display, what: on ? "false-colour" : "light", scale } };
  };
  show();
  return h("span", { class: "row" }, h("label", null, box, " Difference A − B "), share);
}
