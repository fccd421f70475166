// Lenses, shutters and sensors in whole frames: labels and pixels tell the same.

#include <cmath>

#include <gtest/gtest.h>

#include "common/image/srgb.h"
#include "render/stereo_renderer.h"
#include "tests/render/render_examples.h"

namespace windhover {
namespace {

constexpr double kFocal_px = 12e3 / 7.465;

// An observer and one target 12 m ahead; no noise.
Scenario Pair() {
  Scenario scenario = ExampleScenario(Observe::kImage);
  scenario.sensor.noise = false;
  scenario.aircraft.resize(2);
  return scenario;
}

world_truth_t PairWorld(double yaw_rate_radps = 0) {
  world_truth_t world = ExampleWorld();
  world.uavs.resize(2);
  world.n_uavs = 2;
  world.uavs[0].w_WB_B_radps[2] = yaw_rate_radps;
  return world;
}

RenderedPair Render(const Scenario& scenario, const world_truth_t& world) {
  return std::move(StereoRenderer(scenario, {0}, 2).Render(world, 3)[0]);
}

void ExpectBoxesNear(const image_box_t& a, const image_box_t& b, double tolerance_px) {
  EXPECT_NEAR(a.x_px - a.w_px / 2, b.x_px - b.w_px / 2, tolerance_px);
  EXPECT_NEAR(a.x_px + a.w_px / 2, b.x_px + b.w_px / 2, tolerance_px);
  EXPECT_NEAR(a.y_px - a.h_px / 2, b.y_px - b.h_px / 2, tolerance_px);
  EXPECT_NEAR(a.y_px + a.h_px / 2, b.y_px + b.h_px / 2, tolerance_px);
}

// V3.5: what is drawn is where the vertices are projected, to half a sample, by every lens.
TEST(Imaging, EveryLensDrawsWhereItProjects) {
  for (const LensModel model : {LensModel::kRadtan, LensModel::kRational, LensModel::kThinPrism,
                                LensModel::kKannalaBrandt}) {
    Scenario scenario = Pair();
    LensConfig& lens = scenario.rig.calibrated.distortion;
    lens.model = model;
    lens.k1 = -0.3;
    lens.k4 = 0.1;
    lens.s1 = model == LensModel::kThinPrism ? 0.01 : 0;
    const annotation_t annotation = Render(scenario, PairWorld()).annotation;
    for (const target_view_t& view : {annotation.targets[0].left, annotation.targets[0].right}) {
      ASSERT_GT(view.visible.w_px, 50);
      ExpectBoxesNear(view.visible, view.full, 0.5);
    }
  }
}

// A right camera that is 10 ms late sees the target turn by 0.5 rad/s · 10 ms · f = 8.04 px more,
// in the boxes of geometry and in those of the pixels. The lens compresses by up to 1 %.
TEST(Imaging, SkewMovesTheRightImageAlone) {
  Scenario scenario = Pair();
  const annotation_t together = Render(scenario, PairWorld(0.5)).annotation;
  scenario.exposure.skew_ms = 10;
  const annotation_t late = Render(scenario, PairWorld(0.5)).annotation;
  const target_annotation_t &a = together.targets[0], &b = late.targets[0];
  EXPECT_EQ(a.left.full.x_px, b.left.full.x_px);
  const double shift_px = 0.5 * 0.010 * kFocal_px;
  EXPECT_NEAR(b.right.full.x_px - a.right.full.x_px, shift_px, 0.02 * shift_px);
  EXPECT_NEAR(b.right.visible.x_px - a.right.visible.x_px, shift_px, 0.02 * shift_px + 0.5);
  EXPECT_EQ(a.range_m, b.range_m);
}

// V3.7: while the camera yaws at 2 rad/s, a rolling shutter of 44 us a row shears the image by
// ω f t_line a row; boxes of geometry and of pixels agree as for a global shutter.
TEST(Imaging, RollingShutterShearsPixelsAndBoxesAlike) {
  Scenario scenario = Pair();
  scenario.exposure.duration_ms = 0.1;
  const annotation_t global = Render(scenario, PairWorld(2)).annotation;
  scenario.exposure.shutter = Shutter::kRolling;
  world_truth_t world = PairWorld(2);
  const annotation_t rolling = Render(scenario, world).annotation;
  const target_view_t &a = global.targets[0].left, &b = rolling.targets[0].left;
  ExpectBoxesNear(b.visible, b.full, 0.5);
  const double shear = 2 * kFocal_px * 44e-6;  // 0.141 px a row.
  // The centre is off the middle row, so that it is seen early or late.
  const double late_rows = a.centre_px[1] - (360 - 1) / 2.0;
  EXPECT_NEAR(b.centre_px[0] - a.centre_px[0], shear * late_rows,
              0.03 * std::abs(shear * late_rows));
  EXPECT_GT(std::abs(b.centre_px[0] - a.centre_px[0]), 0.5);
}

double Light(const RgbImage& image, int x0, int x1, int y0, int y1) {
  double sum = 0;
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) sum += LinearFromSrgb(image.Row(y)[3 * x + 1] / 255.0);
  }
  return sum;
}

