#include "learn/audit.h"

#include <algorithm>

#include <fmt/format.h>

#include "common/random/random_stream.h"

namespace windhover {
namespace {

using Samples = std::vector<PcmSample>;

const std::vector<std::string> kNoMisalignment = {"rig.misalignment.offset_px=0",
                                                  "rig.misalignment.yaw_deg=0",
                                                  "rig.misalignment.pitch_deg=0",
                                                  "rig.misalignment.roll_deg=0",
                                                  "rig.misalignment.random.yaw_sigma_deg=0",
                                                  "flex.drift.yaw_sigma_deg=0"};

const std::vector<std::string> kNothingButMisalignment = {"rig.misalignment.random.yaw_sigma_deg=0",
                                                          "flex.drift.yaw_sigma_deg=0",
                                                          "vibration.level=0",
                                                          "geometric.sigma_px=0.5",
                                                          "geometric.sigma_relative=0",
                                                          "geometric.gross_rate=0",
                                                          "score.reference=range"};

PcmStages Trained(const SampleSplits& data, const PcmRecipe& recipe) {
  PcmTrainer trainer(data.train, data.val, recipe);
  trainer.Finish();
  return trainer.Best();
}

AuditFinding Ask(const std::string& question, const SampleSplits& data, const PcmStages& pcm) {
  return {question, ScoreOffset(data.test, 0).abs_rel,
          ScoreOffset(data.test, MedianOffset(data.train)).abs_rel,
          ScorePcm(pcm, FurtherStages::kNone, data.test).abs_rel, ""};
}

template <typename Change>
void ChangeBoxes(const Change& change, Samples* samples) {
  for (PcmSample& sample : *samples) change(&sample.boxes);
}

void DropSizes(CorrectableBoxes* boxes) { boxes->w = boxes->h = {0, 0}; }

void Enlarge(CorrectableBoxes* boxes) {
  for (auto* sizes : {&boxes->w, &boxes->h}) {
    for (float& size : *sizes) size *= 1.4f;
  }
}

void ShuffleSizes(Samples* samples) {
  RandomStream random(1, "audit/shuffle");
  for (std::size_t i = samples->size() - 1; i > 0; --i) {
    CorrectableBoxes &a = (*samples)[i].boxes, &b = (*samples)[random() % (i + 1)].boxes;
    std::swap(a.w, b.w);
    std::swap(a.h, b.h);
  }
}

std::string WithoutSizes(double whole, const AuditFinding& found) {
  return found.pcm > 1.25 * whole
             ? fmt::format("needs sizes: without them {:.1f} times the error", found.pcm / whole)
             : "does not need sizes";
}

std::string Elsewhere(const char* what, double whole, const AuditFinding& found) {
  if (found.pcm > 1.25 * whole) {
    return fmt::format("trusts sizes: {} make it {:.1f} times as wrong", what, found.pcm / whole);
  }
  return fmt::format("does not mind {}", what);
}

}  // namespace

float MedianOffset(const std::vector<PcmSample>& samples) {
  std::vector<float> offsets;
  for (const PcmSample& s : samples) {
    offsets.push_back(s.boxes.Disparity() - s.boxes.range_m / s.label_m);
  }
  const auto middle = offsets.begin() + static_cast<std::ptrdiff_t>(offsets.size() / 2);
  std::nth_element(offsets.begin(), middle, offsets.end());
  return *middle;
}

PcmScore ScoreOffset(const std::vector<PcmSample>& samples, float offset) {
  std::vector<RangedSample> ranged;
  for (const PcmSample& s : samples) {
    ranged.push_back({s.boxes.Range_m(s.boxes.Disparity() - offset), s.label_m, 0});
  }
  return Score(ranged);
}

std::vector<AuditFinding> Audit(const StereoRig& rig, const PcmRecipe& one,
                                const DrawAudited& draw) {
  PcmRecipe recipe = one;
  recipe.n_stages = 1;
  const SampleSplits data = SamplesOf(draw({}), rig);
  const PcmStages pcm = Trained(data, recipe);
  std::vector<AuditFinding> findings = {Ask("as it is", data, pcm)};
  const double whole = findings[0].pcm;
  findings[0].verdict = whole < findings[0].offset1 ? "better than one constant offset"
                                                    : "no better than one constant offset";

  SampleSplits without = data;
  for (Samples* part : {&without.train, &without.val, &without.test}) ChangeBoxes(DropSizes, part);
  findings.push_back(Ask("without widths and heights", without, Trained(without, recipe)));
  findings.back().verdict = WithoutSizes(whole, findings.back());

  SampleSplits shuffled = data;
  ShuffleSizes(&shuffled.test);
  findings.push_back(Ask("sizes of other boxes", shuffled, pcm));
  findings.back().verdict = Elsewhere("sizes of other boxes", whole, findings.back());

  SampleSplits larger = data;
  ChangeBoxes(Enlarge, &larger.test);
  findings.push_back(Ask("a target 1.4 times as large", larger, pcm));
  findings.back().verdict = Elsewhere("larger targets", whole, findings.back());

  const SampleSplits shaken = SamplesOf(draw(kNoMisalignment), rig);
  findings.push_back(Ask("vibration and noise alone", shaken, Trained(shaken, recipe)));
  AuditFinding& vibration = findings.back();
  vibration.verdict = vibration.pcm < 0.9 * vibration.baseline
                          ? "learns sizes: what shakes has no offset to learn"
                          : "learns nothing: what shakes has no offset to learn";

  const SampleSplits still = SamplesOf(draw(kNothingButMisalignment), rig);
  findings.push_back(Ask("misalignment alone", still, Trained(still, recipe)));
  AuditFinding& offset = findings.back();
  offset.verdict = offset.offset1 <= offset.pcm
                       ? "one constant offset does at least as well"
                       : "better than one constant offset, though nothing else is wrong";
  return findings;
}

std::string AuditText(const std::vector<AuditFinding>& findings) {
  std::string text =
      fmt::format("{:28} {:>8} {:>8} {:>8}  {}\n", "", "baseline", "offset1", "pcm", "verdict");
  for (const AuditFinding& f : findings) {
    text += fmt::format("{:28} {:8.3f} {:8.3f} {:8.3f}  {}\n", f.question, f.baseline, f.offset1,
                        f.pcm, f.verdict);
  }
  return text;
}

}  // namespace windhover
