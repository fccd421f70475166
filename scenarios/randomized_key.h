#pragma once

#include <string>
#include <vector>

#include "common/config/fields.h"

namespace windhover {

/// A key of a scenario that every random_seed draws anew (scenarios/randomize.h): evenly between
/// two numbers, or one of some values.
struct RandomizedKey {
  std::string key;
  double min = kUnset, max = kUnset;
  std::vector<std::string> one_of;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("key", key, NotEmpty{}, "key that is drawn, outside lists: vibration.level");
    v.Field("min", min, Optional{}, "smallest value, each up to max as likely");
    v.Field("max", max, Optional{}, "largest value");
    v.Field("one_of", one_of, MayBeEmpty{}, "values, each as likely, instead of min and max");
  }
};

}  // namespace windhover
