// axe-core finds nothing serious on any page, in light and in dark.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { axeScript } from "./support/browser.mjs";
import { sights, someJobs } from "./support/sights.mjs";
import { suite } from "./support/suite.mjs";

const kSerious = ["serious", "critical"];

const given = suite(async (service) => ({ jobs: await someJobs(service) }));

/** [ "rule: what (where)" ] */
async function violations(page) {
  await page.evaluate(readFileSync(axeScript, "utf8"));
  const results = await page.evaluate(() => globalThis.axe.run(document, { resultTypes: ["violations"] }));
  assert.ok(results.passes.length > 10, "rules were applied");
  return results.violations.filter(({ impact }) => kSerious.includes(impact))
    .flatMap(({ id, help, nodes }) => nodes.map(({ target, failureSummary }) => `${id}: ${help} (${target}) ${failureSummary}`));
}

for (const colorScheme of ["light", "dark"]) {
  test(`every page is accessible in ${colorScheme}`, async (t) => {
    for (const { name, path, prepare, expected } of sights(given.jobs)) {
      await t.test(name, async () => {
        const watched = await given.open(path, { colorScheme, expected });
        await prepare(watched.page);
        assert.deepEqual(await violations(watched.page), []);
        await watched.close();
      });
    }
  });
}

test("what is wrong is found: a picture without words, text that cannot be read", async () => {
  const watched = await given.open("/system");
  await watched.page.locator(".cards .good").waitFor();
  await watched.page.evaluate(() => {
    const [picture, text] = [document.createElement("img"), document.createElement("p")];
    text.textContent = "hardly there";
    text.style.color = "#d0d0d0";
    document.querySelector("main").append(picture, text);
  });
  const found = await violations(watched.page);
  assert.ok(["image-alt", "color-contrast"].every((rule) => found.some((one) => one.startsWith(rule))), found.join("\n"));
  await watched.close();
});
