// Debian's Chromium with WebGL by software. A page that complains, asks elsewhere or breaks its policy fails the test.
import assert from "node:assert/strict";
import { createRequire } from "node:module";
import { join } from "node:path";

const packages = createRequire(join(process.env.KEYLUME_BROWSER_PACKAGES, "package.json"));
const { chromium } = packages("playwright-core");
export const axeScript = packages.resolve("axe-core/axe.min.js");

/** For what waits on a job or on a picture drawn by software, on a machine that has other work as well. */
export const kPatienceMs = 60_000;

export function launch() {
  return chromium.launch({
    executablePath: process.env.KEYLUME_CHROMIUM,
    chromiumSandbox: false,
    args: ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--disable-background-networking",
      "--disable-component-update", "--disable-sync", "--no-first-run"],
  });
}

/** A page of its own (cookies too) that remembers what it should not have done. */
export class Watched {
  complaints = [];
  elsewhere = [];

  /** `options`: of the browser's context; `expected`: complaints that belong to what is tested. */
  static async open(browser, service, path, { expected = /^$/, ...options } = {}) {
    const watched = new Watched();
    watched.expected = expected;
    watched.service = service;
    watched.context = await browser.newContext({ viewport: { width: 1280, height: 900 }, reducedMotion: "reduce", ...options });
    watched.page = await watched.context.newPage();
    const { page } = watched;
    page.setDefaultTimeout(kPatienceMs);
    page.on("console", (message) => message.type() === "error" && watched.complain(`${message.text()} (${message.location().url})`));
    page.on("pageerror", (error) => watched.complain(error.stack ?? String(error)));
    page.on("request", (request) => watched.look(request.url()));
    await page.goto(service.url + path);
    return watched;
  }

  complain(text) {
    if (!this.expected.test(text)) this.complaints.push(text);
  }

  look(url) {
    const { protocol, origin } = new URL(url);
    if (!["data:", "blob:"].includes(protocol) && origin !== this.service.url) this.elsewhere.push(url);
  }

  goTo(path) {
    return this.page.goto(this.service.url + path);
  }

  /** Ends it, and asserts that nothing went wrong meanwhile. */
  async close() {
    await this.context.close();
    assert.deepEqual(this.complaints, [], "the console stayed silent");
    assert.deepEqual(this.elsewhere, [], "nothing was asked of others");
  }
}

/** Drops files on what `selector` names, as from a file manager. */
export async function drop(page, selector, files) {
  const packed = files.map(({ name, bytes }) => ({ name, text: bytes.toString("base64") }));
  const dataTransfer = await page.evaluateHandle((list) => {
    const transfer = new DataTransfer();
    for (const { name, text } of list)
      transfer.items.add(new File([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))], name));
    return transfer;
  }, packed);
  await page.dispatchEvent(selector, "dragover", { dataTransfer });
  await page.dispatchEvent(selector, "drop", { dataTransfer });
}

/** Until the walk of a job shows light, and what it shows stays the same. */
export async function untilLit(page, canvas = page.locator(".walk-canvas").first()) {
  await canvas.waitFor();
  let before = "";
  let same = 0;
  for (let look = 0; look < 200 && same < 2; ++look) {
    await page.waitForTimeout(150);
    const now = (await canvas.screenshot()).toString("base64");
    same = now === before && (await isLit(page)) ? same + 1 : 0;
    before = now;
  }
  assert.equal(same, 2, "the picture comes to rest");
  return canvas;
}

function isLit(page) {
  return page.evaluate(() => performance.getEntriesByType("resource").some(({ name, responseEnd }) => /\/half\//.test(name) && responseEnd > 0));
}

/** What was copied last; the context has the permissions clipboard-read and clipboard-write. */
export async function copied(page) {
  await page.getByText("Command copied").first().waitFor();
  return page.evaluate(() => navigator.clipboard.readText());
}