// V3.11: a corner keeps cos⁴ of its light. A wide lens, so that it shows: f = 402 px.
TEST(Imaging, VignettingIsCosineToTheFourth) {
  Scenario scenario = Pair();
  scenario.rig.calibrated.focal_mm = 3;
  scenario.rig.calibrated.distortion.k1 = 0;
  scenario.rig.misalignment = {};
  const RgbImage plain = Render(scenario, PairWorld()).left;
  scenario.optics.vignetting = true;
  const RgbImage dark = Render(scenario, PairWorld()).left;
  for (const auto& [x, y] : {std::pair{20, 20}, std::pair{620, 20}, std::pair{320, 20}}) {
    const double ratio =
        Light(dark, x - 10, x + 10, y - 10, y + 10) / Light(plain, x - 10, x + 10, y - 10, y + 10);
    const double focal_px = kFocal_px / 4;
    const double tangent = std::hypot(x - 319.5, y - 179.5) / focal_px;
    // Bytes of about 128 are known to 1 % of their light.
    EXPECT_NEAR(ratio, std::pow(1 + tangent * tangent, -2), 0.01) << x << " " << y;
  }
}

// Defocus smooths the target and leaves its place: labels do not change.
TEST(Imaging, DefocusSmoothsInPlace) {
  Scenario scenario = Pair();
  const RenderedPair sharp = Render(scenario, PairWorld());
  scenario.optics.f_number = 1.4;
  scenario.optics.focus_m = 2;
  const RenderedPair soft = Render(scenario, PairWorld());
  const auto roughness = [](const RgbImage& image) {
    double sum = 0;
    for (int x = 1; x < image.width_px; ++x) {
      sum += std::abs(image.Row(180)[3 * x] - image.Row(180)[3 * x - 3]);
    }
    return sum;
  };
  EXPECT_LT(roughness(soft.left), 0.7 * roughness(sharp.left));
  EXPECT_NEAR(Light(soft.left, 0, 640, 0, 360) / Light(sharp.left, 0, 640, 0, 360), 1, 0.01);
}

// V3.10: from a scene four times too bright for the exposure, within ten frames to 3 %.
TEST(Imaging, AutoExposureReachesItsTarget) {
  Scenario scenario = Pair();
  scenario.exposure.auto_exposure.mode = AutoExposureMode::kIndependent;
  scenario.exposure.auto_exposure.target = 0.1;
  scenario.environment.brightness = 0.6;
  scenario.exposure.duration_ms = 4;
  StereoRenderer renderer(scenario, {0}, 2);
  RgbImage image;
  double exposure_s = 0;
  for (int frame = 0; frame <= 10; ++frame) {
    RenderedPair pair = std::move(renderer.Render(PairWorld(), frame)[0]);
    image = std::move(pair.left);
    exposure_s = pair.exposure_s;
  }
  EXPECT_NEAR(Sensor(scenario.sensor).MeanLight(image) / 0.1, 1, 0.03);
  EXPECT_NE(exposure_s, 0.004);
}

