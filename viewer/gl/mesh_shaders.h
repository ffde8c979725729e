// The GLSL of MeshRenderer. Positions are grid points; `anchor` is one near the eye and is
// subtracted as integers, so that nothing is lost close to the surface of a fine grid.
//
// What a program needs beyond the plain one is switched on by defines: SLIDES (vertices move from
// `from` to `position`), SCALE (coloured by a number), SCREEN_DOOR (translucent), WIREFRAME.
// Attribute locations are those of mesh_attributes.h.
#pragma once

namespace meshfront {

// Where a vertex is shown, for all programs alike: what is drawn in two passes falls on the same
// pixels.
inline constexpr char kPlaceShader[] = R"(
uniform ivec3 anchor;
uniform mat4 clipFromGrid;  // from grid steps relative to the anchor
uniform float slideNow;     // seconds, on the births' clock
uniform float slideSeconds;
// Relative to the anchor.
vec3 slid(ivec3 from, ivec3 position, float birth) {
  float t = clamp((slideNow - birth) / slideSeconds, 0.0, 1.0);
  vec3 there = vec3(position - anchor);
  return t < 1.0 ? mix(vec3(from - anchor), there, t * t * (3.0 - 2.0 * t)) : there;
}
)";

inline constexpr char kVertexPlaceShader[] = R"(
layout(location = 0) in ivec3 position;
#ifdef SLIDES
layout(location = 1) in ivec3 from;
layout(location = 6) in float birth;
vec4 placed() {
  return vec4(slid(from, position, birth), 1.0);
}
#else
vec4 placed() {
  return vec4(vec3(position - anchor), 1.0);
}
#endif
invariant gl_Position;
)";

inline constexpr char kMeshVertexShader[] = R"(
layout(location = 2) in vec3 normal;
layout(location = 3) in vec4 own;  // colour, sRGB
uniform mat4 viewFromGrid;
uniform mat3 viewFromNormal;
out vec3 viewPosition;
out vec3 viewNormal;
out vec4 ownColour;
#ifdef SCALE
layout(location = 4) in uint tree;
layout(location = 5) in uvec4 state;
layout(location = 7) in uint pixels;
uniform int scale;  // as Colouring
uniform uint finestLevel;
uniform uint instance;
out vec3 scaleColour;
#endif
void main() {
  ownColour = own;
  vec4 p = placed();
  gl_Position = clipFromGrid * p;
  viewPosition = (viewFromGrid * p).xyz;
  viewNormal = viewFromNormal * normal;
#ifdef SCALE
  scaleColour = scale == 1   ? treeColour(tree, instance)
                : scale == 2 ? levelColour(state.y != 0u ? finestLevel : state.x, finestLevel)
                : scale == 3 ? pixelColour(pixels)
                             : missingColour(state.x, finestLevel, state.y != 0u);
#endif
}
)";

// A share of `alpha` of the pixels, by ordered dither: the nearest of what is left is seen, so that
// each pixel still shows one triangle, in whatever order they come.
inline constexpr char kScreenDoorShader[] = R"(
bool letThrough(float alpha) {
  uvec2 at = uvec2(gl_FragCoord.xy);
  uint x = at.x ^ at.y;
  uint rank = (x & 1u) << 5 | (at.y & 1u) << 4 | (x & 2u) << 2 | (at.y & 2u) << 1 |
              (x & 4u) >> 1 | (at.y & 4u) >> 2;
  return alpha < (float(rank) + 0.5) / 64.0;
}
)";

// Clay, or the mesh's own colours, under a light that the viewer carries: a wide key light from
// above the left shoulder, a weak fill from the other side, and a sky that is brighter than the
// ground.
inline constexpr char kMeshFragmentShader[] = R"(
in vec3 viewPosition;
in vec3 viewNormal;
in vec4 ownColour;
#ifdef SCALE
in vec3 scaleColour;
#endif
uniform bool flatShading;
uniform bool colours;
uniform uint firstItem;
layout(location = 0) out vec4 colour;
layout(location = 1) out uint item;

const vec3 kClay = vec3(0.56, 0.37, 0.26);  // linear
const vec3 kKeyDirection = vec3(-0.45, 0.55, 0.70);
const vec3 kFillDirection = vec3(0.85, -0.05, 0.45);

vec3 surfaceNormal() {
  // On the side of the viewer whichever way the triangle is turned.
  vec3 facet = normalize(cross(dFdx(viewPosition), dFdy(viewPosition)));
  float length2 = dot(viewNormal, viewNormal);
  if (flatShading || length2 == 0.0) {
    return facet;
  }
  return viewNormal * inversesqrt(length2) * (gl_FrontFacing ? 1.0 : -1.0);
}

