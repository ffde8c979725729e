#include "tests/evaluation/quality/sender_way.h"

#include <utility>

#include "shared/receiver/request_budget.h"
#include "tests/evaluation/sender_driven/hello_messages.h"
#include "tests/evaluation/sender_driven/message_stream.h"

namespace meshfront::evaluation {
Result<std::unique_ptr<SenderWay>> SenderWay::create(const PackRecords& pack,
                                                     const SenderModel& model,
                                                     const SenderOptions& options, Easel& easel,
                                                     const EvaluationView& view, bool goesOn) {
  Result<RefinedPack> refined = RefinedPack::fromBase(pack);
  if (!refined) return tl::unexpected(refined.error());
  std::unique_ptr<SenderWay> way(new SenderWay(std::move(*refined), model, options, easel, view));
  const MeshMetadata& metadata = pack.metadata();
  const MeshHello hello{metadata.quantization,
                        metadata.boundsMin,
                        metadata.boundsMax,
                        {model.baseBytes().begin(), model.baseBytes().end()}};
  way->cost_.bytesDown = kMessageHead + hello.toBytes().size();
  ViewRequest request = ViewRequest::of(view.camera, easel.size(), model.quantization(), 0);
  request.everything = goesOn;
  way->cost_.bytesUp = kMessageHead + request.toBytes().size();
  way->session_.look(request);
  return way;
}

Result<bool> SenderWay::advance(uint64_t) {
  const SentBatch& batch = session_.next(adaptiveBatch(cost_.records));
  if (batch.splits.empty()) return false;
  // Both number the records in preorder.
  for (const SentSplit& split : batch.splits)
    if (Result<void> done = refined_.split(split.node); !done) return tl::unexpected(done.error());
  cost_.records += batch.splits.size();
  cost_.bytesDown += kMessageHead + batch.message.size();
  return true;
}

}  // namespace meshfront::evaluation
