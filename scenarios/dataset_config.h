#pragma once

#include "common/config/fields.h"

namespace windhover {

/// Which part of a data set a flight belongs to.
enum class Split { kTrain, kVal, kTest };
template <>
inline constexpr EnumNames<Split> kEnumNames<Split>{
    {Split::kTrain, "train"}, {Split::kVal, "val"}, {Split::kTest, "test"}};

struct SplitConfig {
  int flights = 1;
  int pairs = 1;
  double near_share = 0.53;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("flights", flights, InRange{1, 1000}, "flights, each with a rig of its own");
    v.Field("pairs", pairs, InRange{1, 1000000}, "stereo pairs of all flights together");
    v.Field("near_share", near_share, InRange{0.01, 0.99}, "share of distances below 20 m");
  }
};

/// Flights like those of the UAVDE data set: 3895 pairs, of distances that are about uniform below
/// and above 20 m (scenarios/dataset.h).
struct DatasetConfig {
  double nearest_m = 4.3;
  double farthest_m = 41;
  double tilt_deg = 5;
  struct Splits {
    SplitConfig train{.flights = 12, .pairs = 2815, .near_share = 0.53};
    SplitConfig val{.flights = 3, .pairs = 541, .near_share = 0.56};
    SplitConfig test{.flights = 3, .pairs = 539, .near_share = 0.53};

    template <typename Visitor>
    void Fields(Visitor& v) {
      v.Section("train", train, "to learn from");
      v.Section("val", val, "to choose by");
      v.Section("test", test, "to report");
    }
  };
  Splits splits;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("nearest_m", nearest_m, InRange{1, 19}, "smallest distance of the target");
    v.Field("farthest_m", farthest_m, InRange{21, 1000}, "largest distance of the target");
    v.Field("tilt_deg", tilt_deg, InRange{0, 20},
            "standard deviation of the target's pitch and roll, from its manoeuvres");
    v.Section("splits", splits, "its parts, of different flights");
  }

  const SplitConfig& Of(Split split) const {
    return split == Split::kTrain ? splits.train : split == Split::kVal ? splits.val : splits.test;
  }
};

}  // namespace windhover
