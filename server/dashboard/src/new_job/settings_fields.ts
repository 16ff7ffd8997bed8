// What the form asks for: where it goes in the job's JSON, its unit, its range and what it means, as
// api/schemas/job.schema.json says.
export interface NumberField {
  readonly kind: "number";
  readonly least: number;
  readonly most: number;
  readonly step?: number;
  readonly unit: string;
  readonly shown?: string;
}
export interface ChoiceField {
  readonly kind: "choice";
  readonly values: readonly (readonly [value: string, label: string])[];
}
export interface TickField {
  readonly kind: "tick";
}
export interface SettingsField {
  readonly pointer: string;
  readonly label: string;
  readonly help: string;
  readonly input: NumberField | ChoiceField | TickField;
}
export interface SettingsGroup {
  readonly title: string;
  readonly fields: readonly SettingsField[];
  /** Shown only when it is asked for. */
  readonly folded?: boolean;
}

const number = (least: number, most: number, unit: string, shown: string, step?: number): NumberField => ({ kind: "number", least, most, unit, shown, step });
const choice = (...values: (readonly [string, string])[]): ChoiceField => ({ kind: "choice", values });

export const kSettings: readonly SettingsGroup[] = [
  {
    title: "Quality",
    fields: [
      { pointer: "/lighting/preset", label: "Preset", help: "Starting values for all else: draft takes seconds, high minutes.",
        input: choice(["draft", "draft"], ["standard", "standard"], ["high", "high"]) },
      { pointer: "/lighting/target_error", label: "Target error", help: "Instead of line counts: work goes on until the noise is at most this share of the mean radiosity. 0.02 is 2 %.",
        input: number(0.001, 1, "of the mean", "none", 0.001) },
      { pointer: "/lighting/standard_errors", label: "Standard errors", help: "Also keep how sure every value is. Takes two to eight times as long.", input: { kind: "tick" } },
      { pointer: "/lighting/seed", label: "Seed", help: "The same job and seed give the same bytes.", input: number(0, 9007199254740991, "", "1", 1) },
    ],
  },
  {
    title: "Patches",
    fields: [
      { pointer: "/lighting/patch_edge_m", label: "Patch edge", help: "Surfaces are cut into patches with edges of at most this. Half the edge is four times the patches.",
        input: number(0.001, 10000, "m", "by preset", 0.001) },
      { pointer: "/lighting/patch_layout", label: "Layout", help: "Adaptive: finer where shadows fall, coarser where nothing happens.",
        input: choice(["uniform", "uniform"], ["adaptive", "adaptive"]) },
      { pointer: "/lighting/patch_count_max", label: "At most", help: "Adaptive layout only.", input: number(100, 20000000, "patches", "200000", 100) },
    ],
  },
  {
    title: "Key-frames",
    fields: [
      { pointer: "/lighting/mode", label: "Mode", help: "Default: as many key-frames as the tolerance needs. Reference: every frame is solved. Paper: Table 1 of Besuievsky and Pueyo.",
        input: choice(["default", "default"], ["reference", "reference"], ["paper", "paper"], ["paper-literal", "paper-literal"], ["frame-by-frame", "frame by frame"]) },
      { pointer: "/lighting/tolerance", label: "Tolerance", help: "Largest interpolation error, relative to the larger of the patch's radiosity and half the mean.",
        input: number(0.0001, 1, "", "0.05", 0.001) },
      { pointer: "/lighting/interpolation", label: "Interpolation", help: "Between two key-frames.", input: choice(["linear", "linear"], ["monotone-cubic", "monotone cubic"]) },
    ],
  },
  {
    title: "Pictures",
    fields: [
      { pointer: "/images/width", label: "Width", help: "Of all pictures the job asks for.", input: number(1, 8192, "pixels", "640", 1) },
      { pointer: "/images/height", label: "Height", help: "", input: number(1, 8192, "pixels", "360", 1) },
      { pointer: "/images/tone_map", label: "Tone map", help: "Filmic: bright light rolls off. Clip: cut at 1.", input: choice(["filmic", "filmic"], ["clip", "clip"]) },
      { pointer: "/images/samples_per_pixel", label: "Samples", help: "More are smoother at edges.", input: number(1, 64, "per pixel", "4", 1) },
    ],
  },
  {
    title: "Lines and samples",
    folded: true,
    fields: [
      { pointer: "/lighting/line_count", label: "Global lines", help: "Shared by every frame. Half the error is four times the lines.", input: number(1000, 1e9, "lines", "by preset", 1000) },
      { pointer: "/lighting/moving_line_count", label: "Of these for what moves", help: "", input: number(1000, 1e9, "lines", "by preset", 1000) },
      { pointer: "/lighting/samples_per_light", label: "Samples per light", help: "Shadow rays per patch and light: smoother penumbras.", input: number(1, 4096, "", "by preset", 1) },
      { pointer: "/lighting/estimate_patch_edge_m", label: "Edge in the estimate", help: "Of the coarse patches that choose the key-frames.", input: number(0.001, 10000, "m", "2", 0.01) },
      { pointer: "/lighting/estimate_line_count", label: "Lines of the estimate", help: "", input: number(1000, 1e8, "lines", "400000", 1000) },
    ],
  },
];

