// usage: node run_tests.mjs DASHBOARD_FOLDER
// Bundles every *_test.ts beside this file with the sources of the dashboard and runs it by node's own test runner.
// DASHBOARD_FOLDER: where the build has put the sources and their packages. Exit 77: the packages are not there.
import { existsSync, mkdtempSync, readdirSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { spawnSync } from "node:child_process";

const here = new URL(".", import.meta.url).pathname;
const dashboard = process.argv[2] ?? "";
if (!existsSync(join(dashboard, "node_modules/esbuild"))) {
  console.log("skipped: the dashboard's packages are not here (no npm, or no network when it was built)");
  process.exit(77);
}
const { buildSync } = createRequire(join(dashboard, "package.json"))("esbuild");

const out = mkdtempSync(join(tmpdir(), "keylume-dashboard-test-"));
const tests = readdirSync(here).filter((name) => name.endsWith("_test.ts"));
buildSync({
  entryPoints: tests.map((name) => join(here, name)),
  outdir: out,
  outExtension: { ".js": ".mjs" },
  bundle: true,
  format: "esm",
  platform: "node",
  alias: { dashboard: join(dashboard, "src") },
  loader: { ".css": "empty" },
  define: { WORKER_URLS: "{}" },
});
const run = spawnSync(process.execPath, ["--test", ...tests.map((name) => join(out, name.replace(/\.ts$/, ".mjs")))], { stdio: "inherit", timeout: 50_000 });
rmSync(out, { recursive: true, force: true });
process.exit(run.status ?? 1);
