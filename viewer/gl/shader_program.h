// GLSL sources to a linked program.
#pragma once

#include <string_view>

#include "shared/result.h"
#include "viewer/gl/gl_object.h"

namespace meshfront {

// `name` goes before the compiler's message.
[[nodiscard]] Result<GlProgram> drawProgram(std::string_view name, std::string_view vertexSource,
                                            std::string_view fragmentSource);
[[nodiscard]] Result<GlProgram> computeProgram(std::string_view name, std::string_view source);

}  // namespace meshfront
