// usage: node build.mjs OUT_FOLDER
// Bundles the dashboard into OUT_FOLDER: index.html, and assets/NAME.HASH.{js,css} with a .gz and a .br of each that is
// smaller. What is in the folder before is removed. The same sources give the same bytes.
import { build } from "esbuild";
import { mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { brotliCompressSync, constants, gzipSync } from "node:zlib";

const out = process.argv[2];
if (!out) {
  console.error("usage: node build.mjs OUT_FOLDER");
  process.exit(64);
}
const here = new URL(".", import.meta.url).pathname;

rmSync(out, { recursive: true, force: true });
mkdirSync(join(out, "assets"), { recursive: true });
const built = await build({
  absWorkingDir: here,
  entryPoints: { keylume: "src/main.ts" },
  outdir: join(out, "assets"),
  entryNames: "[name].[hash]",
  chunkNames: "[name].[hash]",
  assetNames: "[name].[hash]",
  bundle: true,
  splitting: true,
  format: "esm",
  target: ["es2022"],
  minify: true,
  legalComments: "none",
  metafile: true,
  logLevel: "warning",
});

const outputs = Object.entries(built.metafile.outputs);
const entry = outputs.find(([, about]) => about.entryPoint === "src/main.ts");
const name = (path) => "/assets/" + path.split("/").pop();
const page = readFileSync(join(here, "src/index.html"), "utf8")
  .replace("{script}", name(entry[0]))
  .replace("{style}", name(entry[1].cssBundle));
writeFileSync(join(out, "index.html"), page);

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
      if (small.length < bytes.length) writeFileSync(path + ending, small);
  }
}
compress(out);
