#include "scenarios/scenario.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"
#include "tests/support/ten_mistakes.h"

namespace windhover {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kValid = R"(description: two aircraft
aircraft:
  - {id: 5, controller: hold, position_m: [10, 0, 0]}
  - {id: 2, type: p600, carries_rig: true}
)";

std::vector<std::string> ErrorsOf(const std::string& yaml,
                                  const std::vector<std::string>& overrides = {}) {
  const TemporaryFolder folder;
  const auto file = folder.Write("s.yaml", yaml);
  try {
    LoadScenario(file, overrides);
  } catch (const ConfigError& error) {
    std::vector<std::string> lines;
    std::istringstream in(error.what());
    for (std::string line; std::getline(in, line);) {
      const std::string name = folder.path().string() + "/";
      for (auto at = line.find(name); at != std::string::npos; at = line.find(name)) {
        line.erase(at, name.size());
      }
      lines.push_back(line);
    }
    return lines;
  }
  return {};
}

TEST(Scenario, AircraftAreSortedById) {
  const TemporaryFolder folder;
  const Scenario scenario = LoadScenario(folder.Write("s.yaml", kValid));
  ASSERT_EQ(scenario.aircraft.size(), 2U);
  EXPECT_EQ(scenario.aircraft[0].self.id, 2);
  EXPECT_EQ(scenario.aircraft[1].self.id, 5);
}

TEST(Scenario, AircraftConfigHoldsOnlyWhatAnAircraftMayKnow) {
  const TemporaryFolder folder;
  const auto file = folder.Write("s.yaml", kValid + "rig: {misalignment: {offset_px: 70}}\n");
  const AircraftConfig config = LoadAircraftConfig(file);
  ASSERT_EQ(config.aircraft.size(), 2U);
  EXPECT_EQ(config.aircraft[0].id, 2);
  EXPECT_TRUE(config.aircraft[0].carries_rig);
  EXPECT_EQ(config.rig.focal_mm, 12);
}

TEST(Scenario, ResolvedYamlReadsBackUnchanged) {
  const TemporaryFolder folder;
  folder.Write("presets/path.tum.txt", "0 0 0 0 0 0 0 1\n");
  folder.Write("presets/p.yaml",
               "aircraft: [{id: 1, controller: trajectory, carries_rig: true, "
               "trajectory: {file: path.tum.txt, scale: 0.1}}]\n");
  const auto file = folder.Write(
      "s.yaml",
      "extends: presets/p.yaml\ndescription: \"a: 'b' ü\"\nexpect: [{metric: x, max: 0.3}]\n");
  const Scenario scenario = LoadScenario(file, {"random_seed=77", "rig.distortion.k1=-0.1"});
  const std::string text = ResolvedYaml(scenario, PathStyle::kAbsolute);
  EXPECT_THAT(text, HasSubstr((folder.path() / "presets/path.tum.txt").string()));
  const Scenario again = LoadScenario(folder.Write("elsewhere/resolved.yaml", text));
  EXPECT_EQ(ResolvedYaml(again, PathStyle::kAbsolute), text);
  EXPECT_EQ(again.random_seed, 77U);
  EXPECT_EQ(again.rig.calibrated.distortion.k1, -0.1);
  // The copy in a log names its files as the author did and needs none of them.
  const std::string as_given = ResolvedYaml(scenario, PathStyle::kAsGiven);
  EXPECT_EQ(ResolvedYaml(ScenarioFromYaml(as_given, "log"), PathStyle::kAsGiven), as_given);
}

TEST(Scenario, LogHeaderIsTheSameWhereverAndHoweverItRuns) {
  const TemporaryFolder here, there;
  const std::string yaml = kValid + "vibration: {source: psd, file: data/v.csv}\n";
  here.Write("data/v.csv", "20,0.04\n90,0.04\n");
  there.Write("data/v.csv", "20,0.04\n90,0.04\n");
  const Scenario a = LoadScenario(here.Write("s.yaml", yaml), {"execution.render_processes=3"});
  const Scenario b = LoadScenario(there.Write("t.yaml", yaml));
  // A process of a run reads the copy with absolute names.
  const Scenario c =
      LoadScenario(there.Write("run/resolved.yaml", ResolvedYaml(a, PathStyle::kAbsolute)));
  EXPECT_EQ(LogHeaderYaml(a), LogHeaderYaml(b));
  EXPECT_EQ(LogHeaderYaml(a), LogHeaderYaml(c));
  EXPECT_THAT(LogHeaderYaml(a), HasSubstr("file: v.csv"));
}

