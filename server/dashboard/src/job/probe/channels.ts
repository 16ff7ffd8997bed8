// One number from three.
export const kChannels = [
  { name: "luminance", label: "Luminance" },
  { name: "red", label: "Red" },
  { name: "green", label: "Green" },
  { name: "blue", label: "Blue" },
] as const;
export type Channel = (typeof kChannels)[number]["name"];

/** Null: not finite, as JSON cannot say it. */
type Rgb = readonly (number | null)[];

/** Y of Rec. 709. */
const kLuminance = [0.2126, 0.7152, 0.0722] as const;

export function channelOf(rgb: Rgb, channel: Channel): number {
  const [r, g, b] = [rgb[0] ?? 0, rgb[1] ?? 0, rgb[2] ?? 0];
  if (channel === "red") return r;
  if (channel === "green") return g;
  if (channel === "blue") return b;
  return kLuminance[0] * r + kLuminance[1] * g + kLuminance[2] * b;
}

/** Channels share their lines, so their errors go together: that of the luminance is at most this. */
export function errorOf(rgb: Rgb, channel: Channel): number {
  return channelOf(rgb, channel);
}
