// Other ways in: an archive, and the command that does what the form would.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { test } from "node:test";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { copied, drop } from "./support/browser.mjs";
import { filesOf, get, post, writeJob } from "./support/jobs.mjs";
import { suite } from "./support/suite.mjs";

const kZip = "import sys, zipfile; from pathlib import Path; out = zipfile.ZipFile(sys.argv[1], 'w', zipfile.ZIP_DEFLATED);" +
  "[out.write(path, 'folder/' + path.name) for path in sorted(Path(sys.argv[2]).iterdir())]; out.close()";

const given = suite(async (service) => {
  await post(service, "/v1/queue/pause");
  return { folder: writeJob(join(service.folder, "job"), { frames: 5, width: 64, height: 36 }) };
});

test("a zip that is dropped is shown, forecast and submitted", async () => {
  const zip = join(given.service.folder, "garage.zip");
  const run = spawnSync("python3", ["-c", kZip, zip, given.folder], { encoding: "utf8" });
  assert.equal(run.status, 0, run.stderr);
  const watched = await given.open("/new");
  const { page } = watched;
  await drop(page, ".drop-zone", [{ name: "garage.zip", bytes: readFileSync(zip) }]);
  await page.locator(".file-list").getByText("garage.zip").waitFor();
  await page.getByText("5 frames at 24 per second").waitFor();
  await page.locator(".forecast-facts", { hasText: "5 frames" }).waitFor();
  await page.getByLabel("Name", { exact: true }).fill("zipped");
  await page.getByRole("button", { name: "Submit job" }).click();
  await page.waitForURL(/\/jobs\/job_/);
  const job = await get(given.service, `/v1/jobs/${/job_\w+/.exec(page.url())[0]}`);
  assert.deepEqual([job.name, job.frame_count, job.state], ["zipped", 5, "queued"]);
  await watched.close();
});

test("the command of the form submits what the form would, with its settings", async (t) => {
  if (spawnSync("curl", ["--version"]).status !== 0) return t.skip("there is no curl");
  const watched = await given.open("/new", { permissions: ["clipboard-read", "clipboard-write"] });
  const { page } = watched;
  await drop(page, ".drop-zone", filesOf(given.folder));
  const forecast = page.locator(".forecast-facts");
  await forecast.waitFor();
  const before = await forecast.textContent();
  await page.getByLabel("Patch edge", { exact: true }).fill("2");
  await page.getByLabel("Name", { exact: true }).fill("it's; by curl, \"so\"");
  await page.getByLabel("Labels", { exact: true }).fill("project=garage, take=3");
  await page.waitForFunction((old) => ![null, undefined, old].includes(document.querySelector(".forecast-facts")?.textContent), before);
  const patches = Number(/([\d,]+) patches/.exec(await forecast.textContent())[1].replaceAll(",", ""));
  await page.getByRole("button", { name: "Copy as curl: submit this job" }).click();
  const line = await copied(page);
  const run = spawnSync("sh", ["-c", line], { cwd: given.folder, encoding: "utf8" });
  assert.equal(run.status, 0, `${line}\n${run.stderr}`);
  const job = JSON.parse(run.stdout);
  assert.deepEqual([job.name, job.labels, job.forecast?.patches], ["it's; by curl, \"so\"", { project: "garage", take: "3" }, patches]);
  await watched.close();
});

test("a file of options that is dropped fills the form", async () => {
  const options = join(given.service.folder, "options.json");
  writeFileSync(options, JSON.stringify({ name: "from a file", priority: 7, labels: { a: "b" } }));
  const watched = await given.open("/new");
  const { page } = watched;
  await drop(page, ".drop-zone", [...filesOf(given.folder), { name: "options.json", bytes: readFileSync(options) }]);
  await page.locator(".forecast-facts").waitFor();
  for (const [label, value] of [["Name", "from a file"], ["Priority", "7"], ["Labels", "a=b"]])
    assert.equal(await page.getByLabel(label, { exact: true }).inputValue(), value);
  await watched.close();
});
