// Several meshes, one scheduler; and the thread that refines them.
#include "shared/scene/scene_receiver.h"

#include <gtest/gtest.h>

#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>

#include "shared/scene/refinement_thread.h"
#include "tests/unit/receiver_fixture.h"

namespace meshfront {
namespace {

// Answers on a thread of its own, in order.
class ThreadedService final : public Transport {
 public:
  explicit ThreadedService(const MeshService& service)
      : service_(service), thread_([this] { run(); }) {}
  ~ThreadedService() override {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    wake_.notify_one();
    thread_.join();
  }
  [[nodiscard]] FetchId send(FetchRequest request, Completion completion) override {
    const std::lock_guard lock(mutex_);
    queue_.push_back({++last_, std::move(request), std::move(completion)});
    wake_.notify_one();
    return last_;
  }
  void cancel(FetchId id) override {
    const std::lock_guard lock(mutex_);
    std::erase_if(queue_, [id](const ScriptedTransport::Held& held) { return held.id == id; });
  }
  void setAway(bool away) {
    const std::lock_guard lock(mutex_);
    away_ = away;
  }

 private:
  void run() {
    std::unique_lock lock(mutex_);
    while (true) {
      wake_.wait(lock, [this] { return stopping_ || !queue_.empty(); });
      if (stopping_) return;
      ScriptedTransport::Held next = std::move(queue_.front());
      queue_.pop_front();
      const bool away = away_;
      lock.unlock();
      FetchResponse response;
      if (away) {
        response.error = {ErrorCode::unavailable, "connection refused"};
      } else {
        response = service_.answer(next.request);
      }
      next.completion(std::move(response));
      lock.lock();
    }
  }

  const MeshService& service_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<ScriptedTransport::Held> queue_;
  FetchId last_ = 0;
  bool stopping_ = false;
  bool away_ = false;
  std::thread thread_;
};

class SceneTest : public ReceiverTest {
 protected:
  static std::vector<SceneMesh> placed(std::initializer_list<double> scales) {
    std::vector<SceneMesh> scene;
    double x = 0;
    for (const double scale : scales) {
      SceneMesh mesh;
      mesh.url = url();
      mesh.name = "torus " + std::to_string(scene.size());
      mesh.worldFromMesh = glm::dmat4(scale);
      mesh.worldFromMesh[3] = {x, 0, 0, 1};
      x += 3e5;
      scene.push_back(std::move(mesh));
    }
    return scene;
  }

  static SceneCounts everythingSeen(const SceneReceiver& scene, uint32_t pixels = 1) {
    SceneCounts counts;
    counts.camera.eye = {0, 0, 1e6};
    counts.picture = {100, 100};
    for (size_t i = 0; i < scene.meshCount(); ++i) {
      MeshCounts& mesh = counts.meshes.emplace_back();
      if (const auto* front = scene.receiver(i).mesh()) {
        mesh.changeCount = front->changeCount();
        mesh.pixels.assign(front->vertexSlotCount(), pixels);
      }
    }
    return counts;
  }

