// Views: other cameras and sizes, rendered from the stored radiosity.
import { messageOf } from "../../api/api_error";
import { get, send } from "../../api/client";
import { curlOf } from "../../api/curl";
import type { AskedView, View } from "../../api/types";
import { bytes } from "../../base/format";
import { fill, h } from "../../base/h";
import { copyCurlButton } from "../../shell/copy_curl";
import { confirmDialog } from "../../shell/dialog";
import { toast, toastError } from "../../shell/toast";
import type { JobContext } from "../job_part";
import { viewCamera } from "../view_camera";

const kLookMs = 1500;
const kSizes = [[640, 360], [1280, 720], [1920, 1080]] as const;
const kFormats = ["png", "jpg", "exr"] as const;

export function views(context: JobContext): HTMLElement {
  const list = h("ul", { class: "view-list" });
  const form = h("div");
  let timer: ReturnType<typeof setTimeout> | undefined;
  const look = async (): Promise<void> => {
    clearTimeout(timer);
    const { views: all } = await get("/v1/jobs/{id}/views", { path: { id: context.id } });
    const details = await Promise.all(all.map((view) =>
      view.state === "ready" ? get("/v1/jobs/{id}/views/{view}", { path: { id: context.id, view: view.id } }) : view));
    if (context.lifetime.ended) return;
    fill(list, details.map((view) => row(context, view, again)));
    if (all.some(({ state }) => state === "waiting" || state === "making")) timer = setTimeout(again, kLookMs);
  };
  const again = (): void => void look().catch((error: unknown) => fill(list, h("li", { class: "bad" }, messageOf(error))));
  const element = h("section", { "aria-label": "Views" }, h("h2", null, "Views"),
    h("p", { class: "small muted" }, "Any camera and size, from the stored radiosity, without solving again. Place the camera in Walk."), form, list);
  context.lifetime.add(
    () => clearTimeout(timer),
    context.stage.watch(() => fill(form, newView(context, again))),
    context.job.watch((job) => {
      const done = job.state === "succeeded";
      if (done && element.hidden) again();
      element.hidden = !done;
    }),
  );
  if (!element.hidden) again();
  return element;
}

function newView(context: JobContext, again: () => void): Node | null {
  const stage = context.stage.value;
  if (!stage) return h("p", { class: "small muted" }, "Open Walk first: what is seen there is rendered here.");
  const size = h("select", { "aria-label": "Size" }, kSizes.map(([w, ht]) => h("option", { value: `${w} ${ht}` }, `${w} × ${ht}`)));
  const format = h("select", { "aria-label": "Format" }, kFormats.map((name) => h("option", { value: name }, name)));
  const all = h("input", { type: "checkbox" });
  const request = (): AskedView => {
    const [width, height] = size.value.split(" ").map(Number) as [number, number];
    const { frames, ...camera } = viewCamera(context, stage);
    return { ...camera, ...(all.checked ? {} : { frames }), width, height, formats: [format.value as (typeof kFormats)[number]] };
  };
  const path = { id: context.id };
  const render = async (): Promise<void> => {
    await send("post", "/v1/jobs/{id}/views", { path, json: request() });
    toast("The view is being rendered.", { kind: "good" });
    again();
  };
  return h("div", { class: "row" }, h("span", null, "The camera of Walk, "), size, format, h("label", null, all, " all frames"),
    h("button", { class: "primary", onclick: () => void render().catch(toastError) }, "Render view"),
    copyCurlButton(() => curlOf("POST", "/v1/jobs/{id}/views", { path, json: request() }), "render this view"));
}

function row(context: JobContext, view: View, again: () => void): HTMLElement {
  const path = { id: context.id, view: view.id };
  const remove = async (): Promise<void> => {
    const sure = await confirmDialog({ title: "Delete this view?", body: ["Its pictures are removed. They can be rendered again."], confirm: "Delete view", danger: true });
    if (sure) await send("delete", "/v1/jobs/{id}/views/{view}", { path }).then(again);
  };
  const files = view.files ?? [];
  const first = files.find(({ href }) => /\.(png|jpg)$/.test(href));
  return h("li", { class: "view" },
    first ? h("a", { href: first.href }, h("img", { src: first.href, alt: `First picture of view ${view.id.slice(0, 8)}`, loading: "lazy" })) : null,
    h("div", null,
      h("div", null, h("code", null, view.id.slice(0, 8)), ` ${view.state}`,
        view.request ? ` · ${view.request.width} × ${view.request.height}` : ""),
      view.error ? h("div", { class: "bad small" }, view.error) : null,
      h("div", { class: "view-files small" }, files.slice(0, 12).map(({ href, bytes: size }) =>
        h("a", { href, download: true }, `${href.split("/").pop()} (${bytes(size)})`)),
        files.length > 12 ? h("span", { class: "muted" }, `and ${files.length - 12} more`) : null),
      h("div", { class: "row" }, h("button", { class: "quiet", onclick: () => void remove().catch(toastError) }, "Delete"),
        copyCurlButton(() => curlOf("GET", "/v1/jobs/{id}/views/{view}", { path }), "list the files of this view"))));
}
