// A job that is done: its video, comparing it, beginning again with its settings, its reference run, deleting it.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { test } from "node:test";
import { join } from "node:path";
import { untilLit } from "./support/browser.mjs";
import { finished, get, untilState, writeJob } from "./support/jobs.mjs";
import { suite } from "./support/suite.mjs";

const kFrames = 24;
const kFps = 30;
const kNarrow = { width: 390, height: 844 };

const given = suite(async (service) => {
  const folder = writeJob(join(service.folder, "job"), { frames: kFrames, width: 160, height: 90, tolerance: 0.2 }, { frames: { count: kFrames, fps: kFps } });
  return {
    first: await finished(service, folder, { name: "first", labels: { project: "again" }, priority: 61 }),
    second: await finished(service, folder, { name: "second" }),
  };
});

const hashesOf = async ({ id }) => Object.fromEntries((await get(given.service, `/v1/jobs/${id}/manifest.json`)).artefacts.map(({ path, sha256 }) => [path, sha256]));
const newJobOf = (page) => page.waitForURL(/\/jobs\/job_/).then(() => /job_\w+/.exec(page.url())[0]);

/** Mean difference, of full scale, of what the video shows and what the picture of the job's own shows. */
function videoBesidePicture(page) {
  return page.evaluate(async () => {
    const [picture, video] = [document.querySelector("img.frame-picture"), document.querySelector("video")];
    await picture.decode();
    const pixelsOf = (source) => {
      const context = Object.assign(document.createElement("canvas"), { width: 160, height: 90 }).getContext("2d");
      context.drawImage(source, 0, 0, 160, 90);
      return context.getImageData(0, 0, 160, 90).data;
    };
    const [a, b] = [pixelsOf(picture), pixelsOf(video)];
    return a.reduce((sum, value, k) => sum + Math.abs(value - b[k]), 0) / a.length / 255;
  });
}

test("a video is made, stands at the slider's frame, and leads it while it plays", async (t) => {
  if (spawnSync("ffmpeg", ["-version"]).status !== 0) return t.skip("there is no ffmpeg");
  const watched = await given.open(`/jobs/${given.first.id}#tab=images`);
  const { page } = watched;
  await page.getByRole("button", { name: "Make mp4" }).click();
  const video = page.locator("video");
  await video.waitFor();
  await page.waitForFunction(() => document.querySelector("video").readyState >= 2);
  const slider = page.getByRole("slider", { name: "Frame of the pictures" });
  const standsAt = (frame) => page.waitForFunction(([wanted, fps]) => {
    const { currentTime, seeking } = document.querySelector("video");
    return !seeking && Math.floor(currentTime * fps) === wanted;
  }, [frame, kFps]);
  const differences = [];
  for (const frame of [3, 20, 12]) {
    await slider.fill(String(frame));
    await standsAt(frame);
    await page.getByText(`Frame ${frame}`, { exact: true }).waitFor();
    differences.push(await videoBesidePicture(page));
  }
  // The picture of another frame beside it: a difference that is seen.
  await page.evaluate(() => (document.querySelector("img.frame-picture").src = document.querySelector("img.frame-picture").src.replace("/frames/12/", "/frames/0/")));
  const apart = await videoBesidePicture(page);
  console.log(`ratio: video beside picture: ${differences.map((x) => x.toFixed(4)).join(", ")}; of another frame ${apart.toFixed(4)}`);
  assert.ok(Math.max(...differences) < apart / 2, `${differences} beside ${apart}`);
  const before = Number(await slider.inputValue());
  await video.evaluate((element) => element.play());
  await page.waitForFunction((old) => Number(document.querySelector("input[aria-label='Frame of the pictures']").value) !== old, before);
  await video.evaluate((element) => element.pause());
  await page.waitForTimeout(200);
  const [shown, frame] = [Number(await slider.inputValue()), await video.evaluate((element, fps) => Math.floor(element.currentTime * fps), kFps)];
  assert.ok(Math.abs(shown - frame) <= 1, `the slider says ${shown}, the video is at ${frame}`);
  await watched.close();
});

test("two jobs that are ticked are compared", async () => {
  const watched = await given.open("/");
  const { page } = watched;
  const tick = ({ id }) => page.locator(`tr[data-id=${id}]`).getByRole("checkbox").click();
  const compare = page.getByRole("button", { name: "Compare", exact: true });
  await tick(given.second);
  await page.getByText("1 chosen").waitFor();
  assert.equal(await compare.count(), 0);
  await tick(given.first);
  await compare.click();
  await page.waitForURL(new RegExp(`/compare\\?a=${given.second.id}&b=${given.first.id}`));
  await untilLit(page, page.locator(".walk-frame"));
  const keys = (await get(given.service, `/v1/jobs/${given.first.id}/key-frames`)).frames.filter(({ kind }) => kind === "key").length;
  await page.getByRole("img", { name: new RegExp(`^A: ${keys} key-frames.*; B: ${keys} key-frames`) }).waitFor();
  assert.equal(await page.locator(".track .key.hollow").count(), keys, "those of B have a shape of their own");
  await page.getByText("key-frame of B", { exact: true }).waitFor();
  await watched.close();
});

