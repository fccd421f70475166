#include <algorithm>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "common/image/image_file.h"
#include "learn/detector/crop.h"
#include "learn/detector/labelled_folder.h"
#include "learn/detector/picture_samples.h"
#include "learn/detector/picture_scene.h"
#include "learn/detector/replay_source.h"
#include "network/box_network.h"
#include "network/detector_input.h"
#include "network/yolox.h"
#include "tests/support/image_box.h"
#include "tests/support/temporary_folder.h"

namespace windhover {
namespace {

bool AreEqual(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0;
}

/// 20 × 10 px whose red tells the column and green the row, with a box of 4 × 2 px.
DetectorSample Chart() {
  DetectorSample sample{.rgb = cv::Mat(10, 20, CV_8UC3), .box = Box(6.5, 3.5, 4, 2)};
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 20; ++x) {
      sample.rgb.at<cv::Vec3b>(y, x) = {static_cast<uchar>(x), static_cast<uchar>(y), 9};
    }
  }
  return sample;
}

TEST(Crop, CutsTheBoxAtItsBorders) {
  // The box covers columns 5 to 8 and rows 3 and 4; the crop begins at column 7 and row 2.
  const auto crop = Cropped(Chart(), 7, 2, {8, 6}, 0.5);
  ASSERT_TRUE(crop && crop->box);
  EXPECT_EQ(crop->rgb.at<cv::Vec3b>(0, 0), cv::Vec3b(7, 2, 9));
  EXPECT_EQ(crop->rgb.size(), cv::Size(8, 6));
  EXPECT_DOUBLE_EQ(crop->box->x_px, 0.5);  // Columns 7 and 8.
  EXPECT_DOUBLE_EQ(crop->box->w_px, 2);
  EXPECT_DOUBLE_EQ(crop->box->y_px, 1.5);
  EXPECT_DOUBLE_EQ(crop->box->h_px, 2);
}

TEST(Crop, IsNothingWhereTooLittleOfTheBoxIsLeft) {
  EXPECT_FALSE(Cropped(Chart(), 7, 2, {8, 6}, 0.51));
  const auto beside = Cropped(Chart(), 9, 2, {8, 6}, 0.51);
  ASSERT_TRUE(beside);
  EXPECT_FALSE(beside->box);
}

TEST(Crop, ShowsTheBoxOrNothingOfIt) {
  RandomStream random(1, "crop");
  std::set<int> places;
  for (int i = 0; i < 300; ++i) {
    const bool shows_box = i % 2 == 0;
    const auto crop = RandomCrop(Chart(), {8, 6}, shows_box, &random);
    if (!crop && !shows_box) continue;  // Few places show nothing of it.
    ASSERT_TRUE(crop);
    ASSERT_EQ(crop->box.has_value(), shows_box);
    const cv::Vec3b first = crop->rgb.at<cv::Vec3b>(0, 0);
    if (!shows_box) {
      EXPECT_TRUE(first[0] >= 9 || first[1] >= 5) << first;
      continue;
    }
    places.insert(first[0]);
    EXPECT_GE(crop->box->w_px * crop->box->h_px, 0.6 * 8);
    EXPECT_DOUBLE_EQ(crop->box->x_px + crop->box->w_px / 2 + first[0],
                     std::min(8.5, first[0] + 7.5));  // The box's right edge, or the crop's.
  }
  EXPECT_THAT(places, testing::IsSupersetOf({1, 2, 3, 4, 5}));
}

TEST(Crop, CannotShowWhatIsNotThere) {
  RandomStream random(1, "crop");
  DetectorSample empty = Chart();
  empty.box.reset();
  EXPECT_FALSE(RandomCrop(empty, {8, 6}, true, &random));
  DetectorSample full = Chart();
  full.box = Box(9.5, 4.5, 20, 10);
  EXPECT_FALSE(RandomCrop(full, {8, 6}, false, &random));
}

TEST(Crop, MirrorsPixelsAndBoxes) {
  const DetectorSample mirrored = Mirrored(Chart());
  EXPECT_EQ(mirrored.rgb.at<cv::Vec3b>(3, 19 - 5), cv::Vec3b(5, 3, 9));
  EXPECT_DOUBLE_EQ(mirrored.box->x_px, 12.5);  // Columns 11 to 14.
  EXPECT_TRUE(AreEqual(Mirrored(mirrored).rgb, Chart().rgb));
}

