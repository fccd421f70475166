#include "scenarios/scenario_rules.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>

#include <fmt/format.h>

#include "common/config/value_text.h"
#include "rig/bar_modes.h"
#include "scenarios/aircraft_rules.h"
#include "scenarios/rule_findings.h"

namespace windhover {
namespace {

// A visitor of Fields that writes every value.
class ValueLister {
 public:
  template <typename Struct>
  explicit ValueLister(Struct value) {
    value.Fields(*this);
  }
  template <typename T, typename Limit>
  void Field(const char* key, T& value, const Limit&, const char*) {
    texts_.emplace_back(key, WriteValue(value));
  }
  const std::vector<std::pair<std::string, std::string>>& texts() const { return texts_; }

 private:
  std::vector<std::pair<std::string, std::string>> texts_;
};

class RuleChecker {
 public:
  RuleChecker(const Scenario& scenario, RuleFindings& findings)
      : scenario_(scenario), findings_(findings) {}

  void CheckAll() {
    CheckFiles();
    CheckTimes();
    CheckFlex();
    CheckWind();
    CheckLens();
    CheckSensor();
    CheckUnused();
    CheckFocus("optics.focus_m", scenario_.optics.focus_m);
    CheckFocus("optics.left.focus_m", scenario_.optics.left.focus_m);
    CheckFocus("optics.right.focus_m", scenario_.optics.right.focus_m);
    CheckEstimator();
    CheckDetector();
    CheckExpectations();
  }

 private:
  void MustBe(const std::string& path, const std::string& must, const std::string& found,
              const std::vector<std::string>& uses = {}) {
    findings_.MustBe(path, must, found, uses);
  }

  void CheckFiles() {
    const VibrationConfig& vibration = scenario_.vibration;
    findings_.CheckFile("vibration.file", vibration.file,
                        vibration.source == VibrationSource::kRecorded, "for source recorded",
                        "vibration.source");
    const EnvironmentConfig& environment = scenario_.environment;
    findings_.CheckFile("environment.file", environment.file, IsImage(environment.type),
                        "for types panorama and photo", "environment.type");
  }

  static bool IsImage(EnvironmentType type) {
    return type == EnvironmentType::kPanorama || type == EnvironmentType::kPhoto;
  }

  void CheckTimes() {
    const double frame_ms = 1e3 / scenario_.frame_rate_hz;
    if (scenario_.exposure.duration_ms > frame_ms) {
      MustBe("exposure.duration_ms", fmt::format("at most {:.4g}, the time of a frame", frame_ms),
             fmt::format("'{}'", scenario_.exposure.duration_ms), {"frame_rate_hz"});
    }
    const double uwb_hz = scenario_.uwb.rate_hz;
    if (uwb_hz > 0 && uwb_hz < 1) {
      MustBe("uwb.rate_hz", "0 or at least 1", fmt::format("'{}'", uwb_hz));
    }
  }

  // Where the modes of the bar are, unless section, mass and length make no sense together.
  void CheckFlex() {
    const FlexConfig& flex = scenario_.flex;
    if (!flex.enabled) return;
    const BarModes modes = ModesOf(flex, scenario_.rig.calibrated.baseline_m);
    const std::string bending = flex.frequency_hz > 0 ? "flex.frequency_hz" : "flex.section";
    const std::string up = flex.frequency_hz > 0 ? bending : "flex.custom.EI_up_Nm2";
    CheckMode(bending, "fore-aft bending", modes.forward);
    CheckMode(flex.section == BarSectionType::kCustom ? up : bending, "vertical bending", modes.up);
    CheckMode("flex.tip_inertia_kgm2", "torsion", modes.twist);
  }

  void CheckMode(const std::string& path, const std::string& name, const Mode& mode) {
    constexpr double kLowest_hz = 1, kHighest_hz = 5000;
    const double frequency_hz = mode.frequency_radps / (2 * std::numbers::pi);
    if (frequency_hz >= kLowest_hz && frequency_hz <= kHighest_hz) return;
    MustBe(path, fmt::format("such that {} has {} Hz to {} Hz", name, kLowest_hz, kHighest_hz),
           fmt::format("{:.4g} Hz", frequency_hz), {"flex", "rig.baseline_m"});
  }

  void CheckWind() {
    const auto& aircraft = scenario_.aircraft;
    const bool acts = std::any_of(aircraft.begin(), aircraft.end(), [](const Aircraft& one) {
      return one.dynamics == Dynamics::kRigidBody;
    });
    if (scenario_.wind.IsCalm() || acts || aircraft.empty()) return;
    MustBe("wind", "calm where no aircraft has dynamics rigid_body: it would move none", "wind");
  }

  void CheckLens() {
    const LensConfig& lens = scenario_.rig.calibrated.distortion;
    lens.ForEachUnused([&](const char* name, double value) {
      if (value == 0) return;
      MustBe(fmt::format("rig.distortion.{}", name), "0: this model has no such term",
             fmt::format("'{}'", value), {"rig.distortion.model"});
    });
  }

  void CheckSensor() {
    const SensorConfig& sensor = scenario_.sensor;
    if (sensor.bayer != BayerPattern::kNone && sensor.jpeg_quality > 0) {
      MustBe("sensor.jpeg_quality", "0 where frames are raw under colour filters",
             fmt::format("'{}'", sensor.jpeg_quality), {"sensor.bayer"});
    }
    if (sensor.bayer != BayerPattern::kNone && sensor.grey) {
      MustBe("sensor.grey", "false where a sensor has colour filters", "'true'", {"sensor.bayer"});
    }
    const double largest_dn = std::exp2(sensor.emva.bits) - 1;
    if (sensor.emva.offset_dn >= largest_dn / 2) {
      MustBe("sensor.emva.offset_dn",
             fmt::format("below half the largest grey value, {}", largest_dn),
             fmt::format("'{}'", sensor.emva.offset_dn), {"sensor.emva.bits"});
    }
    const AutoExposureConfig& automatic = scenario_.exposure.auto_exposure;
    if (automatic.min_ms > automatic.max_ms) {
      MustBe("exposure.auto.min_ms", fmt::format("at most max_ms, {}", automatic.max_ms),
             fmt::format("'{}'", automatic.min_ms), {"exposure.auto.max_ms"});
    }
  }

