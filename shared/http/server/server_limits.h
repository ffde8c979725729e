// What a server lets one client take, and all of them together. Each limit has an option of the
// programs (server_options.cpp), where its range stands, and a status for what lies beyond.
//
// Memory is bounded by these limits, whatever clients send. A server holds at most
//
//   (maxConnections + 1,024) * 1 KiB                 connections
//   + those of them that are in a request * (192 KiB + 2 * maxHeader)
//                                                    its line and fields, what follows it
//   + threads * 64 KiB                               what is being read
//   + memoryInFlight                                 contents received, answers being sent
//   + (threads + waitingThreads) * (3 * maxAnswer + 16 B * maxIds)    answers being put together
//   + --fetch-memory                                 proxy: records fetched for these answers
//   + the budget of the index (service) or of the cache (proxy)
//
// because contents and answers are counted in memoryInFlight before they are kept or queued, and
// refused by 503 where they do not fit. A request holds 192 KiB only where its line comes in pieces
// and nearly is too long; a usual one holds its URL. Few come near: receivers ask for some thousand
// nodes at a time. Where memory is scarce, lower maxRecords first.
#pragma once

#include <cstddef>

#include "shared/http/split_request.h"

namespace meshfront {

struct ServerLimits {
  // A request.
  size_t maxTarget = kMaxTargetOctets;    // octets of a URL; 414
  size_t maxHeader = size_t{32} << 10;    // octets of a request's fields; 431
  size_t maxContent = kMaxContentOctets;  // octets; 413
  size_t maxIds = size_t{1} << 18;        // nodes; 413
  size_t maxLevels = kMaxDepth;           // of descendants, "levels=K"; 413

  // An answer.
  size_t maxRecords = size_t{1} << 22;  // 413
  size_t maxAnswer = size_t{64} << 20;  // octets of records; 413

  // Connections. Those beyond a limit are refused by 503 or 429 and closed; where refusedAtMost()
  // wait for that already, more are closed at once (of one address) or not accepted (in all).
  size_t maxConnections = 16384;            // fewer where the system grants fewer descriptors; 503
  size_t maxConnectionsPerAddress = 12288;  // an IPv6 /64 counts as one; 429

  // Time, in seconds. Bytes that trickle in do not prolong it.
  double headerTimeout = 10;   // from a request's first octet to the end of its fields; 408
  double contentTimeout = 30;  // from there to the end of its content; 408
  double answerTimeout = 300;  // from there to the last octet sent; the connection is cut
  double idleTimeout = 75;     // without any octet, either way; the connection is closed

  // All requests together.
  size_t memoryInFlight = size_t{512} << 20;  // octets, see above; 503
};

// Connections beyond a limit that are kept until they have been refused.
[[nodiscard]] constexpr size_t refusedAtMost(size_t limit) {
  return limit < 1024 ? limit : 1024;
}

}  // namespace meshfront
