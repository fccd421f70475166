#include "dataset/flight_layouts.h"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "camera/stereo_rig.h"
#include "common/file/whole_file.h"
#include "sim/onboard_sensors.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kStart_ns = 1'000'000'000'000'000'000;

std::int64_t StampOf(Utime utime) { return kStart_ns + utime * 1000; }

std::string ImageOf(Utime utime) { return fmt::format("{}.png", StampOf(utime)); }

/// Four terms of a lens that both formats know, and the name that each gives to the model.
struct FourTerms {
  const char *euroc_name, *kalibr_name;
  std::array<double, 4> terms;
};

FourTerms TermsOf(const LensConfig& lens, const char* format) {
  if (lens.model == LensModel::kRadtan && lens.k3 == 0) {
    return {"radial-tangential", "radtan", {lens.k1, lens.k2, lens.p1, lens.p2}};
  }
  if (lens.model == LensModel::kKannalaBrandt) {
    return {"equidistant", "equidistant", {lens.k1, lens.k2, lens.k3, lens.k4}};
  }
  throw ConfigError(fmt::format(
      "--format {} has lenses of k1, k2, p1, p2 or kannala_brandt (found rig.distortion with "
      "further terms)",
      format));
}

// Row by row, as both formats write transforms.
std::vector<double> RowsOf(const Eigen::Isometry3d& X) {
  std::vector<double> rows;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) rows.push_back(X.matrix()(i, j));
  }
  return rows;
}

std::string EurocTransform(const Eigen::Isometry3d& X_BS) {
  return fmt::format("T_BS:\n  cols: 4\n  rows: 4\n  data: [{}]\n", fmt::join(RowsOf(X_BS), ", "));
}

std::string EurocCamera(const PosedCamera& camera, const Scenario& scenario) {
  const CalibratedRig& rig = scenario.rig.calibrated;
  const FourTerms lens = TermsOf(rig.distortion, "euroc");
  const Intrinsics k = camera.camera.intrinsics();
  return "sensor_type: camera\ncomment: simulated by windhover\n" +
         EurocTransform(rig.X_BR() * camera.X_RC) +
         fmt::format(
             "rate_hz: {}\nresolution: [{}]\ncamera_model: pinhole\n"
             "intrinsics: [{}, {}, {}, {}]\ndistortion_model: {}\n"
             "distortion_coefficients: [{}]\n",
             scenario.frame_rate_hz, fmt::join(rig.image, ", "), k.fx_px, k.fy_px, k.cx_px, k.cy_px,
             lens.euroc_name, fmt::join(lens.terms, ", "));
}

std::string EurocImu(double rate_hz) {
  return "sensor_type: imu\ncomment: simulated by windhover\n" +
         EurocTransform(Eigen::Isometry3d::Identity()) +
         fmt::format(
             "rate_hz: {}\ngyroscope_noise_density: {}\ngyroscope_random_walk: 0\n"
             "accelerometer_noise_density: {}\naccelerometer_random_walk: 0\n",
             rate_hz, OnboardSensors::kGyroSigma_radps / std::sqrt(rate_hz),
             OnboardSensors::kAccelerometerSigma_mps2 / std::sqrt(rate_hz));
}

std::string ImuRows(const std::vector<imu_t>& samples) {
  std::string rows;
  for (const imu_t& imu : samples) {
    rows += fmt::format("{},{},{}\n", StampOf(imu.utime), fmt::join(imu.gyro_B_radps, ","),
                        fmt::join(imu.specific_force_B_mps2, ","));
  }
  return rows;
}

std::string KalibrCamera(int number, const PosedCamera& camera, const Scenario& scenario) {
  const CalibratedRig& rig = scenario.rig.calibrated;
  const FourTerms lens = TermsOf(rig.distortion, "kalibr");
  const Intrinsics k = camera.camera.intrinsics();
  const auto transform = [](const char* name, const Eigen::Isometry3d& X) {
    std::string yaml = fmt::format("  {}:\n", name);
    const std::vector<double> rows = RowsOf(X);
    for (int i = 0; i < 16; i += 4) {
      yaml += fmt::format("  - [{}]\n", fmt::join(rows.begin() + i, rows.begin() + i + 4, ", "));
    }
    return yaml;
  };
  std::string yaml = fmt::format("cam{}:\n", number);
  yaml += transform("T_cam_imu", (rig.X_BR() * camera.X_RC).inverse());
  if (number == 1) {
    Eigen::Isometry3d X_RL = Eigen::Isometry3d::Identity();
    X_RL.translation().x() = -rig.baseline_m;
    yaml += transform("T_cn_cnm1", X_RL);
  }
  return yaml + fmt::format(
                    "  cam_overlaps: [{}]\n  camera_model: pinhole\n"
                    "  distortion_coeffs: [{}]\n  distortion_model: {}\n"
                    "  intrinsics: [{}, {}, {}, {}]\n  resolution: [{}]\n"
                    "  rostopic: /cam{}/image_raw\n  timeshift_cam_imu: 0.0\n",
                    1 - number, fmt::join(lens.terms, ", "), lens.kalibr_name, k.fx_px, k.fy_px,
                    k.cx_px, k.cy_px, fmt::join(rig.image, ", "), number);
}

