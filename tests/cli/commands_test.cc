#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/ten_mistakes.h"

namespace windhover {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

const std::string kWindhover = std::string(WINDHOVER_BIN_DIR) + "/windhover";
const std::string kScenarios = std::string(WINDHOVER_SOURCE_DIR) + "/scenarios/";

TEST(Windhover, EveryCommandExplainsItselfWithAnExample) {
  for (const char* command :
       {"run", "bench", "export", "import", "mesh-info", "budget", "check", "keys", "replay",
        "reproduce", "score", "compare", "report", "snapshot", "sweep", "train", "doctor", "spy"}) {
    SCOPED_TRACE(command);
    Program help({kWindhover, command, "--help"});
    EXPECT_EQ(help.Wait(), 0);
    EXPECT_THAT(help.Out(), HasSubstr(std::string("Example: windhover ") + command));
  }
}

TEST(Windhover, WrongUsageIsExitCode2) {
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {},
           {"fly"},
           {"run"},
           {"run", "no/such.yaml"},
           {"run", kScenarios + "ideal_geometric.yaml", "--in-process", "--frames", "shm"},
           {"run", kScenarios + "ideal_geometric.yaml", "--observe", "x-ray"},
           {"run", kScenarios + "ideal_geometric.yaml", "--bus", "canbus"},
           {"keys", "no.such.section"},
           {"bench"},
           {"bench", "render", "--rasteriser", "gpu"},
           {"bench", "render", "--rounds", "0"},
           {"budget", "no/such.yaml"},
           {"budget", kScenarios + "uavde_12mm.yaml", "--distances", "-1"},
           {"export", kScenarios + "presets/uavde_12mm.yaml", "--format", "voc", "--out", "x"},
           {"export", kScenarios + "presets/uavde_12mm.yaml", "--format", "tum", "--out",
            "/dev/null"},
           {"export", kScenarios + "presets/uavde_12mm.yaml", "--format", "tum", "--dense", "--out",
            "x"},
           {"import", "--format", "uavde", "no/such", "--out", "x.csv"},
           {"import", "--format", "uavde", kScenarios, "--out", "x.csv"},
           {"score", kScenarios + "uavde_12mm.yaml", "--split", "test"},
           {"reproduce", "lens", "--out", "x"},
           {"train"},
           {"train", "pcm", "no/such.yaml", "--out", "x.json"},
           {"train", "pcm", kScenarios + "presets/uavde_12mm.yaml", "--out", "x.json", "--width",
            "5"},
           {"compare", kScenarios},
           {"compare", kScenarios, kScenarios},
           {"compare", "--baseline", kScenarios + "uavde_12mm.yaml", kScenarios, "--max-worse",
            "n=1"},
           {"replay", "no/such/run"}}) {
    std::vector<std::string> words = {kWindhover};
    words.insert(words.end(), arguments.begin(), arguments.end());
    SCOPED_TRACE(testing::PrintToString(words));
    Program program(words);
    EXPECT_EQ(program.Wait(), 2);
    EXPECT_THAT(program.Err(), StartsWith("windhover: error: "));
  }
}

TEST(WindhoverRun, RefusesABrokenDetectorBeforeItStarts) {
  const TemporaryFolder folder;
  const std::string models = std::string(WINDHOVER_SOURCE_DIR) + "/models/";
  const std::string card = folder.Write("card.json", TextOf(models + "yolox_small.json"));
  folder.Write("yolox_small.onnx", TextOf(models + "yolox_small.onnx"));
  folder.Write("yolox_refine.onnx", TextOf(models + "yolox_refine.onnx").substr(0, 1000));
  for (const std::string command : {"run", "check"}) {
    SCOPED_TRACE(command);
    std::vector<std::string> words = {kWindhover, command, kScenarios + "uavde_12mm.yaml", "--set",
                                      "estimator.detector_model=" + card};
    const auto out = folder.path() / "run";
    if (command == "run") words.insert(words.end(), {"--out", out});
    Program program(words);
    EXPECT_EQ(program.Wait(), 2);
    EXPECT_THAT(program.Err(), StartsWith("windhover: error: --set:1:26: "));
    EXPECT_THAT(program.Err(), HasSubstr("yolox_refine.onnx: "));
    EXPECT_FALSE(std::filesystem::exists(out));
  }
}

