#include "tests/evaluation/quality/evaluated_mesh.h"

#include <utility>

#include "tests/evaluation/quality/whole_download.h"
#include "tests/evaluation/view_independent/error_order.h"
#include "tests/evaluation/view_independent/geometric_error.h"

namespace meshfront::evaluation {

Result<std::unique_ptr<EvaluatedMesh>> EvaluatedMesh::load(const std::string& name,
                                                           const std::filesystem::path& path,
                                                           const std::vector<std::string>& views,
                                                           Easel& easel) {
  Result<PackRecords> pack = PackRecords::read(path);
  if (!pack) return tl::unexpected(pack.error());
  std::unique_ptr<EvaluatedMesh> mesh(new EvaluatedMesh(name, std::move(*pack)));
  mesh->service_ = std::make_unique<CountedService>(mesh->pack_.pack());
  Result<RefinedPack> full = RefinedPack::fromBase(mesh->pack_);
  if (!full) return tl::unexpected(full.error());
  if (Result<void> done = full->splitAll(mesh->pack_.byLevel()); !done)
    return tl::unexpected(done.error());
  const MeshMetadata& metadata = mesh->pack_.metadata();
  for (const std::string& viewName : views) {
    Result<EvaluationView> view = viewNamed(viewName, metadata, easel.size());
    if (!view) return tl::unexpected(view.error());
    EvaluatedView& seen = mesh->views_.emplace_back();
    seen.view = std::move(*view);
    Canvas canvas(easel, full->mesh(), metadata.quantization, seen.view);
    Result<Picture> picture = canvas.draw();
    if (!picture) return tl::unexpected(picture.error());
    seen.full = std::move(*picture);
  }
  const auto orderBy = [&](ErrorMeasure measure) {
    return evaluation::errorOrder(mesh->pack_.records(), geometricErrors(*full, measure));
  };
  mesh->errorOrder_ = orderBy(ErrorMeasure::distance);
  mesh->normalOrder_ = orderBy(ErrorMeasure::normal);
  const Result<std::optional<uint64_t>> whole = dracoBytes(*full);
  if (!whole) return tl::unexpected(whole.error());
  mesh->wholeFileBytes_ = *whole;
  return mesh;
}

}  // namespace meshfront::evaluation
