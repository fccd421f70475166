#pragma once

#include <functional>
#include <vector>

#include "learn/train_joint_mlp.h"
#include "learn/train_pcm.h"
#include "scenarios/scenario.h"

namespace windhover {

/// Asks whether a correction that other rigs taught needs fewer tuples of a new one.
struct PretrainingPlan {
  std::vector<Scenario> sources;  ///< Bases of the data sets to learn from first.
  Scenario unseen;                ///< Base of the new rig's data sets.
  PcmRecipe recipe = StableRecipe();
  JointMlpRecipe joint_mlp;
  double fine_tuning_rate = 1e-3;                  ///< Of both where something is learned already.
  std::vector<int> n_tuples = {0, 50, 200, 1000};  ///< Of the new rig, none or at least 10.
  int n_seeds = 3;                                 ///< Data sets.
  int n_training_seeds = 2;  ///< Trainings on each, each with other tuples of the new rig.
  int threads = 1;
};

/// Abs Rel on the test flights of the new rig, by number of tuples, then by data set; the mean
/// over trainings.
struct PretrainingScores {
  using Curve = std::vector<std::vector<double>>;
  struct Learner {
    std::vector<Curve> pretrained;  ///< On each of the plan's sources.
    Curve scratch;                  ///< Nothing learned before: plain triangulation at 0 tuples.
  };
  Learner pcm, joint_mlp;
  Curve offset1;  ///< The median offset of the same tuples.
};

/// Trains one stage of pcm, and the joint network. From n tuples, drawn from all training flights
/// of the new rig, every fifth is kept to choose by; training takes as many steps as pre-training
/// whatever n is, and is not taken where its start did better on what was kept. `on_step` is told
/// after each of n_seeds * n_training_seeds. The same bits on any number of threads.
PretrainingScores TryPretraining(const PretrainingPlan& plan, const std::function<void()>& on_step);

}  // namespace windhover
