// What is done with jobs once there are some: comparing, lighting them otherwise, looking from elsewhere.
import assert from "node:assert/strict";
import { test } from "node:test";
import { join } from "node:path";
import { untilLit } from "./support/browser.mjs";
import { finished, get, submit, untilState, writeJob } from "./support/jobs.mjs";
import { brightness, decodePng, difference } from "./support/pixels.mjs";
import { waitFor } from "./support/service.mjs";
import { suite } from "./support/suite.mjs";

const kFrames = 8;
const kSame = 0.004; // of full scale: a step of eight bits

const given = suite(async (service) => {
  const job = (name, lighting = {}) => finished(service, writeJob(join(service.folder, name), { frames: kFrames, width: 64, height: 36, ...lighting }), { name });
  return {
    coarse: await job("coarse", { line_count: 20_000 }),
    fine: await job("fine"),
    grouped: await job("grouped", { light_groups: { middle: ["lamp_0_0"] } }),
  };
});

const picture = async (canvas) => decodePng(await canvas.screenshot());

test("two jobs are compared on either side of an edge, and by their difference", async () => {
  const watched = await given.open("/compare");
  const { page } = watched;
  const chooser = page.getByLabel("Job A", { exact: true });
  await chooser.locator("option").nth(2).waitFor({ state: "attached" });
  await chooser.selectOption(given.coarse.id);
  await page.getByLabel("Job B", { exact: true }).selectOption(given.fine.id);
  await page.getByRole("button", { name: "Compare", exact: true }).click();
  await page.waitForURL(/compare\?a=job_.*b=job_/);
  const frame = page.locator(".walk-frame");
  await untilLit(page, frame);
  const both = await picture(frame);
  await page.getByLabel("Edge between A and B").fill("100");
  const onlyA = await picture(await untilLit(page, frame));
  await page.getByLabel("Edge between A and B").fill("0");
  const onlyB = await picture(await untilLit(page, frame));
  assert.ok(difference(onlyA, onlyB).mean > 0, "the jobs differ");
  const half = difference(leftHalf(both), leftHalf(onlyA)).mean;
  assert.ok(half < kSame && half < difference(leftHalf(both), leftHalf(onlyB)).mean, "A is on the left");
  await page.getByLabel(/Difference A/).check();
  await page.locator(".legend").getByText("W/m²").waitFor();
  const shown = await picture(await untilLit(page, frame));
  assert.ok(difference(shown, onlyA).mean > 0.05, "the difference is not the light");
  await page.getByRole("button", { name: "Plot the difference of every frame" }).click();
  const plot = page.getByRole("img", { name: /RMSE relative to the mean, at most [\d.]+ % in frame \d+/ });
  await plot.waitFor();
  const [largest] = /[\d.]+(?= %)/.exec(await plot.getAttribute("aria-label"));
  assert.ok(Number(largest) > 0.1 && Number(largest) < 100, largest);
  await watched.close();
});

function leftHalf({ width, height, rgb }) {
  const half = Math.floor(width / 2) - 2; // without the edge itself
  const out = new Uint8Array(3 * half * height);
  for (let y = 0; y < height; ++y) out.set(rgb.subarray(3 * y * width, 3 * (y * width + half)), 3 * y * half);
  return { width: half, height, rgb: out };
}

test("a job compared with itself has no difference", async () => {
  const watched = await given.open(`/compare?a=${given.fine.id}&b=${given.fine.id}`);
  const { page } = watched;
  await untilLit(page, page.locator(".walk-frame"));
  await page.getByRole("button", { name: "Plot the difference of every frame" }).click();
  await page.getByRole("img", { name: "at most 0.0 % in frame 0" }).waitFor();
  await watched.close();
});

