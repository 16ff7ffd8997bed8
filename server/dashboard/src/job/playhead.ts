// What all parts of a job's page look at together: the moment, the patches chosen, the camera. Kept in the address
// (#frame=12&patch=345,7&cam=...) so that a link leads to the same sight.
import { Signal } from "../base/signal";

/** Where the walk's camera is: metres, world space. */
export interface CameraState {
  position: [number, number, number];
  target: [number, number, number];
  verticalFovDeg: number;
}

export class Playhead {
  /** In frames, 0 .. frameCount - 1; fractional while playing. */
  readonly time = new Signal(0);
  readonly playing = new Signal(false);
  /** Frames per second, < 0 backwards; the job's own at first. J, K and L change it. */
  readonly speed: Signal<number>;
  readonly loop = new Signal(true);
  /** Patches whose radiosity is plotted, in the order they were chosen. */
  readonly pinned = new Signal<readonly number[]>([]);
  /** Null: the first camera of the job at this frame. */
  readonly camera = new Signal<CameraState | null>(null);

  constructor(
    readonly frameCount: number,
    private framesPerSecond: number,
  ) {
    this.speed = new Signal(framesPerSecond);
  }

  /** The job's own pace. */
  get fps(): number {
    return this.framesPerSecond;
  }

  set fps(fps: number) {
    this.framesPerSecond = fps;
    if (!this.playing.value) this.speed.value = fps;
  }

  /** The stored frame that is shown, or nearest to what is. */
  get frame(): number {
    return Math.round(this.time.value);
  }
}
