// Sweeps that train what methods learn at each point: `retrain: true`.

#include <algorithm>
#include <chrono>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/random/random_stream.h"
#include "estimator/correction_card.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const std::string kWindhover = std::string(WINDHOVER_BIN_DIR) + "/windhover";
const std::string kBase = WINDHOVER_SOURCE_DIR "/scenarios/ideal_geometric.yaml";

/// A data set of 100 pairs: a training takes 0.1 s.
const std::string kHead = "description: d\nbase: " + kBase + "\n";
const std::string kSet =
    "  duration_s: 1\n"
    "  expect: []\n"
    "  geometric: {sigma_px: 1}\n"
    "  rig: {misalignment: {offset_px: 20}}\n"
    "  dataset: {splits: {train: {flights: 3, pairs: 60}, val: {flights: 1, pairs: 20}, test: "
    "{flights: 1, pairs: 20}}}\n";
const std::string kTail =
    "seeds: {count: 3}\n"
    "metrics: [methods.baseline.abs_rel, methods.pcm.abs_rel, methods.joint_mlp.abs_rel]\n";
const std::string kMethods = "  estimator: {methods: [baseline, pcm, joint_mlp]}\n";
const std::string kFactors =
    "factors:\n"
    "  - {key: rig.focal_mm, values: [8, 12, 16]}\n"
    "  - {key: nav.position_sigma_m, values: [0, 1]}\n";  // Which no training sees.
const std::string kSweep = kHead + "set:\n" + kSet + kMethods + kFactors + kTail;

class SweepRetrain : public testing::Test {
 protected:
  SweepRetrain() { file_ = folder_.Write("sweep.yaml", kSweep + "retrain: true\n"); }

  std::string Out(const std::string& name) const { return folder_.path() / name; }

  int Run(std::vector<std::string> words) {
    words.insert(words.begin(), kWindhover);
    Program program(words);
    const int status = program.Wait();
    said_ = program.Out() + program.Err();
    return status;
  }

  /// The table and the cards of a sweep.
  std::vector<std::string> Results(const std::string& name) const {
    std::vector<std::string> results = {TextOf(folder_.path() / name / "table.csv")};
    for (const int point : {0, 2, 4}) {
      results.push_back(
          TextOf(folder_.path() / name / "cards" / ("point" + std::to_string(point) + ".json")));
    }
    return results;
  }

  void Refuses(const std::string& text, const std::string& message) {
    const std::string file = folder_.Write("wrong.yaml", text);
    EXPECT_EQ(Run({"sweep", file, "--out", Out("o")}), 2) << said_;
    EXPECT_THAT(said_, HasSubstr("wrong.yaml:" + message));
    EXPECT_FALSE(fs::exists(Out("o")));
  }

  TemporaryFolder folder_;
  std::string file_, said_;
};

// By hand: train for the rig of the only point, then sweep with that card.
TEST_F(SweepRetrain, IsTrainPcmAndASweepWithItsCard) {
  const std::string factor = "factors: [{key: rig.focal_mm, values: [12]}]\n" + kTail;
  const std::string scenario =
      folder_.Write("scenario.yaml", "extends: " + kBase + "\n" +
                                         "duration_s: 1\nexpect: []\ngeometric: {sigma_px: 1}\n"
                                         "rig: {focal_mm: 12, misalignment: {offset_px: 20}}\n" +
                                         kSet.substr(kSet.find("  dataset") + 2));
  ASSERT_EQ(Run({"train", "pcm", scenario, "--out", Out("card.json")}), 0) << said_;
  const std::string with_card =
      "  estimator: {methods: [baseline, pcm, joint_mlp], correction: card.json}\n";
  const std::string by_hand =
      folder_.Write("by_hand.yaml", kHead + "set:\n" + kSet + with_card + factor);
  ASSERT_EQ(Run({"sweep", by_hand, "--out", Out("by_hand")}), 0) << said_;
  const std::string retrain =
      folder_.Write("retrain.yaml", kHead + "retrain: true\nset:\n" + kSet + kMethods + factor);
  ASSERT_EQ(Run({"sweep", retrain, "--out", Out("retrain")}), 0) << said_;

  EXPECT_EQ(TextOf(Out("retrain/table.csv")), TextOf(Out("by_hand/table.csv")));
  CorrectionCard card = ReadCorrectionCard(fs::path(Out("card.json")));
  CorrectionCard trained = ReadCorrectionCard(fs::path(Out("retrain/cards/point0.json")));
  EXPECT_EQ(trained.provenance.at("point"), "rig.focal_mm = 12");
  EXPECT_EQ(trained.provenance.at("scores"), card.provenance.at("scores"));
  card.provenance = trained.provenance = {};
  EXPECT_EQ(CorrectionCardText(trained), CorrectionCardText(card));
}

