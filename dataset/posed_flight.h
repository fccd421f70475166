#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "eval/run_record.h"
#include "lcmtypes/detection_t.hpp"
#include "lcmtypes/frame_digest_t.hpp"
#include "lcmtypes/imu_t.hpp"
#include "lcmtypes/world_truth_t.hpp"
#include "scenarios/scenario.h"

namespace windhover {

/// Where everything is when a stereo pair is taken, and what else was measured then.
struct PosedPair {
  int tick = 0;
  world_truth_t world{};
  std::map<int, double> uwb_m;            ///< From the rig's aircraft, by target id.
  std::optional<detection_t> detections;  ///< As logged; nothing: there is no log.
  std::optional<frame_digest_t> digest;   ///< Of the frame that a run saw, if it saw one.
};

/// The true state of the rig's aircraft at one time.
struct OwnTruth {
  Utime utime = 0;
  uav_truth_t truth{};
};

/// One flight as one rig sees it, before a pixel is drawn.
struct PosedFlight {
  Scenario scenario;
  int observer = 0;  ///< Position in scenario.aircraft.
  std::vector<PosedPair> pairs;
  std::vector<imu_t> imu;       ///< Of the rig's aircraft.
  std::vector<OwnTruth> track;  ///< At samples of the IMU; of a run, at its frames.
};

/// The flights that a data set is made of; each can be flown apart from the others.
struct FlightSource {
  struct Flight {
    Split split;
    std::string name;  ///< As in file names, unique: "train-03".
    int n_pairs;
  };
  std::vector<Flight> flights;  ///< In order of split.
  std::function<PosedFlight(std::size_t)> fly;
  bool adapts = false;        ///< Exposure is automatic: a frame depends on those before it.
  std::string resolved_yaml;  ///< The scenario that describes them all.
  std::uint64_t seed = 0;
};

/// Which pairs of a flight are taken when not all are wanted.
enum class PairChoice { kSpread, kFirst };

/// The flights of the data set that `base.dataset` describes (scenarios/dataset.h), or as many
/// pairs of them as wanted, each split and flight with its share. More pairs than there are make
/// more flights.
/// @throws ConfigError if a split would be left without any; as GeometricFlight when one is flown.
FlightSource FlightsOfDataset(const Scenario& base, std::uint64_t seed,
                              const std::optional<int>& n_pairs = std::nullopt,
                              PairChoice choice = PairChoice::kSpread);

/// What each rig of the run in `folder` saw: the first `n_pairs` of each, or all.
/// @throws ConfigError if it is no run, INVALID, carries no rig, or has fewer pairs than that.
FlightSource FlightsOfRun(const std::filesystem::path& folder, Split split,
                          const std::optional<int>& n_pairs);

}  // namespace windhover