  void connectAll(SceneReceiver& scene) {
    for (int i = 0; i < 20 && !transport_.held.empty(); ++i) {
      transport_.answer(service_);
      scene.advance();
    }
  }
};

TEST_F(SceneTest, AllMeshesBecomeComplete) {
  SceneReceiver scene(placed({1, 2, 0.5}), {}, transport_);
  EXPECT_FALSE(scene.bounds());
  connectAll(scene);
  ASSERT_TRUE(scene.bounds());
  EXPECT_GT(scene.bounds()->max.x, 6e5);
  EXPECT_EQ(scene.status().state, ReceiverState::refining);
  for (int i = 0; i < 10'000 && scene.isAtWork(); ++i) {
    if (scene.wantsRanking()) scene.rank(everythingSeen(scene));
    if (!transport_.held.empty()) transport_.answer(service_);
    scene.advance();
  }
  const SceneStatus status = scene.status();
  EXPECT_EQ(status.state, ReceiverState::complete);
  EXPECT_EQ(status.splits, 3 * service_.splitCount());
  EXPECT_EQ(status.meshes.size(), 3U);
  for (size_t i = 0; i < 3; ++i) expectWholeMesh(scene.receiver(i));
}

TEST_F(SceneTest, WhatLooksLargerComesFirst) {
  SceneOptions options;
  options.receiver.batch = 8;
  options.receiver.window = 1;
  SceneReceiver scene(placed({1, 0.05}), options, transport_);
  connectAll(scene);
  scene.rank(everythingSeen(scene));
  // All of the first request's nodes are of the mesh that looks twenty times as large.
  ASSERT_EQ(transport_.held.size(), 1U);
  EXPECT_EQ(requested(transport_.held[0]).size(), 8U);
  transport_.answer(service_);
  scene.advance();
  EXPECT_GT(scene.receiver(0).mesh()->splitsApplied(), 0U);
  EXPECT_EQ(scene.receiver(1).mesh()->splitsApplied(), 0U);
}

TEST_F(SceneTest, EqualMeshesShareByPixels) {
  SceneOptions options;
  options.receiver.batch = 12;
  options.receiver.window = 1;
  options.receiver.order = RankOrder::pixels;
  SceneReceiver scene(placed({1, 1}), options, transport_);
  connectAll(scene);
  SceneCounts counts = everythingSeen(scene, 10);
  // Eight vertices of the second mesh show more than any of the first.
  size_t raised = 0;
  const SelectivelyRefinedMesh& second = *scene.receiver(1).mesh();
  for (VertexSlot slot = 0; slot < second.vertexSlotCount(); ++slot) {
    const bool splits =
        !second.isLeaf(second.nodeAt(slot)) && !second.isVirtual(second.nodeAt(slot));
    counts.meshes[1].pixels[slot] = splits && raised < 8 ? 100 : 0;
    raised += counts.meshes[1].pixels[slot] / 100;
  }
  ASSERT_EQ(raised, 8U);
  scene.rank(counts);
  ASSERT_EQ(transport_.held.size(), 2U);
  EXPECT_EQ(requested(transport_.held[0]).size(), 4U);
  EXPECT_EQ(requested(transport_.held[1]).size(), 8U);
}

TEST_F(SceneTest, TheLiftedComeFirst) {
  ReceiverOptions options = batches(5, 1);
  Receiver& receiver = connect(options);
  const SelectivelyRefinedMesh& mesh = *receiver.mesh();
  std::vector<uint8_t> lift(mesh.vertexSlotCount(), 0);
  std::vector<NodeId> expected;
  for (VertexSlot slot = mesh.vertexSlotCount() / 2; expected.size() < 5; ++slot) {
    if (mesh.isLeaf(mesh.nodeAt(slot))) continue;
    lift[slot] = 200;
    expected.push_back(mesh.id(mesh.nodeAt(slot)));
  }
  receiver.rank(everywhere(receiver), {.lift = lift, .levelsBehind = 40});
  std::sort(expected.begin(), expected.end());
  ASSERT_EQ(transport_.held.size(), 1U);
  EXPECT_EQ(requested(transport_.held[0]), expected);
}

// Does what a drawing thread does, with estimated pixels.
class Onlooker {
 public:
  Onlooker(RefinementThread& thread, size_t meshes) : thread_(thread), fronts_(meshes) {}

