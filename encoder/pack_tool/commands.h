// The subcommands of meshfront-pack. Each prints to standard output and gives the exit status; a
// status other than 0 is an answer ("not equal"), an Error a failure.
#pragma once

#include <filesystem>
#include <string>

#include "shared/mesh/quantization.h"
#include "shared/mesh/vertex_attributes.h"
#include "shared/result.h"

namespace meshfront {

[[nodiscard]] Result<int> printInfo(const std::filesystem::path& pack, bool json);

// Decodes in many orders and compares with the mesh file.
[[nodiscard]] Result<int> verifyAgainst(const std::filesystem::path& pack,
                                        const std::filesystem::path& mesh, unsigned orders,
                                        bool json);

// Mesh files or packs, a mesh file on `bits` and `normalBits` unless one of them is a pack.
[[nodiscard]] Result<int> compareFiles(const std::filesystem::path& a,
                                       const std::filesystem::path& b, unsigned bits,
                                       unsigned normalBits, bool json);

// `node`: TREE:PATH, see node_name.h.
[[nodiscard]] Result<int> dumpNode(const std::filesystem::path& pack, const std::string& node,
                                   bool json);

// Static files of the interface, see static_export.h.
[[nodiscard]] Result<int> exportFiles(const std::filesystem::path& pack,
                                      const std::filesystem::path& folder, bool force);

}  // namespace meshfront
