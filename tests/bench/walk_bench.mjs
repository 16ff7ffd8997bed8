// usage: node walk_bench.mjs [--repetitions N]
// How fluid the dashboard's walk is: the garage with 49,208 patches and 120 frames in Chromium, which draws by software at
// 640 x 360. Prints a table and judges nothing. Environment: as tests/browser.
import { performance } from "node:perf_hooks";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { launch } from "../browser/support/browser.mjs";
import { finished, writeJob } from "../browser/support/jobs.mjs";
import { Service } from "../browser/support/service.mjs";

const repetitions = Number(process.argv[process.argv.indexOf("--repetitions") + 1] || 5);
const kScrubs = 20;
const kPlayMs = 5000;

const median = (values) => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];
const rows = [];
const row = (what, bar, values, unit) =>
  rows.push([what, bar, `${median(values).toFixed(2)} ${unit}`, `${Math.min(...values).toFixed(2)} .. ${Math.max(...values).toFixed(2)}`]);

/** Seconds from opening the address to the first picture with the light of its frame. */
async function open(browser, url) {
  const page = await browser.newPage({ viewport: { width: 1280, height: 900 } });
  await page.addInitScript(() => {
    window.drawn = [];
    document.addEventListener("drawn", ({ detail }) => window.drawn.push({ at: performance.now(), ...detail }), true);
    new MutationObserver(() => {
      const canvas = document.querySelector(".walk-canvas");
      if (canvas) Object.assign(canvas.style, { width: "640px", height: "360px" });
    }).observe(document, { childList: true, subtree: true });
  });
  const begin = performance.now();
  await page.goto(url);
  await page.waitForFunction(() => window.drawn.some(({ exact }) => exact));
  return { page, seconds: (performance.now() - begin) / 1000 };
}

/** To a frame far from any that was fetched, and back in time until its light is on the screen. */
function scrub(page, frame) {
  return page.evaluate((wanted) => new Promise((resolve) => {
    const slider = document.querySelector(".timeline-slider");
    const begin = performance.now();
    const look = ({ detail }) => {
      if (!detail.exact || detail.time !== wanted) return;
      document.removeEventListener("drawn", look, true);
      resolve((performance.now() - begin) / 1000);
    };
    document.addEventListener("drawn", look, true);
    slider.value = String(wanted);
    slider.dispatchEvent(new Event("input", { bubbles: true }));
  }), frame);
}

async function play(page) {
  await page.click(".timeline-play");
  await page.waitForTimeout(1000);
  const count = () => page.evaluate(() => window.drawn.length);
  const [before, begin] = [await count(), performance.now()];
  await page.waitForTimeout(kPlayMs);
  const rate = ((await count()) - before) / ((performance.now() - begin) / 1000);
  await page.click(".timeline-play");
  return rate;
}

const folder = mkdtempSync(join(tmpdir(), "keylume-walk-"));
const service = await new Service().start();
const browser = await launch();
try {
  const job = await finished(service, writeJob(join(folder, "job"), { frames: 120, width: 64, height: 36, preset: "standard", standard_errors: false }));
  const url = `${service.url}/jobs/${job.id}`;
  const [opened, scrubbed, played] = [[], [], []];
  for (let k = 0; k < repetitions; ++k) {
    const { page, seconds } = await open(browser, url);
    opened.push(seconds);
    for (let n = 0; n < kScrubs; ++n) scrubbed.push(await scrub(page, ((n * 47 + k * 13) % 119) + 1));
    played.push(await play(page));
    await page.close();
  }
  row("first picture after opening", "< 2 s", opened, "s");
  row("to any frame", "< 0.3 s", scrubbed, "s");
  row("playing", ">= 30 /s", played, "/s");
  for (const line of [["", "bar", "median", "range"], ...rows]) console.log(line.map((text) => text.padEnd(30)).join(""));
} finally {
  await browser.close();
  await service.stop();
  rmSync(folder, { recursive: true, force: true });
}
