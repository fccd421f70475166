#include <fmt/format.h>

#include "cli/reproduce.h"

namespace windhover {
namespace {

using Score = PublishedScore;
using Overrides = std::vector<std::string>;

// The paper's triangulation, its tables II, III, VII and VIII.
constexpr Score kVal12{.abs_rel = 0.490, .sq_rel = 6.716, .near = {}, .far = {}};
constexpr Score kTest12{.abs_rel = 0.494, .sq_rel = 6.818, .near = {}, .far = {}};
constexpr Score kTest16{.abs_rel = 0.430, .sq_rel = 5.090, .near = {}, .far = {}};
constexpr Score kPcmVal{.abs_rel = 0.148, .sq_rel = 1.014, .near = {}, .far = {}};
constexpr Score kPcmTest{.abs_rel = 0.121, .sq_rel = 0.620, .near = {}, .far = {}};
constexpr Score kDicVal{.abs_rel = 0.114, .sq_rel = 0.673, .near = {}, .far = {}};
constexpr Score kDicTest{.abs_rel = 0.098, .sq_rel = 0.401, .near = {}, .far = {}};

// What is not a number of this report is worded as what it is: likely, or not shown.
constexpr const char* kRecipe =
    "Not shown: the noise of the paper's boxes is not published. Likely it is milder and its "
    "training shorter than ours, since little training on milder noise gives such a number, too; "
    "the rows of table III with the paper's recipe show what the recipe alone changes.";
constexpr const char* kGate =
    "Likely chance: with this noise most samples err by more than T after one correction, so that "
    "the gate has little to tell apart; the rows of DIC and DIC* of table III show that gap.";
constexpr const char* kBaseline =
    "Data sets differ from draw to draw (sd); offset and distances of the preset were chosen to "
    "fit the paper's over many.";

Score Of(double abs_rel, double sq_rel) { return {abs_rel, sq_rel, {}, {}}; }
Score NearFar(double near, double far) { return {{}, {}, near, far}; }
Score AbsRel(double abs_rel) { return {abs_rel, {}, {}, {}}; }

/// What the tables' learned rows have learned.
class Lessons {
 public:
  explicit Lessons(Effort effort) : effort_(effort) {}

  /// Two stages, and all that a card can hold.
  Lesson Main() const { return Make("main", 2, 0.06, false); }
  Lesson ForAll() const { return Make("for_all", 2, 0.06, true); }
  Lesson Stages(int n) const { return Make(fmt::format("stages_{}", n), n, 0.06, false); }
  Lesson Threshold(double t) const {
    return t == 0.06 ? Main() : Make(fmt::format("threshold_{:.2f}", t), 2, t, false);
  }
  /// As the authors train.
  Lesson Paper() const {
    Lesson lesson{"paper", PaperRecipe(), false};
    if (effort_ == Effort::kQuick) lesson.recipe.epochs = 1000;
    return lesson;
  }

 private:
  Lesson Make(std::string name, int n_stages, double threshold, bool all_hard) const {
    Lesson lesson{std::move(name), StableRecipe(), n_stages == 2 && !all_hard && threshold == 0.06};
    lesson.recipe.n_stages = n_stages;
    lesson.recipe.threshold = threshold;
    lesson.recipe.all_hard = all_hard;
    if (effort_ == Effort::kQuick) lesson.recipe.epochs /= 2;
    return lesson;
  }

