// Orbit with the pointer, walk with the keys; the place is a Signal that others may set.
import { PerspectiveCamera, Sphere, Vector3 } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { CameraState } from "../job/playhead";
import { Lifetime, Signal } from "../base/signal";

/** Extents of the scene per second. */
const kWalkSpeed = 0.15;
const kHurry = 4;
/** In radii of the scene. */
const kTurnRadius = 0.005;
/** Of a notch of the wheel, in radii of the scene. */
const kWheelStep = 0.06;

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
    this.controls.enableZoom = false; // it would end at the point one turns about
    this.controls.addEventListener("start", () => {
      this.moved.value = true;
      // Inside, what is under the pointer stays under it: the picture's height is the angle of view, not a whole turn.
      this.controls.rotateSpeed = this.isInside() ? -this.camera.fov / 360 : 1;
    });
    this.controls.addEventListener("change", () => this.tell());
    this.lifetime.add(() => this.controls.dispose(), this.state.watch((state) => this.set(state)));
    this.lifetime.listen(canvas, "keydown", (event) => this.key(event, true));
    this.lifetime.listen(canvas, "keyup", (event) => this.key(event, false));
    const wheel = (event: WheelEvent): void => {
      event.preventDefault();
      this.moved.value = true;
      this.step([-Math.sign(event.deltaY), 0, 0], kWheelStep);
    };
    canvas.addEventListener("wheel", wheel, { passive: false });
    this.lifetime.add(() => canvas.removeEventListener("wheel", wheel));
    this.lifetime.listen(canvas, "blur", () => this.pressed.clear());
  }

  get walking(): boolean {
    return this.pressed.size > 0;
  }

  /** Goes on by `seconds` while keys are held. */
  walk(seconds: number): void {
    const sum: [number, number, number] = [0, 0, 0];
    for (const code of this.pressed) kSteps[code]!.forEach((part, k) => (sum[k]! += part));
    this.step(sum, seconds * kWalkSpeed * (this.hurry ? kHurry : 1));
  }

  /** Along the way one looks, to the right, up; `radii` of the scene for 1. */
  private step([ahead, aside, above]: readonly [number, number, number], radii: number): void {
    const along = this.along();
    const right = along.clone().cross(this.camera.up).normalize();
    const step = along.multiplyScalar(ahead).addScaledVector(right, aside).addScaledVector(this.camera.up, above);
    step.multiplyScalar(radii * this.bounds.radius);
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

  private along(): Vector3 {
    return this.controls.target.clone().sub(this.camera.position).normalize();
  }

  private isInside(): boolean {
    return this.camera.position.distanceTo(this.bounds.center) < this.bounds.radius;
  }

  /** What dragging turns about: from outside the middle of the scene, inside it a point so near that one turns in place. */
  private pivot(along: Vector3): Vector3 {
    const { center, radius } = this.bounds;
    const eye = this.camera.position;
    const ahead = Math.min(Math.max(center.clone().sub(eye).dot(along), radius / 10), 4 * radius);
    return eye.clone().addScaledVector(along, this.isInside() ? kTurnRadius * radius : ahead);
  }

  /** From the controls to the signal. */
  private tell(): void {
    if (this.setting) return;
    const { position } = this.camera;
    // Told from afar, so that rounding the target does not turn the view.
    const target = this.isInside() ? position.clone().addScaledVector(this.along(), this.bounds.radius) : this.controls.target;
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
    this.controls.target.set(...state.target);
    this.controls.target.copy(this.pivot(this.along()));
    this.camera.fov = state.verticalFovDeg;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.setting = false;
  }
}