std::string TumRow(Utime utime, const uav_truth_t& uav) {
  const std::int64_t stamp_us = StampOf(utime) / 1000;
  return fmt::format("{}.{:06} {} {} {} {} {}\n", stamp_us / 1'000'000, stamp_us % 1'000'000,
                     fmt::join(uav.p_WB_m, " "), uav.qx, uav.qy, uav.qz, uav.qw);
}

}  // namespace

StereoFiles EurocLayout::ImageFiles(const PairId& id) const {
  const fs::path mav = fs::path(id.flight) / "mav0";
  return {mav / "cam0" / "data" / ImageOf(id.utime), mav / "cam1" / "data" / ImageOf(id.utime)};
}

void EurocLayout::Check(const Scenario& scenario) const {
  TermsOf(scenario.rig.calibrated.distortion, "euroc");
}

void EurocLayout::BeginFlight(const FlightSource::Flight& flight, const PosedFlight& posed) {
  EndFlight();
  mav_ = folder_ / flight.name / "mav0";
  images_ = "#timestamp [ns],filename\n";
  WriteSensors(posed);
  WriteImu(posed);
  WriteTrack(posed);
}

void EurocLayout::WriteSensors(const PosedFlight& posed) const {
  const PosedStereoRig rig = Posed(posed.scenario.rig.calibrated.ToStereoRig());
  ReplaceFile(WithFolders(mav_ / "cam0" / "sensor.yaml"), EurocCamera(rig.left, posed.scenario));
  ReplaceFile(WithFolders(mav_ / "cam1" / "sensor.yaml"), EurocCamera(rig.right, posed.scenario));
  ReplaceFile(WithFolders(mav_ / "body.yaml"), "comment: simulated by windhover\n");
  ReplaceFile(WithFolders(mav_ / "state_groundtruth_estimate0" / "sensor.yaml"),
              "sensor_type: visual-inertial\ncomment: simulated by windhover: the truth\n" +
                  EurocTransform(Eigen::Isometry3d::Identity()));
}

void EurocLayout::WriteImu(const PosedFlight& posed) const {
  if (posed.imu.empty()) return;
  ReplaceFile(WithFolders(mav_ / "imu0" / "sensor.yaml"), EurocImu(posed.scenario.nav.imu_rate_hz));
  ReplaceFile(mav_ / "imu0" / "data.csv",
              "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
              "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n" +
                  ImuRows(posed.imu));
}

void EurocLayout::WriteTrack(const PosedFlight& posed) const {
  std::string rows =
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], "
      "q_RS_z [], v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], "
      "b_w_RS_S_y [rad s^-1], b_w_RS_S_z [rad s^-1], b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], "
      "b_a_RS_S_z [m s^-2]\n";
  for (const auto& [utime, uav] : posed.track) {
    rows += fmt::format("{},{},{},{},{},{},{},0,0,0,0,0,0\n", StampOf(utime),
                        fmt::join(uav.p_WB_m, ","), uav.qw, uav.qx, uav.qy, uav.qz,
                        fmt::join(uav.v_WB_mps, ","));
  }
  ReplaceFile(mav_ / "state_groundtruth_estimate0" / "data.csv", rows);
}

void EurocLayout::Add(const LabelledPair& pair) {
  images_ += fmt::format("{},{}\n", StampOf(pair.id.utime), ImageOf(pair.id.utime));
}

void EurocLayout::EndFlight() {
  if (mav_.empty()) return;
  ReplaceFile(mav_ / "cam0" / "data.csv", images_);
  ReplaceFile(mav_ / "cam1" / "data.csv", images_);
}

void EurocLayout::Finish() { EndFlight(); }

StereoFiles KalibrLayout::ImageFiles(const PairId& id) const {
  const fs::path flight = id.flight;
  return {flight / "cam0" / ImageOf(id.utime), flight / "cam1" / ImageOf(id.utime)};
}

void KalibrLayout::Check(const Scenario& scenario) const {
  TermsOf(scenario.rig.calibrated.distortion, "kalibr");
}

void KalibrLayout::BeginFlight(const FlightSource::Flight& flight, const PosedFlight& posed) {
  const PosedStereoRig rig = Posed(posed.scenario.rig.calibrated.ToStereoRig());
  const fs::path folder = folder_ / flight.name;
  ReplaceFile(
      WithFolders(folder / "camchain.yaml"),
      KalibrCamera(0, rig.left, posed.scenario) + KalibrCamera(1, rig.right, posed.scenario));
  if (posed.imu.empty()) return;
  ReplaceFile(folder / "imu0.csv",
              "timestamp,omega_x,omega_y,omega_z,alpha_x,alpha_y,alpha_z\n" + ImuRows(posed.imu));
}

void TumLayout::BeginFlight(const FlightSource::Flight& flight, const PosedFlight& posed) {
  for (std::size_t i = 0; i < posed.scenario.aircraft.size(); ++i) {
    std::string rows;
    for (const PosedPair& pair : posed.pairs) {
      rows += TumRow(pair.world.utime, pair.world.uavs[i]);
    }
    const std::string name = std::cmp_equal(i, posed.observer)
                                 ? "rig.tum"
                                 : fmt::format("uav_{}.tum", posed.scenario.aircraft[i].self.id);
    ReplaceFile(WithFolders(folder_ / flight.name / name), rows);
  }
}

}  // namespace windhover
