#include "estimator/tracker.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace windhover {
namespace {

constexpr Utime kForgetAfter = 1'000'000;
constexpr int kNoTrack = -1;

/// How far a target may seem to move between frames: itself, and a little.
double Reach_rad(double width_rad) { return 2 * width_rad + 0.03; }

double Angle_rad(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace

std::vector<int> Tracker::Assign(Utime utime, const std::vector<Sighting>& sightings) {
  std::erase_if(tracks_, [utime](const Track& t) { return utime - t.last_seen > kForgetAfter; });
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    for (std::size_t j = 0; j < tracks_.size(); ++j) {
      const double angle_rad = Angle_rad(sightings[i].direction_W, tracks_[j].direction_W);
      if (angle_rad < Reach_rad(sightings[i].width_rad)) pairs.emplace_back(angle_rad, i, j);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  std::vector<int> ids(sightings.size(), kNoTrack);
  std::vector<bool> taken(tracks_.size());
  for (const auto& [angle_rad, i, j] : pairs) {
    if (ids[i] != kNoTrack || taken[j]) continue;
    taken[j] = true;
    ids[i] = tracks_[j].id;
    tracks_[j].last_seen = utime;
    tracks_[j].direction_W = sightings[i].direction_W;
  }
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    if (ids[i] != kNoTrack) continue;
    ids[i] = next_id_++;
    tracks_.push_back({ids[i], utime, sightings[i].direction_W});
  }
  return ids;
}

}  // namespace windhover
