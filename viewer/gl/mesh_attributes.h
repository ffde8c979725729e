// What a mesh's vertex array and the shaders agree on: attribute locations, by number in the GLSL.
#pragma once

namespace meshfront {

inline constexpr unsigned kPositionAttribute = 0;  // ivec3, grid
inline constexpr unsigned kFromAttribute = 1;      // ivec3, grid: where it slides from
inline constexpr unsigned kNormalAttribute = 2;    // vec3
inline constexpr unsigned kColourAttribute = 3;    // vec4, sRGB and alpha
inline constexpr unsigned kTreeAttribute = 4;      // uint
inline constexpr unsigned kStateAttribute = 5;     // uvec4: level, is a leaf, depth
inline constexpr unsigned kBirthAttribute = 6;     // float, seconds: when it began to slide
inline constexpr unsigned kPixelAttribute = 7;     // uint: pixels counted
inline constexpr unsigned kPixelBinding = 3;       // the buffer binding of the last one

}  // namespace meshfront
