// A small mesh, coded for real, and a service of it in memory: answers as the interface says, for
// tests that script what happens to the answers on their way.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "encoder/coding/mesh_coder.h"
#include "shared/codec/answer.h"
#include "shared/hierarchy/node_id.h"
#include "shared/receiver/transport.h"
#include "shared/store/mesh_metadata.h"

namespace meshfront {

struct TestMesh {
  std::vector<GridPosition> positions;
  std::vector<Triangle> triangles;
  CodedMesh coded;
  // A bumpy torus of `around` times `across` vertices.
  [[nodiscard]] static TestMesh torus(uint32_t around, uint32_t across);
};

class MeshService {
 public:
  explicit MeshService(TestMesh mesh, std::string revision = std::string(32, 'a'));

  [[nodiscard]] FetchResponse answer(const FetchRequest& request) const;

  std::string revision;       // what the metadata names
  std::string knownRevision;  // what the rest is there for
  bool refusesExpansion = false;
  size_t mostNodes = SIZE_MAX;  // 413 beyond
  [[nodiscard]] const TestMesh& mesh() const { return mesh_; }
  [[nodiscard]] uint64_t splitCount() const { return records_.size(); }

  // The set and the expansion that a request for records spells.
  struct Wanted {
    std::vector<NodeId> nodes;
    Expansion expansion;
  };
  [[nodiscard]] static Wanted wantedBy(const FetchRequest& request);

 private:
  struct Place {
    size_t chunk = 0;
    RecordEntry entry;
  };
  [[nodiscard]] FetchResponse records(const FetchRequest& request) const;

  TestMesh mesh_;
  std::map<NodeId, Place> records_;
};

// Holds requests until the test answers them, in any order.
class ScriptedTransport final : public Transport {
 public:
  struct Held {
    FetchId id;
    FetchRequest request;
    Completion completion;
  };
  [[nodiscard]] FetchId send(FetchRequest request, Completion completion) override {
    held.push_back({++last_, std::move(request), std::move(completion)});
    return last_;
  }
  void cancel(FetchId id) override {
    std::erase_if(held, [id](const Held& request) { return request.id == id; });
  }
  // Takes out the request at `index` and completes it.
  void complete(size_t index, FetchResponse response) {
    Held request = std::move(held.at(index));
    held.erase(held.begin() + static_cast<ptrdiff_t>(index));
    request.completion(std::move(response));
  }
  void answer(const MeshService& service, size_t index = 0) {
    complete(index, service.answer(held.at(index).request));
  }

  std::vector<Held> held;  // oldest first

 private:
  FetchId last_ = 0;
};

}  // namespace meshfront
