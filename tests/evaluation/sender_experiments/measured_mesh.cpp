#include "tests/evaluation/sender_experiments/measured_mesh.h"

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <queue>

#include "shared/bits/base64url.h"
#include "shared/hierarchy/tree_bitstring.h"
#include "shared/http/split_request.h"
#include "shared/receiver/request_budget.h"
#include "tests/evaluation/sender_driven/hello_messages.h"
#include "tests/evaluation/sender_driven/message_stream.h"

namespace meshfront::evaluation {
namespace {

constexpr size_t kIndexBytes = size_t{4} << 30;
constexpr size_t kMostWanted = size_t{1} << 18;

}  // namespace

Result<MeasuredMesh> MeasuredMesh::open(const std::string& path) {
  auto pack = Pack::open(path);
  if (!pack) return tl::unexpected(pack.error());
  auto model = SenderModel::load(**pack);
  if (!model) return tl::unexpected(model.error());
  const MeshMetadata& metadata = (*pack)->metadata();
  auto store = std::make_shared<PackStore>(*pack, std::make_shared<MemoryBudget>(kIndexBytes));
  return MeasuredMesh{std::filesystem::path(path).stem().string(), *pack, std::move(store),
                      std::move(*model), Bounds::of(metadata.boundsMin, metadata.boundsMax)};
}

size_t helloBytes(const MeasuredMesh& mesh) {
  const auto base = mesh.model.baseBytes();
  return kMessageHead +
         MeshHello{mesh.model.quantization(), {}, {}, {base.begin(), base.end()}}.toBytes().size();
}

Result<SetRequest> setRequest(const SenderModel& model, std::span<const uint32_t> nodes) {
  std::vector<NodeId> ids;
  ids.reserve(nodes.size());
  for (const uint32_t node : nodes) ids.push_back(model.id(node));
  const auto bitstring = encodeTreeBitstring(ids);
  if (!bitstring) return tl::unexpected(bitstring.error());
  return SetRequest{base64urlEncode(*bitstring), nodes.size()};
}

Result<std::vector<SetRequest>> wholeMeshRequests(const SenderModel& model) {
  using Ranked = std::pair<unsigned, uint32_t>;  // level, node
  std::priority_queue<Ranked, std::vector<Ranked>, std::greater<>> front;
  for (const uint32_t root : model.roots()) front.emplace(model.level(root), root);
  std::vector<SetRequest> requests;
  for (uint64_t asked = 0; !front.empty();) {
    std::vector<uint32_t> nodes;
    const uint32_t most = adaptiveBatch(asked);
    while (!front.empty() && nodes.size() < most) {
      nodes.push_back(front.top().second);
      front.pop();
    }
    for (const uint32_t node : nodes)
      for (const uint32_t child : {model.leftChild(node), model.rightChild(node)})
        if (child != kNoNode) front.emplace(model.level(child), child);
    std::sort(nodes.begin(), nodes.end());
    asked += nodes.size();
    auto request = setRequest(model, nodes);
    if (!request) return tl::unexpected(request.error());
    requests.push_back(std::move(*request));
  }
  return requests;
}

Result<std::vector<SetRequest>> requestsFor(const SenderModel& model, std::vector<uint32_t> nodes) {
  std::vector<SetRequest> requests;
  std::sort(nodes.begin(), nodes.end());
  // Those without an ancestor among the nodes; then the same of the rest.
  while (!nodes.empty()) {
    std::vector<uint32_t> tops;
    std::vector<uint32_t> below;
    uint32_t end = 0;
    for (const uint32_t node : nodes) {
      if (node < end) {
        below.push_back(node);
        continue;
      }
      tops.push_back(node);
      end = model.end(node);
    }
    for (size_t i = 0; i < tops.size(); i += kLargestAdaptiveBatch) {
      const size_t count = std::min<size_t>(kLargestAdaptiveBatch, tops.size() - i);
      auto request = setRequest(model, std::span(tops).subspan(i, count));
      if (!request) return tl::unexpected(request.error());
      requests.push_back(std::move(*request));
    }
    nodes = std::move(below);
  }
  return requests;
}

bool answerRequest(PackStore& store, const SetRequest& request, uint64_t& bytes) {
  const auto set = parseSplitUrl(request.ids, false, {}, 0, kMostWanted);
  if (!set) return false;
  const auto answer = store.collect(set->wanted, set->expansion, {}, Waiting::refused);
  if (!answer || answer->records != request.count) return false;
  bytes += answer->bytes.size();
  return true;
}

double processorSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace meshfront::evaluation
