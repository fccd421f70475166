#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "sweep/sweep_plan.h"

namespace windhover {

/// @throws ConfigError where sweep.yaml says `retrain: true`, if no method learns, one cannot learn
/// from the data set of a point, or a factor chooses the card that training would replace.
void CheckRetraining(const SweepPlan& plan);

/// What `retrain: true` trains: for each point the card that `windhover train pcm` makes of its
/// scenario. Points that differ in nothing that training sees share a card. A card is a function of
/// its point's scenario alone; it is there whole or not at all.
class SweepCards {
 public:
  /// @param folder of the sweep: cards go to cards/, nothing else is left.
  SweepCards(const SweepPlan& plan, std::filesystem::path folder);

  /// A run of `point` with its card as estimator.correction. The first run trains it; other
  /// processes that need it wait.
  /// @throws std::runtime_error saying why training failed: at once, if it failed here before.
  Scenario WithCard(Scenario drawn, std::size_t point);

 private:
  std::string Train(std::size_t point) const;
  void Make(const std::filesystem::path& card, std::size_t point);

  const SweepPlan& plan_;
  std::filesystem::path folder_;
  std::vector<std::size_t> first_alike_;         ///< Of each point; its card has the number.
  std::map<std::size_t, std::string> failures_;  ///< Why there is no card.
};

}  // namespace windhover