test("the groups of lights add up to the whole, and one switched off makes it darker", async () => {
  const watched = await given.open(`/jobs/${given.grouped.id}#frame=4`);
  const { page } = watched;
  const canvas = await untilLit(page);
  const whole = await picture(canvas);
  const relight = page.getByRole("region", { name: "Relight" });
  await relight.waitFor();
  const [middle, other] = ["middle", "other"].map((name) => relight.getByRole("checkbox", { name }));
  // A colour that is white to the eye: the parts are summed instead of the whole that was stored.
  await relight.getByLabel("Colour of middle").fill("#fffffe");
  const summed = await picture(await untilLit(page));
  const apart = difference(summed, whole);
  assert.ok(apart.mean < kSame && apart.largest < 0.02, `the sum of the groups: ${JSON.stringify(apart)}`);
  await other.uncheck();
  const onlyMiddle = brightness(await picture(await untilLit(page)));
  await other.check();
  await middle.uncheck();
  const onlyOther = brightness(await picture(await untilLit(page)));
  assert.ok(onlyMiddle < 0.97 * brightness(whole) && onlyOther < brightness(whole), `${onlyMiddle} ${onlyOther} ${brightness(whole)}`);
  await relight.getByRole("button", { name: "Render with these" }).click();
  await page.getByText("The view is being rendered").waitFor();
  const [view] = (await waitFor(() => ready(given.grouped), 120, "the view is ready")).views;
  assert.deepEqual((await viewOf(given.grouped, view)).request.light_gains, { middle: [0, 0, 0] });
  await relight.getByRole("button", { name: "As solved" }).click();
  assert.ok(difference(await picture(await untilLit(page)), whole).mean < kSame);
  await watched.close();
});

async function ready(job) {
  const answer = await get(given.service, `/v1/jobs/${job.id}/views`);
  return answer.views.length > 0 && answer.views.every(({ state }) => state === "ready") && answer;
}

const viewOf = (job, view) => get(given.service, `/v1/jobs/${job.id}/views/${view.id}`);

test("a camera placed in the walk is rendered as a view, and its picture shown", async () => {
  const watched = await given.open(`/jobs/${given.fine.id}#frame=4`);
  const { page } = watched;
  const canvas = await untilLit(page);
  const box = await canvas.boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width / 2 + 120, box.y + box.height / 2 + 30, { steps: 5 });
  await page.mouse.up();
  await page.waitForFunction(() => location.hash.includes("cam="));
  await page.getByRole("tab", { name: "Images and video" }).click();
  await page.getByRole("button", { name: "Render view", exact: true }).click();
  const shown = page.locator(".view img");
  await shown.waitFor();
  await page.waitForFunction(() => document.querySelector(".view img")?.naturalWidth === 640);
  const [view] = (await get(given.service, `/v1/jobs/${given.fine.id}/views`)).views;
  const { request, files } = await viewOf(given.fine, view);
  const asked = decodeURIComponent(/cam=([^&]+)/.exec(page.url())[1]).split(",").map(Number);
  const { position, target } = request.camera;
  [...position, ...target].forEach((x, k) => assert.ok(Math.abs(x - asked[k]) < 0.01, `${[...position, ...target]} for ${asked}`));
  assert.ok(files.length > 0);
  await watched.close();
});

test("another job is canceled from the queue, after asking", async () => {
  const folder = writeJob(join(given.service.folder, "long"), { frames: 120, preset: "high" });
  const { id } = await submit(given.service, folder, { name: "to cancel" });
  // A job that has come somewhere is not stopped without asking.
  await waitFor(async () => (await get(given.service, `/v1/jobs/${id}`)).progress.fraction > 0, 60, "the job is at work");
  const watched = await given.open("/");
  const { page } = watched;
  const row = page.locator(`tr[data-id=${id}]`);
  await row.waitFor();
  await row.getByRole("button", { name: "Actions for to cancel" }).click();
  await page.getByRole("menuitem", { name: "Cancel", exact: true }).click();
  const dialog = page.getByRole("dialog");
  await dialog.getByRole("button", { name: /^Cancel 1 job/ }).click();
  await row.getByText("Canceled", { exact: true }).waitFor();
  await untilState(given.service, id, "canceled", 10);
  assert.equal((await get(given.service, `/v1/jobs/${given.fine.id}`)).state, "succeeded");
  await watched.close();
});
