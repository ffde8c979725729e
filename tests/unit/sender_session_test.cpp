// The sender-driven peer: what a session sends, and what its client makes of the messages.
#include "tests/evaluation/sender_driven/sender_session.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "shared/camera/camera_spec.h"
#include "tests/data/mesh_shapes.h"
#include "tests/unit/encoded_mesh.h"

namespace meshfront::evaluation {
namespace {

constexpr PixelSize kSenderPicture{400, 400};

class SenderSessionTest : public ::testing::Test {
 protected:
  explicit SenderSessionTest(const IndexedMesh& mesh = torus(40, 24))
      : content_(encodedContent(mesh)),
        chunks_(content_.chunks.begin(), content_.chunks.end()),
        model_(SenderModel::load(content_.metadata.quantization, content_.base, chunks_).value()) {}

  [[nodiscard]] Camera camera(const char* spec) const {
    const Bounds bounds = Bounds::of(content_.metadata.boundsMin, content_.metadata.boundsMax);
    return placeCamera(parseCameraSpec(spec).value(), bounds, kSenderPicture.aspect());
  }
  [[nodiscard]] ViewRequest view(const char* spec, float tolerance = 0) const {
    return ViewRequest::of(camera(spec), kSenderPicture, model_.quantization(), tolerance);
  }
  [[nodiscard]] SelectivelyRefinedMesh clientMesh() const {
    return SelectivelyRefinedMesh::fromBase(model_.base()).value();
  }

