// Data sets from flights to files: what is in them, that they are the same however they were made,
// and what is said when they cannot be.

#include "dataset/export.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/config/enum_name.h"
#include "common/image/image_codecs.h"
#include "learn/uavde_file.h"
#include "learn/uavde_folder.h"
#include "render/stereo_renderer.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace windhover {
namespace {

using testing::HasSubstr;

namespace fs = std::filesystem;

const fs::path kPreset = fs::path(WINDHOVER_SOURCE_DIR) / "scenarios/presets/uavde_12mm.yaml";

Scenario Base(std::vector<std::string> overrides = {}) {
  overrides.insert(overrides.end(),
                   {"aircraft=[{id: 0}]", "description=preset", "estimator.correction=''"});
  return LoadUndrawnScenario(kPreset, overrides);
}

// A quarter of the pixels each way, of the same field of view: quick.
Scenario SmallBase() { return Base({"rig.image=[320, 180]", "rig.pixel_um=14.93"}); }

ExportPlan PlanOf(const fs::path& folder, DatasetFormat format, int pairs, int threads = 1) {
  ExportPlan plan;
  plan.source = FlightsOfDataset(SmallBase(), 1, pairs);
  plan.format = format;
  plan.folder = folder;
  plan.images.threads = threads;
  plan.scenario = "small.yaml";
  plan.command = "windhover export small.yaml";
  plan.version = "test";
  return plan;
}

bool GoOn(int /*done*/, int /*total*/) { return true; }

TEST(FlightsOfDataset, SharesOutPairsAsThePaperSplits) {
  const FlightSource all = FlightsOfDataset(SmallBase(), 1);
  std::map<Split, int> pairs, flights;
  for (const auto& flight : all.flights) {
    pairs[flight.split] += flight.n_pairs;
    ++flights[flight.split];
  }
  EXPECT_EQ(pairs[Split::kTrain], 2815);
  EXPECT_EQ(pairs[Split::kVal], 541);
  EXPECT_EQ(pairs[Split::kTest], 539);
  EXPECT_EQ(flights[Split::kTrain], 12);
  EXPECT_THROW(FlightsOfDataset(SmallBase(), 1, 2), ConfigError);
}

TEST(FlightsOfDataset, GivesAsManyPairsAsWantedOfFlownFlights) {
  const FlightSource whole = FlightsOfDataset(SmallBase(), 1);
  const PosedFlight first = whole.fly(0);
  for (const int wanted : {40, 1000, 3895, 9000}) {
    SCOPED_TRACE(wanted);
    const FlightSource source = FlightsOfDataset(SmallBase(), 1, wanted);
    int n = 0;
    for (const auto& flight : source.flights) n += flight.n_pairs;
    EXPECT_EQ(n, wanted);
    const PosedFlight flight = source.fly(0);
    ASSERT_EQ(std::ssize(flight.pairs), source.flights[0].n_pairs);
    // A pair is that of the whole flight at its tick: fewer pairs do not make it fly faster.
    for (const PosedPair& pair : flight.pairs) {
      const PosedPair& same = first.pairs.at(static_cast<std::size_t>(pair.tick));
      EXPECT_EQ(pair.world.uavs[1].p_WB_m[0], same.world.uavs[1].p_WB_m[0]);
      EXPECT_EQ(pair.uwb_m, same.uwb_m);
    }
  }
}

TEST(Export, SameBytesOnAnyNumberOfThreadsAndAfterAnyStop) {
  const TemporaryFolder folder;
  const fs::path once = folder.path() / "once", again = folder.path() / "again";
  ASSERT_TRUE(Export(PlanOf(once, DatasetFormat::kYolo, 12, 1), GoOn));
  const std::string sums = TextOf(once / "SHA256SUMS");
  EXPECT_EQ(std::count(sums.begin(), sums.end(), '\n'), 2 * 12 + 2 * 12 + 3);
  // Stopped after 1 pair, then after 5, then with a half-written note, as a killed process leaves.
  int stops = 0;
  for (const int stop : {1, 5}) {
    stops += !Export(PlanOf(again, DatasetFormat::kYolo, 12, 2),
                     [&](int done, int /*total*/) { return done < stop; });
    EXPECT_FALSE(fs::exists(again / "dataset.json"));
  }
  EXPECT_EQ(stops, 2);
  std::ofstream(again / "images" / "train" / "x.jpg.1234.part") << "what a killed process leaves";
  const fs::path note = fs::directory_iterator(again / ".export")->path();
  if (note.extension() == ".lcm" && fs::file_size(note) > 10) {
    fs::resize_file(note, fs::file_size(note) - 10);
  }
  ASSERT_TRUE(Export(PlanOf(again, DatasetFormat::kYolo, 12, 2), GoOn));
  EXPECT_EQ(TextOf(again / "SHA256SUMS"), sums);
  EXPECT_EQ(TextOf(again / "dataset.json"), TextOf(once / "dataset.json"));
  EXPECT_FALSE(fs::exists(again / ".export"));
}

// What is exported can be imported: from the texts as from the .npy.
TEST(Export, ItsUavdeTextsAndNumbersAgree) {
  const TemporaryFolder folder;
  const fs::path set = folder.path() / "set";
  ASSERT_TRUE(Export(PlanOf(set, DatasetFormat::kUavde, 24, 2), GoOn));
  const TupleSplits numbers = ReadUavdeFolder(set / "data", 320, 180);
  const TupleSplits texts =
      ReadUavdeTexts({.folder = set, .image_width_px = 320, .image_height_px = 180});
  for (const auto part : {&TupleSplits::train, &TupleSplits::val, &TupleSplits::test}) {
    ASSERT_EQ((texts.*part).size(), (numbers.*part).size());
    for (std::size_t i = 0; i < (texts.*part).size(); ++i) {
      const StereoTuple &text = (texts.*part)[i], &number = (numbers.*part)[i];
      // A float has 24 bits: 1e-5 px of 320.
      EXPECT_NEAR(text.box.left.x_px, number.box.left.x_px, 4e-5);
      EXPECT_NEAR(text.box.right.h_px, number.box.right.h_px, 4e-5);
      EXPECT_NEAR(text.range_m, number.range_m, 1e-5);
      // UWB between antennas is a little off the distance between rig and target.
      EXPECT_NE(text.range_true_m, text.range_m);
      EXPECT_NEAR(text.range_true_m, text.range_m, 1);
    }
  }
}

// Depth, disparity and masks lie beside the images, in KITTI's unit, 1/256.
TEST(Export, DenseLabelsSayHowFarATargetIs) {
  const TemporaryFolder folder;
  ExportPlan plan = PlanOf(folder.path() / "set", DatasetFormat::kCoco, 12, 2);
  plan.images.dense = true;
  ASSERT_TRUE(Export(plan, GoOn));
  const PosedFlight flight = plan.source.fly(0);
  const PairId id{Split::kTrain, "train-00", flight.pairs[0].tick, 0, 0};
  const auto read = [&](const char* name) {
    return Codecs().imread((plan.folder / "dense" / StemOf(id) / name).string(), -1);
  };
  const cv::Mat depth = read("depth_left.png"), disparity = read("disparity.png"),
                mask = read("mask_left.png");
  ASSERT_EQ(depth.type(), CV_16UC1);
  ASSERT_EQ(disparity.type(), CV_16UC1);
  ASSERT_EQ(mask.type(), CV_8UC1);
  const SceneGeometry geometry(flight.scenario, {flight.observer});
  const target_annotation_t target = geometry.Annotate(flight.pairs[0].world, 0).targets[0];
  int n = 0;
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      ASSERT_EQ(depth.at<std::uint16_t>(y, x) > 0, mask.at<std::uint8_t>(y, x) == 2);
      if (mask.at<std::uint8_t>(y, x) == 0) continue;
      ++n;
      // No part of an M200 is farther than 0.6 m from its centre.
      EXPECT_NEAR(depth.at<std::uint16_t>(y, x) / 256.0, target.depth_m, 0.6);
      const double true_px = target.left.centre_px[0] - target.right.centre_px[0];
      EXPECT_NEAR(disparity.at<std::uint16_t>(y, x) / 256.0 / true_px, 1,
                  0.6 / target.depth_m + 0.02);
    }
  }
  EXPECT_GT(n, 20);
}

