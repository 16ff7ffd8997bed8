// GLSL ES 3.00. Patches and places are rows of texels: number i is texel (i % width, i / width). The width is a power of
// two: a division for every texel would cost software a third of its pace.
import { kTexelsShift } from "./texels";

const kTexel = `
ivec2 texelOf(uint i) { return ivec2(int(i & ${(1 << kTexelsShift) - 1}u), int(i >> ${kTexelsShift})); }
`;

/** One triangle over the whole target. */
export const kWholeTargetVertex = `
in vec3 position;
void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }
`;

/** The same picture. */
export const kCopyFragment = `
precision highp float;
precision highp sampler2D;
uniform sampler2D picture;
out vec4 colour;
void main() { colour = texelFetch(picture, ivec2(gl_FragCoord.xy), 0); }
`;

/** Adds a term: sum + gain * mix(before, after). [W/m^2] */
export const kPatchFragment = `
precision highp float;
precision highp sampler2D;
uniform sampler2D sum, before, after;
uniform vec3 gain;
uniform float weight;
out vec4 value;
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  value.rgb = texelFetch(before, at, 0).rgb;
#ifdef MIXED
  value.rgb = mix(value.rgb, texelFetch(after, at, 0).rgb, weight);
#endif
  value = vec4(gain * value.rgb, 1.0);
#ifdef FURTHER
  value.rgb += texelFetch(sum, at, 0).rgb;
#endif
}
`;

/** Radiosity at a place: the row of its node in the mesh's matrix times the patches; rows have four parts, few have MORE. [W/m^2] */
export const kNodeFragment = `
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp usampler2D;
uniform sampler2D patches, shares;
uniform usampler2D around, span, row;
out vec4 value;
${kTexel}
vec3 patchAt(uint n) { return texelFetch(patches, texelOf(n), 0).rgb; }
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  uvec4 four = texelFetch(around, at, 0);
  vec4 share = texelFetch(shares, at, 0);
  value = vec4(share.x * patchAt(four.x) + share.y * patchAt(four.y) + share.z * patchAt(four.z) + share.w * patchAt(four.w), 1.0);
#ifdef MORE
  uvec2 parts = texelFetch(span, at, 0).rg;
  for (uint k = parts.x; k < parts.y; ++k) {
    uvec2 entry = texelFetch(row, texelOf(k), 0).rg;
    value.rgb += uintBitsToFloat(entry.y) * patchAt(entry.x);
  }
#endif
}
`;

/**
 * `grid`: first, stride, first place, rows, see grids.ts; no rows for a triangle, whose corners lie at (0, 0), (1, 0),
 * (0, 1). `corner`: in cells.
 */
export const kSurfaceVertex = `
precision highp float;
precision highp int;
uniform mat4 modelViewMatrix, projectionMatrix;
in vec3 position;
in ivec4 grid;
in vec2 corner;
flat out ivec4 cells;
out vec2 place;
out vec3 seenAt;
void main() {
  cells = grid;
  place = corner;
  vec4 seen = modelViewMatrix * vec4(position, 1.0);
  seenAt = seen.xyz;
  gl_Position = projectionMatrix * seen;
}
`;

/** The cell one looks at: its patch, the places of its corners, and where in it. MOSAIC: cells of several sizes. */
const kCell = `
uniform usampler2D units;
flat in ivec4 cells;
in vec2 place;
struct Cell {
  uint patchId;
  int low, high;    // places of its corners (0, 0) and (0, 1); one on: (1, 0) and (1, 1)
  vec2 at;          // 0 .. 1
  float size;       // where cells are of one size 1
  bool triangle;
};
Cell cellHere() {
  int columns = abs(cells.y);
  ivec2 count = max(ivec2(columns, cells.w), 1);
  vec2 within = clamp(place, vec2(0.0), vec2(count));
  ivec2 unit = min(ivec2(within), count - 1);
  int n = cells.x + unit.y * cells.y + unit.x;
#ifdef MOSAIC
  uvec2 tile = texelFetch(units, texelOf(uint(n)), 0).rg;
  int size = 1 << (tile.y & 15u), low = int(tile.y >> 4);
  ivec2 origin = unit & ~(size - 1);
  return Cell(tile.x, low, low + 2, (within - vec2(origin)) / float(size), float(size), false);
#else
  bool triangle = cells.w == 0;
  int low = cells.z + unit.y * (columns + 1) + unit.x;
  return Cell(uint(n), low, low + (triangle ? 2 : columns + 1), within - vec2(unit), 1.0, triangle);
#endif
}
`;

/**
 * Variants are made by defines, since software runs all branches of a shader. WHAT: 0 light, 1 false colour, 2 clay;
 * FILMIC, SMOOTH, BORDERS, MARKED: as Display says; BACK: the black backs of what has but one side.
 */
