// The examples that the dashboard offers to start from, with a list of them.
import { copyFileSync, existsSync, mkdirSync, readdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";

const offered = [
  { name: "garage", title: "Garage", description: "A toy plane flies through a garage; the light stays. Its shadow wanders over the floor. 120 frames." },
  { name: "cornell_box", title: "Cornell box", description: "A box moves and turns under a ceiling light between a red and a green wall." },
  { name: "room", title: "Room", description: "A lamp swings through a room with furniture." },
];

/** What each file of an example is in an upload; others, as the scripts that made them, are left behind. */
function fieldOf(file) {
  if (file === "scene.obj") return "scene";
  if (file === "animation.json") return "animation";
  if (file.endsWith(".mtl")) return "materials";
  if (/\.(png|jpe?g)$/.test(file) && file !== "preview.png") return "textures";
  return null;
}

export function copyExamples(from, to) {
  mkdirSync(to, { recursive: true });
  const list = [];
  for (const { name, title, description } of offered) {
    if (!existsSync(join(from, name))) continue;
    const folder = join(to, name);
    mkdirSync(folder, { recursive: true });
    const files = [];
    for (const file of readdirSync(join(from, name)).sort()) {
      const field = fieldOf(file);
      if (field === null && file !== "preview.png") continue;
      copyFileSync(join(from, name, file), join(folder, file));
      if (field !== null) files.push({ field, name: file, href: `/examples/${name}/${file}` });
    }
    const preview = existsSync(join(folder, "preview.png")) ? `/examples/${name}/preview.png` : null;
    list.push({ name, title, description, preview, files });
  }
  writeFileSync(join(to, "index.json"), JSON.stringify({ examples: list }, null, 1));
}
