// The service goes and comes back, and asks who one is.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { join } from "node:path";
import { Watched, launch, untilLit } from "./support/browser.mjs";
import { finished, get, submit, untilState, writeJob } from "./support/jobs.mjs";
import { Service, waitFor } from "./support/service.mjs";

/** What the browser itself writes while there is no service. */
const kAway = /ERR_CONNECTION_REFUSED|ERR_INCOMPLETE_CHUNKED_ENCODING|ERR_CONNECTION_RESET|ERR_EMPTY_RESPONSE|status of 503/;
const kDenied = /status of 401/;

let browser;
const services = [];

before(async () => (browser = await launch()));
after(async () => {
  await browser?.close();
  for (const service of services) await service.end();
});

async function newService() {
  const service = new Service();
  services.push(service);
  return service;
}

const connection = (page) => page.locator(".connection").getAttribute("data-how");
const untilConnected = (page, how) => page.locator(`.connection[data-how="${how}"]`).waitFor();

test("a page that watches a job outlives a restart of the service, and sees the job's end", async () => {
  const service = await (await newService()).start();
  const folder = writeJob(join(service.folder, "job"), { frames: 60, width: 320, height: 180, preset: "standard" });
  const { id } = await submit(service, folder, { name: "watched" });
  const watched = await Watched.open(browser, service, `/jobs/${id}`, { expected: kAway });
  const { page } = watched;
  await untilConnected(page, "live");
  await waitFor(async () => Number(await page.getByRole("progressbar").getAttribute("aria-valuenow")) > 0, 60, "progress is seen");
  assert.notEqual(await page.locator(".job-head .state").textContent(), "Succeeded", "it is still at work");
  await service.stop();
  await untilConnected(page, "offline");
  await page.getByText("The service does not answer since").waitFor();
  assert.equal(await page.getByRole("heading", { level: 1 }).textContent(), "watched", "what was there stays");
  await service.restart();
  await untilConnected(page, "live");
  assert.equal(await page.getByText("The service does not answer since").isVisible(), false);
  await untilState(service, id, "succeeded");
  await page.locator(".job-head .state", { hasText: "Succeeded" }).waitFor();
  await untilLit(page);
  await watched.close();
});

test("the queue shows after a restart what was submitted meanwhile", async () => {
  const service = await (await newService()).start();
  const watched = await Watched.open(browser, service, "/", { expected: kAway });
  const { page } = watched;
  await page.getByRole("heading", { name: "No jobs yet" }).waitFor();
  await untilConnected(page, "live");
  await service.stop();
  await service.restart();
  const { id } = await submit(service, writeJob(join(service.folder, "job"), { frames: 2 }), { name: "meanwhile" });
  await page.getByRole("link", { name: "meanwhile" }).waitFor();
  await untilState(service, id, "succeeded");
  await page.locator(`tr[data-id=${id}]`).getByText("Succeeded").waitFor();
  assert.equal(await connection(page), "live");
  await watched.close();
});

test("with a token one logs in, comes to where one wanted to go, and out again", async () => {
  const service = await newService();
  const token = service.createToken("ada");
  await service.start();
  const watched = await Watched.open(browser, service, "/system?x=1", { expected: kDenied });
  const { page } = watched;
  const field = page.getByLabel("Token");
  await field.fill("kl_" + "0".repeat(40));
  await page.getByRole("button", { name: "Log in" }).click();
  await page.getByText("This token is not known here").waitFor();
  await field.fill(token);
  await field.press("Enter");
  await page.waitForURL(/\/system\?x=1$/);
  await page.getByText("Ready: jobs are taken and rendered.").waitFor();
  await untilConnected(page, "live");
  const cookies = await watched.context.cookies();
  assert.ok(cookies.length === 1 && cookies[0].httpOnly && cookies[0].sameSite === "Strict", JSON.stringify(cookies));
  const kept = await page.evaluate(() => JSON.stringify({ ...localStorage, ...sessionStorage }));
  assert.ok(!kept.includes("kl_"), "scripts keep no token");
  await page.reload();
  await page.getByText("Ready: jobs are taken and rendered.").waitFor();
  await page.getByRole("button", { name: "Log out" }).click();
  await field.waitFor();
  await watched.goTo("/");
  await field.waitFor();
  await watched.close();
});
