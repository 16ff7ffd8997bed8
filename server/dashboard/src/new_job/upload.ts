// The files of a job before it is submitted: sorted by what they are, and the settings of the form laid over the
// animation's JSON.
export type Field = "scene" | "materials" | "textures" | "animation" | "options" | "archive";

export interface Part {
  readonly field: Field;
  readonly file: File;
}

/** What a file is, by its name; null: nothing that a job has. */
export function fieldOf(name: string): Field | null {
  const ending = name.toLowerCase().split(".").pop() ?? "";
  if (name.toLowerCase() === "options.json") return "options";
  const fields: Readonly<Record<string, Field>> = {
    obj: "scene", mtl: "materials", png: "textures", jpg: "textures", jpeg: "textures", json: "animation", zip: "archive", tar: "archive",
  };
  return fields[ending] ?? null;
}

/** There is one scene and one animation; others replace those of their name. An archive is the whole job. */
export function withFiles(parts: readonly Part[], files: readonly File[]): { parts: Part[]; unknown: string[] } {
  let kept = [...parts];
  const unknown: string[] = [];
  for (const file of files) {
    const field = fieldOf(file.name);
    if (field === null) {
      unknown.push(file.name);
      continue;
    }
    const single = field === "scene" || field === "animation" || field === "options" || field === "archive";
    if (field === "archive") kept = [];
    else kept = kept.filter((part) => part.field !== "archive" && !(part.field === field && (single || part.file.name === file.name)));
    kept.push({ field, file });
  }
  return { parts: kept, unknown };
}

export function isWhole(parts: readonly Part[]): boolean {
  const has = (field: Field) => parts.some((part) => part.field === field);
  return has("archive") || (has("scene") && has("animation"));
}

/** What is still missing, for people. */
export function missing(parts: readonly Part[]): string {
  const has = (field: Field) => parts.some((part) => part.field === field);
  if (parts.length === 0) return "";
  const names = [has("scene") ? "" : "the scene (.obj)", has("animation") ? "" : "the animation (.json)"].filter((text) => text !== "");
  return has("archive") || names.length === 0 ? "" : `Still missing: ${names.join(" and ")}.`;
}

type Json = Record<string, unknown>;

/** What this file says; null: there is none, none that is JSON, or it is in an archive. */
export async function jsonOf(parts: readonly Part[], wanted: "animation" | "options"): Promise<Json | null> {
  const file = parts.find(({ field }) => field === wanted)?.file;
  if (!file) return null;
  try {
    const value: unknown = JSON.parse(await file.text());
    return typeof value === "object" && value !== null && !Array.isArray(value) ? (value as Json) : null;
  } catch {
    return null; // the check says where it is no JSON
  }
}

/** Values of the form by JSON pointer ("/lighting/preset"); undefined: as the file says. */
export type Settings = Readonly<Record<string, unknown>>;

/** The animation with the form's values in their places. Lists of images take theirs in every entry. */
export function withSettings(animation: Json, settings: Settings): Json {
  const result = structuredClone(animation);
  for (const [pointer, value] of Object.entries(settings)) {
    if (value === undefined) continue;
    const [section, name] = pointer.slice(1).split("/") as [string, string];
    if (section === "images") {
      for (const image of Array.isArray(result["images"]) ? (result["images"] as Json[]) : []) image[name] = value;
      continue;
    }
    const place = (result[section] ??= {}) as Json;
    place[name] = value;
  }
  return result;
}

/** The body of a submission, a check or a preview. `animation`: null where it is in an archive. */
export function formOf(parts: readonly Part[], animation: Json | null, options: Json): FormData {
  const form = new FormData();
  for (const { field, file } of parts) {
    if (field === "options" || (field === "animation" && animation !== null)) continue;
    form.append(field, file, file.name);
  }
  if (animation !== null) form.append("animation", new Blob([JSON.stringify(animation)], { type: "application/json" }), "animation.json");
  if (Object.keys(options).length > 0) form.append("options", new Blob([JSON.stringify(options)], { type: "application/json" }), "options.json");
  return form;
}
