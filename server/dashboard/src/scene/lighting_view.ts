// The contract of the WebGL view: a mesh, weighted sums of radiosity series, a moment, a camera, a way of showing.
import type { CameraState } from "../job/playhead";
import type { Signal } from "../base/signal";

export type Rgb = readonly [number, number, number];

/** Radiosity (or its standard error) of every patch in every frame, fetched as half floats when it is needed. */
export interface FrameSource {
  readonly frameCount: number;
  readonly patchCount: number;
  /** Stored value x this = W/m^2. */
  readonly halfScale: number;
  /** (patches, 3) half floats of a frame, if it is here. */
  cached(frame: number): Uint16Array | null;
  /** Rejects where it cannot be fetched. */
  load(frame: number): Promise<Uint16Array>;
  /** Fetches what is missing of the next `count` frames, some at a time; asked often, it costs nothing. */
  prefetch(frame: number, direction: 1 | -1, count: number): void;
  /** [W/m^2] of one patch in a frame that is here, else null. */
  value(patch: number, frame: number): Rgb | null;
}

/** Shown is the sum of gain x source over all terms: relighting has a term per light group, a difference gain -1. */
export interface Term {
  source: FrameSource;
  gain: Rgb;
}

export interface Display {
  /** Light as a camera sees it; its luminance as false colour [W/m^2]; or the reflectance, lit from the eye. */
  what: "light" | "false-colour" | "clay";
  /** In clay: objects that ever move are tinted. */
  tintMoving: boolean;
  /** The job's cameras and the lights that have no surface are drawn. */
  marks: boolean;
  /** Stops on top of the job's own exposure. */
  exposureStops: number;
  toneMap: "clip" | "filmic";
  /** Blended between the patches as the pictures are, or one colour per patch. */
  smooth: boolean;
  borders: boolean;
  /** Of false colour [W/m^2]; log from `from` > 0. With `signed`, -to .. to from blue to red. */
  scale: { from: number; to: number; log: boolean; signed: boolean };
}

export interface Picked {
  patch: number;
  object: number;
  /** World space [m]. */
  position: Rgb;
}

/** Told by the canvas as the event "drawn" after every picture: what the bench counts. */
export interface Drawn {
  /** In frames. */
  readonly time: number;
  /** The light of this very moment was there, not that of a neighbour. */
  readonly exact: boolean;
}

export interface LightingView {
  readonly canvas: HTMLCanvasElement;
  /** Lists are compared by identity: another list is another light. */
  setTerms(terms: readonly Term[]): void;
  /** In frames, fractional: the shader mixes the two stored frames around it. Shows the nearest loaded one until both are here. */
  setTime(frame: number): void;
  setDisplay(display: Partial<Display>): void;
  readonly camera: Signal<CameraState>;
  /** The job's own camera `name` as time goes on, until the user moves or it is null. */
  followCamera(name: string | null): void;
  /** The camera that is followed. */
  readonly following: Signal<string | null>;
  /** From outside, so that everything is seen. */
  showAll(): void;
  setHighlighted(patches: readonly number[]): void;
  /** Why light that is wanted could not be fetched; null while all is well. */
  readonly trouble: Signal<string | null>;
  /** At a point of the canvas in CSS pixels. */
  pick(x: number, y: number): Picked | null;
  dispose(): void;
}
