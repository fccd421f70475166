#pragma once

#include <map>
#include <optional>

#include "common/file/whole_file.h"
#include "dataset/dataset_layout.h"

namespace windhover {

// Layouts that keep each flight in a folder of its own: SPLIT names are part of those. Time stamps
// are nanoseconds from 10^18 on (9 September 2001), as programs expect those of a Unix clock.

/// EuRoC's MAV data set (ASL): FLIGHT/mav0/{cam0,cam1,imu0,state_groundtruth_estimate0}, each with
/// data.csv and sensor.yaml; grey PNG. The body frame S is windhover's B, the world R is W.
class EurocLayout : public DatasetLayout {
 public:
  explicit EurocLayout(std::filesystem::path folder) : folder_(std::move(folder)) {}

  StereoFiles ImageFiles(const PairId& id) const override;
  PairChoice pair_choice() const override { return PairChoice::kFirst; }
  bool has_grey_images() const override { return true; }
  /// Lenses have no more terms than k1, k2, p1, p2.
  void Check(const Scenario& scenario) const override;
  void BeginFlight(const FlightSource::Flight& flight, const PosedFlight& posed) override;
  void Add(const LabelledPair& pair) override;
  void Finish() override;

 private:
  void WriteSensors(const PosedFlight& posed) const;
  void WriteImu(const PosedFlight& posed) const;
  void WriteTrack(const PosedFlight& posed) const;
  void EndFlight();

  std::filesystem::path folder_, mav_;  ///< mav_: of the flight at hand.
  std::string images_;                  ///< Both cameras' data.csv.
};

/// What kalibr_bagcreater takes: FLIGHT/{cam0,cam1}/STAMP.png and imu0.csv; with the calibrated
/// rig as camchain.yaml. Grey PNG.
class KalibrLayout : public DatasetLayout {
 public:
  explicit KalibrLayout(std::filesystem::path folder) : folder_(std::move(folder)) {}

  StereoFiles ImageFiles(const PairId& id) const override;
  PairChoice pair_choice() const override { return PairChoice::kFirst; }
  bool has_grey_images() const override { return true; }
  void Check(const Scenario& scenario) const override;
  void BeginFlight(const FlightSource::Flight& flight, const PosedFlight& posed) override;
  void Add(const LabelledPair& /*pair*/) override {}
  void Finish() override {}

 private:
  std::filesystem::path folder_;
};

/// TUM trajectories, true poses X_WB at the times of frames, "t x y z qx qy qz qw":
/// FLIGHT/rig.tum of the aircraft with the rig, FLIGHT/uav_ID.tum of the others. No images.
class TumLayout : public DatasetLayout {
 public:
  explicit TumLayout(std::filesystem::path folder) : folder_(std::move(folder)) {}

  StereoFiles ImageFiles(const PairId& /*id*/) const override { return {}; }
  bool has_images() const override { return false; }
  PairChoice pair_choice() const override { return PairChoice::kFirst; }
  void BeginFlight(const FlightSource::Flight& flight, const PosedFlight& posed) override;
  void Add(const LabelledPair& /*pair*/) override {}
  void Finish() override {}

 private:
  std::filesystem::path folder_;
};

}  // namespace windhover
