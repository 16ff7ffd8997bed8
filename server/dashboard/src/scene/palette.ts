// Colours that stand for numbers. Both are even in lightness, so that equal steps look equal, and can be told apart by
// people who see few colours.

type Colour = readonly [number, number, number];

/** Viridis by S. van der Walt and N. Smith (matplotlib, CC0), at eleven points from low to high. */
const kViridis: readonly Colour[] = [
  [68, 1, 84], [72, 36, 117], [65, 68, 135], [53, 95, 141], [42, 120, 142], [33, 145, 140],
  [34, 168, 132], [68, 191, 112], [122, 209, 81], [189, 223, 38], [253, 231, 37],
];
/** Less, equal, more. */
const kDiverging: readonly Colour[] = [
  [33, 102, 172], [103, 169, 207], [209, 229, 240], [247, 247, 247], [253, 219, 199], [239, 138, 98], [178, 24, 43],
];

/** 0 .. 1 -> sRGB 0 .. 255. */
export function paletteColour(t: number, signed: boolean): Colour {
  const colours = signed ? kDiverging : kViridis;
  const x = Math.min(Math.max(t, 0), 1) * (colours.length - 1);
  const k = Math.min(Math.floor(x), colours.length - 2);
  const [from, to] = [colours[k]!, colours[k + 1]!];
  const mix = (c: 0 | 1 | 2) => from[c] + (x - k) * (to[c] - from[c]);
  return [mix(0), mix(1), mix(2)];
}

/** 256 x 2 texels, RGBA: the even scale below, the signed one above. */
export function paletteTexels(): Uint8Array<ArrayBuffer> {
  const texels = new Uint8Array(256 * 2 * 4);
  for (let row = 0; row < 2; ++row)
    for (let i = 0; i < 256; ++i) texels.set([...paletteColour(i / 255, row === 1), 255], 4 * (256 * row + i));
  return texels;
}

/** For CSS: the legend beside the picture. */
export function paletteGradient(signed: boolean): string {
  const stops = (signed ? kDiverging : kViridis).map(([r, g, b]) => `rgb(${r} ${g} ${b})`);
  return `linear-gradient(to right, ${stops.join(", ")})`;
}
