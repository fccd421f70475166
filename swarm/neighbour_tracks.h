#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "common/time/sim_time.h"
#include "lcmtypes/nav_state_t.hpp"
#include "lcmtypes/range_t.hpp"
#include "scenarios/swarm_config.h"
#include "swarm/flocking.h"
#include "swarm/track_filter.h"

namespace windhover {

/// The other aircraft that one has seen of late.
///
/// Each frame, sightings join tracks within the gate, the likeliest pair first, one sighting to
/// one track; the estimator's number of a track only tips the scales between pairs nearly as
/// likely. A sighting that joins none begins a track, which counts after `hits` sightings and until
/// then ends when it misses two frames. A track that counts is predicted while it is out of
/// sight, and forgotten after memory_s.
class NeighbourTracks {
 public:
  /// `method`: whose estimates count. `speed_mps`: how fast others may be.
  NeighbourTracks(const TracksConfig& config, std::string method, double speed_mps)
      : config_(config), method_(std::move(method)), speed_mps_(speed_mps) {}

  /// One frame, in order of time.
  void Look(const nav_state_t& nav, const Eigen::Isometry3d& X_BR, const range_t& ranges);

  /// Those within `reach_m` that count, by age of their tracks.
  std::vector<Neighbour> Within(double reach_m, const nav_state_t& nav) const;

 private:
  struct Track {
    TrackFilter filter;
    int estimator_track;
    int hits, misses;  // Sightings so far; frames missed since the last.
    Utime born_utime, seen_utime;
  };

  std::vector<Sighting> SightingsOf(const nav_state_t& nav, const Eigen::Isometry3d& X_BR,
                                    const range_t& ranges) const;
  std::vector<int> Associate(const std::vector<Sighting>& sightings) const;
  void Begin(const Sighting& sighting, Utime utime);
  void Forget(Utime utime);
  bool Counts(const Track& track) const { return track.hits >= config_.hits; }

  TracksConfig config_;
  std::string method_;
  double speed_mps_;
  Utime utime_ = 0;
  std::vector<Track> tracks_;  // Oldest first.
};

}  // namespace windhover
