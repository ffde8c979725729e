// Colours that stand for numbers: of a tree, a level, a count of pixels, what is still missing. On
// the CPU for legends; the shaders compute the same (kColourScaleShader).
//
// All are made in OKLCH, a space of lightness, chroma and hue that are even to the eye
// (Ottosson 2020, "A perceptual color space for image processing").
#pragma once

#include <array>
#include <cstdint>

namespace meshfront {

using ShownColour = std::array<float, 3>;  // sRGB, 0 .. 1, before light falls on it

// A hue of its own for each tree; `instance` in the scene, as trees are numbered in each mesh.
[[nodiscard]] ShownColour treeColour(uint32_t tree, uint32_t instance = 0);
// From the coarsest, 0 (red), to the finest level of the mesh (blue).
[[nodiscard]] ShownColour levelColour(unsigned level, unsigned finestLevel);
// By the logarithm, from dark violet for 1 to yellow for kMostPixels and more; grey for none.
[[nodiscard]] ShownColour pixelColour(double pixels);
inline constexpr double kMostPixels = 1023;
// What is final is neutral; else the coarser the level, the more is missing and the redder it is.
[[nodiscard]] ShownColour missingColour(unsigned level, unsigned finestLevel, bool isLeaf);

// GLSL: vec3 treeColour(uint tree, uint instance), levelColour(uint level, uint finest),
// pixelColour(uint pixels), missingColour(uint level, uint finest, bool isLeaf): linear, not sRGB.
extern const char* const kColourScaleShader;

}  // namespace meshfront
