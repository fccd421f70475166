#include "cli/reproduce_targets.h"

#include <algorithm>

#include <fmt/format.h>

#include "cli/reproduce_tally.h"
#include "common/config/enum_name.h"
#include "common/file/whole_file.h"
#include "learn/detector/unseen_target.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct Method {
  const char *label, *estimator;
  bool learns;
};
constexpr Method kMethods[] = {
    {"baseline", "baseline", false}, {"+ PCM", "pcm", true}, {"+ PCM + DIC", "pcm_dic", true}};

/// The rows of one target and one source of boxes.
struct RowGroup {
  TargetKind kind;
  const char* boxes;
};

Json RowOf(const RowGroup& group, const Method& method) {
  std::string target = NameOf(group.kind);
  std::replace(target.begin(), target.end(), '_', ' ');
  Json row = {{"method", fmt::format("{}, {}: {}", target, group.boxes, method.label)},
              {"preset", "uavde_12mm"},
              {"estimator", method.estimator},
              {"boxes", group.boxes}};
  row["paper"] = {{"val", Json::object()}, {"test", Json::object()}};
  return row;
}

void AddMissing(const RowGroup& group, const std::string& why, Json* rows) {
  for (const Method& method : kMethods) {
    Json row = RowOf(group, method);
    row["missing"] = why;
    rows->push_back(std::move(row));
  }
}

std::string WhyNotTuned(int status) {
  constexpr int kNotStarted = 127;  // As a shell says it.
  if (status == kNotStarted) return "windhover-train-detector is built where libtorch-dev is";
  return fmt::format("windhover-train-detector ended with exit status {}", status);
}

/// The plan at work.
class UnseenTrial {
 public:
  UnseenTrial(const UnseenTargetsPlan& plan, const ReproduceOptions& options, Json* rows)
      : plan_(plan), options_(options), rows_(*rows), card_(ReadDetectorCard(plan.detector)) {
    const CardShelf::Request correction{plan.lesson, 1, 1};
    options.cards->Fetch({correction}, [] {});
    for (const Method& method : kMethods) {
      methods_.push_back(
          {method.estimator, method.learns ? options.cards->FileOf(correction) : std::string()});
    }
  }

  void Try(TargetKind kind) {
    const auto untuned = Detect(kind, card_, plan_.detector.parent_path());
    AddRows({kind, "untuned"}, untuned, BoxSource::kBest);
    AddRows({kind, "labelled"}, untuned, BoxSource::kLabelled);
    Step();
    if (const int status = FineTune(kind); status != 0) {
      AddMissing({kind, "fine-tuned"}, WhyNotTuned(status), &rows_);
      return;
    }
    Step();
    const auto tuned = Detect(kind, ReadDetectorCard(TunedCard(kind)), plan_.folder);
    AddRows({kind, "fine-tuned"}, tuned, BoxSource::kBest);
    Step();
  }

 private:
  void Step() {
    ++done_;
    if (options_.on_step) options_.on_step(done_, 3 * static_cast<int>(plan_.targets.size()));
  }

  fs::path TunedCard(TargetKind kind) const {
    return plan_.folder / fmt::format("{}.json", NameOf(kind));
  }

  std::vector<TriedPair> Detect(TargetKind kind, const DetectorCard& card,
                                const fs::path& folder) const {
    YoloxDetector detector(card, folder);
    return TryDetector(&detector, plan_.base, TrialPicturesOf(kind, /*seed=*/1), plan_.pairs,
                       [](int) { return true; });
  }

  int Train(const std::string& network, const std::string& onnx, const fs::path& labelled,
            const fs::path& out) const {
    std::vector<std::string> arguments = {
        "--network",  network,
        "--from",     (plan_.detector.parent_path() / onnx).string(),
        "--labelled", labelled.string(),
        "--out",      out.string(),
        "--steps",    std::to_string(plan_.tuning_steps),
        "--rate",     "2e-4",
        "--threads",  std::to_string(std::min(2, options_.threads))};
    arguments.insert(arguments.end(), plan_.tuning.begin(), plan_.tuning.end());
    const int status = plan_.train(arguments);
    fs::remove(out.string() + ".state");  // Nothing goes on from it.
    return status;
  }

