#include "viewer/gl/colour_scales.h"

#include <algorithm>
#include <cmath>

namespace meshfront {
namespace {

constexpr float kTurn = 6.2831853F;

float mixed(float from, float to, float share) {
  return from * (1 - share) + to * share;
}

// Hue in turns.
ShownColour fromLch(float lightness, float chroma, float hue) {
  const float a = chroma * std::cos(kTurn * hue);
  const float b = chroma * std::sin(kTurn * hue);
  const auto cube = [](float x) { return x * x * x; };
  const float l = cube(lightness + 0.3963377774F * a + 0.2158037573F * b);
  const float m = cube(lightness - 0.1055613458F * a - 0.0638541728F * b);
  const float s = cube(lightness - 0.0894841775F * a - 1.2914855480F * b);
  ShownColour colour = {4.0767416621F * l - 3.3077115913F * m + 0.2309699292F * s,
                        -1.2684380046F * l + 2.6097574011F * m - 0.3413193965F * s,
                        -0.0041960863F * l - 0.7034186147F * m + 1.7076147010F * s};
  for (float& c : colour) {
    c = std::clamp(c, 0.0F, 1.0F);
    c = c > 0.0031308F ? 1.055F * std::pow(c, 1 / 2.4F) - 0.055F : 12.92F * c;
  }
  return colour;
}

float levelShare(unsigned level, unsigned finest) {
  return std::min(static_cast<float>(level) / static_cast<float>(std::max(finest, 1U)), 1.0F);
}

uint32_t scrambled(uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352dU;
  x ^= x >> 15;
  x *= 0x846ca68bU;
  return x ^ (x >> 16);
}

}  // namespace

ShownColour treeColour(uint32_t tree, uint32_t instance) {
  const uint32_t bits = scrambled(tree + 0x9e3779b9U * (instance + 1));
  const float hue = static_cast<float>(bits & 0xffffU) / 65536;
  const float light = static_cast<float>(bits >> 24) / 255;
  return fromLch(mixed(0.56F, 0.84F, light), 0.105F, hue);
}

ShownColour levelColour(unsigned level, unsigned finestLevel) {
  const float x = levelShare(level, finestLevel);
  return fromLch(mixed(0.56F, 0.86F, 1 - std::abs(2 * x - 1)), 0.13F, mixed(0.07F, 0.73F, x));
}

ShownColour pixelColour(double pixels) {
  if (pixels < 1) return fromLch(0.45F, 0, 0);
  const auto most = static_cast<float>(std::log2(1 + kMostPixels));
  const float x = std::min((static_cast<float>(std::log2(1 + pixels)) - 1) / (most - 1), 1.0F);
  return fromLch(mixed(0.27F, 0.91F, x), mixed(0.12F, 0.16F, x), mixed(0.86F, 0.29F, x));
}

ShownColour missingColour(unsigned level, unsigned finestLevel, bool isLeaf) {
  if (isLeaf) return fromLch(0.80F, 0.012F, 0.70F);
  const float x = 1 - levelShare(level, finestLevel);
  return fromLch(mixed(0.86F, 0.56F, x), mixed(0.12F, 0.19F, x), mixed(0.26F, 0.07F, x));
}

const char* const kColourScaleShader = R"(
vec3 fromLch(float lightness, float chroma, float hue) {
  float a = chroma * cos(6.2831853 * hue);
  float b = chroma * sin(6.2831853 * hue);
  vec3 lms = vec3(lightness + 0.3963377774 * a + 0.2158037573 * b,
                  lightness - 0.1055613458 * a - 0.0638541728 * b,
                  lightness - 0.0894841775 * a - 1.2914855480 * b);
  lms = lms * lms * lms;
  return clamp(vec3(dot(lms, vec3(4.0767416621, -3.3077115913, 0.2309699292)),
                    dot(lms, vec3(-1.2684380046, 2.6097574011, -0.3413193965)),
                    dot(lms, vec3(-0.0041960863, -0.7034186147, 1.7076147010))), 0.0, 1.0);
}
float levelShare(uint level, uint finest) {
  return min(float(level) / float(max(finest, 1u)), 1.0);
}
uint scrambled(uint x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  return x ^ (x >> 16);
}
vec3 treeColour(uint tree, uint instance) {
  uint bits = scrambled(tree + 0x9e3779b9u * (instance + 1u));
  float hue = float(bits & 0xffffu) / 65536.0;
  return fromLch(mix(0.56, 0.84, float(bits >> 24) / 255.0), 0.105, hue);
}
vec3 levelColour(uint level, uint finest) {
  float x = levelShare(level, finest);
  return fromLch(mix(0.56, 0.86, 1.0 - abs(2.0 * x - 1.0)), 0.13, mix(0.07, 0.73, x));
}
vec3 pixelColour(uint pixels) {
  if (pixels == 0u) {
    return fromLch(0.45, 0.0, 0.0);
  }
  float x = min((log2(1.0 + float(pixels)) - 1.0) / 9.0, 1.0);
  return fromLch(mix(0.27, 0.91, x), mix(0.12, 0.16, x), mix(0.86, 0.29, x));
}
vec3 missingColour(uint level, uint finest, bool isLeaf) {
  if (isLeaf) {
    return fromLch(0.80, 0.012, 0.70);
  }
  float x = 1.0 - levelShare(level, finest);
  return fromLch(mix(0.86, 0.56, x), mix(0.12, 0.19, x), mix(0.26, 0.07, x));
}
)";

}  // namespace meshfront
