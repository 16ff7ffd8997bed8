// The moment, the patches and the camera in the address (#frame=12&patch=345,7&cam=...), both ways.
import type { Lifetime } from "../base/signal";
import type { CameraState, Playhead } from "./playhead";

const kWriteMs = 250; // browsers refuse more than a hundred changes in half a minute
const kPinnedMax = 16;

export function keepInAddress(playhead: Playhead, lifetime: Lifetime): void {
  read(playhead);
  lifetime.listen(window, "hashchange", () => read(playhead));
  let timer: ReturnType<typeof setTimeout> | undefined;
  const later = (): void => {
    if (playhead.playing.value) return; // written when it stops
    clearTimeout(timer);
    timer = setTimeout(() => write(playhead), kWriteMs);
  };
  let ready = false; // watch() calls at once, when there is nothing new to write
  for (const signal of [playhead.time, playhead.pinned, playhead.camera, playhead.playing])
    lifetime.add((signal as { watch(listener: () => void): () => void }).watch(() => ready && later()));
  ready = true;
  lifetime.add(() => clearTimeout(timer));
}

function read(playhead: Playhead): void {
  const words = new URLSearchParams(location.hash.slice(1));
  const frame = Number(words.get("frame") ?? NaN);
  if (Number.isFinite(frame)) playhead.time.value = Math.min(Math.max(frame, 0), playhead.frameCount - 1);
  const patches = (words.get("patch") ?? "").split(",").filter((word) => /^\d{1,8}$/.test(word)).map(Number).slice(0, kPinnedMax);
  if (patches.join() !== playhead.pinned.value.join()) playhead.pinned.value = patches;
  const camera = cameraOf(words.get("cam"));
  if (camera) playhead.camera.value = camera;
}

/** "px,py,pz,tx,ty,tz,fov". */
function cameraOf(text: string | null): CameraState | null {
  const numbers = (text ?? "").split(",").map(Number);
  if (numbers.length !== 7 || !numbers.every(Number.isFinite)) return null;
  const [px, py, pz, tx, ty, tz, fov] = numbers as [number, number, number, number, number, number, number];
  return { position: [px, py, pz], target: [tx, ty, tz], verticalFovDeg: Math.min(Math.max(fov, 1), 170) };
}

function write(playhead: Playhead): void {
  const words: string[] = [];
  const others = new URLSearchParams(location.hash.slice(1));
  for (const name of ["frame", "patch", "cam"]) others.delete(name);
  if (playhead.frame !== 0) words.push(`frame=${playhead.frame}`);
  if (playhead.pinned.value.length > 0) words.push(`patch=${playhead.pinned.value.join(",")}`);
  const camera = playhead.camera.value;
  if (camera) words.push(`cam=${[...camera.position, ...camera.target, camera.verticalFovDeg].map((x) => Number(x.toFixed(3))).join(",")}`);
  if (others.size > 0) words.push(others.toString());
  history.replaceState(history.state, "", location.pathname + location.search + (words.length > 0 ? `#${words.join("&")}` : ""));
}
