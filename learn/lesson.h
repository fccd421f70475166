#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "camera/stereo_rig.h"
#include "estimator/correction_card.h"
#include "learn/stereo_tuple.h"
#include "learn/train_pcm.h"
#include "scenarios/scenario.h"

namespace windhover {

/// What a row of a table has learned before it is tried.
struct Lesson {
  std::string name;  ///< Also of its card; empty: nothing.
  PcmRecipe recipe = StableRecipe();
  /// Also the fitted priors and the joint network.
  bool everything = false;
};

/// Learns from the training split, chooses by the validation split. `seed` is the training's.
CorrectionCard Learn(const Lesson& lesson, const TupleSplits& tuples, const StereoRig& rig,
                     std::uint64_t seed);

/// Cards of lessons on the data sets of one scenario, learned when they are first asked for.
class CardShelf {
 public:
  /// Cards go to `folder`, which exists. @param base of the data sets to learn from.
  CardShelf(std::filesystem::path folder, Scenario base, int threads)
      : folder_(std::move(folder)), base_(std::move(base)), threads_(threads) {}

  struct Request {
    Lesson lesson;
    std::uint64_t data_seed = 1, training_seed = 1;
  };

  /// Learns what of `requests` is not there yet, each on one thread. `on_card` is told after each.
  void Fetch(const std::vector<Request>& requests, const std::function<void()>& on_card);

  /// The card's file. @pre it has been fetched.
  std::string FileOf(const Request& request) const;

 private:
  std::filesystem::path folder_;
  Scenario base_;
  int threads_;
  std::set<std::string> there_;
};

}  // namespace windhover
