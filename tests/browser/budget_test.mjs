// What a browser has to fetch and to allow.
import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import { gzipSync } from "node:zlib";
import { test } from "node:test";
import { join } from "node:path";
import { suite } from "./support/suite.mjs";

const kScriptBytesMax = 250_000;
const assets = join(process.env.KEYLUME_DASHBOARD, "assets");

const given = suite();

test("all scripts together are at most 250 kB as they are sent", () => {
  const scripts = readdirSync(assets).filter((name) => name.endsWith(".js"));
  const bytes = scripts.reduce((sum, name) => sum + gzipSync(readFileSync(join(assets, name)), { level: 9 }).length, 0);
  console.log(`ratio: ${scripts.length} scripts, ${(bytes / 1000).toFixed(1)} kB gzipped of ${kScriptBytesMax / 1000} kB`);
  assert.ok(scripts.length > 3 && bytes <= kScriptBytesMax, `${bytes} bytes`);
});

test("the queue does without what draws in three dimensions", async () => {
  const fetched = [];
  const watched = await given.open("/");
  watched.page.on("response", (response) => fetched.push(response));
  await watched.page.reload();
  await watched.page.getByRole("heading", { name: "No jobs yet" }).waitFor();
  const scripts = fetched.filter((response) => response.url().endsWith(".js"));
  assert.ok(scripts.length > 0 && !scripts.some((response) => response.url().includes("webgl_view")));
  for (const response of scripts) {
    const { etag, ...headers } = await response.allHeaders();
    assert.match(headers["cache-control"] ?? "", /immutable/, response.url());
    assert.ok(["br", "gzip"].includes(headers["content-encoding"]), response.url());
  }
  await watched.close();
});

test("scripts from elsewhere, scripts in the page and frames around it are refused, and a test would see it", async () => {
  const watched = await given.open("/system");
  const { page } = watched;
  await page.locator(".cards .good").waitFor();
  const policy = (await (await fetch(`${given.service.url}/`, { headers: { Accept: "text/html" } })).headers).get("content-security-policy");
  for (const rule of ["default-src 'none'", "script-src 'self';", "connect-src 'self';", "frame-ancestors 'none'"]) assert.ok(policy.includes(rule), policy);
  assert.ok(!/unsafe-(inline|eval)/.test(policy), policy);
  const ran = await page.evaluate(async () => {
    const script = document.createElement("script");
    script.textContent = "globalThis.injected = true";
    document.head.append(script);
    const elsewhere = await fetch("http://127.0.0.1:9/").then(() => "reached", () => "refused");
    return [globalThis.injected ?? false, elsewhere];
  });
  assert.deepEqual(ran, [false, "refused"]);
  assert.ok(watched.complaints.filter((text) => text.includes("Content Security Policy")).length >= 2, watched.complaints.join("\n"));
  watched.complaints = [];
  watched.elsewhere = [];
  await watched.close();
});
