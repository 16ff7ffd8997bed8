// What the parts of a job's page share. Each part is a folder of job/ with one function of this kind.
import type { Job } from "../api/types";
import type { Lifetime, Signal } from "../base/signal";
import type { FrameSource, LightingView, Term } from "../scene/lighting_view";
import type { ShadingMesh } from "../scene/shading_mesh";
import type { Playhead } from "./playhead";

/** The lighting in the browser; there once Walk has fetched the mesh of a job that has succeeded. */
export interface LightStage {
  readonly view: LightingView;
  readonly mesh: ShadingMesh;
  /** Of every patch: "radiosity", "radiosity_se", "radiosity_GROUP". The same source for the same name. */
  source(series: string): FrameSource;
  /** What is shown as light: the radiosity, or the groups of lights as bright as they are set. */
  readonly light: Signal<readonly Term[]>;
}

export interface JobContext {
  readonly id: string;
  /** Kept true as long as the page is open. */
  readonly job: Signal<Job>;
  readonly playhead: Playhead;
  readonly stage: Signal<LightStage | null>;
  /** Of the page. */
  readonly lifetime: Lifetime;
}

/** Returns at once with what can be shown at once. */
export type OpenJobPart = (context: JobContext) => HTMLElement;
