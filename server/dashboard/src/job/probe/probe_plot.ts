// The plot: a line for each patch, twice its standard error around it, key-frames as marks, the moment as a line.
import type { PatchSeries } from "../../api/types";
import { axis, fitWidth, kLineColours, resolvedColour, uPlot } from "../../base/plot";
import type { Lifetime } from "../../base/signal";
import { fill } from "../../base/h";
import type { KeyFrames } from "../key_frames";
import type { Playhead } from "../playhead";
import { channelOf, errorOf, kChannels, type Channel } from "./channels";

const kHeight = 260;
/** Of a normal distribution 95 in 100 lie within. */
const kErrors = 2;

export interface Probed {
  readonly series: readonly PatchSeries[];
  readonly channel: Channel;
  readonly keys: KeyFrames;
  readonly playhead: Playhead;
}

export function probePlot(place: HTMLElement, probed: Probed, lifetime: Lifetime): void {
  const { playhead } = probed;
  const plot = new uPlot({
    width: Math.max(place.clientWidth, 200), height: kHeight, legend: { show: false }, cursor: { drag: { setScale: false } },
    scales: { x: { time: false, range: [0, Math.max(playhead.frameCount - 1, 1)] } },
    axes: [axis("frame", "x"), axis(`${kChannels.find(({ name }) => name === probed.channel)!.label} [W/m²]`, "y")],
    series: [{}, ...probed.series.flatMap((series, k) => lines(series, kLineColours[k % kLineColours.length]!))],
    bands: probed.series.map((_, k) => ({ series: [3 * k + 2, 3 * k + 3], fill: `${kLineColours[k % kLineColours.length]}33` })),
    hooks: { draw: [(u) => drawMarks(u, probed)] },
  }, data(probed));
  fill(place, plot.root);
  plot.root.setAttribute("role", "img");
  plot.root.setAttribute("aria-label", describe(probed));
  fitWidth(plot, place, lifetime);
  lifetime.add(playhead.time.watch(() => plot.redraw(false)));
  lifetime.listen(plot.over, "click", () => {
    const { idx } = plot.cursor;
    if (idx === null || idx === undefined) return;
    playhead.playing.value = false;
    playhead.time.value = idx;
  });
}

function lines(series: PatchSeries, colour: string): uPlot.Series[] {
  const edge: uPlot.Series = { stroke: "transparent", points: { show: false } };
  return [{ label: `patch ${series.patch}`, stroke: colour, width: 2, points: { show: false } }, edge, edge];
}

function data({ series, channel, playhead }: Probed): uPlot.AlignedData {
  const frames = Array.from({ length: playhead.frameCount }, (_, frame) => frame);
  const columns = series.flatMap(({ radiosity, standard_error }) => {
    const value = radiosity.map((rgb) => channelOf(rgb, channel));
    const error = value.map((_, frame) => kErrors * errorOf(standard_error?.[frame] ?? [0, 0, 0], channel));
    return [value, value.map((v, k) => v + error[k]!), value.map((v, k) => Math.max(v - error[k]!, 0))];
  });
  return [frames, ...columns];
}

/** Key-frames as triangles on the axis; the moment as a line. */
function drawMarks(u: uPlot, { keys, playhead }: Probed): void {
  const { ctx, bbox } = u;
  const size = 5 * devicePixelRatio;
  ctx.save();
  ctx.fillStyle = resolvedColour("--text");
  for (const { frame, kind } of keys.frames) {
    if (kind === "interpolated") continue;
    const x = u.valToPos(frame, "x", true);
    ctx.beginPath();
    ctx.moveTo(x, bbox.top + bbox.height - (kind === "key" ? 2 : 1.2) * size);
    ctx.lineTo(x + size, bbox.top + bbox.height);
    ctx.lineTo(x - size, bbox.top + bbox.height);
    ctx.fill();
  }
  ctx.strokeStyle = resolvedColour("--accent");
  ctx.lineWidth = devicePixelRatio;
  const now = u.valToPos(playhead.time.value, "x", true);
  ctx.beginPath();
  ctx.moveTo(now, bbox.top);
  ctx.lineTo(now, bbox.top + bbox.height);
  ctx.stroke();
  ctx.restore();
}

function describe({ series, channel }: Probed): string {
  return series.map(({ patch, radiosity }) => {
    const values = radiosity.map((rgb) => channelOf(rgb, channel));
    return `Patch ${patch}: ${channel} from ${Math.min(...values).toPrecision(3)} to ${Math.max(...values).toPrecision(3)} W/m² over ${values.length} frames`;
  }).join("; ");
}
