// How much two jobs differ in each frame: root of the mean square over the patches, weighted by area, relative to the
// mean of A in that frame, as the paper's figure 7.
import { fill, h } from "../../base/h";
import { axis, fitWidth, uPlot } from "../../base/plot";
import { Vector3 } from "../../scene/vector";
import type { FrameSource } from "../../scene/lighting_view";
import { kNoNode, type ShadingMesh } from "../../scene/shading_mesh";
import { halfValue } from "../../scene/half_floats";
import { sameMesh, type Side } from "./compare_sights";

const kHeight = 200;

export function rmsePlot(place: HTMLElement, a: Side, b: Side): void {
  if (!sameMesh(a.opened.mesh, b.opened.mesh)) return;
  const button = h("button", { onclick: () => void begin().catch(failed) }, "Plot the difference of every frame");
  const status = h("p", { class: "muted small", role: "status" });
  fill(place, button, status);
  const failed = (error: unknown): void => {
    if (!a.lifetime.ended) status.textContent = error instanceof Error ? error.message : String(error);
  };

  async function begin(): Promise<void> {
    button.disabled = true;
    const frames = a.playhead.frameCount;
    const area = areasOf(a.opened.mesh);
    const errors: number[] = [];
    for (let frame = 0; frame < frames && !a.lifetime.ended; ++frame) {
      status.textContent = `Frame ${frame} of ${frames - 1}`;
      errors.push(100 * (await relativeRmse(a.opened.source("radiosity"), b.opened.source("radiosity"), frame, area)));
    }
    if (a.lifetime.ended) return;
    fill(place, h("h2", null, "Difference of every frame"));
    draw(place, a, errors);
  }
}

async function relativeRmse(a: FrameSource, b: FrameSource, frame: number, area: Float64Array): Promise<number> {
  const [x, y] = await Promise.all([a.load(frame), b.load(frame)]);
  let squares = 0;
  let sum = 0;
  for (let k = 0; k < x.length; ++k) {
    const value = halfValue(x[k]!) * a.halfScale;
    const difference = value - halfValue(y[k]!) * b.halfScale;
    const weight = area[Math.floor(k / 3)]!;
    squares += weight * difference * difference;
    sum += weight * value;
  }
  const all = 3 * area.reduce((total, one) => total + one, 0);
  return sum > 0 ? Math.sqrt(squares / all) / (sum / all) : 0;
}

/** Of the patches in object space [m^2]: parallelograms and triangles. */
function areasOf(mesh: ShadingMesh): Float64Array {
  const corner = (patch: number, k: number): Vector3 => Vector3.from(mesh.nodePosition, mesh.patchNodes[4 * patch + k]!);
  return Float64Array.from({ length: mesh.patchCount }, (_, patch) => {
    const triangle = mesh.patchNodes[4 * patch + 3] === kNoNode;
    const origin = corner(patch, 0);
    const size = corner(patch, 1).minus(origin).cross(corner(patch, triangle ? 2 : 3).minus(origin)).length;
    return triangle ? size / 2 : size;
  });
}

function draw(place: HTMLElement, { playhead, lifetime }: Side, errors: readonly number[]): void {
  const plot = new uPlot({
    width: Math.max(place.clientWidth, 200), height: kHeight, legend: { show: false },
    scales: { x: { time: false } }, axes: [axis("frame", "x"), axis("RMSE / mean [%]", "y")],
    series: [{}, { stroke: "#0072b2", width: 2, points: { show: false } }],
  }, [errors.map((_, frame) => frame), [...errors]]);
  const largest = Math.max(...errors);
  plot.root.setAttribute("role", "img");
  plot.root.setAttribute("aria-label", `RMSE relative to the mean, at most ${largest.toPrecision(2)} % in frame ${errors.indexOf(largest)}`);
  place.append(plot.root);
  fitWidth(plot, place, lifetime);
  lifetime.listen(plot.over, "click", () => {
    if (plot.cursor.idx !== null && plot.cursor.idx !== undefined) playhead.time.value = plot.cursor.idx;
  });
}
