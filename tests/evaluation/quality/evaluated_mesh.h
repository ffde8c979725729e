// A mesh with all that the experiments need of it once: its records, the full mesh's picture from
// each view, the view-independent order, the size of the whole as one file.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tests/evaluation/quality/counted_service.h"
#include "tests/evaluation/quality/easel.h"
#include "tests/evaluation/view_independent/pack_records.h"

namespace meshfront::evaluation {

struct EvaluatedView {
  EvaluationView view;
  Picture full;  // of the full mesh
};

class EvaluatedMesh {
 public:
  [[nodiscard]] static Result<std::unique_ptr<EvaluatedMesh>> load(
      const std::string& name, const std::filesystem::path& pack,
      const std::vector<std::string>& views, Easel& easel);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const PackRecords& pack() const { return pack_; }
  [[nodiscard]] CountedService& service() { return *service_; }
  [[nodiscard]] const std::vector<EvaluatedView>& views() const { return views_; }
  [[nodiscard]] const std::vector<RecordIndex>& errorOrder() const { return errorOrder_; }
  [[nodiscard]] const std::vector<RecordIndex>& normalOrder() const { return normalOrder_; }
  [[nodiscard]] std::optional<uint64_t> wholeFileBytes() const { return wholeFileBytes_; }

 private:
  EvaluatedMesh(std::string name, PackRecords pack)
      : name_(std::move(name)), pack_(std::move(pack)) {}

  std::string name_;
  PackRecords pack_;
  std::unique_ptr<CountedService> service_;
  std::vector<EvaluatedView> views_;
  std::vector<RecordIndex> errorOrder_;   // by distance
  std::vector<RecordIndex> normalOrder_;  // by the variance of normals
  std::optional<uint64_t> wholeFileBytes_;
};

}  // namespace meshfront::evaluation
