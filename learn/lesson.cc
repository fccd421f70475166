#include "learn/lesson.h"

#include <fstream>
#include <map>
#include <mutex>
#include <stdexcept>

#include <fmt/format.h>

#include "learn/fit_priors.h"
#include "learn/train_card.h"
#include "learn/train_joint_mlp.h"
#include "learn/tuple_source.h"
#include "render/parallel_for.h"

namespace windhover {
CorrectionCard Learn(const Lesson& lesson, const TupleSplits& tuples, const StereoRig& rig,
                     std::uint64_t seed) {
  const std::vector<PcmSample> train = SamplesOf(tuples.train, rig);
  const std::vector<PcmSample> val = SamplesOf(tuples.val, rig);
  PcmRecipe recipe = lesson.recipe;
  recipe.seed = seed;
  PcmTrainer trainer(train, val, recipe);
  // What a training that diverges had found counts.
  trainer.Finish();
  CorrectionCard card;
  card.pcm = trainer.Best();
  if (lesson.everything) {
    card.joint_mlp = TrainJointMlp(train, val, {.seed = seed});
    card.priors = FitPriors(tuples.train, rig);
  }
  card.provenance = {{"lesson", lesson.name}, {"seed", seed}, {"epochs", trainer.epochs_done()}};
  return card;
}

void CardShelf::Fetch(const std::vector<Request>& requests, const std::function<void()>& on_card) {
  std::vector<Request> missing;
  std::set<std::uint64_t> data_seeds;
  for (const Request& request : requests) {
    if (!there_.insert(FileOf(request)).second) continue;
    missing.push_back(request);
    data_seeds.insert(request.data_seed);
  }
  std::map<std::uint64_t, TupleSplits> data;
  for (const std::uint64_t seed : data_seeds) data[seed] = DrawTuples(base_, seed, threads_);
  const StereoRig rig = base_.rig.calibrated.ToStereoRig();
  std::mutex telling;
  ParallelFor(static_cast<int>(missing.size()), threads_, [&](int task, int /*worker*/) {
    const Request& request = missing[static_cast<std::size_t>(task)];
    const CorrectionCard card =
        Learn(request.lesson, data.at(request.data_seed), rig, request.training_seed);
    std::ofstream file(FileOf(request));
    if (!(file << CorrectionCardText(card)).flush()) {
      throw std::runtime_error(FileOf(request) + ": cannot be written");
    }
    const std::scoped_lock lock(telling);
    on_card();
  });
}

std::string CardShelf::FileOf(const Request& request) const {
  return folder_ / fmt::format("{}_data{}_training{}.json", request.lesson.name, request.data_seed,
                               request.training_seed);
}

}  // namespace windhover
