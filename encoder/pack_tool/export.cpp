// meshfront-pack export.
#include <fmt/format.h>

#include "encoder/pack_tool/commands.h"
#include "encoder/pack_tool/static_export.h"
#include "encoder/pipeline/signals_held_back.h"

namespace meshfront {

Result<int> exportFiles(const std::filesystem::path& path, const std::filesystem::path& folder,
                        bool force) {
  const auto pack = Pack::open(path);
  if (!pack) return tl::unexpected(pack.error());
  const SignalsHeldBack held;
  const auto done = exportStaticFiles(**pack, folder, force, [&] { return held.interrupted(); });
  if (!done) return tl::unexpected(done.error());
  held.ignore();
  const MeshMetadata& m = (*pack)->metadata();
  fmt::print("wrote {}: mesh {}, revision {}, {} files, {} bytes\n", folder.string(), m.name,
             m.revision, done->files, done->bytes);
  return 0;
}

}  // namespace meshfront
