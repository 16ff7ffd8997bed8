// What WebGL draws is what the engine draws, from the same radiosity and camera.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { join } from "node:path";
import { Watched, launch, untilLit } from "./support/browser.mjs";
import { finished, writeJob } from "./support/jobs.mjs";
import { decodePng, difference } from "./support/pixels.mjs";
import { Service } from "./support/service.mjs";

const kSize = { width: 640, height: 360 };
const kFrames = 120;
/** The plane over the window of light, its shadow in the middle, and on its way out. */
const kShown = [12, 60, 101];
const kMeanMax = 0.02;
const kPercentile99Max = 0.1;

let service, browser, job;

before(async () => {
  service = await new Service().start();
  browser = await launch();
  job = await finished(service, writeJob(join(service.folder, "garage"), { frames: kFrames, ...kSize }));
});
after(async () => {
  await browser?.close();
  await service?.end();
});

/** The picture alone, one texel for each pixel of the engine's. */
function sizeCanvas(page) {
  return page.locator(".walk-canvas").evaluate((canvas, { width, height }) => {
    const style = { position: "fixed", left: 0, top: 0, zIndex: 10, width: `${width}px`, height: `${height}px`, aspectRatio: "auto", maxHeight: "none" };
    Object.assign(canvas.style, style);
  }, kSize);
}

for (const frame of kShown) {
  test(`frame ${frame} of the garage in the walk is the engine's picture`, async () => {
    const watched = await Watched.open(browser, service, `/jobs/${job.id}#frame=${frame}`);
    const { page } = watched;
    await page.locator(".walk-canvas").waitFor();
    await sizeCanvas(page);
    const canvas = await untilLit(page);
    const shown = decodePng(await canvas.screenshot());
    const answer = await fetch(`${service.url}/v1/jobs/${job.id}/frames/${frame}/image.png`);
    const wanted = decodePng(Buffer.from(await answer.arrayBuffer()));
    const { mean, percentile99, largest } = difference(shown, wanted);
    const percent = (x) => `${(100 * x).toFixed(2)} %`;
    console.log(`ratio: frame ${frame}: mean difference ${percent(mean)}, 99th percentile ${percent(percentile99)}, largest ${percent(largest)}`);
    assert.ok(mean < kMeanMax, `mean difference ${percent(mean)}`);
    assert.ok(percentile99 < kPercentile99Max, `99th percentile ${percent(percentile99)}`);
    await watched.close();
  });
}

test("the comparison tells frames apart", async () => {
  const picture = async (frame) => decodePng(Buffer.from(await (await fetch(`${service.url}/v1/jobs/${job.id}/frames/${frame}/image.png`)).arrayBuffer()));
  const { percentile99 } = difference(await picture(kShown[0]), await picture(kShown[1]));
  assert.ok(percentile99 >= kPercentile99Max, `${percentile99}`);
});
