#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "camera/lens_config.h"
#include "camera/stereo_rig.h"
#include "common/config/fields.h"
#include "scenarios/selfcal_config.h"
#include "scenarios/swarm_config.h"

namespace windhover {

/// What the estimator is given of each frame.
enum class Observe { kTruth, kGeometric, kAnnotated, kImage };
template <>
inline constexpr EnumNames<Observe> kEnumNames<Observe>{{Observe::kTruth, "truth"},
                                                        {Observe::kGeometric, "geometric"},
                                                        {Observe::kAnnotated, "annotated"},
                                                        {Observe::kImage, "image"}};

/// Who moves an aircraft: sim (hold, trajectory, waypoints) or its swarm node (follow, swarm).
enum class Controller { kHold, kTrajectory, kWaypoints, kFollow, kSwarm };
template <>
inline constexpr EnumNames<Controller> kEnumNames<Controller>{
    {Controller::kHold, "hold"},
    {Controller::kTrajectory, "trajectory"},
    {Controller::kWaypoints, "waypoints"},
    {Controller::kFollow, "follow"},
    {Controller::kSwarm, "swarm"}};

/// The stereo rig as calibrated: what its owner believes. The rig that render/ uses differs by
/// the scenario's misalignment, vibration and flex.
struct CalibratedRig {
  double baseline_m = 0.406;
  double focal_mm = 12;
  double pixel_um = 3.7325;
  std::array<int, 2> image = {1280, 720};

  LensConfig distortion;

  /// Where the rig sits on the aircraft: X_BR.
  struct Mount {
    std::array<double, 3> position_m = {0.15, 0, 0};
    double pitch_deg = 0;

    template <typename Visitor>
    void Fields(Visitor& v) {
      v.Field("position_m", position_m, InRange{-2, 2},
              "middle of the baseline in the body frame (forward, left, up)");
      v.Field("pitch_deg", pitch_deg, InRange{-90, 90}, "upward tilt of the optical axis");
    }
  };
  Mount mount;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("baseline_m", baseline_m, InRange{0.01, 10}, "distance between the optical centres");
    v.Field("focal_mm", focal_mm, InRange{1, 500}, "focal length of both lenses");
    v.Field("pixel_um", pixel_um, InRange{0.5, 50}, "pixel pitch of both sensors");
    v.Field("image", image, InRange{16, 8192}, "width and height of an image, px");
    v.Section("distortion", distortion, "lens of both cameras (terms in OpenCV's meaning)");
    v.Section("mount", mount, "where the rig sits on the aircraft");
  }

  double FocalPx() const { return focal_mm * 1e3 / pixel_um; }

  /// Both cameras alike, with the principal point at the image's centre.
  StereoRig ToStereoRig() const;

  /// The mount as a transform from the rig frame R to the body frame B.
  Eigen::Isometry3d X_BR() const;
};

/// Every distance estimator, in the order of docs/estimation.md.
inline const std::vector<std::string> kRangeMethods = {
    "baseline", "offset1",      "size",      "fusion",  "pcm",
    "pcm_dic",  "pcm_dic_star", "joint_mlp", "selfcal", "fused"};

/// Every detector; all but `classical` are trained.
inline const std::vector<std::string> kDetectors = {"classical", "yolox_nano", "yolox_small"};

struct EstimatorConfig {
  std::string detector = "classical";
  InputFile detector_model;
  std::vector<std::string> methods = {"baseline"};
  std::string in_loop = "baseline";  ///< The method that swarm flies on; one of `methods`.
  double offset1_px = 0;
  double target_width_m = 0.887;
  double disparity_sigma_px = 1;
  double size_sigma = 0.1;
  InputFile correction;
  SelfcalConfig selfcal;

  template <typename Visitor>
  void Fields(Visitor& v);
};

struct FollowConfig {
  double distance_m = 10;
  double gain_per_s = 0.8;
  double max_speed_mps = 5;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("distance_m", distance_m, InRange{1, 1000}, "distance to keep from the target");
    v.Field("gain_per_s", gain_per_s, InRange{0, 10}, "speed per metre of distance error");
    v.Field("max_speed_mps", max_speed_mps, InRange{0, 50}, "largest commanded speed");
  }
};

/// One aircraft, as it may know itself.
struct AircraftSelf {
  int id = 0;
  bool carries_rig = false;
  Controller controller = Controller::kHold;
  FollowConfig follow;
  GoalConfig goal;  ///< Of controller swarm.
};

/// All that estimator/ and swarm/ may know of a scenario; the rest is ground truth.
struct AircraftConfig {
  double frame_rate_hz = 10;
  Observe observe = Observe::kGeometric;
  CalibratedRig rig;
  EstimatorConfig estimator;
  SwarmConfig swarm;
  std::vector<AircraftSelf> aircraft;  ///< Sorted by id.
};

/// Reads the whole scenario file, so that every error in it is reported, and returns only what
/// an aircraft may know.
/// @throws ConfigError listing every problem in the file.
AircraftConfig LoadAircraftConfig(const std::filesystem::path& file);

template <typename Visitor>
void EstimatorConfig::Fields(Visitor& v) {
  v.Field("detector", detector, OneOf{kDetectors}, "finds aircraft in images (observe: image)");
  v.Field("detector_model", detector_model, MayBeEmpty{},
          "card of a trained detector, as `windhover train detector` writes it");
  v.Field("methods", methods, ItemsOneOf{kRangeMethods},
          "distance estimators, all run on the same frames");
  v.Field("in_loop", in_loop, OneOf{kRangeMethods}, "the method the swarm flies on");
  v.Field("offset1_px", offset1_px, InRange{-1000, 1000},
          "disparity that offset1 takes away: measured minus true, from a calibration flight");
  v.Field("target_width_m", target_width_m, InRange{0.01, 100}, "width that size assumes");
  v.Field("disparity_sigma_px", disparity_sigma_px, InRange{0, 100},
          "standard deviation of a detected disparity");
  v.Field("size_sigma", size_sigma, InRange{0, 1}, "relative standard deviation of a box width");
  v.Field("correction", correction, MayBeEmpty{},
          "file of trained corrections, as `windhover train pcm` writes it");
  v.Section("selfcal", selfcal, "recursive self-calibration: methods selfcal and fused");
}

}  // namespace windhover
