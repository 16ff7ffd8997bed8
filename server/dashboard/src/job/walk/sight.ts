// How the walk shows what it shows.
import type { Display } from "../../scene/lighting_view";
import type { ShadingMesh } from "../../scene/shading_mesh";

/** Light and false colour show the radiosity, the error its standard error, in false colour as well. */
export const kModes = [
  { name: "light", label: "Light" },
  { name: "false-colour", label: "False colour" },
  { name: "error", label: "Standard error" },
  { name: "clay", label: "Surfaces" },
] as const;
export type Mode = (typeof kModes)[number]["name"];

export interface Sight {
  readonly mode: Mode;
  readonly display: Partial<Display>;
}

/** The mean radiosity of the sequence [W/m^2], which auto exposure brings to middle grey. */
export function meanRadiosity(mesh: ShadingMesh): number {
  return (0.18 * Math.PI) / mesh.autoExposure;
}

/** A scale of false colours: four decades around the mean for light, from a thousandth of it for errors. */
export function usualScale(mode: Mode, mesh: ShadingMesh): Display["scale"] {
  const mean = meanRadiosity(mesh);
  if (mode === "error") return { from: mean / 1000, to: mean / 2, log: true, signed: false };
  return { from: mean / 30, to: mean * 30, log: true, signed: false };
}

export function firstSight(mesh: ShadingMesh): Sight {
  return {
    mode: "light",
    display: { what: "light", exposureStops: 0, toneMap: "filmic", smooth: true, borders: false, scale: usualScale("light", mesh) },
  };
}

export function inMode(sight: Sight, mode: Mode, mesh: ShadingMesh): Sight {
  const what = mode === "light" || mode === "clay" ? mode : "false-colour";
  return { mode, display: { ...sight.display, what, scale: usualScale(mode, mesh) } };
}
