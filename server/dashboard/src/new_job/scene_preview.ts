// The scene of an upload with its motion, before it is lit: what moves is tinted.
import { fill, h } from "../base/h";
import { Lifetime } from "../base/signal";
import { readShadingMesh, type ShadingMesh } from "../scene/shading_mesh";
import { Playhead } from "../job/playhead";
import { frameSlider, playButton } from "../job/timeline/play_controls";
import { startPlayer } from "../job/timeline/player";

export interface ScenePreview {
  readonly element: HTMLElement;
  show(archive: ArrayBuffer): Promise<void>;
  clear(): void;
}

export function scenePreview(page: Lifetime): ScenePreview {
  const element = h("div", { class: "preview" });
  let shown = new Lifetime();
  page.add(() => shown.end());
  const clear = (): void => {
    shown.end();
    shown = new Lifetime();
    fill(element, h("p", { class: "preview-empty muted" }, "The scene appears here when its files are there."));
  };
  clear();
  return {
    element, clear,
    show: async (archive) => {
      const { createLightingView } = await import("../scene/webgl_view");
      const mesh = readShadingMesh(archive);
      clear();
      if (page.ended) return;
      open(element, mesh, createLightingView, shown);
    },
  };
}

function open(place: HTMLElement, mesh: ShadingMesh, create: typeof import("../scene/webgl_view").createLightingView, lifetime: Lifetime): void {
  const canvas = h("canvas", { class: "preview-canvas", tabindex: "0", "aria-label": "The scene of this upload. Drag to look around." });
  const tools = h("div", { class: "row" });
  fill(place, canvas, tools, facts(mesh));
  const view = create(canvas, mesh);
  lifetime.add(() => view.dispose());
  view.setDisplay({ what: "clay", tintMoving: true, marks: true });
  const playhead = new Playhead(mesh.frameCount, mesh.fps);
  startPlayer(playhead, lifetime);
  lifetime.add(playhead.time.watch((time) => view.setTime(time)));
  fill(tools, playButton(playhead, lifetime), frameSlider(playhead, lifetime), cameraChoice(mesh, view, lifetime));
}

function cameraChoice(mesh: ShadingMesh, view: ReturnType<typeof import("../scene/webgl_view").createLightingView>, lifetime: Lifetime): HTMLElement {
  const select = h("select", { onchange: () => view.followCamera(select.value || null) },
    h("option", { value: "" }, "from outside"), mesh.cameras.names.map((name) => h("option", { value: name }, name)));
  lifetime.add(view.following.watch((name) => (select.value = name ?? "")));
  view.showAll();
  return h("label", null, "Camera ", select);
}

function facts(mesh: ShadingMesh): HTMLElement {
  const emitting = mesh.materialNames.filter((_, k) => mesh.materialEmits[k] === 1);
  const lights = [...emitting, ...mesh.lights.names];
  return h("p", { class: "muted small" },
    `${mesh.frameCount} frames at ${mesh.fps} per second · ${mesh.objectNames.length} objects · lights: ${lights.join(", ") || "none"} · blue: what moves; yellow: what emits`);
}