// V3.12: JPEG of quality 95 keeps a frame to 38 dB, and a target in its place: the centroid of
// what the target changes moves by less than 0.3 px.
TEST(Imaging, JpegKeepsFramesAndTargets) {
  const Scenario scenario = Pair();
  world_truth_t empty = PairWorld();
  empty.uavs[1] = TruthAt(1, {-50, 0, 10});
  const RgbImage with = Render(scenario, PairWorld()).left, without = Render(scenario, empty).left;
  const FrameFormat format{.is_bayer = false, .jpeg_quality = 95};
  const RgbImage received = AsReceived(with, format);
  double squares = 0;
  for (std::size_t i = 0; i < with.pixels.size(); ++i) {
    squares += std::pow(with.pixels[i] - received.pixels[i], 2);
  }
  const double mean_square = squares / static_cast<double>(with.pixels.size());
  EXPECT_GT(10 * std::log10(255 * 255 / mean_square), 38);
  EXPECT_GT(mean_square, 0);
  const auto centroid = [&without](const RgbImage& image, int axis) {
    double sum = 0, moment = 0;
    for (int y = 0; y < image.height_px; ++y) {
      for (int x = 0; x < image.width_px; ++x) {
        const bool is_changed = std::abs(image.Row(y)[3 * x] - without.Row(y)[3 * x]) > 25;
        sum += is_changed;
        moment += is_changed * (axis == 0 ? x : y);
      }
    }
    return moment / sum;
  };
  EXPECT_NEAR(centroid(received, 0), centroid(with, 0), 0.3);
  EXPECT_NEAR(centroid(received, 1), centroid(with, 1), 0.3);
}

// Colours come back from the mosaic but for edges.
TEST(Imaging, BayerFramesAreMosaics) {
  const RgbImage image = Render(Pair(), PairWorld()).left;
  const FrameFormat format{.is_bayer = true, .jpeg_quality = 0};
  const image_t message = EncodeFrame(RgbImage(image), 5, format);
  EXPECT_EQ(message.pixelformat, image_t::PIXEL_FORMAT_BAYER_RGGB);
  EXPECT_EQ(message.row_stride, 640);
  ASSERT_EQ(message.data.size(), 640u * 360u);
  for (const auto& [x, y, c] : {std::tuple{100, 100, 0}, std::tuple{101, 100, 1},
                                std::tuple{100, 101, 1}, std::tuple{101, 101, 2}}) {
    EXPECT_EQ(message.data[static_cast<std::size_t>(y * 640 + x)], image.Row(y)[3 * x + c]);
  }
  const RgbImage received = AsReceived(image, format);
  double error = 0;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    error += std::abs(image.pixels[i] - received.pixels[i]);
  }
  EXPECT_LT(error / static_cast<double>(image.pixels.size()), 6);
}

// BT.709's luminance of the linear light, then the curve; a single channel of noise.
TEST(Imaging, GreyFramesHoldLuminance) {
  Scenario scenario = Pair();
  scenario.sensor.noise = false;
  const RgbImage colour = Render(scenario, PairWorld()).left;
  scenario.sensor.grey = true;
  const RgbImage grey = Render(scenario, PairWorld()).left;
  const FrameFormat format = FrameFormatOf(scenario.sensor);
  const image_t message = EncodeFrame(RgbImage(grey), 5, format);
  EXPECT_EQ(message.pixelformat, image_t::PIXEL_FORMAT_GRAY);
  ASSERT_EQ(message.data.size(), 640u * 360u);
  for (std::size_t i = 0; i < message.data.size(); i += 1009) {
    const auto light = [&](std::size_t c) {
      return LinearFromSrgb(colour.pixels[3 * i + c] / 255.0);
    };
    const double luminance = 0.2126 * light(0) + 0.7152 * light(1) + 0.0722 * light(2);
    // The colours were rounded: half a grey level each.
    EXPECT_NEAR(message.data[i], 255 * SrgbFromLinear(luminance), 1.1) << i;
  }
  EXPECT_EQ(AsReceived(grey, format).pixels[3], message.data[1]);
  const image_t jpeg = EncodeFrame(RgbImage(grey), 5, {.is_grey = true, .jpeg_quality = 95});
  EXPECT_EQ(jpeg.pixelformat, image_t::PIXEL_FORMAT_MJPEG);
}

}  // namespace
}  // namespace windhover