/// Scenes of two pictures of 16 × 16 px, one with a box; their colour tells the scene.
std::vector<DetectorSample> ColouredScene(int scene) {
  const cv::Mat picture(16, 16, CV_8UC3, cv::Scalar::all(scene));
  return {{.rgb = picture, .box = Box(7, 7, 4, 4)}, {.rgb = picture, .box = std::nullopt}};
}

ReplayConfig SmallReplay() {
  return {.seed = 3,
          .batch = 8,
          .size = {8, 8},
          .positive_share = 0.7,
          .whole_every = 4,
          .whole_batch = 6,
          .first_scenes = 2,
          .steps_per_scene = 5,
          .scenes_kept = 3};
}

TEST(ReplaySource, GivesTheSameBatchWhereverItBegan) {
  ReplaySource whole(ColouredScene, SmallReplay());
  for (int step = 0; step < 40; ++step) {
    const auto batch = whole.Batch(step);
    if (step % 13 != 0) continue;
    const auto again = ReplaySource(ColouredScene, SmallReplay()).Batch(step);
    for (std::size_t i = 0; i < batch.size(); ++i) {
      EXPECT_TRUE(AreEqual(batch[i].rgb, again[i].rgb)) << step;
      EXPECT_EQ(batch[i].box.has_value(), again[i].box.has_value());
    }
  }
  EXPECT_TRUE(
      AreEqual(whole.Batch(2)[0].rgb, ReplaySource(ColouredScene, SmallReplay()).Batch(2)[0].rgb));
}

TEST(ReplaySource, DrawsFromTheNewestScenes) {
  std::vector<int> made;
  ReplaySource source(
      [&](int scene) {
        made.push_back(scene);
        return ColouredScene(scene);
      },
      SmallReplay());
  EXPECT_EQ(source.ScenesUntil(0), 2);
  EXPECT_EQ(source.ScenesUntil(15), 5);
  source.Batch(15);  // Scenes 2, 3 and 4; 5 is made beside it.
  source.Batch(20);
  source.Batch(20);
  EXPECT_THAT(std::vector<int>(made.begin(), made.begin() + 4), testing::ElementsAre(2, 3, 4, 5));
}

TEST(ReplaySource, KeepsTheShareOfPicturesWithABox) {
  ReplaySource source(ColouredScene, SmallReplay());
  int n = 0, with_box = 0;
  for (int step = 0; step < 250; ++step) {
    for (const DetectorSample& sample : source.Batch(step)) {
      ++n;
      with_box += sample.box.has_value();
      ASSERT_EQ(sample.rgb.size(), step % 4 == 0 ? cv::Size(16, 16) : cv::Size(8, 8));
    }
  }
  EXPECT_NEAR(with_box, 0.7 * n, 4 * std::sqrt(n * 0.7 * 0.3));  // Four standard deviations.
}

TEST(ReplaySource, TakesWhatThereIs) {
  ReplayConfig config = SmallReplay();
  config.positive_share = 1;
  const cv::Mat picture = cv::Mat::zeros(16, 16, CV_8UC3);
  const auto source_of = [&](const std::optional<image_box_t>& box) {
    return ReplaySource([=](int) { return std::vector{DetectorSample{picture, box}}; }, config);
  };
  EXPECT_FALSE(source_of(std::nullopt).Batch(1)[0].box);
  // A quarter of a box that fills the picture is neither an aircraft nor none.
  EXPECT_THROW(source_of(Box(7.5, 7.5, 16, 16)).Batch(1), std::runtime_error);
}

Scenario SmallRig() {
  Scenario scenario;
  scenario.description = "test";
  scenario.rig.calibrated.image = {320, 180};
  scenario.rig.calibrated.pixel_um = 4 * 3.7325;
  scenario.rig.calibrated.distortion.k1 = -0.1;
  scenario.aircraft.resize(1);
  return scenario;
}

PictureConfig FewPictures() {
  PictureConfig config;
  config.pairs = 4;
  return config;
}

TEST(PictureScene, IsAFunctionOfItsNumber) {
  const LabelledPair pair = PictureScene(SmallRig(), FewPictures(), 3).Draw(2);
  PictureScene scene(SmallRig(), FewPictures(), 3);
  scene.Draw(0);
  const LabelledPair again = scene.Draw(2);
  EXPECT_TRUE(AreEqual(pair.eyes[0].rgb, again.eyes[0].rgb));
  EXPECT_TRUE(AreEqual(pair.eyes[1].rgb, again.eyes[1].rgb));
  EXPECT_EQ(pair.range_m, again.range_m);
  EXPECT_FALSE(
      AreEqual(pair.eyes[0].rgb, PictureScene(SmallRig(), FewPictures(), 4).Draw(2).eyes[0].rgb));
}