TEST(WindhoverCheck, PrintsEveryMistakeAtItsPlace) {
  const TemporaryFolder folder;
  const auto file = folder.Write("s.yaml", kTenMistakes);
  Program check({kWindhover, "check", file});
  EXPECT_EQ(check.Wait(), 2);
  std::istringstream lines(check.Err());
  int n = 0;
  for (std::string line; std::getline(lines, line); ++n) {
    EXPECT_THAT(line, StartsWith("windhover: error: " + file.string() + ":"));
  }
  EXPECT_EQ(n, 10);
}

TEST(WindhoverCheck, PassesWhatIsRight) {
  Program check({kWindhover, "check", kScenarios + "uavde_12mm.yaml", "--set", "random_seed=4",
                 "--resolved"});
  EXPECT_EQ(check.Wait(), 0) << check.Err();
  EXPECT_THAT(check.Out(), HasSubstr("random_seed: 4\n"));
}

TEST(WindhoverTrain, OneSeedIsOneCardThatScenariosTake) {
  const TemporaryFolder folder;
  const auto train = [&](const std::string& name) {
    const std::string card = folder.path() / name;
    Program program({kWindhover, "train", "pcm", kScenarios + "presets/uavde_12mm.yaml", "--out",
                     card, "--epochs", "2", "--set",
                     "dataset.splits={train: {flights: 1, pairs: 40}, val: {flights: 1, pairs: 9},"
                     " test: {flights: 1, pairs: 9}}"});
    EXPECT_EQ(program.Wait(), 0) << program.Err();
    EXPECT_THAT(program.Out(), HasSubstr("pcm_dic"));
    return TextOf(card);
  };
  const std::string card = train("a.json");
  EXPECT_EQ(train("b.json"), card);
  EXPECT_THAT(TextOf(folder.path() / "a.svg"), StartsWith("<svg"));
  for (const std::string network : {"offset0", "gate0", "offset1"}) {
    const std::string file = folder.path() / ("a." + network + ".onnx");
    Program sum({"sha256sum", file});
    ASSERT_EQ(sum.Wait(), 0) << sum.Err();
    EXPECT_THAT(card, HasSubstr("\"" + network + ".onnx\": \"" + sum.Out().substr(0, 64) + "\""));
  }

  const auto check = [&](const std::string& text) {
    folder.Write("card.json", text);
    const auto file = folder.Write("s.yaml", "extends: " + kScenarios +
                                                 "ideal_geometric.yaml\n"
                                                 "estimator:\n"
                                                 "  methods: [baseline, pcm, pcm_dic, joint_mlp]\n"
                                                 "  correction: card.json\n");
    auto program = std::make_unique<Program>(std::vector<std::string>{kWindhover, "check", file});
    const int status = program->Wait();
    return std::to_string(status) + " " + program->Err();
  };
  EXPECT_THAT(check(card), StartsWith("0 "));
  const std::string broken = check(card.substr(0, card.size() / 2));
  EXPECT_THAT(broken, StartsWith("2 "));
  EXPECT_THAT(broken, HasSubstr("s.yaml:4:"));
  EXPECT_THAT(broken, HasSubstr("card.json:"));
}

TEST(WindhoverTrain, SaysWhatIsWrongWithTuples) {
  const TemporaryFolder folder;
  const auto tuples = folder.Write("t.csv", "0,0,0,700,300,0,30,600,300,60,30,12,12\n");
  Program program({kWindhover, "train", "pcm", kScenarios + "presets/uavde_12mm.yaml", "--out",
                   folder.path() / "a.json", "--tuples", tuples});
  EXPECT_EQ(program.Wait(), 2);
  EXPECT_THAT(program.Err(), HasSubstr("t.csv:1: sizes of boxes must be above 0"));
}