TEST_F(SweepRetrain, WorkersAndShardsMakeOneTable) {
  ASSERT_EQ(Run({"sweep", file_, "--out", Out("one"), "--jobs", "1"}), 0) << said_;
  ASSERT_EQ(Run({"sweep", file_, "--out", Out("two"), "--jobs", "2"}), 0) << said_;
  EXPECT_EQ(Results("two"), Results("one"));
  std::vector<std::string> cards;
  for (const auto& entry : fs::directory_iterator(Out("one/cards"))) {
    cards.push_back(entry.path().filename());
  }
  EXPECT_THAT(cards, testing::UnorderedElementsAre("point0.json", "point2.json", "point4.json"))
      << "points that training sees alike share a card";
  EXPECT_NE(Results("one")[1], Results("one")[2]);
  for (const std::string i : {"0", "1"}) {
    ASSERT_EQ(Run({"sweep", file_, "--out", Out(i), "--shard", i + "/2"}), 0) << said_;
  }
  ASSERT_EQ(Run({"sweep", "merge", Out("0"), Out("1"), "--out", Out("merged")}), 0) << said_;
  EXPECT_EQ(Results("merged").front(), Results("one").front());
  // Shard 1 has points 1, 3, 5; its cards have the numbers of the first points alike.
  EXPECT_EQ(TextOf(Out("1/cards/point4.json")), Results("one")[3]);
}

// Five times, while it trains or flies.
TEST_F(SweepRetrain, KilledAndResumedItMakesTheSameTable) {
  ASSERT_EQ(Run({"sweep", file_, "--out", Out("undisturbed"), "--jobs", "2"}), 0) << said_;
  RandomStream random(3, "kill");
  int n_before_the_last_card = 0;
  for (int kill = 0; kill < 5; ++kill) {
    Program sweep({kWindhover, "sweep", file_, "--out", Out("killed"), "--jobs", "2", "--resume"});
    std::this_thread::sleep_for(
        std::chrono::milliseconds(static_cast<int>(random.Uniform(20, 150))));
    sweep.Signal(SIGKILL);
    sweep.Wait();
    n_before_the_last_card += fs::exists(Out("killed/cards/point4.json")) ? 0 : 1;
  }
  EXPECT_GE(n_before_the_last_card, 1) << "a kill must meet a sweep that trains";
  ASSERT_EQ(Run({"sweep", file_, "--out", Out("killed"), "--jobs", "2", "--resume"}), 0) << said_;
  EXPECT_EQ(Results("killed"), Results("undisturbed"));
}

// A target that is never detected teaches nothing.
TEST_F(SweepRetrain, WhereTrainingFailsRunsAreInvalid) {
  const std::string file = folder_.Write(
      "fails.yaml", kHead + "retrain: true\nset:\n" + kSet + kMethods +
                        "factors: [{key: geometric.miss_rate, values: [0, 1]}]\n" + kTail);
  EXPECT_EQ(Run({"sweep", file, "--out", Out("o")}), 3);
  EXPECT_THAT(said_, HasSubstr("windhover: error: point 1, seed 3: retrain: training cannot start: "
                               "a split has no samples"));
  const std::string table = TextOf(Out("o/table.csv"));
  EXPECT_THAT(table, HasSubstr("\n0,3,0,pass,0."));
  EXPECT_THAT(table, HasSubstr("\n1,3,1,invalid,"));
}

TEST_F(SweepRetrain, SaysWhatCannotBeTrained) {
  const std::string head = kHead + "retrain: true\n";
  Refuses(head + "set: {estimator: {methods: [baseline, size]}}\n",
          "3:10: retrain: must be false where no method learns (found true with "
          "estimator.methods [baseline, size])");
  Refuses(head +
              "set: {estimator: {methods: [baseline, fused]}}\n"
              "factors: [{key: dataset.splits.train.flights, values: [12, 2]}]\n",
          "3:10: retrain: must be false where fusion or fused is to learn from less than 3 flights "
          "(found true with dataset.splits.train.flights 2, at point 1)");
  Refuses(head + "set:\n" + kMethods + "factors: [{key: estimator.correction, values: [" + kBase +
              "]}]\n",
          "6:17: estimator.correction: must be left to training where retrain is true");
  Refuses(kHead + "retrain: sometimes\n", "3:10: retrain: must be true or false");
  EXPECT_EQ(
      Run({"sweep", folder_.Write("no_card.yaml", kHead + "set:\n" + kMethods), "--out", Out("o")}),
      2);
  EXPECT_THAT(said_, HasSubstr("estimator.correction: must be the file of a trained correction"));
}

TEST_F(SweepRetrain, ItResumesNoSweepWithoutTraining) {
  const std::string text =
      kHead + "set:\n" + kSet + "  estimator: {methods: [baseline, fusion]}\n" + kFactors;
  const std::string with = folder_.Write("with.yaml", text + "retrain: true\n");
  EXPECT_EQ(Run({"sweep", with, "--out", Out("o"), "--shard", "0/6"}), 3);
  EXPECT_THAT(said_, HasSubstr("seed 1: retrain: too few detections to fit the priors of fusion"));
  const std::string without = folder_.Write("without.yaml", text);
  EXPECT_EQ(Run({"sweep", without, "--out", Out("o"), "--shard", "0/6", "--resume"}), 2);
  EXPECT_THAT(said_, HasSubstr("(found another 'retrain' in "));
}

}  // namespace
}  // namespace windhover
