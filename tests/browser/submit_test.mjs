// From files on a desk to a value on a patch, as a new user goes.
import assert from "node:assert/strict";
import { test } from "node:test";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { drop, untilLit } from "./support/browser.mjs";
import { filesOf, get, untilState, writeJob } from "./support/jobs.mjs";
import { suite } from "./support/suite.mjs";

/** Where in the picture of frame 60 the shadow lies, and where the floor is lit. */
const kShadow = [0.5, 0.62];
const kLit = [0.12, 0.85];
/** The browser says so of every answer that is no success; here one is asked for. */
const kRefused = /status of 422 .*\/v1\/validate/;
const kToleranceOfValues = 1e-3;

let watched, page, id;
const given = suite(async () => {
  watched = await given.open("/new", { expected: kRefused });
  page = watched.page;
});

/** At a share of the canvas's width and height. */
async function pointAt(canvas, [x, y]) {
  const box = await canvas.boundingBox();
  return { x: Math.round(x * box.width), y: Math.round(y * box.height) };
}

/** "patch 345 1.234  1.234  1.234 W/m²", of an object that moves with its name before. */
async function valueUnderPointer(before) {
  await page.waitForFunction((old) => {
    const text = document.querySelector(".walk-value")?.textContent ?? "";
    return /W\/m²/.test(text) && !text.includes(`patch ${old} `);
  }, before);
  const text = await page.locator(".walk-value").textContent();
  const found = /^(?:(.+) · )?patch (\d+) (.+) W\/m²$/.exec(text);
  assert.ok(found, text);
  return { patch: Number(found[2]), rgb: found[3].trim().split(/\s+/).map(Number) };
}

function assertNear(value, wanted, what) {
  assert.ok(wanted > 0 && Math.abs(value - wanted) <= kToleranceOfValues * wanted, `${what}: ${value}, the service says ${wanted}`);
}

test("files that are dropped on the form are shown, checked and forecast", async () => {
  const folder = writeJob(join(given.service.folder, "garage"), { frames: 120, width: 960, height: 540 });
  await drop(page, ".drop-zone", filesOf(folder));
  for (const name of ["scene.obj", "garage.mtl", "animation.json"])
    await page.locator(".file-list").getByText(name, { exact: true }).waitFor();
  await page.locator(".preview-canvas").waitFor();
  await page.getByText("120 frames at 24 per second").waitFor();
  const forecast = page.locator(".forecast-facts");
  await forecast.waitFor();
  assert.match(await forecast.textContent(), /9,442 patches, 120 frames, 45 polygons/);
  await page.getByLabel("Preset").selectOption("draft");
});

test("a setting that cannot be is told at its field, and then taken back", async () => {
  const tolerance = page.getByLabel("Tolerance");
  await tolerance.fill("7");
  await page.locator('#' + await tolerance.getAttribute("id") + '[aria-invalid="true"]').waitFor();
  const described = (await tolerance.getAttribute("aria-describedby")).split(" ").at(-1);
  assert.notEqual(await page.locator(`#${described}`).textContent(), "");
  await tolerance.fill("");
  await page.locator('#' + await tolerance.getAttribute("id") + '[aria-invalid="false"]').waitFor();
  await page.locator(".forecast-facts").waitFor();
});

test("the job that is submitted is watched until it is done", async () => {
  await page.getByLabel("Name").fill("dropped garage");
  await page.getByRole("button", { name: "Submit job" }).click();
  await page.waitForURL(/\/jobs\/job_/);
  id = /job_\w+/.exec(page.url())[0];
  await page.getByRole("heading", { name: "dropped garage" }).waitFor();
  const bar = page.getByRole("progressbar");
  const seen = [];
  while ((await page.locator(".job-head .state").textContent()) !== "Succeeded") {
    seen.push(Number(await bar.getAttribute("aria-valuenow")));
    assert.ok(seen.length < 2400, "the page says that the job is done");
    await page.waitForTimeout(50);
  }
  const between = new Set(seen.filter((value) => value > 0 && value < 100));
  assert.ok(between.size >= 3, `progress was seen on the way: ${[...between]}`);
  assert.deepEqual(seen, seen.slice().sort((a, b) => a - b), "progress goes on");
  await untilState(given.service, id, "succeeded", 1);
});

test("the light is there, and scrubbing shows another frame", async () => {
  const canvas = await untilLit(page);
  const first = await canvas.screenshot();
  const slider = page.getByRole("slider", { name: "Frame" });
  await slider.fill("60");
  assert.match(await page.locator(".timeline-moment").textContent(), /^Frame 60 of 119/);
  await untilLit(page);
  assert.notDeepEqual(await canvas.screenshot(), first);
  await page.waitForFunction(() => location.hash.includes("frame=60"));
});

test("a patch that is clicked has the value that the service gives", async () => {
  const canvas = page.locator(".walk-canvas");
  const values = [];
  for (const place of [kShadow, kLit]) {
    await canvas.click({ position: await pointAt(canvas, place) });
    const { patch, rgb } = await valueUnderPointer(values[0]?.patch);
    const series = await get(given.service, `/v1/jobs/${id}/patches/${patch}/series.json`);
    rgb.forEach((value, k) => assertNear(value, series.radiosity[60][k], `patch ${patch}, channel ${k}`));
    values.push({ patch, rgb });
  }
  assert.ok(values[0].rgb[0] < 0.97 * values[1].rgb[0], `it is darker below the plane: ${JSON.stringify(values)}`);
  const [shadow, lit] = values.map(({ patch }) => patch);
  const chips = page.locator(".probe-chip");
  assert.equal(await chips.count(), 2);
  await page.waitForFunction(() => [...document.querySelectorAll(".probe-value")].every((value) => value.textContent !== ""));
  const [r, g, b] = (await get(given.service, `/v1/jobs/${id}/patches/${shadow}/series.json`)).radiosity[60];
  const luminance = 0.2126 * r + 0.7152 * g + 0.0722 * b;
  assertNear(parseFloat(await page.locator(".probe-value").first().textContent()), luminance, "beside the plot");
  await page.waitForFunction((patches) => decodeURIComponent(location.hash).includes(`patch=${patches}`), `${shadow},${lit}`);
});

test("pinned patches are plotted over all frames and saved as CSV", async () => {
  const plot = page.getByRole("img", { name: /over 120 frames/ });
  await plot.waitFor();
  assert.match(await plot.getAttribute("aria-label"), /^Patch \d+: luminance from [\d.]+ to [\d.]+ W\/m² over 120 frames; Patch \d+/);
  const painted = await plot.locator("canvas").evaluate((canvas) =>
    new Set(new Uint32Array(canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data.buffer)).size);
  assert.ok(painted > 10, `${painted} colours in the plot`);
  const coming = page.waitForEvent("download");
  await page.getByRole("button", { name: "Save as CSV" }).click();
  const lines = readFileSync(await (await coming).path(), "utf8").trim().split("\n");
  assert.match(lines[0], /^patch,frame,r,g,b/);
  assert.equal(lines.length, 1 + 2 * 120);
});

test("a link leads to the same moment and patches", async () => {
  const other = await given.open(new URL(page.url()).pathname + new URL(page.url()).hash);
  await other.page.locator(".probe-chip").nth(1).waitFor();
  assert.match(await other.page.locator(".timeline-moment").textContent(), /^Frame 60 /);
  await other.close();
});

test("all this without a complaint or a request to others", () => watched.close());