// A reader for each format, field by field after its description.
TEST(Export, ReadersOfEachFormatTakeIt) {
  const std::string python = "/usr/bin/python3";
  if (Program({python, "-c", "import numpy, pandas, yaml"}).Wait() != 0) {
    GTEST_SKIP() << "python3-numpy, python3-pandas or python3-yaml is not installed";
  }
  const std::string reader = std::string(WINDHOVER_SOURCE_DIR) + "/tests/dataset/read_formats.py";
  for (const std::string& name : NamesOf<DatasetFormat>()) {
    SCOPED_TRACE(name);
    const TemporaryFolder folder;
    const ExportPlan plan = PlanOf(folder.path() / "set", *ValueNamed<DatasetFormat>(name), 24, 2);
    ASSERT_TRUE(Export(plan, GoOn));
    Program read({python, reader, name, plan.folder.string()});
    EXPECT_EQ(read.Wait(), 0) << read.Err();
    EXPECT_GE(std::atoi(read.Out().c_str()), 20);
  }
}

TEST(Export, AnotherSeedIsAnotherDataSet) {
  const PosedFlight one = FlightsOfDataset(SmallBase(), 1, 12).fly(0);
  const PosedFlight two = FlightsOfDataset(SmallBase(), 2, 12).fly(0);
  EXPECT_NE(one.pairs[0].world.uavs[1].p_WB_m[1], two.pairs[0].world.uavs[1].p_WB_m[1]);
}

TEST(Export, RefusesAFolderThatHoldsSomethingElse) {
  const TemporaryFolder folder;
  const fs::path other = folder.path() / "other", unfinished = folder.path() / "unfinished";
  fs::create_directories(other);
  std::ofstream(other / "thesis.tex") << "years of work";
  const auto message = [](const ExportPlan& plan) -> std::string {
    try {
      Export(plan, GoOn);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(
      message(PlanOf(other, DatasetFormat::kTum, 12)),
      HasSubstr("--out must be new, empty or the same export unfinished (found other files"));
  EXPECT_EQ(TextOf(other / "thesis.tex"), "years of work");
  ASSERT_FALSE(
      Export(PlanOf(unfinished, DatasetFormat::kYolo, 12), [](int, int) { return false; }));
  EXPECT_THAT(message(PlanOf(unfinished, DatasetFormat::kCoco, 12)),
              HasSubstr("found another one"));
  EXPECT_THAT(message(PlanOf(other / "thesis.tex" / "x", DatasetFormat::kTum, 12)),
              HasSubstr("--out must be"));
}

TEST(Export, RefusesALensThatTheFormatCannotExpress) {
  const TemporaryFolder folder;
  ExportPlan plan = PlanOf(folder.path() / "x", DatasetFormat::kEuroc, 12);
  plan.source = FlightsOfDataset(Base({"rig.distortion.k3=0.5"}), 1, 12);
  EXPECT_THROW(Export(plan, GoOn), ConfigError);
  EXPECT_FALSE(fs::exists(folder.path() / "x"));
}

}  // namespace
}  // namespace windhover
