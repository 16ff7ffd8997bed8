// What a new user does first: one click, and a look at the light.
import assert from "node:assert/strict";
import { test } from "node:test";
import { untilLit } from "./support/browser.mjs";
import { untilState } from "./support/jobs.mjs";
import { decodePng } from "./support/pixels.mjs";
import { suite } from "./support/suite.mjs";

/** Of the picture: the floor below the plane in the middle of its flight. */
const kBelow = { left: 0.46, right: 0.54, top: 0.6, bottom: 0.66 };
const kDarkerMin = 0.03;

const given = suite();

/** Mean of a part of the picture, 0 .. 1. */
function meanOf({ width, height, rgb }, { left, right, top, bottom }) {
  let [sum, count] = [0, 0];
  for (let y = Math.round(top * height); y < bottom * height; ++y)
    for (let x = Math.round(left * width); x < right * width; ++x, ++count) sum += rgb[3 * (y * width + x)] / 255;
  return sum / count;
}

test("the example is submitted by one click, and the plane's shadow lies on the floor at frame 60", async () => {
  const watched = await given.open("/");
  const { page } = watched;
  await page.getByRole("button", { name: "Try the example" }).click();
  await page.waitForURL(/\/jobs\/job_/);
  await untilState(given.service, /job_\w+/.exec(page.url())[0], "succeeded", 300);
  const canvas = await untilLit(page);
  const before = meanOf(decodePng(await canvas.screenshot()), kBelow);
  await page.getByRole("slider", { name: "Frame" }).fill("60");
  await untilLit(page);
  const under = meanOf(decodePng(await canvas.screenshot()), kBelow);
  console.log(`ratio: the floor in the middle: ${before.toFixed(3)} in frame 0, ${under.toFixed(3)} in frame 60`);
  assert.ok(under < before - kDarkerMin, `${under} after ${before}`);
  await watched.close();
});