  /// Both networks of the card, which keeps all that is not of them. @return an exit status.
  int FineTune(TargetKind kind) const {
    const fs::path labelled = plan_.folder / NameOf(kind), out = TunedCard(kind);
    fs::remove_all(labelled);
    WriteLabelledFolder(plan_.base, TuningPicturesOf(kind, /*seed=*/1), plan_.tuning_pairs,
                        labelled);
    DetectorCard tuned = card_;
    tuned.box_noise = nullptr;  // Another detector errs in another way.
    if (card_.refiner) {
      const fs::path refiner = plan_.folder / fmt::format("{}_refine.json", NameOf(kind));
      const int status = Train("yolox_refine", card_.refiner->onnx, labelled, refiner);
      if (status != 0) return status;
      const DetectorCard made = ReadDetectorCard(refiner);
      tuned.refiner = made.detector;
      tuned.provenance = {{"refiner", made.provenance}};
    } else {
      tuned.provenance = Json::object();
    }
    if (const int status = Train(card_.network, card_.detector.onnx, labelled, out)) return status;
    const DetectorCard made = ReadDetectorCard(out);
    tuned.detector = made.detector;
    tuned.provenance["detector"] = made.provenance;
    ReplaceFile(out, DetectorCardText(tuned));
    return 0;
  }

  void AddRows(const RowGroup& group, const std::vector<TriedPair>& pairs, BoxSource source) {
    const int pairs_a_scene = TrialPicturesOf(group.kind, 1).pairs;
    std::array<std::vector<Tally>, std::size(kMethods)> scenes;
    for (const auto& frames : RangesOn(pairs, pairs_a_scene, source, plan_.base, methods_)) {
      const std::vector<Tally> tallies = TalliesOf(frames, {0, 1, 2}, std::size(kMethods));
      for (std::size_t m = 0; m < tallies.size(); ++m) scenes[m].push_back(tallies[m]);
    }
    const TrialScore trial = ScoreTrial(pairs);
    for (std::size_t m = 0; m < std::size(kMethods); ++m) {
      Json row = RowOf(group, kMethods[m]);
      if (kMethods[m].learns) row["learned"] = plan_.lesson.name;
      row["test"] = ScoreOf(scenes[m], /*n_seeds=*/1);
      if (source == BoxSource::kBest) {
        const TrialScore::Bin& all = trial.bins.front();
        if (trial.ap50) row["test"]["ap50"] = *trial.ap50;
        if (all.n > 0) row["test"]["recall"] = static_cast<double>(all.n_found) / all.n;
        row["test"]["beside_targets"] = trial.n_beside;
      }
      rows_.push_back(std::move(row));
    }
  }

  const UnseenTargetsPlan& plan_;
  const ReproduceOptions& options_;
  Json& rows_;
  DetectorCard card_;
  std::vector<TrialMethod> methods_;
  int done_ = 0;
};

}  // namespace

UnseenTargetsPlan UnseenTargetsOf(Effort effort, const ReproducedTable& targets,
                                  const ReproduceOptions& options) {
  UnseenTargetsPlan plan;
  plan.base = BaseOf(targets.rows.front(), options.scenarios);
  for (const ReproducedRow& row : targets.rows) {
    if (!row.lesson.name.empty()) plan.lesson = row.lesson;
  }
  if (effort == Effort::kQuick) {
    plan.pairs = 60;
    plan.tuning_steps = 100;
  }
  return plan;
}

void AddUnseenTargets(const UnseenTargetsPlan& plan, const ReproduceOptions& options,
                      Json* targets) {
  Json& rows = (*targets)["rows"];
  (*targets)["also"] = {"sq_rel", "ap50", "recall"};
  if (!fs::exists(plan.detector)) {
    for (const TargetKind kind : plan.targets) {
      for (const char* boxes : {"untuned", "labelled", "fine-tuned"}) {
        AddMissing({kind, boxes}, fmt::format("there is no detector {}", plan.detector.string()),
                   &rows);
      }
    }
    return;
  }
  UnseenTrial trial(plan, options, &rows);
  for (const TargetKind kind : plan.targets) trial.Try(kind);
}

}  // namespace windhover