// The same scene without its target differs inside of the label alone, and up to near its edges.
TEST(PictureScene, LabelsWhatTheTargetChanges) {
  Scenario base = SmallRig();
  base.sensor.noise = false;
  PictureConfig with = FewPictures(), without = with;
  with.is_randomised = without.is_randomised = false;
  with.most_distractors = without.most_distractors = 0;
  with.empty_share = 0;
  without.empty_share = 1;
  with.nearest_m = 5;
  with.farthest_m = 12;
  int n = 0;
  for (int number = 0; number < 6; ++number) {
    PictureScene scene(base, with, number), bare(base, without, number);
    for (int i = 0; i < 2; ++i) {
      const LabelledPicture picture = scene.Draw(i).eyes[1], nothing = bare.Draw(i).eyes[1];
      ASSERT_FALSE(nothing.box);
      if (!picture.box || picture.truncation > 0) continue;
      cv::Mat difference, changed;
      cv::absdiff(picture.rgb, nothing.rgb, difference);
      cv::extractChannel(difference, changed, 1);
      const cv::Rect seen = cv::boundingRect(changed > 1);
      const image_box_t& box = *picture.box;
      ++n;
      // A pixel is changed by what covers a part of it, and during half of the 2 ms about the
      // label's moment 0.8 rad/s move it by 0.64 px, 4 m/s at 5 m by as much. Blades fade out.
      constexpr double kBeyond_px = 0.5 + 2 * 0.64;
      EXPECT_GE(seen.x, box.x_px - box.w_px / 2 - kBeyond_px);
      EXPECT_LE(seen.x + seen.width - 1, box.x_px + box.w_px / 2 + kBeyond_px);
      EXPECT_GE(seen.y, box.y_px - box.h_px / 2 - kBeyond_px);
      EXPECT_LE(seen.y + seen.height - 1, box.y_px + box.h_px / 2 + kBeyond_px);
      EXPECT_GE(seen.width, 0.75 * box.w_px);
      EXPECT_GE(seen.height, 0.75 * box.h_px);
    }
  }
  EXPECT_GE(n, 6);
}

TEST(PictureScene, HoldsSurroundingsBackForTests) {
  PictureConfig train = FewPictures(), test = train;
  test.split = Split::kTest;
  std::set<EnvironmentType> trained;
  std::set<TargetKind> kinds;
  for (int scene = 0; scene < 40; ++scene) {
    const PicturePlan plan = PlanPictures(SmallRig(), train, scene);
    trained.insert(plan.scenario.environment.type);
    kinds.insert(plan.kind);
    EXPECT_EQ(PlanPictures(SmallRig(), test, scene).scenario.environment.type,
              EnvironmentType::kBasketballCourt);
    EXPECT_EQ(plan.worlds.size(), 4u);
    EXPECT_EQ(plan.worlds[0].uavs.size(), plan.scenario.aircraft.size());
  }
  EXPECT_EQ(trained, (std::set{EnvironmentType::kPlayground, EnvironmentType::kForest,
                               EnvironmentType::kBuildings}));
  EXPECT_EQ(kinds.size(), 4u);
}

TEST(PictureScene, IsBeforePanoramasWhereGiven) {
  PictureConfig config = FewPictures();
  config.most_distractors = 0;
  config.backgrounds.resize(1);
  config.backgrounds[0].type = EnvironmentType::kPanorama;
  int n = 0;
  for (int scene = 0; scene < 40; ++scene) {
    const auto plan = PlanPictures(SmallRig(), config, scene);
    n += plan.scenario.environment.type == EnvironmentType::kPanorama;
  }
  EXPECT_NEAR(n, 10, 4 * std::sqrt(40 * 0.25 * 0.75));  // One of four; four standard deviations.
}

LabelledPicture GreyPicture() {
  LabelledPicture picture;
  picture.rgb = cv::Mat(720, 1280, CV_8UC3, cv::Scalar::all(50));
  picture.box = Box(639.5, 359.5, 300, 150);
  cv::rectangle(picture.rgb, cv::Rect(490, 285, 300, 150), cv::Scalar::all(200), cv::FILLED);
  return picture;
}

