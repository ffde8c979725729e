// The sender-driven peer (Kim, Lee and Kobbelt 2004; the comparison in Cheng and Ooi 2008): a
// server that keeps for each client what it has been sent, decides by the client's view what comes
// next, and sends splits with their IDs.
//
//   auto model = SenderModel::load(*pack);                         // shared by all sessions
//   SenderSession session(*model, {});
//   session.look(ViewRequest::of(camera, {500, 500}, model->quantization(), 0));
//   for (;;) {
//     const SentBatch& batch = session.next(200);                  // in sending order
//     if (batch.splits.empty()) break;                             // the view has all it asks for
//     bytes += batch.message.size();                               // what goes over the wire
//   }
//
// Each active node is tested against the view frustum (by the sphere around all that is below it),
// the cone of its normals and its error in pixels. All three hold for all descendants, so that a
// node is tested once a view: candidates wait in a queue by their order, and the children of what
// is sent join it. No memory is allocated by the node; arrays grow by doubling.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "shared/bits/bit_writer.h"
#include "shared/result.h"
#include "tests/evaluation/sender_driven/active_tags.h"
#include "tests/evaluation/sender_driven/candidate_queue.h"
#include "tests/evaluation/sender_driven/sender_model.h"
#include "tests/evaluation/sender_driven/split_message.h"
#include "tests/evaluation/sender_driven/view_request.h"
#include "tests/evaluation/sender_driven/view_test.h"

namespace meshfront::evaluation {

// What the server keeps of a client.
enum class Bookkeeping {
  windowedTags,  // a bit a node in bands of the hierarchy, without what is all ones or all zeros
  vertexFront,   // the list of active nodes that can be split
};

enum class SenderOrder {
  error,         // screen-space error, as published
  significance,  // level of significance, then screen-space error
};

struct SenderOptions {
  Bookkeeping bookkeeping = Bookkeeping::windowedTags;
  SenderOrder order = SenderOrder::error;
  IdCoding ids = IdCoding::adaptive;  // needs tags; with a vertex front: bitstring
  // Sphere, cone and error of each node go with its record, for clients that coarsen by them.
  bool criteria = false;
  // Tests all active nodes again for each batch, as published, in place of keeping the candidates.
  bool retest = false;
};

// Processor seconds by part (Cheng and Ooi 2008, table 1), where they are asked for.
struct SenderTimes {
  double findSplits = 0;   // taking candidates in their order; copying records
  double visibility = 0;   // the tests
  double frontUpdate = 0;  // bookkeeping: finding active nodes, marking what was sent
  double encodeIds = 0;
  [[nodiscard]] double total() const { return findSplits + visibility + frontUpdate + encodeIds; }
};

struct SentSplit {
  uint32_t node = 0;  // of the model
  uint32_t idBits = 0;
  uint32_t recordBits = 0;
  uint32_t criterionBits = 0;
};

struct SentBatch {
  std::vector<SentSplit> splits;  // in the order of the message: parents before children
  std::vector<uint8_t> message;   // all that goes over the wire, but for its length's framing
  uint64_t idBits = 0;            // of the batch; shares of splits are even where IDs go together
  uint64_t recordBits = 0;
  uint64_t criterionBits = 0;
};

class SenderSession {
 public:
  // The model must outlive the session.
  explicit SenderSession(const SenderModel& model, const SenderOptions& options = {});

  // A new view. Finds what it asks for among the active nodes.
  void look(const ViewRequest& request);
  // The next splits for the view, at most `maxRecords` (> 0) and best first over the batches; empty
  // when the view has all it asks for. Valid until the next call.
  const SentBatch& next(size_t maxRecords);
  // All for the view in one list.
  [[nodiscard]] std::vector<SentSplit> answer(const ViewRequest& request, size_t batch = 2000);

  // After a lost connection: the client's front (SenderClient::leafList()), in place of what the
  // session kept. Untrusted; on an error the session is as new.
  Result<void> resume(std::span<const uint8_t> leafList);

  // Has been sent; with windowed tags only.
  [[nodiscard]] bool wasSent(uint32_t node) const {
    return sent_.has(model_.level(node), model_.tag(node));
  }
  [[nodiscard]] uint64_t sentCount() const { return sentCount_; }
  [[nodiscard]] const SenderModel& model() const { return model_; }

  // Bytes held for the client while it rests (active nodes or tags, and what the coding of IDs has
  // learned), and those of the candidates that wait while a view is being answered.
  [[nodiscard]] size_t sessionBytes() const;
  [[nodiscard]] size_t queueBytes() const { return queue_.memoryBytes(); }
  // What a single window over all tags would hold, as published.
  [[nodiscard]] size_t singleWindowBytes() const { return sent_.singleWindowBytes(); }

  // Times are counted from here on, into `times`; a clock is read some times a batch.
  void measure(SenderTimes* times) { times_ = times; }

 private:
  class Clock;
  [[nodiscard]] bool usesTags() const { return options_.bookkeeping == Bookkeeping::windowedTags; }
  void findCandidates();
  void scanTags();
  void scanFront();
  void startOnRest();
  void addIfAskedFor(uint32_t node);
  [[nodiscard]] uint32_t bucketOf(uint32_t node, float size) const;
  void takeRound(size_t most, Clock& clock);
  void writeMessage(Clock& clock);
  void writeRecords(BitWriter& out);

  const SenderModel& model_;
  SenderOptions options_;
  ViewTest view_;
  bool everything_ = false;
  bool onRest_ = false;          // what the view asks for has been sent
  ActiveTags sent_;              // windowed tags
  std::vector<uint32_t> front_;  // vertex front: active nodes that are not in the queue
  CandidateQueue queue_;
  IdChances chances_;
  IdWriter ids_;
  uint64_t sentCount_ = 0;
  SenderTimes* times_ = nullptr;
  // Working space.
  std::vector<uint32_t> taken_;  // of the batch
  std::vector<uint32_t> born_;   // children of what a round has taken
  SentBatch batch_;
};

}  // namespace meshfront::evaluation
