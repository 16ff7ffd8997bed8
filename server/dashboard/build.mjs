// usage: node build.mjs OUT_FOLDER [EXAMPLES_FOLDER]
// Bundles the dashboard into OUT_FOLDER: index.html, assets/NAME.HASH.{js,css}, examples/, with a .gz and a .br of each
// that is worth it. What is in the folder before is removed. The same sources give the same bytes.
import { build } from "esbuild";
import { mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join, relative } from "node:path";
import { brotliCompressSync, constants, gzipSync } from "node:zlib";
import { copyExamples } from "./copy_examples.mjs";

const here = new URL(".", import.meta.url).pathname;
const [out, examples = join(here, "../../api/examples")] = process.argv.slice(2);
if (!out) {
  console.error("usage: node build.mjs OUT_FOLDER [EXAMPLES_FOLDER]");
  process.exit(64);
}

rmSync(out, { recursive: true, force: true });
mkdirSync(join(out, "assets"), { recursive: true });

const common = {
  absWorkingDir: here,
  outdir: join(out, "assets"),
  entryNames: "[name].[hash]",
  chunkNames: "[name].[hash]",
  assetNames: "[name].[hash]",
  bundle: true,
  target: ["es2022"],
  minify: true,
  legalComments: "none",
  metafile: true,
  logLevel: "warning",
};
const url = (path) => "/assets/" + path.split("/").pop();

// Every src/**/NAME_worker.ts is a script of its own, whose name the pages are told (base/workers.ts).
const workers = readdirSync(join(here, "src"), { recursive: true }).map(String).filter((path) => path.endsWith("_worker.ts"));
const nameOf = (path) => path.split("/").pop().replace(/_worker\.ts$/, "");
const workerUrls = {};
if (workers.length > 0) {
  const entryPoints = Object.fromEntries(workers.map((path) => [nameOf(path), "src/" + path]));
  const built = await build({ ...common, entryPoints, format: "iife" });
  for (const [path, about] of Object.entries(built.metafile.outputs)) workerUrls[nameOf(about.entryPoint)] = url(path);
}

// All styles are one file, that of the theme first: a script fetched later would not bring its own with it.
const styles = new Set();
const collectStyles = {
  name: "collect-styles",
  setup(builder) {
    builder.onLoad({ filter: /\.css$/ }, ({ path }) => {
      styles.add(path);
      return { contents: "", loader: "js" };
    });
  },
};
const rank = (path) => (path.endsWith("/shell/theme.css") ? 0 : path.includes("/node_modules/") ? 1 : path.endsWith("/shell/shell.css") ? 2 : 3);

const built = await build({
  ...common,
  plugins: [collectStyles],
  entryPoints: { keylume: "src/main.ts" },
  splitting: true,
  format: "esm",
  define: { WORKER_URLS: JSON.stringify(workerUrls) },
});

const inOrder = [...styles].sort((a, b) => rank(a) - rank(b) || (a < b ? -1 : 1));
const style = await build({
  ...common,
  entryNames: "keylume.[hash]",
  stdin: { contents: inOrder.map((path) => `@import ${JSON.stringify("./" + relative(here, path))};`).join("\n"), loader: "css", resolveDir: here, sourcefile: "keylume.css" },
});

const entry = Object.entries(built.metafile.outputs).find(([, about]) => about.entryPoint === "src/main.ts");
const page = readFileSync(join(here, "src/index.html"), "utf8")
  .replace("{script}", url(entry[0]))
  .replace("{style}", url(Object.keys(style.metafile.outputs)[0]));
writeFileSync(join(out, "index.html"), page);
copyExamples(examples, join(out, "examples"));

function compress(folder) {
  for (const file of readdirSync(folder, { withFileTypes: true })) {
    const path = join(folder, file.name);
    if (file.isDirectory()) {
      compress(path);
      continue;
    }
    const bytes = readFileSync(path);
    const packed = {
      ".gz": gzipSync(bytes, { level: 9 }),
      ".br": brotliCompressSync(bytes, { params: { [constants.BROTLI_PARAM_QUALITY]: 11 } }),
    };
    for (const [ending, small] of Object.entries(packed))
      if (small.length < 0.95 * bytes.length) writeFileSync(path + ending, small);
  }
}
compress(out);
