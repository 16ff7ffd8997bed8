// Orbit with the pointer, walk with the keys; the place is a Signal that others may set.
import { PerspectiveCamera, Sphere, Vector3 } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { CameraState } from "../job/playhead";
import { Lifetime, Signal } from "../base/signal";

/** Extents of the scene per second. */
const kWalkSpeed = 0.15;
const kHurry = 4;

/** Along the way one looks, to the right, up: of a key. */
const kSteps: Readonly<Record<string, readonly [number, number, number]>> = {
  KeyW: [1, 0, 0], KeyS: [-1, 0, 0], KeyD: [0, 1, 0], KeyA: [0, -1, 0], KeyE: [0, 0, 1], KeyQ: [0, 0, -1],
  ArrowUp: [1, 0, 0], ArrowDown: [-1, 0, 0], ArrowRight: [0, 1, 0], ArrowLeft: [0, -1, 0],
};

export class CameraControl {
  readonly camera: PerspectiveCamera;
  readonly state: Signal<CameraState>;
  /** True while the user has moved and nothing else leads the camera. */
  readonly moved = new Signal(false);
  private readonly controls: OrbitControls;
  private readonly pressed = new Set<string>();
  private readonly lifetime = new Lifetime();
  private hurry = false;
  private setting = false;

  constructor(canvas: HTMLCanvasElement, up: readonly [number, number, number], private readonly bounds: Sphere, first: CameraState) {
    this.camera = new PerspectiveCamera(first.verticalFovDeg, 1, bounds.radius / 2000, bounds.radius * 20);
    this.camera.up.set(...up);
    this.state = new Signal(first);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.addEventListener("start", () => (this.moved.value = true));
    this.controls.addEventListener("change", () => this.tell());
    this.lifetime.add(() => this.controls.dispose(), this.state.watch((state) => this.set(state)));
    this.lifetime.listen(canvas, "keydown", (event) => this.key(event, true));
    this.lifetime.listen(canvas, "keyup", (event) => this.key(event, false));
    this.lifetime.listen(canvas, "blur", () => this.pressed.clear());
  }

  get walking(): boolean {
    return this.pressed.size > 0;
  }

  /** Goes on by `seconds` while keys are held. */
  walk(seconds: number): void {
    const along = this.controls.target.clone().sub(this.camera.position).normalize();
    const right = along.clone().cross(this.camera.up).normalize();
    const step = new Vector3();
    for (const code of this.pressed) {
      const [ahead, aside, above] = kSteps[code]!;
      step.addScaledVector(along, ahead).addScaledVector(right, aside).addScaledVector(this.camera.up, above);
    }
    step.multiplyScalar(seconds * kWalkSpeed * this.bounds.radius * (this.hurry ? kHurry : 1));
    this.camera.position.add(step);
    this.controls.target.add(step);
    this.tell();
  }

  dispose(): void {
    this.lifetime.end();
  }

  private key(event: KeyboardEvent, down: boolean): void {
    this.hurry = event.shiftKey;
    if (!kSteps[event.code] || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    if (down) this.pressed.add(event.code);
    else this.pressed.delete(event.code);
    if (down) this.moved.value = true;
    this.state.value = { ...this.state.value }; // wakes the view, which asks for the next step
  }

  /** From the controls to the signal. */
  private tell(): void {
    if (this.setting) return;
    const { position } = this.camera;
    const { target } = this.controls;
    this.setting = true;
    this.state.value = {
      position: [position.x, position.y, position.z], target: [target.x, target.y, target.z], verticalFovDeg: this.camera.fov,
    };
    this.setting = false;
  }

  /** From the signal to the controls. */
  private set(state: CameraState): void {
    if (this.setting) return;
    this.setting = true;
    this.camera.position.set(...state.position);
    // A target far enough away to be orbited: where one looks at, not one metre ahead.
    this.controls.target.set(...state.target);
    this.camera.fov = state.verticalFovDeg;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.setting = false;
  }
}