  Effort effort_;
};

ReproducedRow Row(std::string label, std::string estimator, Lesson lesson, const Score& val,
                  const Score& test, std::string why = {}) {
  return {.method = std::move(label),
          .preset = "uavde_12mm",
          .estimator = std::move(estimator),
          .lesson = std::move(lesson),
          .paper_val = val,
          .paper_test = test,
          .why = std::move(why)};
}

ReproducedRow On(const std::string& preset, const Overrides& overrides, ReproducedRow row) {
  row.preset = preset;
  row.overrides = overrides;
  return row;
}

ReproducedRow NotYet(std::string label, const Score& val, const Score& test, std::string what) {
  return {.method = std::move(label),
          .preset = "uavde_12mm",
          .paper_val = val,
          .paper_test = test,
          .missing = "not yet: " + what};
}

const Overrides kAnnotated = {"geometric.sigma_px=0", "geometric.sigma_relative=0",
                              "geometric.gross_rate=0"};

ReproducedTable Comparison(const Lessons& lessons) {
  return {
      "comparison",
      "methods on the same detections, and dense matchers (table II)",
      {NotYet("ADCensus", Of(0.601, 13.588), Of(0.714, 22.911), "dense matchers"),
       NotYet("ELAS", Of(0.508, 6.609), Of(0.527, 6.467), "dense matchers"),
       Row("Baseline", "baseline", {}, Of(0.490, 6.716), Of(0.494, 6.818), kBaseline),
       On("uavde_12mm", kAnnotated,
          Row("Baseline*, annotated boxes", "baseline", {}, Of(0.483, 6.550), Of(0.488, 6.712))),
       Row("Ours of the paper: PCM + DIC", "pcm_dic", lessons.Main(), Of(0.114, 0.673),
           Of(0.098, 0.401), kGate),
       Row("one offset calibrated", "offset1", {}, {}, {}),
       Row("size of the box alone", "size", {}, {}, {}),
       Row("disparity and size of one frame", "fusion", lessons.Main(), {}, {}),
       Row("joint network", "joint_mlp", lessons.Main(), {}, {}),
       Row("selfcal, nothing learned", "selfcal", {}, {}, {}),
       Row("fused", "fused", lessons.Main(), {}, {})}};
}

ReproducedTable Components(const Lessons& lessons) {
  return {
      "components",
      "what each part of the correction brings (table III)",
      {Row("Baseline", "baseline", {}, kVal12, kTest12, kBaseline),
       Row("+ PCM", "pcm", lessons.Main(), kPcmVal, kPcmTest, kRecipe),
       Row("+ PCM + DIC", "pcm_dic", lessons.Main(), kDicVal, kDicTest, kGate),
       Row("+ PCM + DIC*", "pcm_dic_star", lessons.ForAll(), Of(0.129, 0.823), Of(0.121, 0.576),
           "Not shown here: that easy samples are corrected too far. The paper's table III says so "
           "of its data."),
       Row("+ PCM, the paper's recipe", "pcm", lessons.Paper(), kPcmVal, kPcmTest, kRecipe),
       Row("+ PCM + DIC, the paper's recipe", "pcm_dic", lessons.Paper(), kDicVal, kDicTest,
           kGate)}};
}

ReproducedTable Corrections(const Lessons& lessons) {
  return {"corrections",
          "number of correction stages (table IV)",
          {Row("0", "baseline", {}, Of(0.490, 6.716), Of(0.494, 6.818)),
           Row("1", "pcm", lessons.Main(), Of(0.148, 1.014), Of(0.121, 0.620), kRecipe),
           Row("2", "pcm_dic", lessons.Main(), Of(0.114, 0.673), Of(0.098, 0.401), kGate),
           Row("3", "pcm_dic", lessons.Stages(3), Of(0.113, 0.663), Of(0.097, 0.356), kGate),
           Row("4", "pcm_dic", lessons.Stages(4), Of(0.112, 0.693), Of(0.097, 0.351), kGate)}};
}

ReproducedTable Threshold(const Lessons& lessons) {
  const auto dic = [&](double t, const Score& val, const Score& test) {
    return Row(fmt::format("{:.2f}", t), "pcm_dic", lessons.Threshold(t), val, test, kGate);
  };
  return {
      "threshold",
      "threshold T of the gate (table V)",
      {Row("1.0 (no second correction)", "pcm", lessons.Main(), Of(0.148, 1.014), Of(0.121, 0.620),
           kRecipe),
       dic(0.05, Of(0.118, 0.693), Of(0.100, 0.369)), dic(0.06, Of(0.114, 0.673), Of(0.098, 0.401)),
       dic(0.07, Of(0.125, 0.775), Of(0.103, 0.428)), dic(0.08, Of(0.116, 0.697), Of(0.102, 0.428)),
       dic(0.09, Of(0.116, 0.702), Of(0.103, 0.430)),
       dic(0.10, Of(0.117, 0.719), Of(0.101, 0.438))}};
}

ReproducedTable HardSamples(const Lessons& lessons) {
  return {
      "hard_samples",
      "targets nearer and farther than 20 m (table VII)",
      {Row("Baseline", "baseline", {}, NearFar(0.376, 0.634), NearFar(0.375, 0.628)),
       Row("+ PCM", "pcm", lessons.Main(), NearFar(0.107, 0.171), NearFar(0.098, 0.145), kRecipe),
       Row("+ PCM + DIC", "pcm_dic", lessons.Main(), NearFar(0.105, 0.126), NearFar(0.092, 0.105),
           kGate),
       Row("fused", "fused", lessons.Main(), {}, {})}};
}

ReproducedTable Lenses(const Lessons& lessons) {
  constexpr const char* kFocal =
      "The estimator is told the focal length of 16 mm. Likely the paper's was not: its code has "
      "that of 12 mm fixed.";
  const auto behind16 = [](ReproducedRow row) { return On("uavde_16mm", {}, std::move(row)); };
  return {
      "lenses",
      "learned behind 12 mm lenses, tried behind 12 mm and 16 mm (table VIII)",
      {Row("baseline, 12 mm", "baseline", {}, kVal12, kTest12, kBaseline),
       Row("+ PCM, 12 mm", "pcm", lessons.Main(), kPcmVal, kPcmTest, kRecipe),
       Row("+ PCM + DIC, 12 mm", "pcm_dic", lessons.Main(), kDicVal, kDicTest, kGate),
       On("uavde_12mm_nominal", {},
          Row("baseline, 12 mm, nominal noise", "baseline", {}, kVal12, kTest12, kBaseline)),
       behind16(Row("baseline, 16 mm", "baseline", {}, {}, kTest16)),
       behind16(Row("+ PCM, 16 mm", "pcm", lessons.Main(), {}, Of(0.199, 1.805), kFocal)),
       behind16(Row("+ PCM + DIC, 16 mm", "pcm_dic", lessons.Main(), {}, Of(0.180, 3.186), kFocal)),
       Row("fused, 12 mm", "fused", lessons.Main(), {}, {}),
       behind16(Row("fused, 16 mm", "fused", lessons.Main(), {}, {}))}};
}

ReproducedTable Targets(const Lessons& lessons) {
  struct Target {
    const char *name, *type;
    std::array<double, 3> untuned, annotated, detected;  ///< Baseline, PCM, PCM + DIC.
  };
  constexpr Target kTargets[] = {
      {"M200 black",
       "m200_black",
       {2.551, 6.466, 1.697},
       {0.434, 0.140, 0.092},
       {0.421, 0.164, 0.096}},
      {"P600", "p600", {2.399, 2.815, 2.718}, {0.421, 0.128, 0.124}, {0.410, 0.183, 0.133}}};
  ReproducedTable table{
      "targets",
      "learned on an orange M200, tried on other targets (table IX). Boxes of M200 and "
      "P600 are modelled; those of a hexacopter and a flying wing, which our "
      "detector never learned from, are labelled ones and what the detector finds "
      "in pictures: untuned, and fine-tuned on fewer than 50 of them",
      {}};
  const auto add = [&](const std::string& name, const Overrides& overrides,
                       const std::array<Score, 3>& paper) {
    const std::array<ReproducedRow, 4> rows = {
        Row(name + ": baseline", "baseline", {}, {}, paper[0],
            "Likely other distances: the paper does not tell those of these targets."),
        Row(name + ": + PCM", "pcm", lessons.Main(), {}, paper[1], kRecipe),
        Row(name + ": + PCM + DIC", "pcm_dic", lessons.Main(), {}, paper[2], kGate),
        Row(name + ": fused", "fused", lessons.Main(), {}, {})};
    for (const ReproducedRow& row : rows) table.rows.push_back(On("uavde_12mm", overrides, row));
  };
  add("M200 orange, detected", {}, {AbsRel(0.494), AbsRel(0.121), AbsRel(0.098)});
  for (const Target& target : kTargets) {
    const std::string pair = fmt::format(
        "aircraft=[{{id: 0, type: p600, carries_rig: true, position_m: [0, 0, 20]}}, "
        "{{id: 1, type: {}}}]",
        target.type);
    Overrides annotated = kAnnotated;
    annotated.push_back(pair);
    const auto [a0, a1, a2] = target.annotated;
    const auto [d0, d1, d2] = target.detected;
    add(fmt::format("{}, annotated", target.name), annotated, {AbsRel(a0), AbsRel(a1), AbsRel(a2)});
    add(fmt::format("{}, detected", target.name), {pair}, {AbsRel(d0), AbsRel(d1), AbsRel(d2)});
    const char* methods[] = {"baseline", "+ PCM", "+ PCM + DIC"};
    for (std::size_t i = 0; i < std::size(methods); ++i) {
      ReproducedRow row = Row(fmt::format("{}, untuned: {}", target.name, methods[i]), "baseline",
                              {}, {}, AbsRel(target.untuned[i]));
      row.missing = "our detector learned from it: below are aircraft that it did not learn from";
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

ReproducedTable Calibration() {
  return {"calibration",
          "triangulation after calibrations (table I)",
          {Row("Uncalibrated", "baseline", {}, {}, Of(0.478, 5.483),
               "Likely other recordings: the paper's tables II to VIII have 0.494 for the same "
               "triangulation."),
           NotYet("Zhang", {}, Of(0.468, 5.342), "calibration"),
           NotYet("OpenCalib (Yan et al.)", {}, Of(0.469, 5.349), "calibration"),
           NotYet("generic (Schöps et al.)", {}, Of(0.471, 5.421), "calibration")}};
}

ReproducedTable Audits() {
  const auto nominal = [](const char* label, const Overrides& overrides) {
    return On("uavde_12mm_nominal", overrides, Row(label, "baseline", {}, {}, {}));
  };
  const Overrides no_offset = {"rig.misalignment.offset_px=0", "rig.misalignment.yaw_deg=0"};
  return {
      "audits",
      "what makes the baseline fail, and what does not",
      {nominal("nominal", {}), nominal("offset and divergence removed", no_offset),
       nominal("offset removed, divergence left", {"rig.misalignment.offset_px=0"}),
       nominal("no vibration", {"vibration.level=0"}),
       nominal("vibration doubled", {"vibration.level=2"}),
       nominal("only vibration, tenfold",
               {no_offset[0], no_offset[1], "rig.misalignment.pitch_deg=0",
                "rig.misalignment.roll_deg=0", "vibration.level=10"}),
       // 70 px of the 12 mm lens as an angle, and the 0.05 deg of the preset.
       On("uavde_16mm", {"rig.misalignment.offset_px=0", "rig.misalignment.yaw_deg=1.2975"},
          Row("16 mm, the same offset as an angle", "baseline", {}, {}, kTest16,
              "An offset that is an angle grows with the focal length; the paper's error is that "
              "of one in pixels (table VIII's 16 mm), so that its offset is likely none."))}};
}

}  // namespace

std::vector<ReproducedTable> ReproducedTables(Effort effort) {
  const Lessons lessons(effort);
  return {Comparison(lessons), Components(lessons),  Corrections(lessons),
          Threshold(lessons),  HardSamples(lessons), Lenses(lessons),
          Targets(lessons),    Calibration(),        Audits()};
}

}  // namespace windhover
