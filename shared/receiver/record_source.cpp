#include "shared/receiver/record_source.h"

#include <utility>

#include "shared/receiver/chunk_source.h"
#include "shared/receiver/exact_source.h"
#include "shared/receiver/problem_details.h"

namespace meshfront {
namespace {

constexpr uint32_t kExactWindow = 1;
constexpr uint32_t kChunkWindow = 4;  // chunks are smaller than batches

}  // namespace

const char* fetchModeName(FetchMode mode) {
  return mode == FetchMode::chunks ? "chunks" : "exact";
}

uint32_t windowOf(const ReceiverOptions& options) {
  if (options.window > 0) return options.window;
  return options.mode == FetchMode::chunks ? kChunkWindow : kExactWindow;
}

uint32_t windowNow(const SourceSurroundings& to) {
  if (to.options.window > 0 || to.options.freshRanking) return windowOf(to.options);
  const uint64_t answers = to.statistics.answers;
  if (answers == 0) return windowOf(to.options);
  const double mean =
      static_cast<double>(to.statistics.answerBytesDown) / static_cast<double>(answers);
  return to.link.window(mean).value_or(windowOf(to.options));
}

void ViewProgress::see(size_t visibleCandidates, bool idle, const ReceiverOptions& options,
                       ReceiverStatistics& statistics) {
  visible = visibleCandidates;
  settled = visible == 0 && idle;
  if (settled) {
    if (!statistics.recordsWhenSettled) statistics.recordsWhenSettled = statistics.records;
    if (options.goal == ReceiverOptions::Goal::complete) completing = true;
  }
  if (visible > 0) completing = false;
  ranked = true;
}

std::optional<SourceTrouble> RecordSource::takeTrouble() {
  return std::exchange(trouble_, std::nullopt);
}

void RecordSource::reportRefusal(const MeshUrl& url, const FetchResponse& response,
                                 const std::string& what) {
  if (response.status == 0) {
    report({SourceTrouble::Kind::away, response.error.message, false});
  } else if (response.status == 404) {
    report({SourceTrouble::Kind::revisionGone, {}, false});
  } else {
    report({SourceTrouble::Kind::failed,
            url.origin + " refuses " + what + ": " + describeRefusal(response), false});
  }
}

std::unique_ptr<RecordSource> makeSource(SourceSurroundings surroundings) {
  if (surroundings.options.mode == FetchMode::chunks)
    return std::make_unique<ChunkSource>(std::move(surroundings));
  return std::make_unique<ExactSource>(std::move(surroundings));
}

}  // namespace meshfront
