// GLSL ES 3.00. Patches, nodes and halves are rows of texels: number i is texel (i % width, i / width). Widths are powers
// of two: a division for every texel would cost software a third of its pace.
import { kHalfsShift, kTexelsShift } from "./texels";

const kTexel = `
ivec2 texelOf(uint i) { return ivec2(int(i & ${(1 << kTexelsShift) - 1}u), int(i >> ${kTexelsShift})); }
ivec2 halfOf(uint i) { return ivec2(int(i & ${(1 << kHalfsShift) - 1}u), int(i >> ${kHalfsShift})); }
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

/** Adds a term: sum + gain * mix(before, after). Half floats lie side by side, three to a patch. [W/m^2] */
export const kPatchFragment = `
precision highp float;
precision highp int;
precision highp sampler2D;
uniform sampler2D sum, before, after;
uniform vec3 gain;
uniform float weight, first;
out vec4 value;
${kTexel}
vec3 radiosity(sampler2D frame, uint patchId) {
  uint i = 3u * patchId;
  return vec3(texelFetch(frame, halfOf(i), 0).r, texelFetch(frame, halfOf(i + 1u), 0).r,
              texelFetch(frame, halfOf(i + 2u), 0).r);
}
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  uint id = uint((at.y << ${kTexelsShift}) + at.x);
  vec3 here = radiosity(before, id);
  if (weight > 0.0) here = mix(here, radiosity(after, id), weight);
  value = vec4(gain * here + (first > 0.5 ? vec3(0.0) : texelFetch(sum, at, 0).rgb), 1.0);
}
`;

/** Radiosity of a node: its row of the mesh's matrix times the patches. [W/m^2] */
export const kNodeFragment = `
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp usampler2D;
uniform sampler2D patches;
uniform usampler2D rowFirst, row;
uniform uint nodeCount;
out vec4 value;
${kTexel}
void main() {
  uint node = uint((int(gl_FragCoord.y) << ${kTexelsShift}) + int(gl_FragCoord.x));
  value = vec4(0.0);
  if (node >= nodeCount) return;
  uint end = texelFetch(rowFirst, texelOf(node + 1u), 0).r;
  for (uint k = texelFetch(rowFirst, texelOf(node), 0).r; k < end; ++k) {
    uvec2 entry = texelFetch(row, texelOf(k), 0).rg;
    value.rgb += uintBitsToFloat(entry.y) * texelFetch(patches, texelOf(entry.x), 0).rgb;
  }
}
`;

/** `corner`: 0 .. 3 of the patch's own. A triangle's lie at (0, 0), (1, 0), (0, 1) of its cell. */
export const kSurfaceVertex = `
precision highp float;
precision highp int;
precision highp usampler2D;
uniform mat4 modelViewMatrix, projectionMatrix;
uniform usampler2D patchNodes;
in vec3 position;
in uint patchId;
in float corner;
flat out uvec4 nodes;
flat out uint id;
out vec2 cell;
out vec3 seenAt;
${kTexel}
void main() {
  id = patchId;
  nodes = texelFetch(patchNodes, texelOf(patchId), 0);
  bool triangle = nodes.w == 0xffffffffu;
  cell = vec2(corner == 1.0 || (corner == 2.0 && !triangle) ? 1.0 : 0.0, corner >= 2.0 ? 1.0 : 0.0);
  vec4 seen = modelViewMatrix * vec4(position, 1.0);
  seenAt = seen.xyz;
  gl_Position = projectionMatrix * seen;
}
`;

/** What is drawn is chosen by `what`: 0 light, 1 false colour, 2 clay. */
export const kSurfaceFragment = `
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp usampler2D;
uniform sampler2D patches, nodeValues, palette, reflectance, marked;
uniform int what, toneMap;
uniform bool smoothShaded, borders, isBack, hasLight;
uniform vec4 scale;   // from, to, log, signed
uniform float exposure, filmicScale;
uniform vec3 tint;
flat in uvec4 nodes;
flat in uint id;
in vec2 cell;
in vec3 seenAt;
out vec4 colour;
${kTexel}
vec3 node(uint n) { return texelFetch(nodeValues, texelOf(n), 0).rgb; }
vec3 radiosity() {
  if (!hasLight) return vec3(0.0);
  if (!smoothShaded) return texelFetch(patches, texelOf(id), 0).rgb;
  vec2 at = clamp(cell, 0.0, 1.0);
  if (nodes.w == 0xffffffffu)
    return node(nodes.x) * max(1.0 - at.x - at.y, 0.0) + node(nodes.y) * at.x + node(nodes.z) * at.y;
  return mix(mix(node(nodes.x), node(nodes.y), at.x), mix(node(nodes.w), node(nodes.z), at.x), at.y);
}
vec3 hable(vec3 x) {
  return (x * (0.15 * x + 0.05) + 0.004) / (x * (0.15 * x + 0.5) + 0.06) - 0.02 / 0.3;
}
vec3 toneCurve(vec3 x) {
  if (toneMap == 0) return min(x, 1.0);
  return min(hable(min(filmicScale * x, 11.2)) / hable(vec3(11.2)), 1.0);
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
vec3 clay() {
  vec3 normal = normalize(cross(dFdx(seenAt), dFdy(seenAt)));
  vec4 material = texelFetch(reflectance, texelOf(id), 0);
  if (material.a > 0.5) return vec3(1.0, 0.85, 0.3);
  return srgb(material.rgb * (0.25 + 0.75 * abs(dot(normal, normalize(seenAt)))));
}
float edge() {
  vec2 wide = fwidth(cell);
  vec2 from = min(cell, 1.0 - cell) / wide;
  if (nodes.w == 0xffffffffu) from = vec2(min(cell.x / wide.x, cell.y / wide.y), (1.0 - cell.x - cell.y) / fwidth(cell.x + cell.y));
  // Cells of a few pixels would be nothing but borders.
  float room = 1.0 / max(max(wide.x, wide.y), 1e-6);
  return (1.0 - smoothstep(0.5, 1.5, min(from.x, from.y))) * smoothstep(3.0, 9.0, room);
}
void main() {
  if (isBack) {
    // One looks into a room from outside, and sees where its lamps are.
    bool emits = what == 2 && texelFetch(reflectance, texelOf(id), 0).a > 0.5;
    if (what == 2 && !emits) discard;
    colour = vec4(emits ? vec3(0.7, 0.6, 0.2) : vec3(0.0), 1.0);
    return;
  }
  vec3 shown = what == 0 ? srgb(toneCurve(max(radiosity(), 0.0) * exposure)) : what == 1 ? falseColour(radiosity()) : clay();
  shown = mix(shown, tint, what == 2 ? 0.45 * step(0.001, dot(tint, tint)) : 0.0);
  if (borders) shown *= 1.0 - 0.45 * edge();
  float mark = texelFetch(marked, texelOf(id), 0).r;
  if (mark > 0.0) shown = mix(shown, vec3(1.0, 0.45, 0.0), max(0.35, edge()));
  colour = vec4(shown, 1.0);
}
`;

/** Patch number + 1 as three bytes; 0 is nothing. */
export const kPickFragment = `
precision highp float;
precision highp int;
uniform bool isBack;
flat in uvec4 nodes;
flat in uint id;
in vec2 cell;
in vec3 seenAt;
out vec4 colour;
void main() {
  uint n = isBack ? 0u : id + 1u;
  colour = vec4(float(n & 255u), float((n >> 8) & 255u), float((n >> 16) & 255u), 255.0) / 255.0;
}
`;
