#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "budget/error_budget.h"
#include "common/config/fields.h"
#include "sweep/sweep_plan.h"

namespace windhover {

/// What a rig has to do.
struct RigRequirement {
  double abs_rel = 0.05;
  double distance_m = 30;
  double field_of_view_deg = 0;
  int confirm = 8;
  int flights = 200;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("abs_rel", abs_rel, InRange{1e-4, 1}, "mean |d - d*| / d* that must not be passed");
    v.Field("distance_m", distance_m, InRange{0.5, 1e4}, "of the target");
    v.Field("field_of_view_deg", field_of_view_deg, InRange{0, 179}, "least, across, of a camera");
    v.Field("confirm", confirm, InRange{0, 1000}, "rigs to simulate, those of the least error");
    v.Field("flights", flights, InRange{2, 1000000}, "to simulate of each");
  }
};

/// requirement.yaml: sections `require` (RigRequirement) and those of a sweep: `base` and `set` are
/// the rig's fixed parts, `factors` what may be chosen, `design` which combinations are looked at.
struct AdviceRequest {
  RigRequirement require;
  SweepPlan rigs;
};

/// @throws ConfigError listing every mistake at its place.
AdviceRequest LoadAdviceRequest(const std::filesystem::path& file);

/// One rig and what it would do.
struct RigAdvice {
  std::size_t point = 0;  ///< Of AdviceRequest::rigs.
  double field_of_view_deg = 0;
  Effect first_order;     ///< Closed form, at the distance.
  double abs_rel = 0;     ///< By that.
  bool is_small = false;  ///< Closed form can be relied on (kSmall).
  bool is_simulated = false;
  Effect simulated = {};
  double simulated_abs_rel = 0;
};

/// Mean of |e| for e normal with the effect's bias and deviation (folded normal distribution).
double MeanAbsolute_m(const Effect& effect);

/// Every rig with a field of view that is wide enough, the least error first; the best of them
/// simulated.
std::vector<RigAdvice> Advise(const AdviceRequest& request);

/// {"require", "rigs": [{"rig": {KEY: VALUE}, "field_of_view_deg", "abs_rel", "simulated_abs_rel",
/// "meets"}]}
nlohmann::ordered_json AdviceJson(const AdviceRequest& request, const std::vector<RigAdvice>& rigs);

/// Whether a rig meets the requirement: by simulation where it was simulated.
bool Meets(const AdviceRequest& request, const RigAdvice& rig);

}  // namespace windhover
