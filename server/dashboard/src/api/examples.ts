// The jobs to start from that come with the dashboard.
import { fetchBytes, get, send } from "./client";
import type { Job, Validation } from "./types";

export interface ExampleFile {
  /** Which part of an upload it is. */
  field: "scene" | "materials" | "textures" | "animation";
  name: string;
  href: string;
}

export interface Example {
  name: string;
  title: string;
  description: string;
  preview: string | null;
  files: ExampleFile[];
}

export async function listExamples(signal?: AbortSignal): Promise<Example[]> {
  return (await get("/examples/index.json", { signal })).examples;
}

/** Its files as if somebody had dropped them. */
export async function fetchExample(example: Example, signal?: AbortSignal): Promise<{ field: ExampleFile["field"]; file: File }[]> {
  return Promise.all(example.files.map(async ({ field, name, href }) => {
    const blob = await (await fetchBytes(href, { signal })).blob();
    return { field, file: new File([blob], name, { type: blob.type }) };
  }));
}

async function formOf(name: string): Promise<FormData> {
  const example = (await listExamples()).find((each) => each.name === name);
  if (!example) throw new Error(`there is no example ${name} here`);
  const form = new FormData();
  for (const { field, file } of await fetchExample(example)) form.append(field, file, file.name);
  return form;
}

/** Submits it as it is. Errors: ApiError. */
export async function submitExample(name: string): Promise<Job> {
  return send("post", "/v1/jobs", { form: await formOf(name) });
}

/** What it would take here. Errors: ApiError. */
export async function forecastOfExample(name: string): Promise<Validation["forecast"]> {
  return (await send("post", "/v1/validate", { form: await formOf(name) })).forecast;
}