TEST(WindhoverKeys, ListsKeysOfASection) {
  Program keys({kWindhover, "keys", "rig.misalignment"});
  EXPECT_EQ(keys.Wait(), 0);
  EXPECT_THAT(keys.Out(), HasSubstr("rig.misalignment.offset_px"));
  EXPECT_THAT(keys.Out(), HasSubstr("-1000 … 1000; default 0"));
  EXPECT_THAT(keys.Out(), testing::Not(HasSubstr("duration_s")));
}

TEST(WindhoverRun, AGeometricRunPassesAndReplays) {
  const TemporaryFolder folder;
  Program run({kWindhover, "run", kScenarios + "ideal_geometric.yaml", "--out", folder.path()});
  EXPECT_EQ(run.Wait(), 0) << run.Err() << run.Out();
  EXPECT_THAT(run.Out(), HasSubstr("verdict: pass"));
  Program replay({kWindhover, "replay", folder.path()});
  EXPECT_EQ(replay.Wait(), 0) << replay.Err();
  EXPECT_THAT(replay.Out(), HasSubstr("all bits as recorded"));
  // Somebody else's estimator: a process on a hub of its own. Here ours, and one that gives up.
  const std::string estimator = std::string(WINDHOVER_BIN_DIR) + "/windhover-estimator";
  Program again({kWindhover, "replay", folder.path(), "--estimator", estimator});
  EXPECT_EQ(again.Wait(), 0) << again.Err();
  EXPECT_THAT(again.Out(), HasSubstr("all bits as recorded"));
  Program gone({kWindhover, "replay", folder.path(), "--estimator", "false"});
  EXPECT_EQ(gone.Wait(), 3) << gone.Out();
  EXPECT_THAT(gone.Err(), HasSubstr("estimator-0: ended with exit status 1; see "));
  Program other({kWindhover, "replay", folder.path(), "--correction", "size"});
  EXPECT_EQ(other.Wait(), 0) << other.Err();
  EXPECT_THAT(other.Out(), HasSubstr("messages differ from the recording"));
  Program failing({kWindhover, "run", kScenarios + "ideal_geometric.yaml", "--out", folder.path(),
                   "--set", "expect=[{metric: methods.baseline.abs_rel, max: 1e-9}]"});
  EXPECT_EQ(failing.Wait(), 1) << failing.Err();
  EXPECT_THAT(failing.Out(), HasSubstr("FAIL"));
}

// What the figures mean, not how large they are: a test is no stopwatch.
// Folders of two seeds each, without and with noise of boxes.
TEST(WindhoverCompare, PutsRunsOfTheSameSeedsSideBySide) {
  const TemporaryFolder folder;
  const auto out = [&](const std::string& name) { return (folder.path() / name).string(); };
  for (const char* seed : {"1", "2"}) {
    for (const char* noise : {"0", "0.05"}) {
      Program run({kWindhover, "run", kScenarios + "ideal_geometric.yaml", "--seed", seed, "--out",
                   out(noise) + "/" + seed, "--set",
                   std::string("geometric.sigma_relative=") + noise, "--set", "duration_s=3",
                   "--no-report"});
      EXPECT_NE(run.Wait(), 3) << run.Err();
    }
  }
  Program pairs({kWindhover, "compare", out("0"), out("0.05"), "--json"});
  ASSERT_EQ(pairs.Wait(), 0) << pairs.Err();
  const auto both = nlohmann::json::parse(pairs.Out());
  EXPECT_EQ(both["pairs"], 2);
  EXPECT_EQ(both["different_keys"][0], "geometric.sigma_relative: 0 → 0.05");
  Program single({kWindhover, "compare", out("0/1"), out("0.05/1")});
  ASSERT_EQ(single.Wait(), 0) << single.Err();
  EXPECT_THAT(single.Out(), HasSubstr("on the frames that both have"));
  EXPECT_THAT(single.Out(), HasSubstr("methods.baseline.abs_rel"));

  const auto held = [&](const std::string& run, const std::string& loss) {
    Program program({kWindhover, "compare", "--baseline", out("0/1") + "/score.json", out(run),
                     "--max-worse", "methods.baseline.abs_rel=" + loss});
    return program.Wait();
  };
  EXPECT_EQ(held("0/1", "0"), 0);
  EXPECT_EQ(held("0.05/1", "0"), 1);
  EXPECT_EQ(held("0.05/1", "9"), 0);
  EXPECT_EQ(held("0.05/1", "-1"), 2);
}

