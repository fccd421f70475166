// What each layout writes of one pair, against its published format.

#include <cstdlib>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dataset/box_text.h"
#include "dataset/coco_layout.h"
#include "dataset/kitti_layout.h"
#include "dataset/npy_writer.h"
#include "learn/uavde_file.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace windhover {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

namespace fs = std::filesystem;

TEST(BoxText, WorkedExample) {
  // The first two pixels of the first row of an image of 4 x 2: middle at pixel coordinate 0.5.
  const image_box_t box{.x_px = 0.5, .y_px = 0, .w_px = 2, .h_px = 1};
  const BoxEdges edges = EdgesOf(box);
  EXPECT_EQ(edges.left_px, 0);
  EXPECT_EQ(edges.top_px, 0);
  EXPECT_EQ(edges.right_px, 2);
  EXPECT_EQ(edges.bottom_px, 1);
  EXPECT_EQ(BoxInShares(box, 4, 2), "0.2500000 0.2500000 0.5000000 0.5000000");
}

TEST(RunLengths, WorkedExample) {
  // Down the columns:  . X .     0 0, then X X, then . X
  //                    . X X
  EXPECT_THAT(RunLengths({0, 7, 0, 0, 7, 7}, 3, 2, 7), ElementsAre(2, 2, 1, 1));
  EXPECT_THAT(RunLengths({7, 0, 0, 0}, 2, 2, 7), ElementsAre(0, 1, 3));
  EXPECT_THAT(RunLengths({7, 0, 0, 0}, 2, 2, 9), ElementsAre(4));
}

/// One rig at the origin's height that looks east, and a target that looks north 10 m ahead.
struct OnePair {
  Scenario scenario;
  PosedFlight flight;
  PosedPair pair;
  annotation_t annotation{};
  detection_t detections{};
  PairId id{.split = Split::kVal, .flight = "val-00", .tick = 3, .utime = 300'000, .number = 5};
  std::optional<SceneGeometry> geometry;

  OnePair() {
    Aircraft rig, target;
    rig.self.id = 0;
    rig.self.carries_rig = true;
    target.self.id = 1;
    scenario.aircraft = {rig, target};
    scenario.exposure.duration_ms = 0.001;
    flight.scenario = scenario;
    uav_truth_t own{}, other{};
    own.qw = 1;
    other.id = 1;
    // A quarter turn to the left; its place makes its centre 10 m in front of the rig's middle.
    other.qw = other.qz = std::sqrt(0.5);
    other.p_WB_m[0] = 10 + scenario.rig.calibrated.mount.position_m[0];
    pair.tick = 3;
    pair.world.utime = id.utime;
    pair.world.n_uavs = 2;
    pair.world.uavs = {own, other};
    pair.uwb_m[1] = 10.5;
    geometry.emplace(scenario, std::vector{0});
    annotation = geometry->Annotate(pair.world, 0);
    stereo_box_t box{annotation.targets[0].left.visible, annotation.targets[0].right.visible, 0.9};
    detections.boxes = {box};
    detections.n_boxes = 1;
  }

  LabelledPair Labelled() const { return {id, flight, pair, *geometry, annotation, detections}; }
};

TEST(KittiLayout, WorkedExample) {
  const TemporaryFolder folder;
  const OnePair one;
  KittiLayout layout(folder.path());
  layout.Add(one.Labelled());
  layout.Finish();
  std::istringstream line(TextOf(folder.path() / "training/label_2/000005.txt"));
  std::string type;
  std::array<double, 14> v{};
  line >> type;
  for (double& value : v) ASSERT_TRUE(line >> value);
  EXPECT_EQ(type, "UAV");
  // M200: 378 mm high, 880 mm wide, 887 mm long with propellers.
  EXPECT_NEAR(v[7], 0.378, 5e-4);
  EXPECT_NEAR(v[8], 0.880, 5e-4);
  EXPECT_NEAR(v[9], 0.887, 5e-4);
  // The left camera is half a baseline left of the rig's middle; the place is that of the lower
  // side.
  EXPECT_NEAR(v[10], one.scenario.rig.calibrated.baseline_m / 2, 1e-4);
  EXPECT_NEAR(v[11], 0.378 / 2, 5e-4);
  EXPECT_NEAR(v[12], 10, 1e-4);
  // It flies to the left of the image: from KITTI's x axis (right), half a turn about y (down).
  EXPECT_NEAR(std::abs(v[13]), M_PI, 1e-6);
  EXPECT_NEAR(std::cos(v[2]), std::cos(v[13] - std::atan2(v[10], v[12])), 1e-6);
  // Its box, 0.880 m long... seen from the side, about f W / Z wide, in 0-based pixels.
  EXPECT_NEAR(v[5] - v[3] + 1, one.annotation.targets[0].left.visible.w_px, 0.02);
  // What P2 makes of the middle of its box lies inside the box.
  const std::string calibration = TextOf(folder.path() / "training/calib/000005.txt");
  std::istringstream p2(calibration.substr(calibration.find("P2: ") + 4));
  std::array<double, 12> P{};
  for (double& value : P) ASSERT_TRUE(p2 >> value);
  const double u = (P[0] * v[10] + P[2] * v[12] + P[3]) / v[12];
  EXPECT_GT(u, v[3]);
  EXPECT_LT(u, v[5]);
  EXPECT_EQ(TextOf(folder.path() / "ImageSets/val.txt"), "000005\n");
}

TEST(EverySingleLayout, WritesOnePairOfEachFormat) {
  for (const auto& [format, name] : kEnumNames<DatasetFormat>.names) {
    if (name == nullptr) continue;
    SCOPED_TRACE(name);
    const TemporaryFolder folder;
    const OnePair one;
    const auto layout = MakeDatasetLayout(format, folder.path());
    const FlightSource::Flight about{Split::kVal, "val-00", 1};
    layout->BeginFlight(about, one.flight);
    layout->Add(one.Labelled());
    layout->Finish();
    int files = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder.path())) {
      files += entry.is_regular_file();
      EXPECT_THAT(entry.path().string(), testing::Not(HasSubstr(".part")));
    }
    EXPECT_GT(files, 0);
  }
}