TEST(Scenario, ReportsTenMistakesAtOnce) {
  EXPECT_THAT(ErrorsOf(kTenMistakes),
              ElementsAre(HasSubstr("s.yaml:1:14: description: must be text, not empty"),
                          HasSubstr("s.yaml:2:1: frame_rat_hz: must be a known key; did you mean "
                                    "'frame_rate_hz'?"),
                          HasSubstr("s.yaml:3:13: duration_s: must be a number between"),
                          HasSubstr("s.yaml:4:10: observe: must be one of truth, geometric, "
                                    "annotated or image (found 'pictures')"),
                          HasSubstr("s.yaml:5:25: exposure.duration_ms: must be at most 100, the "
                                    "time of a frame (found '200')"),
                          HasSubstr("s.yaml:6:43: estimator.in_loop: must be one of "
                                    "estimator.methods, [baseline] (found 'size')"),
                          HasSubstr("s.yaml:7:12: vibration.file: must be the name of a file for "
                                    "source recorded (found nothing)"),
                          HasSubstr("s.yaml:8:34: environment.file: must be a file that can be "
                                    "read (found 'none.jpg')"),
                          HasSubstr("s.yaml:10:5: aircraft.0.trajectory.file: must be the name of "
                                    "a file for controller trajectory (found nothing)"),
                          HasSubstr("s.yaml:11:10: aircraft.1.id: must be unlike that of every "
                                    "other aircraft (found '1' again)")));
}

TEST(Scenario, ChecksRulesOfTheSwarm) {
  const std::string head = "description: x\naircraft:\n";
  EXPECT_THAT(ErrorsOf(head + "  - {id: 0}\n  - {id: 1, position_m: [0.2, 0, 0]}\n"),
              ElementsAre(HasSubstr("aircraft.1.position_m: must be at least 0.6 m from aircraft 0 "
                                    "(found 0.2 m)")));
  EXPECT_THAT(
      ErrorsOf(head + "  - {controller: swarm, carries_rig: true}\n"
                      "  - {id: 1, position_m: [2, 0, 0]}\nswarm: {scatter_m: 1}\n"),
      ElementsAre(HasSubstr("aircraft.1.position_m: must be at least 0.6 m from aircraft 0, "
                            "and 1.73 m for swarm.scatter_m (found 2 m)")));
  EXPECT_THAT(ErrorsOf(head + "  - {goal: {position_m: [1, 0, 0], speed_mps: 1}}\n"),
              ElementsAre(HasSubstr("s.yaml:3:12: aircraft.0.goal: must be left out unless its "
                                    "controller is swarm")));
  EXPECT_THAT(
      ErrorsOf(head +
               "  - {controller: swarm, carries_rig: true, goal: {position_m: [1, 0, 0]}}\n"),
      ElementsAre(HasSubstr("aircraft.0.goal.speed_mps: must be above 0")));
  EXPECT_THAT(ErrorsOf(kValid + "swarm: {olfati_saber: {a: 6}, guard: {sigmas: 11}}\n"),
              ElementsAre(HasSubstr("s.yaml:5:23: swarm.olfati_saber.b: must be at least a, 6"),
                          HasSubstr("s.yaml:5:47: swarm.guard.sigmas: must be a number between 0 "
                                    "and 10 (found '11')")));
}