  PackContent content_;
  std::vector<std::span<const uint8_t>> chunks_;
  SenderModel model_;
};

std::vector<SenderOptions> senderOptions() {
  std::vector<SenderOptions> all;
  for (const auto bookkeeping : {Bookkeeping::windowedTags, Bookkeeping::vertexFront})
    for (const auto order : {SenderOrder::error, SenderOrder::significance})
      for (const auto ids : {IdCoding::published, IdCoding::bitstring, IdCoding::adaptive})
        for (const bool further : {false, true})
          all.push_back({bookkeeping, order, ids, further, further});
  return all;
}

TEST_F(SenderSessionTest, SendsEachNodeOnceParentsFirst) {
  for (const SenderOptions& options : senderOptions()) {
    SenderSession session(model_, options);
    SelectivelyRefinedMesh mesh = clientMesh();
    ClientSession client;
    std::set<uint32_t> sent;
    for (const char* spec : {"close", "whole", "whole;azimuth=200"}) {
      ViewRequest request = view(spec, 0.5F);
      request.everything = spec == std::string("whole;azimuth=200");
      session.look(request);
      for (;;) {
        const SentBatch& batch = session.next(70);
        if (batch.splits.empty()) break;
        EXPECT_LE(batch.splits.size(), 70U);
        uint64_t bits = 0;
        for (const SentSplit& split : batch.splits) {
          EXPECT_TRUE(sent.insert(split.node).second);
          const uint32_t parent = model_.parent(split.node);
          EXPECT_TRUE(parent == kNoNode || sent.count(parent) == 1);
          bits += split.recordBits + split.criterionBits;
        }
        EXPECT_EQ(bits, batch.recordBits + batch.criterionBits);
        EXPECT_LT(8 * batch.message.size() - batch.idBits - bits, 8U);
        const auto applied = applySplitMessage(batch.message, mesh, client);
        ASSERT_TRUE(applied) << applied.error().message;
        EXPECT_EQ(*applied, batch.splits.size());
      }
    }
    EXPECT_EQ(sent.size(), model_.nodeCount());
    EXPECT_EQ(session.sentCount(), model_.nodeCount());
    EXPECT_TRUE(mesh.complete());
  }
}

TEST_F(SenderSessionTest, SplitsAllThatIsVisible) {
  for (const char* spec : {"whole", "half;azimuth=70", "close;elevation=-30"}) {
    SenderSession session(model_);
    SelectivelyRefinedMesh mesh = clientMesh();
    ClientSession client;
    session.look(view(spec));
    while (!session.next(200).splits.empty()) {
      // What was sent is asked for below.
    }
    SelectivelyRefinedMesh full = clientMesh();
    for (uint32_t node = 0; node < model_.nodeCount(); ++node) {
      const auto split = [&](SelectivelyRefinedMesh& into) {
        return into.split(into.find(model_.id(node)).value(), model_.recordBytes(),
                          model_.recordBegin(node), model_.recordBits(node));
      };
      ASSERT_TRUE(split(full));
      if (!session.wasSent(node)) continue;
      ASSERT_TRUE(split(mesh));
    }
    ASSERT_LT(mesh.splitsApplied(), full.splitsApplied());
    // Each triangle of the full mesh that faces the eye with a corner in the picture.
    const Projection projection = Projection::fit(
        camera(spec), Bounds::of(content_.metadata.boundsMin, content_.metadata.boundsMax), 1);
    const glm::dmat4 clip = projection.clipFrom(glm::dvec3(0));
    size_t visible = 0;
    for (const Triangle& corners : full.drawnCorners()) {
      if (corners[0] == corners[1]) continue;
      std::array<glm::dvec3, 3> at{};
      bool inside = false;
      for (size_t i = 0; i < 3; ++i) {
        const auto world = model_.quantization().toWorld(full.positions()[corners[i]]);
        at[i] = {world[0], world[1], world[2]};
        const glm::dvec4 place = clip * glm::dvec4(at[i], 1);
        inside = inside || (std::abs(place.x) < place.w && std::abs(place.y) < place.w);
      }
      const glm::dvec3 normal = glm::cross(at[1] - at[0], at[2] - at[0]);
      if (!inside || glm::dot(normal, projection.camera.eye - at[0]) <= 0) continue;
      ++visible;
      for (const uint32_t corner : corners) {
        const auto node = mesh.find(full.id(full.nodeAt(corner)));
        EXPECT_TRUE(node && mesh.isActive(*node));
      }
    }
    EXPECT_GT(visible, 50U);
  }
}

TEST_F(SenderSessionTest, TakesTheLargestErrorsFirst) {
  SenderOptions options;
  options.ids = IdCoding::published;
  SenderSession session(model_, options);
  const ViewTest test(view("whole"));
  session.look(view("whole"));
  float last = std::numeric_limits<float>::infinity();
  for (;;) {
    const SentBatch& batch = session.next(100);
    if (batch.splits.empty()) break;
    for (const SentSplit& split : batch.splits) {
      float pixels = 0;
      ASSERT_TRUE(test.passes(model_.criteria(split.node), pixels));
      // Eighths of an octave, and a round that began before better children came.
      EXPECT_LE(pixels, last * 1.2F);
      last = std::min(last, pixels);
    }
  }
}

TEST_F(SenderSessionTest, ResumesFromTheListOfLeaves) {
  for (const auto bookkeeping : {Bookkeeping::windowedTags, Bookkeeping::vertexFront}) {
    SenderOptions options;
    options.bookkeeping = bookkeeping;
    SenderSession first(model_, options);
    SelectivelyRefinedMesh mesh = clientMesh();
    ClientSession client;
    first.look(view("half"));
    for (int i = 0; i < 3; ++i)
      ASSERT_TRUE(applySplitMessage(first.next(90).message, mesh, client));
    const std::vector<uint8_t> leaves = encodeLeafList(mesh);
    EXPECT_LT(8 * leaves.size(), 3 * mesh.splitsApplied());
    SenderSession second(model_, options);
    ASSERT_TRUE(second.resume(leaves));
    EXPECT_EQ(second.sentCount(), mesh.splitsApplied());
    client = {};
    const auto nodesOf = [](const std::vector<SentSplit>& splits) {
      std::set<uint32_t> nodes;
      for (const SentSplit& split : splits) nodes.insert(split.node);
      return nodes;
    };
    // The candidates that the first one holds are those that the second one finds.
    EXPECT_EQ(nodesOf(second.answer(view("half"))), nodesOf(first.answer(view("half"))));
    SenderSession third(model_, options);
    ASSERT_TRUE(third.resume(leaves));
    third.look(view("whole"));
    for (;;) {
      const SentBatch& batch = third.next(150);
      if (batch.splits.empty()) break;
      ASSERT_TRUE(applySplitMessage(batch.message, mesh, client));
    }
    EXPECT_EQ(third.sentCount(), mesh.splitsApplied());
  }
}

TEST_F(SenderSessionTest, FreesTheLeftPartsOfItsWindows) {
  SenderSession session(model_);
  const size_t fresh = session.sessionBytes();
  ViewRequest request = view("whole", 2);
  (void)session.answer(request);
  EXPECT_GT(session.sessionBytes(), fresh);
  EXPECT_LE(session.sessionBytes() - fresh, model_.nodeCount() / 4 + 128);
  request.everything = true;
  (void)session.answer(request);
  EXPECT_EQ(session.sentCount(), model_.nodeCount());
  EXPECT_EQ(session.sessionBytes(), fresh);
  EXPECT_EQ(session.singleWindowBytes(), 0U);
  for (uint32_t node = 0; node < model_.nodeCount(); ++node) EXPECT_TRUE(session.wasSent(node));
}

TEST_F(SenderSessionTest, SurvivesDamagedBytes) {
  std::mt19937 random(7);
  for (const auto ids : {IdCoding::published, IdCoding::bitstring, IdCoding::adaptive}) {
    SenderOptions options;
    options.ids = ids;
    options.criteria = true;
    SenderSession session(model_, options);
    session.look(view("whole"));
    const std::vector<uint8_t> message = session.next(40).message;
    for (size_t length = 0; length + 1 < message.size(); ++length) {
      SelectivelyRefinedMesh mesh = clientMesh();
      ClientSession client;
      EXPECT_FALSE(applySplitMessage(std::span(message).first(length), mesh, client));
    }
    for (int i = 0; i < 150; ++i) {
      std::vector<uint8_t> damaged = message;
      for (int flips = 0; flips < 4; ++flips)
        damaged[random() % damaged.size()] ^= static_cast<uint8_t>(1U << random() % 8);
      SelectivelyRefinedMesh mesh = clientMesh();
      ClientSession client;
      (void)applySplitMessage(damaged, mesh, client);
      SenderSession other(model_);
      (void)other.resume(damaged);
      EXPECT_LE(other.sentCount(), model_.nodeCount());
    }
  }
}

TEST(ViewRequest, GoesOverTheWireAndRefusesWhatIsNoView) {
  ViewRequest request = ViewRequest::of(Camera{{3, 4, 5}, {0, 1, 0}}, {640, 480}, {}, 1.5F);
  request.everything = true;
  const std::vector<uint8_t> bytes = request.toBytes();
  ASSERT_EQ(bytes.size(), ViewRequest::kBytes);
  const auto read = ViewRequest::fromBytes(bytes);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->toBytes(), bytes);
  EXPECT_FALSE(ViewRequest::fromBytes(std::span(bytes).first(bytes.size() - 1)));
  for (const size_t at : {size_t{3}, size_t{51}, size_t{59}}) {
    std::vector<uint8_t> damaged = bytes;
    damaged[at] = 0xff;  // not a number, or below 0
    EXPECT_FALSE(ViewRequest::fromBytes(damaged)) << at;
  }
}

}  // namespace
}  // namespace meshfront::evaluation
