// A receiver of a torus over a scripted transport.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "shared/receiver/receiver.h"
#include "tests/unit/mesh_service.h"

namespace meshfront {

class ReceiverTest : public ::testing::Test {
 protected:
  using Goal = ReceiverOptions::Goal;

  static const MeshService& torusService() {
    static const MeshService kService(TestMesh::torus(48, 24));
    return kService;
  }

  static MeshUrl url() { return *parseMeshUrl("http://host/v1/meshes/torus"); }

  static std::vector<uint32_t> everywhere(const Receiver& receiver, uint32_t pixels = 1) {
    return std::vector<uint32_t>(receiver.mesh()->vertexSlotCount(), pixels);
  }

  static std::vector<NodeId> requested(const ScriptedTransport::Held& held) {
    return MeshService::wantedBy(held.request).nodes;
  }

  // Triangles by their corners' positions, each beginning at its least corner.
  static std::vector<std::array<GridPosition, 3>> canonical(
      const std::vector<GridPosition>& positions, const std::vector<Triangle>& triangles) {
    std::vector<std::array<GridPosition, 3>> result;
    for (const Triangle& t : triangles) {
      std::array<GridPosition, 3> corners{positions[t[0]], positions[t[1]], positions[t[2]]};
      std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
      result.push_back(corners);
    }
    std::sort(result.begin(), result.end());
    return result;
  }

  template <typename Change>
  static ReceiverOptions with(Change change) {
    ReceiverOptions options;
    change(options);
    return options;
  }

  static ReceiverOptions batches(uint32_t batch, uint32_t window) {
    return with([=](ReceiverOptions& o) {
      o.batch = batch;
      o.window = window;
    });
  }

  Receiver& start(ReceiverOptions options = {}) {
    receiver_.emplace(url(), std::move(options), transport_);
    return *receiver_;
  }
  // Through metadata and base.
  Receiver& connect(ReceiverOptions options = {}) {
    Receiver& receiver = start(std::move(options));
    transport_.answer(service_);
    receiver.advance();
    transport_.answer(service_);
    receiver.advance();
    EXPECT_NE(receiver.mesh(), nullptr) << receiver.reason();
    return receiver;
  }
  // Ranks with all vertices visible and answers in order until nothing is at work.
  void runToTheEnd(Receiver& receiver) {
    for (int i = 0; i < 10'000 && receiver.isAtWork(); ++i) {
      if (receiver.wantsRanking()) receiver.rank(everywhere(receiver));
      if (!transport_.held.empty()) transport_.answer(service_);
      receiver.advance();
    }
  }

  void expectWholeMesh(const Receiver& receiver) const {
    const GridMesh whole = receiver.mesh()->snapshot();
    EXPECT_EQ(canonical(whole.positions, whole.triangles),
              canonical(service_.mesh().positions, service_.mesh().triangles));
  }

  MeshService service_ = torusService();
  ScriptedTransport transport_;
  std::optional<Receiver> receiver_;
};

}  // namespace meshfront