// Half a metre behind the middle it sees that; half a metre above it only when it looks down.
TEST(Scenario, ARigMustNotLookIntoItsOwnAircraft) {
  const auto errors = [](const char* mount) {
    return ErrorsOf(kValid + "rig: {mount: " + mount + "}\n");
  };
  const auto is_refused =
      ElementsAre(HasSubstr("rig.mount.position_m: must be such that no camera looks into its own "
                            "aircraft (found '[-0.5, 0, 0]')"));
  EXPECT_THAT(errors("{position_m: [-0.5, 0, 0]}"), is_refused);
  EXPECT_THAT(errors("{position_m: [0, 0, 0.5], pitch_deg: -90}"), testing::SizeIs(1));
  EXPECT_THAT(errors("{position_m: [0, 0, 0.5]}"), testing::IsEmpty());
  EXPECT_THAT(errors("{position_m: [0.15, 0, 0], pitch_deg: -90}"), testing::IsEmpty());
  EXPECT_THAT(errors("{position_m: [0, 0, 0], pitch_deg: 20}"), testing::IsEmpty());
}

TEST(Scenario, ChecksEachRule) {
  const std::string head = "description: x\naircraft:\n";
  EXPECT_THAT(ErrorsOf("description: x\n"),
              ElementsAre(HasSubstr("aircraft: must be a list of at least one (found none)")));
  EXPECT_THAT(ErrorsOf(head + "  - {controller: follow}\n  - {id: 1, position_m: [9, 0, 0]}\n"),
              ElementsAre(HasSubstr("aircraft.0.carries_rig: must be true for controller follow")));
  EXPECT_THAT(ErrorsOf(head + "  - {controller: follow, carries_rig: true}\n"),
              ElementsAre(HasSubstr("follow only where there is another aircraft")));
  EXPECT_THAT(ErrorsOf(head + "  - {controller: waypoints}\n"),
              ElementsAre(HasSubstr("aircraft.0.waypoints: must be a list of at least one")));
  EXPECT_THAT(ErrorsOf(head + "  - {controller: waypoints, waypoints: [{time_s: 1}, {time_s: 1}]}"),
              ElementsAre(HasSubstr("aircraft.0.waypoints.1.time_s: must be later than the one "
                                    "before, 1 (found '1')")));
  EXPECT_THAT(ErrorsOf(head + "  - {type: mesh}\n"),
              ElementsAre(HasSubstr("aircraft.0.mesh.file: must be the name of a file")));
  EXPECT_THAT(ErrorsOf(kValid + "wind: {turbulence: light}\n"),
              ElementsAre(HasSubstr("s.yaml:5:7: wind: must be calm where no aircraft has dynamics "
                                    "rigid_body")));
  EXPECT_THAT(ErrorsOf(kValid + "wind: {mean_mps: [1, 0]}\n"),
              ElementsAre(HasSubstr("s.yaml:5:18: wind.mean_mps: must be")));
  EXPECT_THAT(ErrorsOf(kValid + "wind: {turbulence: light}\n", {"aircraft.0.dynamics=rigid_body"}),
              testing::IsEmpty());
  EXPECT_THAT(ErrorsOf(kValid + "uwb: {rate_hz: 0.5}\n"),
              ElementsAre(HasSubstr("s.yaml:5:16: uwb.rate_hz: must be 0 or at least 1")));
  EXPECT_THAT(ErrorsOf(kValid + "rig: {distortion: {model: kannala_brandt, k4: 0.1, p1: 0.01}}\n"),
              ElementsAre(HasSubstr("rig.distortion.p1: must be 0: this model has no such term "
                                    "(found '0.01')")));
  EXPECT_THAT(ErrorsOf(kValid + "sensor: {bayer: rggb, jpeg_quality: 90}\n"),
              ElementsAre(HasSubstr("sensor.jpeg_quality: must be 0 where frames are raw under "
                                    "colour filters (found '90')")));
  EXPECT_THAT(ErrorsOf(kValid + "sensor: {model: emva1288, emva: {bits: 8, offset_dn: 200}}\n"),
              ElementsAre(HasSubstr("sensor.emva.offset_dn: must be below half the largest grey "
                                    "value, 255 (found '200')")));
  EXPECT_THAT(ErrorsOf(kValid + "exposure: {auto: {min_ms: 20}}\n"),
              ElementsAre(HasSubstr("exposure.auto.min_ms: must be at most max_ms, 10")));
  EXPECT_THAT(ErrorsOf(kValid + "optics: {focus_m: 0.01, left: {focus_m: -3}}\n"),
              ElementsAre(HasSubstr("optics.focus_m: must be 0 (infinity) or at least two focal "
                                    "lengths, 0.024 m (found '0.01')"),
                          HasSubstr("optics.left.focus_m: must be 0 (infinity)")));
  EXPECT_THAT(ErrorsOf(kValid + "expect: [{metric: a}]\n"),
              ElementsAre(HasSubstr("expect.0: must be bounded by max, min, upper95 or lower95")));
  EXPECT_THAT(ErrorsOf(kValid + "expect: [{metric: a, min: 2, max: 1}]\n"),
              ElementsAre(HasSubstr("expect.0.min: must be at most max, 1 (found '2')")));
  EXPECT_THAT(ErrorsOf(kValid + "score: {collision_m: 2}\n"),
              ElementsAre(HasSubstr("score.collision_m: must be at most near_miss_m, 1.5")));
}