TEST(PictureSamples, LetterboxesPictureAndLabel) {
  const DetectorSample sample = WholeSample(GreyPicture());
  EXPECT_EQ(sample.rgb.size(), cv::Size(352, 192));
  // 192 rows hold 720, 3.75 each: 341.3 columns of picture.
  EXPECT_NEAR(sample.box->w_px, 80, 1e-9);
  EXPECT_NEAR(sample.box->h_px, 40, 1e-9);
  EXPECT_NEAR(sample.box->x_px, 640 / 3.75 - 0.5, 1e-9);
  EXPECT_NEAR(sample.box->y_px, 95.5, 1e-9);
  EXPECT_EQ(sample.rgb.at<cv::Vec3b>(95, 170), cv::Vec3b(200, 200, 200));
  EXPECT_EQ(sample.rgb.at<cv::Vec3b>(95, 125), cv::Vec3b(50, 50, 50));
}

TEST(PictureSamples, LooksAgainAroundTheTargetAndElsewhere) {
  RandomStream random(2, "refinement");
  int with_box = 0, without = 0;
  for (int i = 0; i < 50; ++i) {
    for (const DetectorSample& sample : RefinementSamples(GreyPicture(), 3, {}, &random)) {
      ASSERT_EQ(sample.rgb.size(), cv::Size(128, 128));
      (sample.box ? with_box : without) += 1;
      if (!sample.box) continue;
      const cv::Rect seen = cv::boundingRect([&] {
        cv::Mat green;
        cv::extractChannel(sample.rgb, green, 1);
        return cv::Mat(green > 157);  // The middle between grey beyond the picture and the target.
      }());
      EXPECT_NEAR(seen.x - 0.5, sample.box->x_px - sample.box->w_px / 2, 1);
      EXPECT_NEAR(seen.width, sample.box->w_px, 1.5);
      EXPECT_NEAR(seen.height, sample.box->h_px, 1.5);
    }
  }
  EXPECT_EQ(with_box, 100);
  EXPECT_GT(without, 10);
}

// Places: a mistake; one with 0.12 of the target, whose crop shows it; 0.53; two more mistakes.
TEST(PictureSamples, LooksWhereTheFirstNetworkDid) {
  RandomStream random(3, "places");
  const std::vector<image_box_t> places = {Box(1100, 150, 60, 60), Box(459.5, 359.5, 200, 100),
                                           Box(600, 340, 200, 150), Box(150, 600, 100, 40),
                                           Box(1000, 650, 80, 80)};
  const auto samples = RefinementSamples(GreyPicture(), 3, places, &random);
  const auto seen = [](const image_box_t& box) {
    return SeenThrough(CropWindow(box, 1.6, {128, 128}), GreyPicture().rgb);
  };
  ASSERT_EQ(samples.size(), 4u);
  EXPECT_TRUE(AreEqual(samples[0].rgb, seen(places[2])));
  // The crop of 320 px, 2.5 to one of the input, is from 440 to 760, the target from 489.5 on.
  EXPECT_NEAR(samples[0].box->x_px, ((489.5 + 760) / 2 - 440) / 2.5 - 0.5, 1e-9);
  EXPECT_TRUE(samples[1].box);
  EXPECT_FALSE(samples[2].box);
  EXPECT_TRUE(AreEqual(samples[2].rgb, seen(places[0])));
  EXPECT_TRUE(AreEqual(samples[3].rgb, seen(places[3])));
}

TEST(PictureSamples, HaveThePlacesOfAFirstNetwork) {
  const LayerTable table = MakeYolox("yolox_small").table;
  const NetworkModel first{table, RandomWeights(table, 2), /*height=*/64, /*width=*/96, ""};
  const cv::Mat rgb = GreyPicture().rgb;
  const auto boxes = BoxNetwork(first, 1).FindInWhole({&rgb, 1}, kWorthALook).at(0);
  const auto places = PlacesFoundBy(first)(rgb);
  ASSERT_FALSE(boxes.empty());
  ASSERT_EQ(places.size(), boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    EXPECT_EQ(places[i].x_px, boxes[i].box.x_px) << i;
    EXPECT_EQ(places[i].w_px, boxes[i].box.w_px) << i;
  }
}

TEST(PictureSamples, LeavesOutWhatIsHardlyThere) {
  LabelledPicture picture = GreyPicture();
  EXPECT_TRUE(IsClear(picture));
  picture.occlusion = 0.7;
  EXPECT_FALSE(IsClear(picture));
  picture.occlusion = 0;
  picture.truncation = 0.7;
  EXPECT_FALSE(IsClear(picture));
  picture.box.reset();
  EXPECT_TRUE(IsClear(picture));
}

