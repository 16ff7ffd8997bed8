// Everything a job has left, with its size.
import { fetchBytes, urlOf } from "../../api/client";
import { curlOf } from "../../api/curl";
import { bytes } from "../../base/format";
import { fill, h } from "../../base/h";
import { copyCurlButton } from "../../shell/copy_curl";
import type { JobContext } from "../job_part";

interface Artefact {
  readonly path: string;
  readonly bytes: number;
  readonly sha256: string;
}

/** What is made on request, of all frames. */
const kMade = [
  { path: "/v1/jobs/{id}/results.tar", name: "results.tar", what: "all files, with checksums and what is needed to render them again" },
  { path: "/v1/jobs/{id}/radiosity.npz", name: "radiosity.npz", what: "radiosity and its errors, for NumPy" },
  { path: "/v1/jobs/{id}/manifest.json", name: "manifest.json", what: "every file with its SHA-256" },
] as const;

export function downloads(context: JobContext): HTMLElement {
  const list = h("div");
  const element = h("section", { "aria-label": "Downloads" }, h("h2", null, "Downloads"), list);
  let begun = false;
  context.lifetime.add(context.job.watch((job) => {
    element.hidden = job.state !== "succeeded";
    if (element.hidden || begun) return;
    begun = true;
    manifestOf(context).then((files) => fill(list, table(context, files)), () => (begun = false));
  }));
  return element;
}

async function manifestOf({ id }: JobContext): Promise<readonly Artefact[]> {
  const response = await fetchBytes(urlOf("/v1/jobs/{id}/manifest.json", { path: { id } }));
  return ((await response.json()) as { artefacts: Artefact[] }).artefacts;
}

function table({ id, playhead }: JobContext, files: readonly Artefact[]): HTMLElement {
  const images = files.filter(({ path }) => path.startsWith("images/"));
  const single = files.filter(({ path }) => !path.startsWith("images/"));
  const path = { id };
  const line = (name: string, what: string, href: string, curl: () => string) =>
    h("tr", null, h("td", null, h("a", { href, download: name }, name)), h("td", { class: "muted" }, what), h("td", null, copyCurlButton(curl, `fetch ${name}`)));
  return h("table", { class: "downloads" }, h("tbody", null,
    kMade.map(({ path: pattern, name, what }) => line(name, what, urlOf(pattern, { path }), () => curlOf("GET", pattern, { path, output: name }))),
    single.map((file) => {
      const pattern = "/v1/jobs/{id}/artefacts/{file}";
      const values = { id, file: file.path };
      return line(file.path, bytes(file.bytes), urlOf(pattern, { path: values }), () => curlOf("GET", pattern, { path: values, output: file.path }));
    }),
    glb(id, playhead.frame),
    images.length > 0 ? h("tr", null, h("td", null, count(images)), h("td", { class: "muted" }, "in results.tar, or one by one above"), h("td")) : null));
}

function count(images: readonly Artefact[]): string {
  return `${images.length} pictures, ${bytes(images.reduce((sum, file) => sum + file.bytes, 0))}`;
}

function glb(id: string, frame: number): HTMLElement {
  const path = { id, f: frame };
  const name = `frame_${frame}.glb`;
  return h("tr", null, h("td", null, h("a", { href: urlOf("/v1/jobs/{id}/frames/{f}/patches.glb", { path }), download: name }, name)),
    h("td", { class: "muted" }, "this frame as glTF, its colours exposed as the pictures are"),
    h("td", null, copyCurlButton(() => curlOf("GET", "/v1/jobs/{id}/frames/{f}/patches.glb", { path, output: name }), `fetch ${name}`)));
}