// What a shutter or a sensor that was not chosen would have needed.
TEST(Scenario, KeysThatNothingReadsMustBeLeftOut) {
  EXPECT_THAT(ErrorsOf(kValid + "sensor: {emva: {prnu: 0.02}}\nexposure: {row_time_us: 20}\n"),
              ElementsAre(HasSubstr("s.yaml:5:23: sensor.emva.prnu: must be left out (or 0.01) "
                                    "unless sensor.model is emva1288 (found '0.02')"),
                          HasSubstr("s.yaml:6:25: exposure.row_time_us: must be left out (or 44) "
                                    "unless exposure.shutter is rolling (found '20')")));
  EXPECT_THAT(ErrorsOf(kValid + "environment: {type: photo, file: s.yaml, cloud_cover: 1}\n"),
              Contains(HasSubstr("environment.cloud_cover: must be left out (or 0.5) unless "
                                 "environment.type is a drawn scene (found '1')")));
  EXPECT_THAT(ErrorsOf(kValid + "sensor: {model: emva1288, emva: {prnu: 0.02}}\nexposure: "
                                "{shutter: rolling, row_time_us: 20}\n"),
              testing::IsEmpty());
  // As resolved.yaml has them.
  EXPECT_THAT(ErrorsOf(kValid + "sensor: {emva: {prnu: 0.01}}\nexposure: {row_time_us: 44}\n"),
              testing::IsEmpty());
}

TEST(Scenario, ReportsKeysThatCannotBeDrawn) {
  EXPECT_THAT(
      ErrorsOf(kValid + R"(randomize:
  - {key: vibration.levl, min: 0, max: 3}
  - {key: vibration.level, min: -1, max: 3}
  - {key: flex.section, one_of: [al_2020, oak]}
  - {key: exposure.skew_ms, min: 3, max: 1}
  - {key: exposure.jitter_ms, min: 3}
  - {key: uwb.sigma_m, min: 0, max: 1, one_of: [2]}
  - {key: aircraft.0.yaw_deg, min: 0, max: 1}
  - {key: random_seed, min: 0, max: 1}
  - {key: sensor.jpeg_quality, min: 0, max: 10}
  - {key: vibration.level, min: 0, max: 1}
  - {min: 0}
)"),
      ElementsAre(HasSubstr("s.yaml:6:11: vibration.levl: must be a known key; did you mean"),
                  HasSubstr("s.yaml:7:33: vibration.level: must be a number between 0 and"),
                  HasSubstr("s.yaml:8:43: flex.section: must be one of cf_tube_16_14, "),
                  HasSubstr("s.yaml:9:34: randomize.3.min: must be at most max, 1 (found '3')"),
                  HasSubstr("s.yaml:10:5: randomize.4: must be given min and max, or one_of "
                            "(found 'exposure.jitter_ms')"),
                  HasSubstr("s.yaml:11:5: randomize.5: must be given min and max, or one_of"),
                  HasSubstr("s.yaml:12:11: aircraft: must be a list (found a map)"),
                  HasSubstr("s.yaml:13:11: randomize.7.key: must be neither random_seed nor a"),
                  HasSubstr("s.yaml:14:11: sensor.jpeg_quality: must be a whole number"),
                  HasSubstr("s.yaml:15:11: randomize.9.key: must be unlike every other key"),
                  HasSubstr("s.yaml:16:5: randomize.10.key: must be text, not empty")));
}

