// Jobs for tests, cut down from the examples by tests/support/small_jobs.py, and what the service says of them.
import { spawnSync } from "node:child_process";
import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { waitFor } from "./service.mjs";

const kSupport = new URL("../../support", import.meta.url).pathname;
const kWrite = `import json, sys
from pathlib import Path
from small_jobs import changed, write_job
about = json.loads(sys.argv[1])
folder = write_job(Path(about["folder"]), **about["cut"])
changed(folder, lambda job: job.update(about["change"]))`;

/** `cut`: arguments of write_job(); `change`: members of animation.json that are replaced. -> folder */
export function writeJob(folder, cut = {}, change = {}) {
  const run = spawnSync("python3", ["-B", "-c", kWrite, JSON.stringify({ folder, cut, change })],
    { env: { ...process.env, PYTHONPATH: kSupport }, encoding: "utf8" });
  if (run.status !== 0) throw new Error(run.stderr);
  return folder;
}

/** [{ name, field, bytes }] of a job's folder. */
export function filesOf(folder) {
  const fields = { obj: "scene", mtl: "materials", json: "animation" };
  return readdirSync(folder).sort().map((name) => ({ name, field: fields[name.split(".").pop()], bytes: readFileSync(join(folder, name)) }));
}

export async function submit(service, folder, options = {}) {
  const form = new FormData();
  for (const { name, field, bytes } of filesOf(folder)) form.append(field, new Blob([bytes]), name);
  form.append("options", new Blob([JSON.stringify(options)]), "options.json");
  const response = await fetch(`${service.url}/v1/jobs`, { method: "POST", body: form });
  if (response.status !== 201 && response.status !== 202) throw new Error(`${response.status} ${await response.text()}`);
  return response.json();
}

export async function get(service, path) {
  const response = await fetch(service.url + path);
  if (!response.ok) throw new Error(`${path}: ${response.status} ${await response.text()}`);
  return response.json();
}

export async function post(service, path, body = {}) {
  const response = await fetch(service.url + path, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) });
  if (!response.ok) throw new Error(`${path}: ${response.status} ${await response.text()}`);
  return response.json();
}

/** Until the job is in `state`. -> job */
export function untilState(service, id, state, seconds = 240) {
  return waitFor(async () => {
    const job = await get(service, `/v1/jobs/${id}`);
    if (job.state !== state && ["failed", "canceled", "succeeded"].includes(job.state)) throw new Error(`the job is ${job.state}: ${job.reason}`);
    return job.state === state && job;
  }, seconds, `job ${id} is ${state}`);
}

export async function finished(service, folder, options = {}) {
  const { id } = await submit(service, folder, options);
  return untilState(service, id, "succeeded");
}
