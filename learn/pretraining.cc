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

SampleSplits Drawn(const Scenario& base, std::uint64_t seed, int threads) {
  return SamplesOf(DrawTuples(base, seed, threads), base.rig.calibrated.ToStereoRig());
}

struct Data {
  std::vector<SampleSplits> sources;
  SampleSplits unseen;
};

/// How one training goes.
struct Course {
  int epochs, validate_every;
  std::uint64_t seed;
};

/// pcm, one stage.
struct PcmStudent {
  using Model = PcmStages;
  PcmRecipe recipe;
  double fine_tuning_rate;

  static double AbsRel(const Model& stages, const Samples& samples) {
    return ScorePcm(stages, FurtherStages::kNone, samples).abs_rel;
  }
  Model Trained(const Samples& train, const Samples& val, const Course& course,
                const std::optional<Model>& start) const {
    PcmRecipe own = recipe;
    own.n_stages = 1;
    own.epochs = course.epochs;
    own.validate_every = course.validate_every;
    own.seed = course.seed;
    if (start) own.optimiser.rate = fine_tuning_rate;
    PcmTrainer trainer(train, val, own, start);
    const Model before = trainer.Best();
    trainer.Finish();
    const Model after = trainer.Best();
    return AbsRel(after, val) < AbsRel(before, val) ? after : before;
  }
};

struct JointStudent {
  using Model = JointMlp;
  JointMlpRecipe recipe;
  double fine_tuning_rate;

  static double AbsRel(const Model& mlp, const Samples& samples) {
    return ScoreJointMlp(mlp, samples).abs_rel;
  }
  Model Trained(const Samples& train, const Samples& val, const Course& course,
                const std::optional<Model>& start) const {
    JointMlpRecipe own = recipe;
    own.epochs = course.epochs;
    own.validate_every = course.validate_every;
    own.seed = course.seed;
    if (start) own.rate = fine_tuning_rate;
    return TrainJointMlp(train, val, own, start);
  }
};

/// Abs Rel of one training, by number of tuples.
struct Outcome {
  struct Learner {
    std::vector<std::vector<double>> pretrained;
    std::vector<double> scratch;
  };
  Learner pcm, joint_mlp;
  std::vector<double> offset1;
};

int BatchesOf(const Samples& samples, int batch) {
  return std::max(1, (static_cast<int>(samples.size()) + batch - 1) / batch);
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

double OffsetAbsRel(const SampleSplits& few, const Samples& test) {
  Samples all = few.train;
  all.insert(all.end(), few.val.begin(), few.val.end());
  return ScoreOffset(test, MedianOffset(all)).abs_rel;
}

template <typename Student>
Outcome::Learner Try(const Student& student, const PretrainingPlan& plan, const Data& data,
                     std::uint64_t seed) {
  constexpr int kLooks = 60;
  using Model = typename Student::Model;
  const auto& recipe = student.recipe;
  std::vector<Model> starts;
  for (const SampleSplits& source : data.sources) {
    const Course course{recipe.epochs, recipe.validate_every, seed};
    starts.push_back(student.Trained(source.train, source.val, course, std::nullopt));
  }
  // As many steps, however few the samples are.
  const int n_steps = recipe.epochs * BatchesOf(data.sources.front().train, recipe.batch);
  const Samples& test = data.unseen.test;
  const Samples shuffled = Shuffled(data.unseen.train, seed);
  Outcome::Learner outcome{.pretrained = std::vector<std::vector<double>>(starts.size()),
                           .scratch = {}};
  for (const int n : plan.n_tuples) {
    const SampleSplits few = FirstOf(shuffled, n);
    const int epochs = std::max(1, n_steps / BatchesOf(few.train, recipe.batch));
    const Course course{epochs, std::max(1, epochs / kLooks), seed};
    const auto tried = [&](const std::optional<Model>& start) {
      return student.AbsRel(student.Trained(few.train, few.val, course, start), test);
    };
    for (std::size_t s = 0; s < starts.size(); ++s) {
      outcome.pretrained[s].push_back(n == 0 ? student.AbsRel(starts[s], test) : tried(starts[s]));
    }
    outcome.scratch.push_back(n == 0 ? ScoreOffset(test, 0).abs_rel : tried(std::nullopt));
  }
  return outcome;
}

Outcome TryOnce(const PretrainingPlan& plan, const Data& data, std::uint64_t seed) {
  Outcome outcome;
  outcome.pcm = Try(PcmStudent{plan.recipe, plan.fine_tuning_rate}, plan, data, seed);
  outcome.joint_mlp = Try(JointStudent{plan.joint_mlp, plan.fine_tuning_rate}, plan, data, seed);
  const Samples& test = data.unseen.test;
  const Samples shuffled = Shuffled(data.unseen.train, seed);
  for (const int n : plan.n_tuples) {
    outcome.offset1.push_back(n == 0 ? ScoreOffset(test, 0).abs_rel
                                     : OffsetAbsRel(FirstOf(shuffled, n), test));
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

void Add(const Outcome::Learner& outcome, std::size_t data_set, double share,
         PretrainingScores::Learner* scores) {
  for (std::size_t s = 0; s < outcome.pretrained.size(); ++s) {
    Add(outcome.pretrained[s], data_set, share, &scores->pretrained[s]);
  }
  Add(outcome.scratch, data_set, share, &scores->scratch);
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
  const PretrainingScores::Learner nothing{
      .pretrained = std::vector<PretrainingScores::Curve>(plan.sources.size(), none),
      .scratch = none};
  PretrainingScores scores{.pcm = nothing, .joint_mlp = nothing, .offset1 = none};
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const std::size_t set = i / static_cast<std::size_t>(n_trainings);
    const double share = 1.0 / n_trainings;
    Add(outcomes[i].pcm, set, share, &scores.pcm);
    Add(outcomes[i].joint_mlp, set, share, &scores.joint_mlp);
    Add(outcomes[i].offset1, set, share, &scores.offset1);
  }
  return scores;
}

}  // namespace windhover
