#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/time/sim_time.h"
#include "swarm/flight_controller.h"
#include "swarm/flocking.h"

namespace windhover {

/// The other aircraft that one has seen of late: each track of the estimator's is filtered with
/// constant gains (alpha-beta), carried on for a second without an image, then forgotten.
class NeighbourTracks {
 public:
  /// `method`: whose estimates count.
  explicit NeighbourTracks(std::string method) : method_(std::move(method)) {}

  void Look(const nav_state_t& nav, const Eigen::Isometry3d& X_BR, const range_t& ranges);

  /// Those within `reach_m`, by track number.
  std::vector<Neighbour> Within(double reach_m, const nav_state_t& nav) const;

 private:
  struct Track {
    Eigen::Vector3d p_WT_m, v_WT_mps;
    Utime seen_utime, utime;
  };

  std::string method_;
  std::map<int, Track> tracks_;
};

}  // namespace windhover
