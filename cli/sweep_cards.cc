#include "cli/sweep_cards.h"

#include <algorithm>
#include <stdexcept>

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/file.h>
#include <unistd.h>

#include "common/config/findings.h"
#include "common/file/whole_file.h"
#include "common/process/process.h"
#include "learn/fit_priors.h"
#include "learn/train_card.h"
#include "learn/tuple_source.h"
#include "scenarios/scenario_rules.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

// As `windhover train pcm` has them when nothing is said. Common to all points, so that these
// differ by their factors and not by luck.
constexpr std::uint64_t kDataSeed = 1, kTrainingSeed = 1;

bool NeedsPriors(const std::string& method) { return method == "fused" || method == "fusion"; }

bool AnyNeedsPriors(const Scenario& scenario) {
  const auto& methods = scenario.estimator.methods;
  return std::any_of(methods.begin(), methods.end(), NeedsPriors);
}

SourceLocation PlaceOfRetrain(const SweepPlan& plan) {
  return NearestNode(plan.source, "retrain").where;
}

/// What training sees of a scenario: nothing of how its run is flown, estimated and scored.
Scenario TrainingBase(Scenario scenario) {
  scenario.description = "retrain";
  scenario.random_seed = Scenario{}.random_seed;
  scenario.duration_s = Scenario{}.duration_s;
  scenario.observe = Observe::kGeometric;
  // What geometric.noise: fitted was read from.
  const InputFile detector_model = scenario.estimator.detector_model;
  scenario.estimator = {};
  scenario.estimator.detector_model = detector_model;
  scenario.nav = {};
  scenario.render = {};
  scenario.swarm = {};
  scenario.expect.clear();
  scenario.execution = {};
  return scenario;
}

/// While this lives, no other process holds the same file's.
class FileLock {
 public:
  explicit FileLock(const fs::path& file)
      : fd_(open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {
    if (fd_ < 0 || flock(fd_, LOCK_EX) != 0) {
      throw std::runtime_error(fmt::format("{}: cannot be locked", file.string()));
    }
  }
  ~FileLock() { close(fd_); }
  FileLock(const FileLock&) = delete;

 private:
  int fd_;
};

void CheckMethods(const SweepPlan& plan, Findings* findings) {
  const std::vector<std::string> methods = plan.BaseScenario().estimator.methods;
  const bool learns = std::any_of(methods.begin(), methods.end(), [](const std::string& method) {
    return NeedsCorrection(method) || NeedsPriors(method);
  });
  if (learns) return;
  findings->MustBe(PlaceOfRetrain(plan), "retrain", "false where no method learns",
                   fmt::format("true with estimator.methods [{}]", fmt::join(methods, ", ")));
}

void CheckFlights(const SweepPlan& plan, Findings* findings) {
  for (std::size_t i = 0; i < plan.points.size(); ++i) {
    const Scenario scenario = plan.ScenarioAt(i);
    const int n = scenario.dataset.Of(Split::kTrain).flights;
    if (static_cast<std::size_t>(n) >= kLeastFlights || !AnyNeedsPriors(scenario)) continue;
    return findings->MustBe(
        PlaceOfRetrain(plan), "retrain",
        fmt::format("false where fusion or fused is to learn from less than {} flights",
                    kLeastFlights),
        fmt::format("true with dataset.splits.train.flights {}, at point {}", n, i));
  }
}

}  // namespace

void CheckRetraining(const SweepPlan& plan) {
  if (!plan.config.retrain) return;
  Findings findings;
  const std::string kCard = "estimator.correction";
  if (const std::size_t f = plan.FactorNamed(kCard); f < plan.factors.size()) {
    findings.MustBe(plan.key_places[f], kCard, "left to training where retrain is true",
                    "a factor");
  }
  CheckMethods(plan, &findings);
  CheckFlights(plan, &findings);
  findings.ThrowIfAny();
}

SweepCards::SweepCards(const SweepPlan& plan, fs::path folder)
    : plan_(plan), folder_(std::move(folder)) {
  std::map<std::string, std::size_t> first;
  for (std::size_t i = 0; i < plan.points.size(); ++i) {
    const std::string seen = ResolvedYaml(TrainingBase(plan.ScenarioAt(i)), PathStyle::kAbsolute);
    first_alike_.push_back(first.emplace(seen, i).first->second);
  }
}

Scenario SweepCards::WithCard(Scenario drawn, std::size_t point) {
  const std::size_t alike = first_alike_[point];
  const fs::path card = fs::absolute(folder_) / "cards" / fmt::format("point{}.json", alike);
  if (const auto known = failures_.find(alike); known != failures_.end()) {
    throw std::runtime_error(known->second);
  }
  if (!fs::exists(card)) {
    try {
      Make(card, alike);
    } catch (const std::exception& error) {
      failures_[alike] = fmt::format("retrain: {}", error.what());
      throw std::runtime_error(failures_[alike]);
    }
  }
  drawn.estimator.correction = {card, card, PlaceOfRetrain(plan_).ToString()};
  return drawn;
}

void SweepCards::Make(const fs::path& card, std::size_t point) {
  fs::create_directories(folder_ / "work");
  const FileLock lock(folder_ / "work" / (card.filename().string() + ".lock"));
  if (fs::exists(card)) return;
  const std::string text = Train(point);
  fs::create_directories(card.parent_path());
  ReplaceFile(card, text);
}

std::string SweepCards::Train(std::size_t point) const {
  const Scenario base = TrainingBase(plan_.ScenarioAt(point));
  CardPlan plan{.rig = base.rig.calibrated.ToStereoRig(),
                .tuples = DrawTuples(base, kDataSeed, 1),
                .pcm = StableRecipe(),
                .joint_mlp = {.seed = kTrainingSeed},
                .start = {},
                .state_file = folder_ / "work" / fmt::format("point{}.state", point),
                .provenance = {{"command", "windhover sweep, retrain: true"},
                               {"point", plan_.Describe(point)},
                               {"data_seed", kDataSeed},
                               {"seed", kTrainingSeed},
                               {"version", WINDHOVER_VERSION}}};
  plan.pcm.seed = kTrainingSeed;
  const TrainedCard trained = TrainCard(plan, [](int, int) { return !StopRequested(); });
  if (trained.end == TrainingEnd::kInterrupted) throw std::runtime_error("interrupted");
  if (trained.end == TrainingEnd::kDiverged) throw std::runtime_error("training diverged");
  if (AnyNeedsPriors(plan_.BaseScenario()) && !trained.card.priors) {
    throw std::runtime_error("too few detections to fit the priors of fusion and fused");
  }
  return CorrectionCardText(trained.card);
}

}  // namespace windhover
