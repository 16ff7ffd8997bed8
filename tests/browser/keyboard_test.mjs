// Everything can be done without a pointer.
import assert from "node:assert/strict";
import { test } from "node:test";
import { untilLit } from "./support/browser.mjs";
import { sights, someJobs } from "./support/sights.mjs";
import { suite } from "./support/suite.mjs";

const kTabsMax = 200;

const given = suite(async (service) => ({ jobs: await someJobs(service) }));

/** Presses Tab until `wanted` (a function in the page, of the focused element) says yes. */
async function tabTo(page, wanted, argument) {
  for (let press = 0; press < kTabsMax; ++press) {
    await page.keyboard.press("Tab");
    const focused = await page.evaluateHandle(() => document.activeElement);
    if (await focused.evaluate(wanted, argument)) return;
  }
  assert.fail(`Tab does not come to ${argument ?? wanted}`);
}

const isNamed = (element, name) => (element.getAttribute("aria-label") ?? element.textContent).trim() === name;

/** Marks what can be pressed, typed into or followed; groups with one tab stop count as one. -> number */
function markControls(page) {
  return page.evaluate(() => {
    const kGroups = "[role=tablist], [role=menu], tr";
    const scope = document.querySelector("dialog[open]") ?? document;
    const all = [...scope.querySelectorAll("button, a[href], input, select, textarea, summary, [tabindex='0']")]
      .filter((element) => !element.disabled && element.checkVisibility({ visibilityProperty: true }))
      .filter((element) => element.tabIndex >= 0 || !element.closest(kGroups));
    all.forEach((element, k) => (element.dataset.control = String(k)));
    return all.length;
  });
}

test("Tab comes to every control of every page, and one sees where it is", async (t) => {
  for (const { name, path, prepare, expected } of sights(given.jobs)) {
    await t.test(name, async () => {
      const watched = await given.open(path, { expected });
      const { page } = watched;
      await prepare(page);
      const count = await markControls(page);
      const reached = new Set();
      const unseen = [];
      for (let press = 0; press < count + 5; ++press) {
        await page.keyboard.press("Tab");
        const { control, what, seen } = await page.evaluate(() => {
          const element = document.activeElement;
          const { outlineStyle } = getComputedStyle(element);
          // The input for files is not seen itself: the zone around it shows.
          return { control: element.dataset.control, what: element.outerHTML.slice(0, 90), seen: outlineStyle !== "none" || element.type === "file" || element === document.body };
        });
        if (control !== undefined) reached.add(control);
        if (!seen) unseen.push(what);
      }
      const missed = await page.evaluate((known) => [...document.querySelectorAll("[data-control]")]
        .filter((element) => !known.includes(element.dataset.control)).map((element) => element.outerHTML.slice(0, 120)), [...reached]);
      assert.deepEqual(missed, []);
      assert.deepEqual(unseen, []);
      assert.ok(reached.size > 0);
      await watched.close();
    });
  }
});

test("two keys lead to every page, and ? lists what keys do", async () => {
  const watched = await given.open("/");
  const { page } = watched;
  for (const [keys, title] of [["gn", "New job"], ["gc", "Compare"], ["gs", "System"], ["gq", "Queue"]]) {
    for (const key of keys) await page.keyboard.press(key);
    await page.getByRole("heading", { level: 1, name: title }).waitFor();
  }
  await page.keyboard.press("?");
  const dialog = page.getByRole("dialog", { name: "Keyboard" });
  await dialog.getByText("Search", { exact: true }).waitFor();
  await page.keyboard.press("Escape");
  await dialog.waitFor({ state: "detached" });
  await watched.close();
});

test("a job is made from an example and submitted", async () => {
  const watched = await given.open("/new");
  const { page } = watched;
  await page.getByRole("button", { name: "Cornell box" }).waitFor();
  await tabTo(page, isNamed, "Cornell box");
  await page.keyboard.press("Enter");
  await page.locator(".forecast-facts").waitFor();
  await tabTo(page, (element) => element.labels?.[0]?.textContent === "Preset");
  await page.keyboard.press("d");
  await tabTo(page, isNamed, "Submit job");
  await page.keyboard.press("Enter");
  await page.waitForURL(/\/jobs\/job_/);
  await tabTo(page, isNamed, "Cancel");
  await page.keyboard.press("Space");
  await page.locator(".job-head .state", { hasText: "Canceled" }).waitFor();
  await watched.close();
});

test("in the queue keys choose jobs and open them", async () => {
  const watched = await given.open("/");
  const { page } = watched;
  await page.locator("tr[data-id]").nth(2).waitFor();
  for (const key of ["j", "ArrowDown", "Space", "Shift+ArrowDown"]) await page.keyboard.press(key);
  await page.getByText("2 chosen").waitFor();
  await page.keyboard.press("Escape");
  await page.getByText("2 chosen").waitFor({ state: "hidden" });
  await page.keyboard.press("Enter");
  await page.waitForURL(/\/jobs\/job_/);
  await watched.close();
});

test("J, K and L play, stop and play back; commas and full stops step", async () => {
  const watched = await given.open(`/jobs/${given.jobs.done.id}#frame=60`);
  const { page } = watched;
  await untilLit(page);
  const frame = async () => Number(/^Frame (\d+)/.exec(await page.locator(".timeline-moment").textContent())[1]);
  const passes = (than) => page.waitForFunction(([text, up]) => {
    const now = Number(/^Frame (\d+)/.exec(document.querySelector(".timeline-moment").textContent)[1]);
    return up ? now > text : now < text;
  }, than);
  await page.keyboard.press("l");
  await passes([62, true]);
  await page.keyboard.press("k");
  const stopped = await frame();
  await page.waitForTimeout(400);
  assert.equal(await frame(), stopped);
  await page.keyboard.press("j");
  await passes([stopped, false]);
  await page.keyboard.press("k");
  const there = await frame();
  await page.keyboard.press(".");
  assert.equal(await frame(), there + 1);
  await page.keyboard.press(",");
  assert.equal(await frame(), there);
  await page.keyboard.press("End");
  assert.equal(await frame(), 119);
  await page.keyboard.press("Home");
  assert.equal(await frame(), 0);
  await watched.close();
});

test("one walks, chooses a patch and changes the part without a pointer", async () => {
  const watched = await given.open(`/jobs/${given.jobs.done.id}`);
  const { page } = watched;
  await untilLit(page);
  await tabTo(page, (element) => element.classList.contains("walk-canvas"));
  await page.keyboard.down("w");
  await page.waitForTimeout(300);
  await page.keyboard.up("w");
  await page.waitForFunction(() => location.hash.includes("cam="));
  await page.keyboard.press("Enter");
  await page.locator(".probe-chip").waitFor();
  await tabTo(page, (element) => element.getAttribute("aria-label")?.startsWith("Let patch"));
  await page.keyboard.press("Enter");
  await page.locator(".probe-chip").waitFor({ state: "detached" });
  await page.locator("#tab-walk").focus();
  await page.keyboard.press("ArrowRight");
  await page.getByRole("tabpanel", { name: "Images and video" }).waitFor();
  assert.equal(await page.evaluate(() => document.activeElement.id), "tab-images");
  await watched.close();
});