// 0.3 is a share of [0, 3); another key in the list changes nothing, another seed all.
TEST(Scenario, DrawsWhatItRandomizes) {
  const TemporaryFolder folder;
  const auto file = folder.Write("s.yaml", kValid + R"(randomize:
  - {key: vibration.level, min: 0, max: 3}
  - {key: flex.section, one_of: [al_2020, cf_tube_16_14]}
)");
  const Scenario scenario = LoadScenario(file);
  EXPECT_TRUE(scenario.randomize.empty());
  EXPECT_EQ(ResolvedYaml(LoadScenario(file), PathStyle::kAsGiven),
            ResolvedYaml(scenario, PathStyle::kAsGiven));
  const Scenario again =
      LoadScenario(folder.Write("resolved.yaml", ResolvedYaml(scenario, PathStyle::kAsGiven)));
  EXPECT_EQ(again.vibration.level, scenario.vibration.level);
  const Scenario alone = LoadScenario(file, {"randomize=[{key: vibration.level, min: 0, max: 3}]"});
  EXPECT_EQ(alone.vibration.level, scenario.vibration.level);
  const Scenario held = LoadScenario(file, {"vibration.level=0.25"});
  EXPECT_EQ(held.vibration.level, 0.25);
  EXPECT_EQ(held.flex.section, scenario.flex.section);
  double sum = 0, largest = 0;
  int n_aluminium = 0;
  constexpr int kSeeds = 200;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const Scenario one = LoadScenario(file, {"random_seed=" + std::to_string(seed)});
    sum += one.vibration.level;
    largest = std::max(largest, one.vibration.level);
    n_aluminium += one.flex.section == BarSectionType::kAl2020;
  }
  // Four standard errors: 3 / √12 / √200 and √(200) / 2.
  EXPECT_NEAR(sum / kSeeds, 1.5, 0.25);
  EXPECT_NEAR(n_aluminium, kSeeds / 2, 29);
  EXPECT_GT(largest, 2.8);
  EXPECT_LE(largest, 3);
  const Scenario undrawn = LoadUndrawnScenario(file);
  EXPECT_EQ(undrawn.vibration.level, 1);
  const std::string text = ResolvedYaml(undrawn, PathStyle::kAsGiven);
  EXPECT_EQ(ResolvedYaml(ScenarioFromYaml(text, "base"), PathStyle::kAsGiven), text);
}

TEST(Scenario, AWrongValueIsReportedOnceNotTwice) {
  EXPECT_THAT(ErrorsOf(kValid + "estimator: {methods: [basline], in_loop: offset1}\n"),
              ElementsAre(HasSubstr("estimator.methods: must be a list of at least one of")));
  EXPECT_THAT(ErrorsOf(kValid, {"aircraft.0.id=x", "aircraft.1.id=0"}),
              ElementsAre(HasSubstr("--set:1:15: aircraft.0.id: must be a whole number")));
}