/// Two pictures as `windhover export --format yolo` writes them: one aircraft, and none.
void WriteFolder(const TemporaryFolder& folder) {
  folder.Write("labels/train/a_left.txt", "0 0.5000000 0.5000000 0.2500000 0.1250000\n");
  folder.Write("labels/train/b_left.txt", "");
  folder.Write("images/train/x", "");
  const cv::Mat picture(160, 320, CV_8UC3, cv::Scalar(10, 20, 200));  // Red, as OpenCV has it.
  WriteImageFile(picture, folder.path() / "images/train/a_left.png");
  WriteImageFile(picture, folder.path() / "images/train/b_left.png");
}

TEST(LabelledFolder, ReadsPicturesAndBoxes) {
  const TemporaryFolder folder;
  WriteFolder(folder);
  const auto files = ReadLabelledFolder(folder.path());
  ASSERT_EQ(files.size(), 2u);
  ASSERT_EQ(files[0].boxes.size(), 1u);
  EXPECT_DOUBLE_EQ(files[0].boxes[0].x_px, 159.5);
  EXPECT_DOUBLE_EQ(files[0].boxes[0].y_px, 79.5);
  EXPECT_DOUBLE_EQ(files[0].boxes[0].w_px, 80);
  EXPECT_DOUBLE_EQ(files[0].boxes[0].h_px, 20);
  EXPECT_EQ(files[0].rgb.at<cv::Vec3b>(5, 5), cv::Vec3b(200, 20, 10));
  EXPECT_TRUE(files[1].boxes.empty());
  EXPECT_EQ(MakeFolderSource(files, false, {.batch = 6})->Batch(1).size(), 6u);
  EXPECT_EQ(MakeFolderSource(files, true, {.batch = 6})->Batch(1)[0].rgb.size(),
            cv::Size(128, 128));
}

TEST(LabelledFolder, PaintsOtherAircraftOver) {
  const LabelledFile file{.file = {},
                          .rgb = cv::Mat(160, 320, CV_8UC3, cv::Scalar::all(9)),
                          .boxes = {Box(50, 50, 20, 10), Box(200, 80, 20, 10)}};
  const auto pictures = PicturesOf(file);
  ASSERT_EQ(pictures.size(), 2u);
  EXPECT_EQ(pictures[0].rgb.at<cv::Vec3b>(50, 50), cv::Vec3b(9, 9, 9));
  EXPECT_EQ(pictures[0].rgb.at<cv::Vec3b>(80, 200), cv::Vec3b(114, 114, 114));
  EXPECT_EQ(pictures[1].box->x_px, 200);
}

TEST(LabelledFolder, SaysAllThatIsWrong) {
  const TemporaryFolder folder;
  WriteFolder(folder);
  std::filesystem::remove(folder.path() / "labels/train/b_left.txt");
  folder.Write("labels/train/a_left.txt",
               "0 0.5 0.5 0.25 0.125\n0 0.5 0.5 0.25\n0 0.9 0.5 0.25 0.125\n"
               "drone 0.5 0.5 0.1 0.1\n0 nan 0.5 0.1 0.1\n0 0.5 0.5 0 0.1\n");
  folder.Write("images/train/c_left.png", "no picture");
  folder.Write("labels/train/c_left.txt", "");
  try {
    ReadLabelledFolder(folder.path());
    FAIL() << "no error";
  } catch (const ConfigError& error) {
    const std::string what = error.what();
    for (const int line : {2, 3, 4, 5, 6}) {
      EXPECT_THAT(what, testing::HasSubstr("a_left.txt:" + std::to_string(line) + ": must be"));
    }
    EXPECT_THAT(what, testing::Not(testing::HasSubstr("a_left.txt:1:")));
    EXPECT_THAT(what, testing::HasSubstr("b_left.png: must have a label file"));
    EXPECT_THAT(what, testing::HasSubstr("c_left.png: must be a picture"));
  }
  EXPECT_THROW(ReadLabelledFolder(folder.path() / "labels"), ConfigError);
}

TEST(MixedSource, JoinsItsParts) {
  const auto of = [](int grey) {
    const cv::Mat picture(8, 8, CV_8UC3, cv::Scalar::all(grey));
    return std::make_unique<ReplaySource>(
        [=](int) {
          return std::vector{DetectorSample{picture, std::nullopt}};
        },
        SmallReplay());
  };
  const auto batch = Mixed(of(0), of(250), 0.25)->Batch(1);
  ASSERT_EQ(batch.size(), 8u);
  // Varied colours stay dark or bright.
  for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(cv::mean(batch[i].rgb)[0] < 90, i < 2) << i;
  EXPECT_LT(cv::mean(Mixed(of(0), of(250), 0.01)->Batch(1)[0].rgb)[0], 90);  // One at least.
}

}  // namespace
}  // namespace windhover
