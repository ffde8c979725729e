// Experiment 2, Cheng and Ooi 2008, 5.2: what a sender-driven connection carries, by view and by
// the coding of IDs.
#include <limits>

#include "shared/receiver/request_budget.h"
#include "tests/evaluation/csv_file.h"
#include "tests/evaluation/sender_driven/message_stream.h"
#include "tests/evaluation/sender_experiments/experiments.h"

namespace meshfront::evaluation {

Result<void> measureBytes(std::span<MeasuredMesh> meshes, const ExperimentOptions& options) {
  CsvFile csv(
      options.output / "bytes.csv",
      {"mesh", "view", "order", "ids", "criteria", "records", "messages", "bytes_up", "bytes_down",
       "id_bits_a_record", "record_bits_a_record", "criterion_bits_a_record"});
  struct Coding {
    const char* name;
    IdCoding ids;
  };
  const std::array codings{Coding{"published", IdCoding::published},
                           Coding{"bitstring", IdCoding::bitstring},
                           Coding{"adaptive", IdCoding::adaptive}};
  for (const MeasuredMesh& mesh : meshes)
    for (const char* view : {"all", "whole", "half", "close"})
      for (const SenderOrder order : {SenderOrder::error, SenderOrder::significance})
        for (const Coding& coding : codings)
          for (const bool criteria : {false, true}) {
            SenderOptions sender;
            sender.order = order;
            sender.ids = coding.ids;
            sender.criteria = criteria;
            SenderSession session(mesh.model, sender);
            const bool everything = view == std::string("all");
            ViewRequest request = mesh.view(mesh.camera(everything ? "whole" : view));
            request.everything = everything;
            session.look(request);
            uint64_t down = helloBytes(mesh) + kMessageHead;  // the last one is "settled"
            uint64_t messages = 0;
            double ids = 0;
            double records = 0;
            double criterionBits = 0;
            for (;;) {
              const SentBatch& batch = session.next(adaptiveBatch(session.sentCount()));
              if (batch.splits.empty()) break;
              ++messages;
              down += kMessageHead + batch.message.size();
              ids += static_cast<double>(batch.idBits);
              records += static_cast<double>(batch.recordBits);
              criterionBits += static_cast<double>(batch.criterionBits);
            }
            const auto count = static_cast<double>(session.sentCount());
            csv.row(mesh.name, view, order == SenderOrder::error ? "error" : "significance",
                    coding.name, criteria ? 1 : 0, session.sentCount(), messages,
                    kMessageHead + ViewRequest::kBytes + (criteria ? kMessageHead : 0), down,
                    ids / count, records / count, criterionBits / count);
          }
  return csv.close();
}

}  // namespace meshfront::evaluation