TEST(UavdeNpyWriter, TrainingReadsItBack) {
  const TemporaryFolder folder;
  UavdeNpyWriter writer(folder.path() / "a.npy");
  for (const float distance_m : {3.5f, 4.5f, 5.5f}) {
    writer.Add({{0, .25f, .5f, .1f, .1f, .5f}, {0, .5f, .25f, .125f, .0625f, .75f}},
               {{0, .375f, .25f, .125f, .0625f, .75f}}, distance_m, "a-1.txt\n");
  }
  writer.Finish();
  const std::vector<StereoTuple> tuples = ReadUavdeFile(folder.path() / "a.npy", 1280, 720);
  ASSERT_EQ(tuples.size(), 3u);
  EXPECT_EQ(tuples[2].range_m, 5.5);
  // The last row counts; a share of 1/2 lies between the two middle pixels.
  EXPECT_EQ(tuples[2].box.left.x_px, 639.5);
  EXPECT_EQ(tuples[2].box.left.w_px, 160);
  EXPECT_EQ(tuples[2].box.right.x_px, 479.5);
  EXPECT_EQ(tuples[2].box.right.h_px, 45);
}

// numpy.save is what the authors' code was written with; numpy reads our file to what it was.
TEST(UavdeNpyWriter, NumpyReadsItBack) {
  if (std::system("/usr/bin/python3 -c 'import numpy' 2>/dev/null") != 0) {
    GTEST_SKIP() << "python3-numpy is not installed";
  }
  const TemporaryFolder folder;
  UavdeNpyWriter writer(folder.path() / "a.npy");
  writer.Add({{0, .5f, .25f, .125f, 1, .75f}}, {{0, 1, 2, 3, 4, 5}, {6, 7, 8, 9, 10, 11}}, 3.5f,
             "a-1.txt\n");
  writer.Add({}, {{1, 1, 1, 1, 1, 1}}, 4.5f, "a-2.txt\n");
  writer.Finish();
  Program python({"/usr/bin/python3", "-c",
                  fmt::format(R"(
import numpy as np
a = np.load('{}', allow_pickle=True)
assert a.shape == (2,) and a.dtype == object, a
for one in a:
    assert list(one) == ['left', 'right', 'dist', 'file_id'], one
    assert one['left'].dtype == np.float32 == one['right'].dtype == one['dist'].dtype
    assert one['dist'].shape == ()
assert a[0]['left'].tolist() == [[0, .5, .25, .125, 1, .75]], a[0]
assert a[0]['right'].tolist() == [[0, 1, 2, 3, 4, 5], [6, 7, 8, 9, 10, 11]]
assert a[0]['dist'] == 3.5 and a[0]['file_id'] == 'a-1.txt\n'
assert a[1]['left'].shape == (0, 6) and a[1]['dist'] == 4.5 and a[1]['file_id'] == 'a-2.txt\n'
)",
                              (folder.path() / "a.npy").string())});
  EXPECT_EQ(python.Wait(), 0) << python.Err();
}

}  // namespace
}  // namespace windhover
