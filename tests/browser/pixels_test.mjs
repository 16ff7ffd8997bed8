// What WebGL draws is what the engine draws, from the same radiosity and camera.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { join } from "node:path";
import { Watched, launch, untilLit } from "./support/browser.mjs";
import { finished, writeJob } from "./support/jobs.mjs";
import { decodePng, difference } from "./support/pixels.mjs";
import { Service } from "./support/service.mjs";

const kSize = { width: 640, height: 360 };
/** Of the examples' pictures. */
const kCamera = "main";
const kJobs = [
  /** The plane over the window of light, its shadow in the middle, and on its way out. Facets are drawn as grids. */
  { name: "garage", cut: { frames: 120 }, shown: [12, 60, 101] },
  /** Cells of several sizes. */
  { name: "adaptive garage", cut: { frames: 12, patch_layout: "adaptive" }, shown: [6] },
  /** Triangles, smooth things, and several that move; larger, since it is full of edges, where both take few samples. */
  { name: "office", cut: { example: "office", frames: 12 }, shown: [7], size: { width: 960, height: 540 } },
];
const kMeanMax = 0.02;
const kPercentile99Max = 0.1;

let service, browser;
const made = new Map();

before(async () => {
  service = await new Service().start();
  browser = await launch();
  for (const { name, cut, size = kSize } of kJobs) made.set(name, await finished(service, writeJob(join(service.folder, name), { ...cut, ...size })));
});
after(async () => {
  await browser?.close();
  await service?.end();
});

/** The picture alone, one texel for each pixel of the engine's. */
function sizeCanvas(page, size) {
  return page.locator(".walk-canvas").evaluate((canvas, { width, height }) => {
    const style = { position: "fixed", left: 0, top: 0, zIndex: 10, width: `${width}px`, height: `${height}px`, aspectRatio: "auto", maxHeight: "none" };
    Object.assign(canvas.style, style);
  }, size);
}

async function picture(job, frame) {
  const answer = await fetch(`${service.url}/v1/jobs/${job.id}/frames/${frame}/image.png`);
  return decodePng(Buffer.from(await answer.arrayBuffer()));
}

const percent = (x) => `${(100 * x).toFixed(2)} %`;

for (const { name, shown, size = kSize } of kJobs) for (const frame of shown) {
  test(`frame ${frame} of the ${name} in the walk is the engine's picture`, async () => {
    const job = made.get(name);
    const watched = await Watched.open(browser, service, `/jobs/${job.id}#frame=${frame}`);
    const { page } = watched;
    await page.locator(".walk-canvas").waitFor();
    await page.locator(".walk-tools").getByLabel("Camera").selectOption(kCamera);
    await sizeCanvas(page, size);
    const canvas = await untilLit(page);
    const { mean, percentile99, largest } = difference(decodePng(await canvas.screenshot()), await picture(job, frame));
    console.log(`ratio: ${name}, frame ${frame}: mean difference ${percent(mean)}, 99th percentile ${percent(percentile99)}, largest ${percent(largest)}`);
    assert.ok(mean < kMeanMax, `mean difference ${percent(mean)}`);
    assert.ok(percentile99 < kPercentile99Max, `99th percentile ${percent(percentile99)}`);
    await watched.close();
  });
}

test("the comparison tells frames apart", async () => {
  const [{ name, shown: [a, b] }] = kJobs;
  const { percentile99 } = difference(await picture(made.get(name), a), await picture(made.get(name), b));
  assert.ok(percentile99 >= kPercentile99Max, `${percentile99}`);
});
