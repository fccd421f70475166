#include "swarm/neighbour_tracks.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "common/geometry/rotation.h"
#include "swarm/flight_controller.h"

namespace windhover {
namespace {

using Eigen::Vector3d;

constexpr int kNoTrack = -1;
constexpr double kSameNumber = 1;  // Gain in cost if the estimator says that it is the same.
constexpr double kFarthest_m = 1e5;

}  // namespace

std::vector<Sighting> NeighbourTracks::SightingsOf(const nav_state_t& nav,
                                                   const Eigen::Isometry3d& X_BR,
                                                   const range_t& ranges) const {
  const Eigen::Isometry3d X_WR = X_WB(nav) * X_BR;
  std::vector<Sighting> sightings;
  for (const range_estimate_t& estimate : ranges.estimates) {
    if (estimate.method != method_ || estimate.status != range_estimate_t::STATUS_OK) continue;
    const Vector3d p_RT_m(estimate.p_RT_m);
    const double range_m = p_RT_m.norm();
    if (!(range_m > 0 && range_m < kFarthest_m)) continue;  // Nor what is no number.
    const Vector3d line_W = X_WR.linear() * p_RT_m / range_m;
    sightings.push_back({X_WR * p_RT_m,
                         SightingCovariance(line_W, range_m, estimate.range_sigma_m,
                                            RadFromDeg(config_.bearing_sigma_deg)),
                         estimate.track_id});
  }
  return sightings;
}

std::vector<int> NeighbourTracks::Associate(const std::vector<Sighting>& sightings) const {
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    for (std::size_t j = 0; j < tracks_.size(); ++j) {
      const TrackFilter& filter = tracks_[j].filter;
      const double limit = config_.gate_sigmas * config_.gate_sigmas;
      if (!(filter.SquaredDistance(sightings[i]) <= limit)) continue;
      const bool same = sightings[i].estimator_track == tracks_[j].estimator_track;
      pairs.emplace_back(filter.Cost(sightings[i]) - (same ? kSameNumber : 0), j, i);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  std::vector<int> tracks(sightings.size(), kNoTrack);
  std::vector<bool> taken(tracks_.size());
  for (const auto& [cost, j, i] : pairs) {
    if (tracks[i] != kNoTrack || taken[j]) continue;
    taken[j] = true;
    tracks[i] = static_cast<int>(j);
  }
  return tracks;
}

void NeighbourTracks::Look(const nav_state_t& nav, const Eigen::Isometry3d& X_BR,
                           const range_t& ranges) {
  const double elapsed_s = tracks_.empty() ? 0 : SecondsFromUtime(nav.utime - utime_);
  utime_ = nav.utime;
  for (Track& track : tracks_) {
    track.filter.Predict(elapsed_s, config_.acceleration_mps2);
    ++track.misses;
  }
  const std::vector<Sighting> sightings = SightingsOf(nav, X_BR, ranges);
  const std::vector<int> tracks = Associate(sightings);
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    if (tracks[i] == kNoTrack) {
      Begin(sightings[i], nav.utime);
      continue;
    }
    Track& track = tracks_[static_cast<std::size_t>(tracks[i])];
    track.filter.Update(sightings[i]);
    track.estimator_track = sightings[i].estimator_track;
    track.misses = 0;
    track.seen_utime = nav.utime;
    ++track.hits;
  }
  Forget(nav.utime);
}

void NeighbourTracks::Begin(const Sighting& sighting, Utime utime) {
  tracks_.push_back({.filter = TrackFilter(sighting, speed_mps_ / 2),
                     .estimator_track = sighting.estimator_track,
                     .hits = 1,
                     .misses = 0,
                     .born_utime = utime,
                     .seen_utime = utime});
}

void NeighbourTracks::Forget(Utime utime) {
  // A track unseen since a younger one took over its number that now counts was the same aircraft,
  // lost in a turn.
  const auto is_replaced = [&](const Track& old) {
    return std::any_of(tracks_.begin(), tracks_.end(), [&](const Track& young) {
      return Counts(young) && young.estimator_track == old.estimator_track &&
             young.born_utime > old.seen_utime;
    });
  };
  std::vector<Track> kept;
  for (const Track& track : tracks_) {
    const bool is_lost = Counts(track)
                             ? SecondsFromUtime(utime - track.seen_utime) > config_.memory_s
                             : track.misses >= 2;
    if (!is_lost && !is_replaced(track)) kept.push_back(track);
  }
  tracks_ = std::move(kept);
}

std::vector<Neighbour> NeighbourTracks::Within(double reach_m, const nav_state_t& nav) const {
  std::vector<Neighbour> neighbours;
  for (const Track& track : tracks_) {
    const Vector3d p_m = track.filter.p_WT_m() - Vector3d(nav.p_WB_m);
    const double distance_m = p_m.norm();
    if (!Counts(track) || !(distance_m <= reach_m)) continue;
    const Vector3d line = distance_m > 1e-6 ? Vector3d(p_m / distance_m) : Vector3d::UnitX();
    neighbours.push_back({.p_m = p_m,
                          .v_mps = track.filter.v_WT_mps(),
                          .sigma_m = std::sqrt(line.dot(track.filter.PositionCovariance() * line)),
                          .unseen_s = SecondsFromUtime(nav.utime - track.seen_utime)});
  }
  return neighbours;
}

}  // namespace windhover
