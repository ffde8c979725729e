// The constant resources of the interface as files, so that any host of static files serves a mesh
// by chunks, each under its URL:
//
//   DIR/v1/meshes/index.html                         the catalogue, of this mesh alone (JSON)
//   DIR/v1/meshes/MESH/index.html                    metadata (JSON)
//   DIR/v1/meshes/MESH/REVISION/base
//   DIR/v1/meshes/MESH/REVISION/chunks/index.html    the chunk index (binary)
//   DIR/v1/meshes/MESH/REVISION/chunks/0, 1, ...
//
// Where a resource's URL is also that of a folder, its file is the folder's index page: hosts send
// that, most after a redirect to the URL with a slash at its end. The same content lies beside it
// as index.json or index.bin for hosts that can be told which index page to take and which type it
// has. Splits by ID need a service.
#pragma once

#include <filesystem>
#include <functional>

#include "shared/result.h"
#include "shared/store/pack.h"

namespace meshfront {

struct ExportSummary {
  uint64_t files = 0;
  uint64_t bytes = 0;
};

// Writes `folder` whole or not at all: into a folder beside it, which then takes its place. A
// folder that is there already must be empty or an earlier export, or is replaced only if `force`
// (then everything in it is deleted); its parent must exist. Once `cancelled` returns true, it
// gives up with an Error and leaves nothing behind.
[[nodiscard]] Result<ExportSummary> exportStaticFiles(const Pack& pack,
                                                      const std::filesystem::path& folder,
                                                      bool force,
                                                      const std::function<bool()>& cancelled = {});

}  // namespace meshfront
