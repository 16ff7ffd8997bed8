// The stages of a job in their order, and the share of its time that each usually takes: the widths of the progress
// bar. The true shares differ by job; the number beside the bar is the service's own.
import type { Job } from "../api/types";

export type StageName = NonNullable<Job["progress"]["stage"]>;

export interface Stage {
  name: StageName;
  label: string;
  share: number;
}

export const stages: readonly Stage[] = [
  { name: "scene", label: "Reading the scene", share: 1 },
  { name: "patches", label: "Cutting into patches", share: 1 },
  { name: "estimate", label: "Estimating the lighting", share: 4 },
  { name: "keyframes", label: "Choosing key-frames", share: 1 },
  { name: "direct", label: "Direct light", share: 12 },
  { name: "solve", label: "Solving key-frames", share: 8 },
  { name: "interpolate", label: "Interpolating", share: 2 },
  { name: "images", label: "Rendering images", share: 6 },
  { name: "publish", label: "Publishing", share: 1 },
];

export function labelOf(stage: StageName | null): string {
  return stages.find(({ name }) => name === stage)?.label ?? "Starting";
}
