#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "common/time/sim_time.h"

namespace windhover {

/// Gives detections of successive frames the same number while they lie near each other.
///
/// A track is a direction in the world frame (seen from a moving aircraft it turns slowly, while
/// image positions jump with every turn of the aircraft itself). Nearest directions are joined
/// first, one detection to one track; a detection that joins none starts a track, and a track
/// that is not seen for a second ends.
class Tracker {
 public:
  /// What a detection looks like from here.
  struct Sighting {
    Eigen::Vector3d direction_W;  ///< Unit vector from the rig to the target.
    double width_rad;             ///< Angular width of its box.
  };

  /// Track number of each sighting, counted from 0 in order of first appearance.
  std::vector<int> Assign(Utime utime, const std::vector<Sighting>& sightings);

 private:
  struct Track {
    int id;
    Utime last_seen;
    Eigen::Vector3d direction_W;
  };

  std::vector<Track> tracks_;
  int next_id_ = 0;
};

}  // namespace windhover
