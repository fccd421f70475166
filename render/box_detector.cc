#include "render/box_detector.h"

#include <algorithm>
#include <tuple>

namespace windhover {
namespace {

detection_t EmptyDetection(const annotation_t& annotation, const char* detector) {
  detection_t detection{};
  detection.utime = annotation.utime;
  detection.observer_id = annotation.observer_id;
  detection.detector = detector;
  return detection;
}

void Finish(detection_t* detection) {
  std::stable_sort(detection->boxes.begin(), detection->boxes.end(),
                   [](const stereo_box_t& a, const stereo_box_t& b) {
                     return std::tuple(-a.score, a.left.x_px) < std::tuple(-b.score, b.left.x_px);
                   });
  detection->n_boxes = static_cast<std::int32_t>(detection->boxes.size());
}

bool Contains(double x_px, double y_px, int width_px, int height_px) {
  return x_px >= -0.5 && y_px >= -0.5 && x_px < width_px - 0.5 && y_px < height_px - 0.5;
}

bool CentreIsInImage(const target_view_t& view, int width_px, int height_px) {
  return view.in_front != 0 && view.full.w_px > 0 &&
         Contains(view.centre_px[0], view.centre_px[1], width_px, height_px);
}

double VisibleShare(const target_view_t& view) {
  return (1 - view.occlusion) * (1 - view.truncation);
}

void AddErrors(const BoxErrors::OneImage& error, image_box_t* box) {
  box->x_px += error.x;
  box->y_px += error.y;
  box->w_px = std::max(box->w_px + error.w, 1.0);
  box->h_px = std::max(box->h_px + error.h, 1.0);
}

}  // namespace

detection_t DetectVisible(const annotation_t& annotation) {
  detection_t detection = EmptyDetection(annotation, "annotated");
  for (const target_annotation_t& target : annotation.targets) {
    if (target.left.visible.w_px <= 0 || target.right.visible.w_px <= 0) continue;
    stereo_box_t box{};
    box.left = target.left.visible;
    box.right = target.right.visible;
    box.score = std::min(VisibleShare(target.left), VisibleShare(target.right));
    detection.boxes.push_back(box);
  }
  Finish(&detection);
  return detection;
}

detection_t DetectGeometric(const annotation_t& annotation, const GeometricConfig& config,
                            std::uint64_t seed, int tick, int width_px, int height_px) {
  detection_t detection = EmptyDetection(annotation, "geometric");
  for (const target_annotation_t& target : annotation.targets) {
    if (!CentreIsInImage(target.left, width_px, height_px) ||
        !CentreIsInImage(target.right, width_px, height_px)) {
      continue;
    }
    const BoxNoise noise(config, seed,
                         "uav" + std::to_string(annotation.observer_id) + "/geometric/target" +
                             std::to_string(target.target_id));
    const auto errors = noise.At(tick, {target.left.full.w_px, target.left.full.h_px},
                                 {target.right.full.w_px, target.right.full.h_px});
    if (!errors) continue;
    stereo_box_t box{};
    box.left = target.left.full;
    box.right = target.right.full;
    box.score = 1;
    AddErrors(errors->left, &box.left);
    AddErrors(errors->right, &box.right);
    detection.boxes.push_back(box);
  }
  Finish(&detection);
  return detection;
}

detection_t DetectTruth(const annotation_t& annotation, const StereoRig& calibrated) {
  detection_t detection = EmptyDetection(annotation, "truth");
  const PosedStereoRig rig = Posed(calibrated);
  for (const target_annotation_t& target : annotation.targets) {
    const Eigen::Vector3d p_RT_m(target.p_RT_m);
    const auto left_px = rig.left.camera.Project(rig.left.X_RC.inverse() * p_RT_m);
    const auto right_px = rig.right.camera.Project(rig.right.X_RC.inverse() * p_RT_m);
    const auto is_seen = [&](const std::optional<Eigen::Vector2d>& q_px) {
      return q_px && Contains(q_px->x(), q_px->y(), calibrated.width_px, calibrated.height_px);
    };
    if (!is_seen(left_px) || !is_seen(right_px)) continue;
    stereo_box_t box{};
    box.left = target.left.full;
    box.right = target.right.full;
    box.left.x_px = left_px->x();
    box.left.y_px = left_px->y();
    box.right.x_px = right_px->x();
    box.right.y_px = right_px->y();
    box.score = 1;
    detection.boxes.push_back(box);
  }
  Finish(&detection);
  return detection;
}

}  // namespace windhover
