#include "sim/state_history.h"

#include <algorithm>

namespace windhover {
namespace {

Kinematics CarriedOn(const Kinematics& state, double h_s) {
  Kinematics moved = state;
  moved.p_WB_m += h_s * state.v_WB_mps;
  return moved;
}

}  // namespace

void StateHistory::Add(double t_s, const Kinematics& state) {
  if (!entries_.empty() && entries_.back().t_s == t_s) entries_.pop_back();
  entries_.push_back({t_s, state});
}

void StateHistory::ForgetBefore(double t_s) {
  while (entries_.size() > 2 && entries_[1].t_s <= t_s) entries_.pop_front();
}

Kinematics StateHistory::At(double t_s) const {
  const auto after = std::lower_bound(entries_.begin(), entries_.end(), t_s,
                                      [](const Entry& e, double t) { return e.t_s < t; });
  if (after == entries_.end()) {
    return CarriedOn(entries_.back().state, t_s - entries_.back().t_s);
  }
  if (after->t_s == t_s || after == entries_.begin()) {
    return CarriedOn(after->state, t_s - after->t_s);
  }
  const Entry &b = *after, &a = *(after - 1);
  const double h_s = b.t_s - a.t_s, s = (t_s - a.t_s) / h_s;
  const Eigen::Vector3d step = b.state.p_WB_m - a.state.p_WB_m;
  const Eigen::Vector3d v0 = h_s * a.state.v_WB_mps, v1 = h_s * b.state.v_WB_mps;
  const Eigen::Vector3d c2 = 3 * step - 2 * v0 - v1, c3 = v0 + v1 - 2 * step;
  Kinematics state;
  state.p_WB_m = a.state.p_WB_m + s * (v0 + s * (c2 + s * c3));
  state.v_WB_mps = (v0 + s * (2 * c2 + s * 3 * c3)) / h_s;
  state.q_WB = a.state.q_WB.slerp(s, b.state.q_WB);
  return state;
}

}  // namespace windhover
