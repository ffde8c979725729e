// The view-independent order: by error, and every record behind its parent's.
#include "tests/evaluation/view_independent/error_order.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/data/temporary_folder.h"
#include "tests/evaluation/view_independent/geometric_error.h"
#include "tests/unit/encoded_mesh.h"
#include "tests/unit/generated_shapes.h"

namespace meshfront::evaluation {
namespace {

// Parents 0 -> 1 -> 2 and 0 -> 3; 4 alone.
std::vector<PackRecord> fiveRecords() {
  std::vector<PackRecord> records(5);
  records[1].parent = 0;
  records[2].parent = 1;
  records[3].parent = 0;
  return records;
}

TEST(ErrorOrder, RaisesWhatOthersWaitFor) {
  const std::vector<double> errors = {1, 2, 9, 4, 5};
  EXPECT_EQ(raisedErrors(fiveRecords(), errors), (std::vector<double>{9, 9, 9, 4, 5}));
  EXPECT_EQ(errorOrder(fiveRecords(), errors), (std::vector<RecordIndex>{0, 1, 2, 4, 3}));
}

TEST(ErrorOrder, LeavesTiesInPreorder) {
  const std::vector<double> errors(5, 1.0);
  EXPECT_EQ(errorOrder(fiveRecords(), errors), (std::vector<RecordIndex>{0, 1, 2, 3, 4}));
}

TEST(ErrorOrder, AppliesToARealMesh) {
  const TemporaryFolder folder;
  const auto shape = testing::sphereShape(4, 0.05);
  IndexedMesh mesh;
  for (const GridPosition& p : shape.positions)
    mesh.positions.push_back(shape.quantization.toWorld(p));
  mesh.triangles = shape.triangles;
  ASSERT_TRUE(writePack(folder / "sphere.pack", encodedContent(mesh)));
  const auto pack = PackRecords::read(folder / "sphere.pack");
  ASSERT_TRUE(pack) << pack.error().message;
  ASSERT_EQ(pack->records().size(), pack->metadata().splitCount);
  for (RecordIndex i = 0; i < pack->records().size(); ++i)
    ASSERT_EQ(pack->find(pack->records()[i].entry.id), i);

  auto full = RefinedPack::fromBase(*pack);
  ASSERT_TRUE(full);
  const auto levels = full->splitAll(pack->byLevel());
  ASSERT_TRUE(levels) << levels.error().message;
  EXPECT_TRUE(full->mesh().complete());

  for (const ErrorMeasure measure :
       {ErrorMeasure::distance, ErrorMeasure::normal, ErrorMeasure::both}) {
    const std::vector<double> errors = geometricErrors(*full, measure);
    const std::vector<RecordIndex> order = errorOrder(pack->records(), errors);
    auto refined = RefinedPack::fromBase(*pack);
    ASSERT_TRUE(refined);
    // Fails where a parent comes later, and where a record comes twice.
    const auto done = refined->splitAll(order);
    ASSERT_TRUE(done) << done.error().message;
    EXPECT_TRUE(refined->mesh().complete());
  }
}

TEST(ErrorOrder, TellsFlatFromBent) {
  const TemporaryFolder folder;
  const auto plane = testing::planeShape(16);
  IndexedMesh mesh;
  for (const GridPosition& p : plane.positions) {
    auto place = plane.quantization.toWorld(p);
    if (place[0] > 0.5) place[2] = 0.2 * std::sin(20 * place[0]) * std::sin(20 * place[1]);
    mesh.positions.push_back(place);
  }
  mesh.triangles = plane.triangles;
  ASSERT_TRUE(writePack(folder / "half.pack", encodedContent(mesh)));
  const auto pack = PackRecords::read(folder / "half.pack");
  ASSERT_TRUE(pack) << pack.error().message;
  auto full = RefinedPack::fromBase(*pack);
  ASSERT_TRUE(full);
  ASSERT_TRUE(full->splitAll(pack->byLevel()));
  const std::vector<double> errors = geometricErrors(*full, ErrorMeasure::distance);
  const int32_t middle = pack->metadata().quantization.toGrid({0.4, 0, 0})[0];
  double flat = 0;
  double bent = 0;
  for (RecordIndex i = 0; i < errors.size(); ++i) {
    // Those whose both children are leaves: nothing of the other half is below them.
    const PackRecord& record = pack->records()[i];
    if (record.children[0] != kNoRecord || record.children[1] != kNoRecord) continue;
    const int32_t x = full->mesh().position(full->nodeOf(i))[0];
    (x < middle ? flat : bent) += errors[i];
  }
  EXPECT_GT(bent, 100 * flat);
}

}  // namespace
}  // namespace meshfront::evaluation
