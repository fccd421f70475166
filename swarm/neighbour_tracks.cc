#include "swarm/neighbour_tracks.h"

namespace windhover {
namespace {

using Eigen::Vector3d;

constexpr double kMemory_s = 1;
// T. Benedict & G. Bordner, 1962: beta = alpha² / (2 - alpha).
constexpr double kAlpha = 0.4, kBeta = kAlpha * kAlpha / (2 - kAlpha);

}  // namespace

void NeighbourTracks::Look(const nav_state_t& nav, const Eigen::Isometry3d& X_BR,
                           const range_t& ranges) {
  for (auto& [id, track] : tracks_) {
    track.p_WT_m += SecondsFromUtime(nav.utime - track.utime) * track.v_WT_mps;
    track.utime = nav.utime;
  }
  const Eigen::Isometry3d X_WR = X_WB(nav) * X_BR;
  for (const range_estimate_t& estimate : ranges.estimates) {
    if (estimate.method != method_ || estimate.status != range_estimate_t::STATUS_OK) continue;
    const Vector3d p_WT_m = X_WR * Vector3d(estimate.p_RT_m);
    if (!p_WT_m.allFinite()) continue;
    const auto [entry, is_new] = tracks_.try_emplace(
        estimate.track_id, Track{p_WT_m, Vector3d::Zero(), nav.utime, nav.utime});
    Track& track = entry->second;
    const double since_s = SecondsFromUtime(nav.utime - track.seen_utime);
    if (!is_new && since_s > 0) {
      const Vector3d residual_m = p_WT_m - track.p_WT_m;
      track.p_WT_m += kAlpha * residual_m;
      track.v_WT_mps += kBeta / since_s * residual_m;
    }
    track.seen_utime = nav.utime;
  }
  std::erase_if(tracks_, [&](const auto& entry) {
    return SecondsFromUtime(nav.utime - entry.second.seen_utime) > kMemory_s;
  });
}

std::vector<Neighbour> NeighbourTracks::Within(double reach_m, const nav_state_t& nav) const {
  std::vector<Neighbour> neighbours;
  for (const auto& [id, track] : tracks_) {
    const Vector3d p_m = track.p_WT_m - Vector3d(nav.p_WB_m);
    if (p_m.norm() <= reach_m) neighbours.push_back({p_m, track.v_WT_mps});
  }
  return neighbours;
}

}  // namespace windhover
