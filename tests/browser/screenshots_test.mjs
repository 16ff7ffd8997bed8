// Pictures of every page, to be looked at: in build/tests/browser, in light, dark and narrow; and those of the README
// in the folder that KEYLUME_SCREENSHOTS names, where it does.
import assert from "node:assert/strict";
import { mkdirSync, statSync } from "node:fs";
import { test } from "node:test";
import { join } from "node:path";
import { sights, someJobs } from "./support/sights.mjs";
import { get, submit } from "./support/jobs.mjs";
import { waitFor } from "./support/service.mjs";
import { suite } from "./support/suite.mjs";

const { KEYLUME_BROWSER_PICTURES: folder, KEYLUME_SCREENSHOTS: readmeFolder } = process.env;
const kVariants = {
  light: { colorScheme: "light" },
  dark: { colorScheme: "dark" },
  narrow: { colorScheme: "light", viewport: { width: 390, height: 844 } },
};
/** Heights in pixels. */
const kReadme = { walk: 1130, queue: 560, new_job: 900 };
const kBytesMin = 5_000; // of a page that is not empty

const given = suite(async (service) => {
  for (const each of [folder, readmeFolder].filter(Boolean)) mkdirSync(each, { recursive: true });
  return { jobs: await someJobs(service, readmeFolder ? { preset: "standard" } : {}) };
});

for (const [variant, options] of Object.entries(kVariants)) {
  test(`every page fits its window and is pictured: ${variant}`, async (t) => {
    for (const { name, path, prepare, expected } of sights(given.jobs)) {
      await t.test(name, async () => {
        const watched = await given.open(path, { ...options, expected });
        const { page } = watched;
        await prepare(page);
        const wide = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
        assert.ok(wide[0] <= wide[1], `${wide[0]} pixels wide, the window has ${wide[1]}`);
        const file = join(folder, `${name}-${variant}.png`);
        await page.screenshot({ path: file, fullPage: name !== "keys" });
        assert.ok(statSync(file).size > kBytesMin);
        await watched.close();
      });
    }
  });
}

test("the README's pictures", { skip: readmeFolder ? false : "KEYLUME_SCREENSHOTS names no folder" }, async () => {
  await fetch(`${given.service.url}/v1/queue/resume`, { method: "POST" });
  const [{ id }] = [await submit(given.service, given.jobs.garage, { name: "garage, take 2" }), await submit(given.service, given.jobs.garage, { name: "garage, take 3" })];
  await waitFor(async () => (await get(given.service, `/v1/jobs/${id}`)).progress.fraction > 0.3, 120, "a job at work");
  for (const { name, path, prepare } of sights(given.jobs)) {
    if (!kReadme[name]) continue;
    const watched = await given.open(path, { colorScheme: "light", viewport: { width: 1280, height: kReadme[name] } });
    await prepare(watched.page);
    await watched.page.evaluate(() => {
      document.activeElement?.blur();
      scrollTo(0, 0);
    });
    await watched.page.screenshot({ path: join(readmeFolder, `dashboard_${name}.png`) });
    await watched.close();
  }
});