TEST(WindhoverBench, FiguresOfARoundAgree) {
  Program bench({kWindhover, "bench", "render", "--rounds", "1", "--json", "--isa", "avx2"});
  ASSERT_EQ(bench.Wait(), 0) << bench.Err();
  const auto json = nlohmann::json::parse(bench.Out());
  EXPECT_EQ(json["setting"]["image_px"], nlohmann::json({1280, 720}));
  EXPECT_NE(json["setting"]["instructions"], "avx512");
  const auto number = [&](const char* row, const char* key) {
    return json[row][key].get<double>();
  };
  double cpu_ms = 0;
  for (const auto& pose : json["full"]["by_pose"]) cpu_ms += pose["cpu_ms"].get<double>() / 16;
  EXPECT_NEAR(cpu_ms, number("full", "cpu_ms"), 1e-9 * cpu_ms);
  for (const char* row : {"background", "full", "blurred"}) {
    EXPECT_NEAR(number(row, "pairs_per_s") * number(row, "wall_ms"), 1000, 1e-6) << row;
    EXPECT_GT(number(row, "cpu_ms"), 0);
    EXPECT_GT(number(row, "peak_memory_mib"), 2 * 1280 * 720 * 3 / 1048576.0);  // Its own images.
  }
  EXPECT_NEAR(number("blurred", "ratio"), number("blurred", "cpu_ms") / number("full", "cpu_ms"),
              1e-9);
  EXPECT_EQ(json["blurred"]["time_samples"], 9);
  EXPECT_NEAR(number("two_processes", "ratio"),
              number("two_processes", "pairs_per_s") / number("full", "pairs_per_s"), 1e-9);
  EXPECT_GT(number("start_up", "wall_s"), 0);
}

// A disk of 300 KB, which grows to 100 MB when it is full.
TEST(WindhoverExport, AFullDiskIsSaidAndTheSameCommandGoesOn) {
  const TemporaryFolder folder;
  const std::string disk = folder.path().string();
  const std::string mount = "mount -t tmpfs -o size=300k none " + disk;
  if (Program({"unshare", "-m", "sh", "-c", mount}).Wait() != 0) {
    GTEST_SKIP() << "cannot mount a disk of its own";
  }
  const auto command = [&](const std::string& out, const std::string& wanted) {
    return fmt::format(
        "rc=0; {} export {}presets/uavde_12mm.yaml --format yolo --frames 12 "
        "--set 'rig.image=[320, 180]' --set rig.pixel_um=14.93 --out {} || rc=$?; test $rc = {}",
        kWindhover, kScenarios, out, wanted);
  };
  const std::string script = "set -e\n" + command(disk + ".whole", "0") + "\n" + mount + "\n" +
                             command(disk + "/set", "3") + "\ntest ! -e " + disk +
                             "/set/dataset.json\n" + "mount -o remount,size=100m " + disk + "\n" +
                             command(disk + "/set", "0") + "\ncmp " + disk + "/set/SHA256SUMS " +
                             disk + ".whole/SHA256SUMS\n";
  Program shell({"unshare", "-m", "sh", "-c", script});
  EXPECT_EQ(shell.Wait(), 0) << script << shell.Err();
  EXPECT_THAT(shell.Err(), HasSubstr("No space left on device"));
  std::filesystem::remove_all(disk + ".whole");
}

}  // namespace
}  // namespace windhover
