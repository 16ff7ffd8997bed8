// What is done to jobs from the queue, and how a job is found among many. The queue is paused: a job stays as it is.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { test } from "node:test";
import { join } from "node:path";
import { copied } from "./support/browser.mjs";
import { get, post, submit, untilState, writeJob } from "./support/jobs.mjs";
import { suite } from "./support/suite.mjs";

/** More than the page fetches at first: the oldest is on its second page. */
const kJobs = 56;

const given = suite(async (service) => {
  await post(service, "/v1/queue/pause");
  const folder = writeJob(join(service.folder, "job"), { frames: 2 });
  const oldest = await submit(service, folder, { name: "needle in the hay", labels: { project: "attic" } });
  for (let k = 1; k < kJobs - 1; ++k) await submit(service, folder, { name: `hay ${k}` });
  return { folder, oldest, newest: await submit(service, folder, { name: "newest", labels: { project: "garage", take: "3" } }) };
});

const rowOf = (page, { id }) => page.locator(`tr[data-id=${id}]`);
const inState = (page, job, state) => rowOf(page, job).locator(".state", { hasText: state }).waitFor();

async function choose(page, job, action) {
  await rowOf(page, job).getByRole("button", { name: "Actions for" }).click();
  await page.getByRole("menuitem", { name: action, exact: true }).click();
}

test("a job is paused, resumed, canceled and queued again from its row", async () => {
  const watched = await given.open("/");
  const { page } = watched;
  const steps = [["Pause", "Paused", "paused"], ["Resume", "Queued", "queued"], ["Cancel", "Canceled", "canceled"], ["Retry", "Queued", "queued"]];
  for (const [action, shown, state] of steps) {
    await choose(page, given.newest, action);
    await inState(page, given.newest, shown);
    await untilState(given.service, given.newest.id, state, 10);
  }
  await watched.close();
});

test("several jobs that are chosen get another priority", async () => {
  const watched = await given.open("/");
  const { page } = watched;
  const rows = page.locator("tr[data-id]");
  await rows.first().waitFor();
  await rows.nth(0).getByRole("checkbox").check();
  await rows.nth(2).getByRole("checkbox").click({ modifiers: ["Shift"] });
  await page.getByText("3 chosen").waitFor();
  await page.getByRole("button", { name: "Priority…" }).click();
  await page.getByLabel("0 to 100").fill("81");
  await page.getByRole("button", { name: "Set", exact: true }).click();
  await rows.nth(2).locator(".cell-priority", { hasText: "81" }).waitFor();
  const { jobs } = await get(given.service, "/v1/jobs?limit=4");
  assert.deepEqual(jobs.map(({ priority }) => priority), [81, 81, 81, 50]);
  await watched.close();
});

test("what would be deleted is told before, and the counts of the states after", async () => {
  const watched = await given.open("/");
  const { page } = watched;
  const job = await submit(given.service, given.folder, { name: "to delete" });
  await post(given.service, `/v1/jobs/${job.id}/cancel`);
  await inState(page, job, "Canceled");
  const option = page.locator("option[value=canceled]");
  await page.waitForFunction(() => document.querySelector("option[value=canceled]").textContent === "Canceled (1)");
  const { files } = await (await fetch(`${given.service.url}/v1/jobs/${job.id}?dry_run=true`, { method: "DELETE" })).json();
  await choose(page, job, "Delete…");
  const dialog = page.getByRole("dialog", { name: "Delete 1 job?" });
  await dialog.getByText(new RegExp(`^${files} files? \\(.*B\\) will be removed for good`)).waitFor();
  await dialog.getByText("to delete").waitFor();
  await dialog.getByRole("button", { name: "Delete 1 job" }).click();
  await rowOf(page, job).waitFor({ state: "detached" });
  await page.waitForFunction(() => document.querySelector("option[value=canceled]").textContent === "Canceled (0)", undefined, { timeout: 2000 });
  assert.equal(await option.textContent(), "Canceled (0)");
  assert.equal((await fetch(`${given.service.url}/v1/jobs/${job.id}`)).status, 404);
  await watched.close();
});

test("a job on a later page is found by a word of its name, and it is said how many were looked at", async () => {
  const watched = await given.open("/");
  const { page } = watched;
  await page.locator("tr[data-id]").nth(49).waitFor();
  assert.equal(await rowOf(page, given.oldest).count(), 0);
  await page.getByLabel(/^Search in names/).fill("NEEDLE hay");
  await rowOf(page, given.oldest).waitFor();
  await page.getByText(`1 found among all ${kJobs} jobs`).waitFor();
  assert.equal(await page.locator("tr[data-id]").count(), 1);
  assert.match(page.url(), /q=NEEDLE\+hay/);
  await watched.close();
});

test("labels are written in one way: in the row, in the filter, in the search and in the form", async () => {
  const asked = [];
  const watched = await given.open("/");
  const { page } = watched;
  page.on("request", (request) => asked.push(decodeURIComponent(request.url())));
  await rowOf(page, given.newest).getByRole("button", { name: "project=garage" }).click();
  const field = page.getByLabel("Labels", { exact: true });
  assert.equal(await field.inputValue(), "project=garage");
  await page.getByText("1 job", { exact: true }).waitFor();
  await field.fill("project=garage, take=4");
  await page.getByText("No job fits.").waitFor();
  assert.ok(asked.some((url) => url.includes("label=project:garage") && url.includes("label=take:4")), asked.join("\n"));
  await field.fill("not a name");
  await page.locator('input[aria-label="Labels"][aria-invalid="true"]').waitFor();
  await field.fill("");
  await page.getByLabel(/^Search in names/).fill("project=attic");
  await rowOf(page, given.oldest).waitFor();
  assert.ok(asked.at(-1).includes("label=project:attic"), "the service looks for labels");
  await watched.goTo("/new");
  assert.match(await page.getByLabel("Labels").getAttribute("placeholder"), /^project=garage/);
  await watched.close();
});

test("the command that is copied does, in a shell, what its entry does", async (t) => {
  if (spawnSync("curl", ["--version"]).status !== 0) return t.skip("there is no curl");
  const watched = await given.open("/", { permissions: ["clipboard-read", "clipboard-write"] });
  const { page } = watched;
  for (const [action, state] of [["Pause", "paused"], ["Resume", "queued"], ["Cancel", "canceled"], ["Delete…", null]]) {
    await rowOf(page, given.newest).getByRole("button", { name: "Actions for" }).click();
    await page.getByRole("menuitem", { name: `Copy as curl: ${action}`, exact: true }).click();
    const line = await copied(page);
    assert.match(line, /^curl /);
    const run = spawnSync("sh", ["-c", line], { encoding: "utf8" });
    assert.equal(run.status, 0, `${line}\n${run.stderr}`);
    if (state) {
      await untilState(given.service, given.newest.id, state, 10);
      await rowOf(page, given.newest).locator(`.state-${state}`).waitFor();
    }
  }
  await rowOf(page, given.newest).waitFor({ state: "detached" });
  assert.equal((await fetch(`${given.service.url}/v1/jobs/${given.newest.id}`)).status, 404);
  await watched.close();
});