  // Until the state is there; the last status.
  SceneStatus lookUntil(ReceiverState state) {
    for (int i = 0; i < 20'000; ++i) {
      look();
      SceneStatus status = thread_.status();
      if (status.state == state) return status;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ADD_FAILURE() << "still " << stateName(thread_.status().state);
    return thread_.status();
  }
  void look() {
    for (const MeshNews& news : thread_.takeNews()) apply(news);
    SceneCounts counts;
    counts.camera.eye = {0, 0, 1e6};
    counts.picture = {100, 100};
    for (const Front& front : fronts_) {
      MeshCounts& mesh = counts.meshes.emplace_back();
      mesh.changeCount = front.changeCount;
      mesh.pixels.assign(front.vertices.size(), 3);
    }
    thread_.see(std::move(counts));
  }
  std::vector<GridPosition> positionsOf(size_t mesh) const {
    std::vector<GridPosition> positions;
    for (const DrawnVertex& vertex : fronts_[mesh].vertices) positions.push_back(vertex.position);
    return positions;
  }
  std::vector<Triangle> trianglesOf(size_t mesh) const {
    std::vector<Triangle> drawn;
    for (const Triangle& corners : fronts_[mesh].corners)
      if (corners != Triangle{}) drawn.push_back(corners);
    return drawn;
  }

 private:
  struct Front {
    uint64_t changeCount = 0;
    std::vector<DrawnVertex> vertices;
    std::vector<Triangle> corners;
  };
  void apply(const MeshNews& news) {
    Front& front = fronts_.at(news.mesh);
    const MeshUpdate& update = news.update;
    EXPECT_EQ(news.introduced.has_value(), front.vertices.empty());
    front.changeCount = update.changeCount;
    front.vertices.resize(update.vertexSlots);
    front.corners.resize(update.faceSlots);
    for (size_t i = 0; i < update.slots.size(); ++i)
      front.vertices.at(update.slots[i]) = update.vertices[i];
    for (size_t i = 0; i < update.faces.size(); ++i)
      front.corners.at(update.faces[i]) = update.corners[i];
  }

  RefinementThread& thread_;
  std::vector<Front> fronts_;
};

TEST_F(SceneTest, AThreadRefinesToTheEnd) {
  ThreadedService transport(service_);
  std::atomic<int> woken = 0;
  RefinementThread thread(placed({1, 1}), {}, transport, [&woken] { ++woken; });
  Onlooker onlooker(thread, 2);
  const SceneStatus status = onlooker.lookUntil(ReceiverState::complete);
  EXPECT_EQ(status.splits, 2 * service_.splitCount());
  EXPECT_GT(woken, 2);
  for (int i = 0; i < 1'000 && thread.status().finalShare < 1; ++i) {
    onlooker.look();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(thread.status().finalShare, 1);
  onlooker.look();
  for (size_t i = 0; i < 2; ++i)
    EXPECT_EQ(canonical(onlooker.positionsOf(i), onlooker.trianglesOf(i)),
              canonical(service_.mesh().positions, service_.mesh().triangles));
  const auto description = thread.describe(1, 0, std::chrono::milliseconds(10'000));
  ASSERT_TRUE(description);
  EXPECT_EQ(description->mesh, 1U);
  EXPECT_TRUE(description->isLeaf);
  EXPECT_FALSE(thread.describe(2, 0, std::chrono::milliseconds(10'000)));
  EXPECT_FALSE(thread.describe(0, 1'000'000, std::chrono::milliseconds(10'000)));
  EXPECT_TRUE(thread.stop().receiver(0).mesh()->complete());
}

TEST_F(SceneTest, AThreadTakesUpAgainWhenTheServerIsBack) {
  ThreadedService transport(service_);
  transport.setAway(true);
  RefinementThread thread(placed({1}), {}, transport, [] {});
  Onlooker onlooker(thread, 1);
  const SceneStatus lost = onlooker.lookUntil(ReceiverState::degraded);
  EXPECT_NE(lost.reason.find("refused"), std::string::npos);
  ASSERT_TRUE(lost.secondsToResume || thread.status().secondsToResume);
  transport.setAway(false);
  onlooker.lookUntil(ReceiverState::complete);
}

TEST_F(SceneTest, AThreadEndsAtAnyTime) {
  ThreadedService transport(service_);
  for (int i = 0; i < 20; ++i) {
    RefinementThread thread(placed({1, 1}), {}, transport, [] {});
    Onlooker onlooker(thread, 2);
    for (int j = 0; j < i; ++j) onlooker.look();
  }
}

}  // namespace
}  // namespace meshfront