TEST(Scenario, ReportsPhysicsThatCannotBe) {
  EXPECT_THAT(
      ErrorsOf(kValid + R"(flex:
  damping: -0.01
  camera_mass_kg: -1
  section: oak
  frequency_hz: 9000
vibration:
  isolator: {damping: -1}
  rotors: {reference_hz: 0}
  axis_ratio: [0.3, .nan, 1]
  preset: violent
rig: {misalignment: {random: {yaw_sigma_deg: -0.1}}}
)"),
      ElementsAre(HasSubstr("s.yaml:6:12: flex.damping: must be a number between 0.0001 and 1"),
                  HasSubstr("s.yaml:7:19: flex.camera_mass_kg: must be a number between 0 and 10"),
                  HasSubstr("s.yaml:8:12: flex.section: must be one of cf_tube_16_14, "),
                  HasSubstr("s.yaml:9:17: flex.frequency_hz: must be a number between 0 and 5000"),
                  HasSubstr("s.yaml:11:23: vibration.isolator.damping: must be"),
                  HasSubstr("s.yaml:12:26: vibration.rotors.reference_hz: must be"),
                  HasSubstr("s.yaml:13:15: vibration.axis_ratio: must be"),
                  HasSubstr("s.yaml:14:11: vibration.preset: must be one of calm, normal, "),
                  HasSubstr("s.yaml:15:46: rig.misalignment.random.yaw_sigma_deg: must be")));
}

TEST(Scenario, ReportsWhatIsWrongInsideTheFileOfTheVibration) {
  const TemporaryFolder folder;
  const std::string imu = folder.Write("imu.csv", "0,0,0,0,0,0,9.8\n0.01,0,0,nan,0,0,9.8\n");
  const std::string psd = folder.Write("psd.csv", "f_hz,g2_per_hz\n20,0.04\n10,0.04\n");
  EXPECT_THAT(ErrorsOf(kValid, {"vibration.source=recorded", "vibration.file=" + imu}),
              ElementsAre(HasSubstr("imu.csv:2: column 4: must be a finite number (found 'nan')")));
  EXPECT_THAT(ErrorsOf(kValid, {"vibration.source=rotors", "vibration.file=" + psd}),
              ElementsAre(HasSubstr("psd.csv:3: f_hz: must rise from line to line (found 10 after "
                                    "20)")));
  EXPECT_THAT(ErrorsOf(kValid, {"vibration.source=psd", "vibration.min_hz=1000"}),
              ElementsAre("vibration.preset: must reach above vibration.min_hz = 1000"));
}

TEST(Scenario, ReportsBarsWhoseModesCannotBe) {
  const std::string custom = "flex: {enabled: true, section: custom, custom: ";
  EXPECT_THAT(ErrorsOf(kValid + custom + "{EI_forward_Nm2: 1e7}}\n"),
              ElementsAre(HasSubstr("flex.section: must be such that fore-aft bending has 1 Hz to "
                                    "5000 Hz (found 2.7")));
  EXPECT_THAT(ErrorsOf(kValid + custom + "{EI_up_Nm2: 0.01}}\n"),
              ElementsAre(HasSubstr("s.yaml:5:60: flex.custom.EI_up_Nm2: must be such that "
                                    "vertical bending has 1 Hz to 5000 Hz (found 0.85")));
  EXPECT_THAT(ErrorsOf(kValid + "flex: {enabled: true, frequency_hz: 0.5}\n"),
              ElementsAre(HasSubstr("s.yaml:5:37: flex.frequency_hz: must be such that fore-aft "
                                    "bending has 1 Hz to 5000 Hz (found 0.5 Hz)")));
  EXPECT_THAT(ErrorsOf(kValid + "flex: {enabled: true, tip_inertia_kgm2: 1e-7}\n"),
              ElementsAre(HasSubstr("flex.tip_inertia_kgm2: must be such that torsion has")));
  EXPECT_THAT(ErrorsOf(kValid + "flex: {enabled: false, frequency_hz: 0.5}\n"), ElementsAre());
}

TEST(Scenario, TakesFilesOfOverridesFromTheCurrentFolder) {
  const TemporaryFolder folder;
  const auto file = folder.Write("s.yaml", kValid);
  const auto before = std::filesystem::current_path();
  folder.Write("here/v.csv", "1,2\n");
  std::filesystem::current_path(folder.path() / "here");
  const Scenario scenario = LoadScenario(file, {"vibration.file=v.csv"});
  std::filesystem::current_path(before);
  EXPECT_EQ(scenario.vibration.file.absolute, (folder.path() / "here/v.csv").string());
}

}  // namespace
}  // namespace windhover
