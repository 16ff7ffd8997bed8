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
 * `grid`: first patch, stride, first place, rows, see grids.ts; no rows for a triangle, whose corners lie at (0, 0), (1, 0),
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

/** The cell one looks at: its patch, its first node, and where in it. */
const kCell = `
flat in ivec4 cells;
in vec2 place;
ivec2 cellAt(out vec2 inside) {
  ivec2 count = max(ivec2(abs(cells.y), cells.w), 1);
  vec2 within = clamp(place, vec2(0.0), vec2(count));
  ivec2 cell = min(ivec2(within), count - 1);
  inside = within - vec2(cell);
  return cell;
}
uint patchOf(ivec2 cell) { return uint(cells.x + cell.y * cells.y + cell.x); }
`;

/**
 * Variants are made by defines, since software runs all branches of a shader. WHAT: 0 light, 1 false colour, 2 clay;
 * FILMIC, SMOOTH, BORDERS, MARKED: as Display says; BACK: the black backs of what has but one side.
 */
export const kSurfaceFragment = `
precision highp float;
precision highp int;
precision highp sampler2D;
uniform sampler2D patches, nodeValues, palette, reflectance, marked;
uniform vec4 scale;   // from, to, log, signed
uniform float exposure, filmicScale;
uniform vec3 tint;
in vec3 seenAt;
out vec4 colour;
${kTexel}${kCell}
vec3 node(int n) { return texelFetch(nodeValues, texelOf(uint(n)), 0).rgb; }
vec3 radiosity(ivec2 cell, vec2 at) {
#ifdef SMOOTH
  bool triangle = cells.w == 0;
  int low = cells.z + cell.y * (abs(cells.y) + 1) + cell.x;
  int high = low + (triangle ? 2 : abs(cells.y) + 1);
  vec4 share = vec4((1.0 - at.x) * (1.0 - at.y), at.x * (1.0 - at.y), (1.0 - at.x) * at.y, at.x * at.y);
  if (triangle) share = vec4(max(1.0 - at.x - at.y, 0.0), at, 0.0);
  return share.x * node(low) + share.y * node(low + 1) + share.z * node(high) + share.w * node(high + (triangle ? 0 : 1));
#else
  return texelFetch(patches, texelOf(patchOf(cell)), 0).rgb;
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
float edge(vec2 at) {
  vec2 wide = fwidth(place);
  vec2 from = min(at, 1.0 - at) / wide;
  if (cells.w == 0) from = vec2(min(at.x / wide.x, at.y / wide.y), (1.0 - at.x - at.y) / fwidth(place.x + place.y));
  // Cells of a few pixels would be nothing but borders.
  float room = 1.0 / max(max(wide.x, wide.y), 1e-6);
  return (1.0 - smoothstep(0.5, 1.5, min(from.x, from.y))) * smoothstep(3.0, 9.0, room);
}
void main() {
#if defined(BACK) && WHAT != 2
  colour = vec4(0.0, 0.0, 0.0, 1.0);
#else
  vec2 at;
  ivec2 cell = cellAt(at);
#ifdef BACK
  // One looks into a room from outside, and sees where its lamps are.
  if (texelFetch(reflectance, texelOf(patchOf(cell)), 0).a < 0.5) discard;
  colour = vec4(0.7, 0.6, 0.2, 1.0);
#else
#if WHAT == 0
  vec3 shown = srgb(toneCurve(max(radiosity(cell, at), 0.0) * exposure));
#elif WHAT == 1
  vec3 shown = falseColour(radiosity(cell, at));
#else
  vec3 shown = clay(texelFetch(reflectance, texelOf(patchOf(cell)), 0));
#endif
#ifdef BORDERS
  shown *= 1.0 - 0.45 * edge(at);
#endif
#ifdef MARKED
  float mark = texelFetch(marked, texelOf(patchOf(cell)), 0).r;
  if (mark > 0.0) shown = mix(shown, vec3(1.0, 0.45, 0.0), max(0.35, edge(at)));
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
in vec3 seenAt;
out vec4 colour;
${kCell}
void main() {
#ifdef BACK
  uint n = 0u;
#else
  vec2 at;
  uint n = patchOf(cellAt(at)) + 1u;
#endif
  colour = vec4(float(n & 255u), float((n >> 8) & 255u), float((n >> 16) & 255u), 255.0) / 255.0;
}
`;