test("the same files and settings again give the same bytes", async () => {
  const watched = await given.open(`/jobs/${given.first.id}`);
  const { page } = watched;
  await page.getByRole("button", { name: "Again with these settings" }).click();
  await page.waitForURL(new RegExp(`/new\\?from=${given.first.id}`));
  await page.locator(".forecast-facts").waitFor();
  for (const [label, value] of [["Tolerance", "0.2"], ["Preset", "draft"], ["Name", "first"], ["Labels", "project=again"], ["Priority", "61"]])
    assert.equal(await page.getByLabel(label, { exact: true }).inputValue(), value, label);
  await page.getByLabel("Name", { exact: true }).fill("first again");
  await page.getByRole("button", { name: "Submit job" }).click();
  const job = await untilState(given.service, await newJobOf(page), "succeeded");
  assert.deepEqual([job.name, job.labels, job.priority], ["first again", { project: "again" }, 61]);
  const [wanted, hashes] = [await hashesOf(given.first), await hashesOf(job)];
  assert.equal(hashes["radiosity.npy"], wanted["radiosity.npy"]);
  await watched.close();
});

test("a job is compared with a reference run of itself, which is submitted for it and waited for", async () => {
  const watched = await given.open(`/jobs/${given.first.id}`);
  const { page } = watched;
  await page.getByRole("button", { name: "Compare with…" }).click();
  await page.getByRole("button", { name: "A with a reference run" }).click();
  await page.waitForURL(new RegExp(`a=${given.first.id}&b=job_`));
  const address = page.url();
  await untilLit(page, page.locator(".walk-frame"));
  const reference = await get(given.service, `/v1/jobs/${/b=(job_\w+)/.exec(address)[1]}`);
  assert.deepEqual([reference.name, reference.labels], ["first reference", { project: "again", reference_of: given.first.id }]);
  const { frames } = await get(given.service, `/v1/jobs/${reference.id}/key-frames`);
  assert.ok(frames.every(({ kind }) => kind === "key"), "every frame of it was solved");
  await page.getByRole("button", { name: "Plot the difference of every frame" }).click();
  const plot = page.getByRole("img", { name: /^RMSE relative to the mean/ });
  await plot.waitFor();
  assert.ok(Number(/[\d.]+(?= %)/.exec(await plot.getAttribute("aria-label"))[0]) > 0);
  // Once more: the run that is there is taken.
  await watched.goTo(`/compare?a=${given.first.id}`);
  await page.getByRole("button", { name: "A with a reference run" }).click();
  await page.waitForURL(address);
  assert.equal((await get(given.service, `/v1/jobs?label=reference_of:${given.first.id}`)).jobs.length, 1);
  await watched.close();
});

test("at 390 pixels the menu has all of it; a job is deleted from its page after asking", async () => {
  const watched = await given.open(`/jobs/${given.second.id}`, { viewport: kNarrow });
  const { page } = watched;
  await page.getByRole("button", { name: "Actions for this job" }).click();
  const menu = page.getByRole("menu");
  for (const name of ["Compare with…", "Again with these settings", "Pin", "Delete…"]) await menu.getByRole("menuitem", { name, exact: true }).waitFor();
  const box = await menu.boundingBox();
  assert.ok(box.x >= 0 && box.x + box.width <= kNarrow.width, `the menu lies in the window: ${JSON.stringify(box)}`);
  const { files } = await (await fetch(`${given.service.url}/v1/jobs/${given.second.id}?dry_run=true`, { method: "DELETE" })).json();
  await menu.getByRole("menuitem", { name: "Delete…", exact: true }).click();
  const dialog = page.getByRole("dialog", { name: "Delete 1 job?" });
  await dialog.getByText(new RegExp(`^${files} files \\(.* [kM]?B\\) will be removed for good`)).waitFor();
  await dialog.getByRole("button", { name: "Delete 1 job" }).click();
  await page.getByRole("heading", { level: 1, name: "Queue" }).waitFor();
  assert.equal((await fetch(`${given.service.url}/v1/jobs/${given.second.id}`)).status, 404);
  await watched.close();
});

test("who looks at a job that somebody deletes is told", async () => {
  const { id } = given.first;
  const watched = await given.open(`/jobs/${id}`);
  await untilLit(watched.page);
  await watched.page.locator('.connection[data-how="live"]').waitFor();
  await fetch(`${given.service.url}/v1/jobs/${id}`, { method: "DELETE" });
  await watched.page.getByText("This job was deleted.").waitFor();
  await watched.close();
});
