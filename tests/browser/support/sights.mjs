// Every page of the dashboard, with something on it: for what holds of all of them.
import { join } from "node:path";
import { drop, untilLit } from "./browser.mjs";
import { filesOf, finished, submit, writeJob } from "./jobs.mjs";

const kFrames = 12;

/** A service's jobs in several states; the garage in frames of the example, with `lighting`. */
export async function someJobs(service, lighting = {}) {
  const folder = (name, cut) => writeJob(join(service.folder, name), { frames: kFrames, width: 320, height: 180, ...cut });
  const garage = folder("garage", { frames: 120, ...lighting });
  const done = await finished(service, garage, { name: "garage", labels: { project: "garage" } });
  const grouped = await finished(service, folder("grouped", { light_groups: { middle: ["lamp_0_0"] } }), { name: "lights apart" });
  await fetch(`${service.url}/v1/queue/pause`, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify({ reason: "for a picture" }) });
  await submit(service, folder("waiting", {}), { name: "small garage", priority: 70 });
  return { garage, done, grouped };
}

/** [{ name, path, prepare(page), expected? }]; `jobs`: of someJobs(). */
export function sights({ garage, done, grouped }) {
  const shown = (selector) => async (page) => {
    await page.locator(selector).first().waitFor();
    await page.waitForTimeout(500);
  };
  const walk = (page) => untilLit(page);
  return [
    { name: "queue", path: "/", prepare: shown("tr[data-id]") },
    { name: "queue_empty", path: "/?q=nothing", prepare: shown(".queue-message .notice") },
    { name: "new_job", path: "/new", prepare: async (page) => {
      await drop(page, ".drop-zone", filesOf(garage));
      await page.locator(".forecast-facts").waitFor();
      await page.locator(".preview-canvas").waitFor();
      await page.getByLabel("Frame", { exact: true }).fill("60");
      await page.waitForTimeout(500);
    } },
    { name: "new_job_empty", path: "/new", prepare: shown(".preview-empty") },
    { name: "walk", path: `/jobs/${done.id}#frame=60`, prepare: walk },
    { name: "probe", path: `/jobs/${done.id}#frame=60`, prepare: async (page) => {
      const canvas = await walk(page);
      await canvas.press("Enter");
      await page.locator(".probe-plot .u-wrap").waitFor();
      await page.waitForTimeout(300);
    } },
    { name: "false_colour", path: `/jobs/${done.id}#frame=60`, prepare: async (page) => {
      await walk(page);
      await page.getByRole("combobox", { name: /^Show/ }).selectOption("false-colour");
      await page.getByLabel("Patch borders").check();
      await walk(page);
    } },
    { name: "relight", path: `/jobs/${grouped.id}#frame=6`, prepare: async (page) => {
      await walk(page);
      await page.getByRole("region", { name: "Relight" }).waitFor();
    } },
    { name: "images", path: `/jobs/${done.id}#tab=images&frame=60`, prepare: shown(".frame-picture") },
    { name: "delete", path: `/jobs/${done.id}#tab=report`, prepare: async (page) => {
      await page.locator(".report .log").waitFor();
      await page.getByRole("button", { name: "Actions for this job" }).click();
      const [inMenu, besideIt] = [page.getByRole("menuitem", { name: "Delete…", exact: true }), page.getByRole("button", { name: "Delete…", exact: true })];
      await (await inMenu.count() > 0 ? inMenu : besideIt).click();
      await page.getByRole("dialog").waitFor();
    } },
    { name: "report", path: `/jobs/${done.id}#tab=report`, prepare: shown(".report .log") },
    { name: "compare", path: `/compare?a=${done.id}&b=${done.id}#frame=60`, prepare: (page) => untilLit(page, page.locator(".walk-frame")) },
    { name: "system", path: "/system", prepare: shown(".cards .good") },
    { name: "login", path: "/login", prepare: shown("#token") },
    { name: "no_such_job", path: "/jobs/job_00000000000000000000000000", prepare: shown(".job .notice"), expected: /status of 404/ },
    { name: "keys", path: "/", prepare: async (page) => {
      await page.locator("tr[data-id]").first().waitFor();
      await page.keyboard.press("?");
      await page.getByRole("dialog").waitFor();
    } },
  ];
}