  // Keys that would be ignored without a word.
  void CheckUnused() {
    if (scenario_.sensor.model != SensorModel::kEmva1288) {
      const ValueLister values(scenario_.sensor.emva), initials(EmvaConfig{});
      for (std::size_t i = 0; i < values.texts().size(); ++i) {
        const auto& [key, text] = values.texts()[i];
        MustBeLeftOut("sensor.emva." + key, text, initials.texts()[i].second, "sensor.model",
                      "emva1288");
      }
    }
    if (scenario_.exposure.shutter != Shutter::kRolling) {
      MustBeLeftOut("exposure.row_time_us", WriteValue(scenario_.exposure.row_time_us),
                    WriteValue(ExposureConfig{}.row_time_us), "exposure.shutter", "rolling");
    }
    if (IsImage(scenario_.environment.type)) {
      MustBeLeftOut("environment.cloud_cover", WriteValue(scenario_.environment.cloud_cover),
                    WriteValue(EnvironmentConfig{}.cloud_cover), "environment.type",
                    "a drawn scene");
    }
  }

  void MustBeLeftOut(const std::string& path, const std::string& found, const std::string& initial,
                     const std::string& unless, const std::string& choice) {
    if (found == initial) return;
    MustBe(path, fmt::format("left out (or {}) unless {} is {}", initial, unless, choice),
           fmt::format("'{}'", found), {unless});
  }

  // Nearer than two focal lengths lenses magnify, which no lens of a rig is built for.
  void CheckFocus(const std::string& path, double focus_m) {
    const double nearest_m = 2e-3 * scenario_.rig.calibrated.focal_mm;
    if (std::isnan(focus_m) || focus_m == 0 || focus_m >= nearest_m) return;
    MustBe(path, fmt::format("0 (infinity) or at least two focal lengths, {:.4g} m", nearest_m),
           fmt::format("'{}'", focus_m), {"rig.focal_mm"});
  }

  void CheckEstimator() {
    const EstimatorConfig& estimator = scenario_.estimator;
    const auto& methods = estimator.methods;
    if (std::count(methods.begin(), methods.end(), estimator.in_loop) == 0) {
      MustBe("estimator.in_loop", fmt::format("one of estimator.methods, {}", Joined(methods)),
             fmt::format("'{}'", estimator.in_loop), {"estimator.methods"});
    }
    for (const std::string& method : methods) {
      if (findings_.files() != InputFiles::kMustExist) break;
      if (!NeedsCorrection(method) || !estimator.correction.empty()) continue;
      MustBe("estimator.correction", fmt::format("the file of a trained correction for {}", method),
             "none", {"estimator.methods"});
      break;
    }
    if (scenario_.score.collision_m > scenario_.score.near_miss_m) {
      MustBe("score.collision_m",
             fmt::format("at most near_miss_m, {}", scenario_.score.near_miss_m),
             fmt::format("'{}'", scenario_.score.collision_m), {"score.near_miss_m"});
    }
  }

  void CheckDetector() {
    const EstimatorConfig& estimator = scenario_.estimator;
    if (estimator.detector != "classical" && estimator.detector_model.empty()) {
      MustBe("estimator.detector_model",
             fmt::format("the card of a trained {}", estimator.detector), "none",
             {"estimator.detector"});
    }
    if (scenario_.geometric.noise == BoxNoiseSource::kFitted && estimator.detector_model.empty()) {
      MustBe("estimator.detector_model", "the card of a detector, for geometric.noise: fitted",
             "none", {"geometric.noise"});
    }
  }

  static std::string Joined(const std::vector<std::string>& words) {
    return fmt::format("[{}]", fmt::join(words, ", "));
  }

  void CheckExpectations() {
    for (std::size_t i = 0; i < scenario_.expect.size(); ++i) {
      const Expectation& e = scenario_.expect[i];
      const std::string path = fmt::format("expect.{}", i);
      if (std::isnan(e.max) && std::isnan(e.min) && std::isnan(e.upper95) &&
          std::isnan(e.lower95)) {
        MustBe(path, "bounded by max, min, upper95 or lower95", "no bound");
      }
      CheckOrder(path, "min", e.min, "max", e.max);
      CheckOrder(path, "lower95", e.lower95, "upper95", e.upper95);
    }
  }

  void CheckOrder(const std::string& path, const std::string& low_name, double low,
                  const std::string& high_name, double high) {
    if (!(low > high)) return;  // Also when one of them is not given.
    MustBe(path + "." + low_name, fmt::format("at most {}, {}", high_name, high),
           fmt::format("'{}'", low), {path + "." + high_name});
  }

  const Scenario& scenario_;
  RuleFindings& findings_;
};

}  // namespace

bool NeedsCorrection(const std::string& method) {
  static const std::set<std::string> kTrained = {"pcm", "pcm_dic", "pcm_dic_star", "joint_mlp",
                                                 "fused"};
  return kTrained.contains(method);
}

void CheckRules(const Scenario& scenario, const ConfigNode& root, InputFiles files,
                Findings& findings) {
  RuleFindings found(root, files, findings);
  RuleChecker(scenario, found).CheckAll();
  CheckAircraftRules(scenario, found);
}

}  // namespace windhover
