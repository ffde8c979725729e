// The GLSL of MeshRenderer. Positions are grid points; `anchor` is one near the eye and is
// subtracted as integers, so that nothing is lost close to the surface of a fine grid.
#pragma once

namespace meshfront {

inline constexpr char kMeshVertexShader[] = R"(#version 450 core
layout(location = 0) in ivec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 own;  // colour, sRGB
uniform ivec3 anchor;
uniform mat4 clipFromGrid;  // from grid steps relative to the anchor
uniform mat4 viewFromGrid;
out vec3 viewPosition;
out vec3 viewNormal;
out vec3 ownColour;
void main() {
  ownColour = own;
  vec4 p = vec4(vec3(position - anchor), 1.0);
  gl_Position = clipFromGrid * p;
  viewPosition = (viewFromGrid * p).xyz;
  viewNormal = mat3(viewFromGrid) * normal;
}
)";

// Clay, or the mesh's own colours, under a light that the viewer carries: a wide key light from
// above the left shoulder, a weak fill from the other side, and a sky that is brighter than the
// ground.
inline constexpr char kMeshFragmentShader[] = R"(
in vec3 viewPosition;
in vec3 viewNormal;
in vec3 ownColour;
uniform bool flatShading;
uniform bool colours;
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

vec3 shaded(vec3 n) {
  vec3 toEye = normalize(-viewPosition);
  vec3 key = normalize(kKeyDirection);
  float keyed = max((dot(n, key) + 0.08) / 1.08, 0.0);
  float filled = max(dot(n, normalize(kFillDirection)), 0.0);
  vec3 sky = mix(vec3(0.055, 0.045, 0.045), vec3(0.13, 0.15, 0.18), 0.5 + 0.5 * n.y);
  vec3 light = sky + keyed * vec3(0.98, 0.94, 0.88) + filled * vec3(0.10, 0.115, 0.15);
  float gloss = pow(max(dot(n, normalize(key + toEye)), 0.0), 32.0) * 0.06;
  float rim = pow(1.0 - clamp(dot(n, toEye), 0.0, 1.0), 4.0) * 0.06;
  vec3 surface = colours ? decoded(ownColour) : kClay;
  return surface * light + gloss + rim;
}

vec3 encoded(vec3 linear) {
  return mix(12.92 * linear, 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055,
             greaterThan(linear, vec3(0.0031308)));
}

#ifdef WIREFRAME
layout(std430, binding = 0) readonly buffer Corners { uint corners[]; };
layout(std430, binding = 1) readonly buffer Positions { int positions[]; };
uniform ivec3 anchor;
uniform mat4 clipFromGrid;
uniform vec2 halfPicture;  // pixels

// A corner in homogeneous pixels; good behind the eye too.
vec3 cornerOnPicture(uint corner) {
  uint at = 3u * corners[3u * uint(gl_PrimitiveID) + corner];
  ivec3 p = ivec3(positions[at], positions[at + 1u], positions[at + 2u]);
  vec4 c = clipFromGrid * vec4(vec3(p - anchor), 1.0);
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
  colour = vec4(shown, 1.0);
  item = uint(gl_PrimitiveID) + 1u;
}
)";

inline constexpr char kItemVertexShader[] = R"(#version 450 core
layout(location = 0) in ivec3 position;
uniform ivec3 anchor;
uniform mat4 clipFromGrid;
void main() {
  gl_Position = clipFromGrid * vec4(vec3(position - anchor), 1.0);
}
)";

inline constexpr char kItemFragmentShader[] = R"(#version 450 core
layout(location = 1) out uint item;
void main() {
  item = uint(gl_PrimitiveID) + 1u;
}
)";

}  // namespace meshfront