vec3 decoded(vec3 srgb) {
  return mix(srgb / 12.92, pow((srgb + 0.055) / 1.055, vec3(2.4)),
             greaterThan(srgb, vec3(0.04045)));
}

vec3 surfaceColour() {
#ifdef SCALE
  return scaleColour;
#else
  return colours ? decoded(ownColour.rgb) : kClay;
#endif
}

vec3 shaded(vec3 n) {
  vec3 toEye = normalize(-viewPosition);
  vec3 key = normalize(kKeyDirection);
  float keyed = max((dot(n, key) + 0.08) / 1.08, 0.0);
  float filled = max(dot(n, normalize(kFillDirection)), 0.0);
  vec3 sky = mix(vec3(0.055, 0.045, 0.045), vec3(0.13, 0.15, 0.18), 0.5 + 0.5 * n.y);
  vec3 light = sky + keyed * vec3(0.98, 0.94, 0.88) + filled * vec3(0.10, 0.115, 0.15);
  float gloss = pow(max(dot(n, normalize(key + toEye)), 0.0), 32.0) * 0.06;
  float rim = pow(1.0 - clamp(dot(n, toEye), 0.0, 1.0), 4.0) * 0.06;
  return surfaceColour() * light + gloss + rim;
}

vec3 encoded(vec3 linear) {
  return mix(12.92 * linear, 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055,
             greaterThan(linear, vec3(0.0031308)));
}

#ifdef WIREFRAME
layout(std430, binding = 0) readonly buffer Corners { uint corners[]; };
layout(std430, binding = 1) readonly buffer Positions { int positions[]; };
uniform vec2 halfPicture;  // pixels
#ifdef SLIDES
layout(std430, binding = 2) readonly buffer Rest { int rest[]; };
layout(std430, binding = 3) readonly buffer Births { float births[]; };
const uint kRestWords = 9u;
#endif

// A corner in homogeneous pixels; good behind the eye too.
vec3 cornerOnPicture(uint corner) {
  uint slot = corners[3u * uint(gl_PrimitiveID) + corner];
  ivec3 p = ivec3(positions[3u * slot], positions[3u * slot + 1u], positions[3u * slot + 2u]);
#ifdef SLIDES
  uint at = kRestWords * slot;
  vec3 place = slid(ivec3(rest[at], rest[at + 1u], rest[at + 2u]), p, births[slot]);
#else
  vec3 place = vec3(p - anchor);
#endif
  vec4 c = clipFromGrid * vec4(place, 1.0);
  return vec3((c.xy + c.w) * halfPicture, c.w);
}

// How much of this pixel an edge covers; fades out where triangles are too small to be told apart.
float edgeCover() {
  vec3 c[3] = vec3[3](cornerOnPicture(0u), cornerOnPicture(1u), cornerOnPicture(2u));
  float nearest = 1e9;
  float height = 1e9;
  for (int i = 0; i < 3; ++i) {
    vec3 line = cross(c[(i + 1) % 3], c[(i + 2) % 3]);
    line /= max(length(line.xy), 1e-30);
    nearest = min(nearest, abs(dot(line, vec3(gl_FragCoord.xy, 1.0))));
    if (c[i].z > 0.0) {
      height = min(height, abs(dot(line, c[i] / c[i].z)));
    }
  }
  return (1.0 - smoothstep(0.3, 1.1, nearest)) * smoothstep(1.5, 7.0, height);
}
#endif

void main() {
  vec3 shown = clamp(encoded(shaded(surfaceNormal())), 0.0, 1.0);
#ifdef WIREFRAME
  shown = mix(shown, vec3(0.10, 0.12, 0.16), 0.75 * edgeCover());
#endif
#ifdef SCREEN_DOOR
  if (letThrough(ownColour.a)) {
    discard;
  }
#endif
  colour = vec4(shown, 1.0);
  item = firstItem + uint(gl_PrimitiveID);
}
)";

inline constexpr char kItemVertexShader[] = R"(
#ifdef SCREEN_DOOR
layout(location = 3) in vec4 own;
out vec4 ownColour;
#endif
void main() {
#ifdef SCREEN_DOOR
  ownColour = own;
#endif
  gl_Position = clipFromGrid * placed();
}
)";

inline constexpr char kItemFragmentShader[] = R"(
#ifdef SCREEN_DOOR
in vec4 ownColour;
#endif
uniform uint firstItem;
layout(location = 1) out uint item;
void main() {
#ifdef SCREEN_DOOR
  if (letThrough(ownColour.a)) {
    discard;
  }
#endif
  item = firstItem + uint(gl_PrimitiveID);
}
)";

}  // namespace meshfront