export const kSurfaceFragment = `
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp usampler2D;
uniform sampler2D patches, nodeValues, palette, reflectance, marked;
uniform vec4 scale;   // from, to, log, signed
uniform float exposure, filmicScale;
uniform vec3 tint;
in vec3 seenAt;
out vec4 colour;
${kTexel}${kCell}
vec3 node(int n) { return texelFetch(nodeValues, texelOf(uint(n)), 0).rgb; }
vec3 radiosity(Cell cell) {
#ifdef SMOOTH
  vec2 at = cell.at;
  vec4 share = vec4((1.0 - at.x) * (1.0 - at.y), at.x * (1.0 - at.y), (1.0 - at.x) * at.y, at.x * at.y);
  if (cell.triangle) share = vec4(max(1.0 - at.x - at.y, 0.0), at, 0.0);
  return share.x * node(cell.low) + share.y * node(cell.low + 1)
      + share.z * node(cell.high) + share.w * node(cell.high + (cell.triangle ? 0 : 1));
#else
  return texelFetch(patches, texelOf(cell.patchId), 0).rgb;
#endif
}
vec3 hable(vec3 x) {
  return (x * (0.15 * x + 0.05) + 0.004) / (x * (0.15 * x + 0.5) + 0.06) - 0.02 / 0.3;
}
vec3 toneCurve(vec3 x) {
#ifdef FILMIC
  return min(hable(min(filmicScale * x, 11.2)) / hable(vec3(11.2)), 1.0);
#else
  return min(x, 1.0);
#endif
}
vec3 srgb(vec3 light) {
  return mix(12.92 * light, 1.055 * pow(max(light, 0.0), vec3(1.0 / 2.4)) - 0.055, step(0.0031308, light));
}
vec3 falseColour(vec3 b) {
  float y = dot(b, vec3(0.2126, 0.7152, 0.0722));
  float t = scale.w > 0.5 ? 0.5 + 0.5 * y / scale.y
          : scale.z > 0.5 ? log(max(y, 1e-30) / scale.x) / log(scale.y / scale.x)
                          : (y - scale.x) / (scale.y - scale.x);
  return texture(palette, vec2(clamp(t, 0.002, 0.998), scale.w > 0.5 ? 0.75 : 0.25)).rgb;
}
vec3 clay(vec4 material) {
  if (material.a > 0.5) return vec3(1.0, 0.85, 0.3);
  vec3 normal = normalize(cross(dFdx(seenAt), dFdy(seenAt)));
  vec3 lit = srgb(material.rgb * (0.25 + 0.75 * abs(dot(normal, normalize(seenAt)))));
  return mix(lit, tint, 0.45 * step(0.001, dot(tint, tint)));
}
float edge(Cell cell) {
  vec2 wide = fwidth(place) / cell.size;
  vec2 from = min(cell.at, 1.0 - cell.at) / wide;
  if (cell.triangle)
    from = vec2(min(cell.at.x / wide.x, cell.at.y / wide.y), (1.0 - cell.at.x - cell.at.y) / fwidth(place.x + place.y));
  // Cells of a few pixels would be nothing but borders.
  float room = 1.0 / max(max(wide.x, wide.y), 1e-6);
  return (1.0 - smoothstep(0.5, 1.5, min(from.x, from.y))) * smoothstep(3.0, 9.0, room);
}
void main() {
#if defined(BACK) && WHAT != 2
  colour = vec4(0.0, 0.0, 0.0, 1.0);
#else
  Cell cell = cellHere();
#ifdef BACK
  // One looks into a room from outside, and sees where its lamps are.
  if (texelFetch(reflectance, texelOf(cell.patchId), 0).a < 0.5) discard;
  colour = vec4(0.7, 0.6, 0.2, 1.0);
#else
#if WHAT == 0
  vec3 shown = srgb(toneCurve(max(radiosity(cell), 0.0) * exposure));
#elif WHAT == 1
  vec3 shown = falseColour(radiosity(cell));
#else
  vec3 shown = clay(texelFetch(reflectance, texelOf(cell.patchId), 0));
#endif
#ifdef BORDERS
  shown *= 1.0 - 0.45 * edge(cell);
#endif
#ifdef MARKED
  float mark = texelFetch(marked, texelOf(cell.patchId), 0).r;
  if (mark > 0.0) shown = mix(shown, vec3(1.0, 0.45, 0.0), max(0.35, edge(cell)));
#endif
  colour = vec4(shown, 1.0);
#endif
#endif
}
`;

/** Patch number + 1 as three bytes; 0 is nothing. */
export const kPickFragment = `
precision highp float;
precision highp int;
precision highp usampler2D;
in vec3 seenAt;
out vec4 colour;
${kTexel}${kCell}
void main() {
#ifdef BACK
  uint n = 0u;
#else
  uint n = cellHere().patchId + 1u;
#endif
  colour = vec4(float(n & 255u), float((n >> 8) & 255u), float((n >> 16) & 255u), 255.0) / 255.0;
}
`;
