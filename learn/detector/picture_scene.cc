#include "learn/detector/picture_scene.h"

#include <utility>

#include "common/image/frame_encoding.h"
#include "render/sensor.h"
#include "render/stereo_renderer.h"

namespace windhover {
namespace {

LabelledPicture PictureOf(RgbImage&& drawn, const target_view_t& view, const FrameFormat& format) {
  RgbImage image = AsReceived(std::move(drawn), format);
  LabelledPicture picture;
  picture.rgb = cv::Mat(image.height_px, image.width_px, CV_8UC3, image.pixels.data()).clone();
  if (view.in_front != 0 && view.visible.w_px > 0) picture.box = view.visible;
  picture.occlusion = view.occlusion;
  picture.truncation = view.truncation;
  return picture;
}

}  // namespace

PictureScene::PictureScene(const Scenario& base, const PictureConfig& config, int scene)
    : plan_(PlanPictures(base, config, scene)),
      renderer_(std::make_unique<StereoRenderer>(plan_.scenario, std::vector<int>{0},
                                                 /*threads=*/1, plan_.shapes)) {}

PictureScene::~PictureScene() = default;

LabelledPair PictureScene::Draw(int i) {
  RenderedPair drawn =
      std::move(renderer_->Render(plan_.worlds[static_cast<std::size_t>(i)], i).front());
  const target_annotation_t& target = drawn.annotation.targets.front();
  const FrameFormat format = FrameFormatOf(plan_.scenario.sensor);
  LabelledPair pair;
  pair.eyes[0] = PictureOf(std::move(drawn.left), target.left, format);
  pair.eyes[1] = PictureOf(std::move(drawn.right), target.right, format);
  pair.kind = plan_.kind;
  pair.range_m = target.range_m;
  return pair;
}

}  // namespace windhover
