#include "learn/pretraining.h"

#include <algorithm>
#include <mutex>
#include <optional>

#include "common/random/random_stream.h"
#include "learn/audit.h"
#include "learn/train_card.h"
#include "learn/tuple_source.h"
#include "render/parallel_for.h"

namespace windhover {
namespace {

using Samples = std::vector<PcmSample>;

struct SampleSplits {
  Samples train, val, test;
};

SampleSplits Drawn(const Scenario& base, std::uint64_t seed, int threads) {
  const TupleSplits tuples = DrawTuples(base, seed, threads);
  const StereoRig rig = base.rig.calibrated.ToStereoRig();
  return {SamplesOf(tuples.train, rig), SamplesOf(tuples.val, rig), SamplesOf(tuples.test, rig)};
}

struct Data {
  std::vector<SampleSplits> sources;
  SampleSplits unseen;
};

/// Abs Rel of one training, by number of tuples.
struct Outcome {
  std::vector<std::vector<double>> pretrained;
  std::vector<double> scratch, offset1;
};

double AbsRel(const PcmStages& stages, const Samples& samples) {
  return ScorePcm(stages, FurtherStages::kNone, samples).abs_rel;
}

PcmStages Trained(const Samples& train, const Samples& val, const PcmRecipe& recipe,
                  const std::optional<PcmStages>& start) {
  PcmTrainer trainer(train, val, recipe, start);
  const PcmStages before = trainer.Best();
  trainer.Finish();
  const PcmStages after = trainer.Best();
  return AbsRel(after, val) < AbsRel(before, val) ? after : before;
}

int BatchesOf(const Samples& samples, const PcmRecipe& recipe) {
  return std::max(1, (static_cast<int>(samples.size()) + recipe.batch - 1) / recipe.batch);
}

/// The first n of these are what somebody recorded who has n; more hold what fewer held.
Samples Shuffled(Samples samples, std::uint64_t seed) {
  RandomStream random(seed, "pretraining/tuples");
  for (std::size_t i = samples.size(); i > 1; --i) {
    std::swap(samples[i - 1], samples[random() % i]);
  }
  return samples;
}

/// Every fifth of the first n to choose by, the rest to learn from.
SampleSplits FirstOf(const Samples& shuffled, int n) {
  SampleSplits first;
  for (std::size_t i = 0; i < std::min(shuffled.size(), static_cast<std::size_t>(n)); ++i) {
    (i % 5 == 4 ? first.val : first.train).push_back(shuffled[i]);
  }
  return first;
}

/// Trains for `n_steps`, however few the samples are.
double TrainedAbsRel(const SampleSplits& few, const Samples& test, PcmRecipe recipe, int n_steps,
                     const std::optional<PcmStages>& start) {
  constexpr int kLooks = 60;
  recipe.epochs = std::max(1, n_steps / BatchesOf(few.train, recipe));
  recipe.validate_every = std::max(1, recipe.epochs / kLooks);
  return AbsRel(Trained(few.train, few.val, recipe, start), test);
}

double OffsetAbsRel(const SampleSplits& few, const Samples& test) {
  Samples all = few.train;
  all.insert(all.end(), few.val.begin(), few.val.end());
  return ScoreOffset(test, MedianOffset(all)).abs_rel;
}

Outcome TryOnce(const PretrainingPlan& plan, const Data& data, std::uint64_t seed) {
  PcmRecipe recipe = plan.recipe, gentle;
  recipe.n_stages = 1;
  recipe.seed = seed;
  gentle = recipe;
  gentle.optimiser.rate = plan.fine_tuning_rate;
  std::vector<PcmStages> starts;
  for (const SampleSplits& source : data.sources) {
    starts.push_back(Trained(source.train, source.val, recipe, std::nullopt));
  }
  const int n_steps = recipe.epochs * BatchesOf(data.sources.front().train, recipe);
  const Samples& test = data.unseen.test;
  const Samples shuffled = Shuffled(data.unseen.train, seed);
  Outcome outcome{
      .pretrained = std::vector<std::vector<double>>(starts.size()), .scratch = {}, .offset1 = {}};
  for (const int n : plan.n_tuples) {
    const SampleSplits few = FirstOf(shuffled, n);
    for (std::size_t s = 0; s < starts.size(); ++s) {
      outcome.pretrained[s].push_back(
          n == 0 ? AbsRel(starts[s], test) : TrainedAbsRel(few, test, gentle, n_steps, starts[s]));
    }
    const double triangulated = ScoreOffset(test, 0).abs_rel;
    outcome.scratch.push_back(n == 0 ? triangulated
                                     : TrainedAbsRel(few, test, recipe, n_steps, std::nullopt));
    outcome.offset1.push_back(n == 0 ? triangulated : OffsetAbsRel(few, test));
  }
  return outcome;
}

/// Adds a training's share of the mean over trainings.
void Add(const std::vector<double>& by_tuples, std::size_t data_set, double share,
         PretrainingScores::Curve* curve) {
  for (std::size_t n = 0; n < by_tuples.size(); ++n) {
    (*curve)[n][data_set] += by_tuples[n] * share;
  }
}

}  // namespace

PretrainingScores TryPretraining(const PretrainingPlan& plan,
                                 const std::function<void()>& on_step) {
  std::vector<Data> data(static_cast<std::size_t>(plan.n_seeds));
  for (std::size_t i = 0; i < data.size(); ++i) {
    for (const Scenario& source : plan.sources) {
      data[i].sources.push_back(Drawn(source, i + 1, plan.threads));
    }
    data[i].unseen = Drawn(plan.unseen, i + 1, plan.threads);
  }
  const int n_trainings = plan.n_training_seeds;
  std::vector<Outcome> outcomes(data.size() * static_cast<std::size_t>(n_trainings));
  std::mutex telling;
  ParallelFor(static_cast<int>(outcomes.size()), plan.threads, [&](int task, int /*worker*/) {
    outcomes[static_cast<std::size_t>(task)] =
        TryOnce(plan, data[static_cast<std::size_t>(task / n_trainings)],
                static_cast<std::uint64_t>(task % n_trainings) + 1);
    const std::scoped_lock lock(telling);
    on_step();
  });
  const PretrainingScores::Curve none(plan.n_tuples.size(), std::vector<double>(data.size()));
  PretrainingScores scores{
      .pretrained = std::vector<PretrainingScores::Curve>(plan.sources.size(), none),
      .scratch = none,
      .offset1 = none};
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const std::size_t set = i / static_cast<std::size_t>(n_trainings);
    const double share = 1.0 / n_trainings;
    for (std::size_t s = 0; s < plan.sources.size(); ++s) {
      Add(outcomes[i].pretrained[s], set, share, &scores.pretrained[s]);
    }
    Add(outcomes[i].scratch, set, share, &scores.scratch);
    Add(outcomes[i].offset1, set, share, &scores.offset1);
  }
  return scores;
}

}  // namespace windhover
