// What a receiver may be told, and what it tells of its work.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>

#include "shared/receiver/ranking.h"
#include "shared/receiver/request_budget.h"
#include "shared/receiver/transport.h"

namespace meshfront {

// What the requests for records name.
enum class FetchMode {
  exact,   // the nodes that the view wants and nothing else: fewest bytes down
  chunks,  // constant pieces of about 512 records: equal URLs for everybody, so that any HTTP cache
           // answers them; what a piece holds beyond the wish is kept and never asked for again
};
[[nodiscard]] const char* fetchModeName(FetchMode mode);  // "exact", "chunks"

struct ReceiverOptions {
  enum class Goal {
    settled,  // what the views show
    complete  // when that is there: the rest
  };
  FetchMode mode = FetchMode::exact;
  RankOrder order = RankOrder::significance;
  Goal goal = Goal::settled;
  uint32_t batch = 0;  // exact: records a request; 0: adaptiveBatch()
  // Requests under way; 0: 1 for exact sets, 4 for chunks, but without freshRanking as many as keep
  // the link busy (LinkMeter), 1..16. The transport should have as many slots.
  uint32_t window = 0;
  // After each answer advance() waits for a ranking before it applies the next one: the requests
  // then depend on the mesh and the views alone, at the price of a count for each answer. Else
  // rankings are used up, and the caller ranks when it likes: for people in front of a window. What
  // depends on time (the window, descendants by need, dropping what a view no longer shows) is done
  // only then.
  bool freshRanking = true;
  // Asks for descendants too: with the first request of all (first_request.h) and, without
  // freshRanking, where the wishes would leave the link idle.
  bool descendants = true;
  // Degrades when something is under way and nothing has come for so long; 0: never.
  std::chrono::milliseconds patience{30'000};
  ReceiverLimits limits;
  // The disk cache (disk_cache.h): what is there is not asked for, and what comes is added.
  // Empty: none.
  std::filesystem::path cacheFolder;
  uint64_t cacheBytes = uint64_t{1} << 30;  // over all meshes in it
  // Called on a thread of the transport when advance() has something to do. Must only wake.
  std::function<void()> onArrival;
  // Of the receiver's thread, for tests; null: std::chrono::steady_clock::now().
  std::function<std::chrono::steady_clock::time_point()> clock;
};
// Requests under way where nothing is measured, >= 1.
[[nodiscard]] uint32_t windowOf(const ReceiverOptions& options);

struct ReceiverStatistics {
  uint64_t requests = 0;         // for records, repeated ones too
  uint64_t answers = 0;          // applied whole; of chunks: taken in
  uint64_t records = 0;          // applied or kept
  uint64_t recordsFromDisk = 0;  // of these
  uint64_t malformed = 0;
  uint64_t cancelled = 0;          // requests that the view overtook; their octets are not counted
  uint64_t expanded = 0;           // requests for descendants, the first one and those by need
  uint64_t answersFromCaches = 0;  // of `answers`, as far as headers tell (cameFromCache())
  uint64_t idsRequested = 0;       // nodes named in requests
  uint64_t setOctets = 0;          // of their bitstrings, before base64url
  uint64_t requestBytesUp = 0;     // of record requests alone: lines, headers, content
  uint64_t answerBytesDown = 0;    // of record answers alone, without headers
  Traffic traffic;                 // everything
  std::optional<uint64_t> recordsWhenSettled;  // the first time
};

}  // namespace meshfront
