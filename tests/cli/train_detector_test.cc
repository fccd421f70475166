// `windhover train detector --labelled`: from pictures of one's own to a card that is run.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "common/image/image_file.h"
#include "network/detector_card.h"
#include "tests/support/program.h"

namespace windhover {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kWindhover = std::string(WINDHOVER_BIN_DIR) + "/windhover";

/// Three pictures with a dark cross each, and one without.
void WritePictures(const TemporaryFolder& folder) {
  for (int i = 0; i < 4; ++i) {
    const std::string name = std::to_string(i) + "_left";
    cv::Mat picture(360, 640, CV_8UC3, cv::Scalar(180, 150, 120));
    if (i < 3) {
      const cv::Point centre(160 + 150 * i, 180), a(32, 18), b(32, -18);
      cv::line(picture, centre - a, centre + a, cv::Scalar::all(30), 6);
      cv::line(picture, centre - b, centre + b, cv::Scalar::all(30), 6);
    }
    const std::string label =
        i < 3 ? "0 " + std::to_string((160.5 + 150 * i) / 640) + " 0.501389 0.110938 0.119444\n"
              : "";
    folder.Write("mine/labels/" + name + ".txt", label);
    std::filesystem::create_directories(folder.path() / "mine/images");
    WriteImageFile(picture, folder.path() / "mine/images" / (name + ".png"));
  }
}

/// Two steps on nothing but the pictures in `folder`/mine.
Program Train(const TemporaryFolder& folder, const std::string& network, const std::string& out,
              const std::vector<std::string>& more) {
  std::vector<std::string> words = {kWindhover,
                                    "train",
                                    "detector",
                                    "--network",
                                    network,
                                    "--labelled",
                                    folder.path() / "mine",
                                    "--labelled-share",
                                    "1",
                                    "--steps",
                                    "2",
                                    "--batch",
                                    "2",
                                    "--crop",
                                    "64",
                                    "--out",
                                    folder.path() / out};
  words.insert(words.end(), more.begin(), more.end());
  return Program(words);
}

nlohmann::json CardOf(const TemporaryFolder& folder, const std::string& name) {
  return nlohmann::json::parse(TextOf(folder.path() / name));
}

TEST(TrainDetector, GoesOnFromWeightsWithLabelledPictures) {
  const TemporaryFolder folder;
  WritePictures(folder);
  for (const std::string network : {"yolox_small", "yolox_refine"}) {
    SCOPED_TRACE(network);
    Program first = Train(folder, network, "first.json", {});
    ASSERT_EQ(first.Wait(), 0) << first.Err();
    const std::string start = folder.path() / "first.onnx";
    Program tuned = Train(folder, network, "tuned.json", {"--from", start, "--rate", "2e-4"});
    ASSERT_EQ(tuned.Wait(), 0) << tuned.Err();
    EXPECT_NE(TextOf(folder.path() / "tuned.onnx"), TextOf(start));
    const auto provenance = CardOf(folder, "tuned.json")["provenance"];
    EXPECT_THAT(provenance["command"].get<std::string>(),
                HasSubstr("--from first.onnx --labelled mine --labelled-share 1"));
    const auto& labelled = provenance["data"]["labelled"];
    EXPECT_EQ(labelled["folder"], "mine");
    EXPECT_EQ(labelled["pictures"], 4);
    EXPECT_EQ(labelled["share"], 1);
    Program sum({"sh", "-c",
                 "cd " + (folder.path() / "mine").string() +
                     " && find -type f -printf '%P\\n' | LC_ALL=C sort | xargs -d '\\n' sha256sum"
                     " | sha256sum"});
    ASSERT_EQ(sum.Wait(), 0) << sum.Err();
    EXPECT_EQ(labelled["sha256"], sum.Out().substr(0, 64));
  }
}

TEST(TrainDetector, BecomesTheSecondStageOfTheFirst) {
  const TemporaryFolder folder;
  WritePictures(folder);
  Program first = Train(folder, "yolox_small", "first.json", {});
  ASSERT_EQ(first.Wait(), 0) << first.Err();
  const std::string card = folder.path() / "first.json";
  Program second = Train(folder, "yolox_refine", "second.json", {"--first", card});
  ASSERT_EQ(second.Wait(), 0) << second.Err();
  EXPECT_EQ(CardOf(folder, "first.json")["refiner"]["onnx"], "second.onnx");
  EXPECT_EQ(CardOf(folder, "first.json")["refiner"]["sha256"],
            CardOf(folder, "second.json")["detector"]["sha256"]);
  EXPECT_THAT(CardOf(folder, "first.json")["provenance"]["refiner"].get<std::string>(),
              HasSubstr("--network yolox_refine --steps 2 "));
  EXPECT_EQ(CardOf(folder, "second.json")["provenance"]["data"]["first_sha256"],
            CardOf(folder, "first.json")["detector"]["sha256"]);

  Program other =
      Train(folder, "yolox_small", "other.json",
            {"--from", folder.path() / "first.onnx", "--second", folder.path() / "second.json"});
  ASSERT_EQ(other.Wait(), 0) << other.Err();
  EXPECT_EQ(CardOf(folder, "other.json")["refiner"], CardOf(folder, "first.json")["refiner"]);
  EXPECT_EQ(CardOf(folder, "other.json")["provenance"]["refiner"],
            CardOf(folder, "second.json")["provenance"]["command"]);
}

TEST(TrainDetector, RefusesASecondStageThatIsNone) {
  const TemporaryFolder folder;
  DetectorCard card;
  card.network = "yolox_small";
  card.detector = {"x.onnx", std::string(64, '0')};
  const std::string file = folder.Write("first.json", DetectorCardText(card));
  const auto refused = [&](const std::string& network, const std::string& out) {
    Program program({kWindhover, "train", "detector", "--network", network, "--out",
                     folder.path() / out, "--second", file});
    EXPECT_EQ(program.Wait(), 2);
    return program.Err();
  };
  EXPECT_THAT(refused("yolox_refine", "x.json"),
              HasSubstr("--second: must go with a first network (found yolox_refine)"));
  EXPECT_THAT(refused("yolox_small", "below/x.json"),
              HasSubstr("--second: must be in the folder of --out (found "));
  EXPECT_THAT(refused("yolox_small", "x.json"),
              HasSubstr("--second: must be the card of a yolox_refine (found yolox_small)"));
}

TEST(TrainDetector, RefusesAFirstStageThatItCannotFollow) {
  const TemporaryFolder folder;
  const std::string card = folder.Write("first.json", "{}");
  Program other(
      {kWindhover, "train", "detector", "--out", folder.path() / "out.json", "--first", card});
  EXPECT_EQ(other.Wait(), 2);
  EXPECT_THAT(other.Err(), HasSubstr("--first: must go with --network yolox_refine (found "));
  Program elsewhere({kWindhover, "train", "detector", "--network", "yolox_refine", "--out",
                     folder.path() / "below/out.json", "--first", card});
  EXPECT_EQ(elsewhere.Wait(), 2);
  EXPECT_THAT(elsewhere.Err(), HasSubstr("--first: must be in the folder of --out (found "));
  Program broken({kWindhover, "train", "detector", "--network", "yolox_refine", "--out",
                  folder.path() / "out.json", "--first", card});
  EXPECT_EQ(broken.Wait(), 2);
  EXPECT_THAT(broken.Err(), HasSubstr("first.json: "));
}

TEST(TrainDetector, RefusesWrongLabelsBeforeItLearns) {
  const TemporaryFolder folder;
  WritePictures(folder);
  std::filesystem::remove(folder.path() / "mine/labels/0_left.txt");
  folder.Write("mine/labels/1_left.txt", "0 0.5 0.5 0.1 0.1\n0 0.5 0.5 1.5 0.1\n");
  folder.Write("mine/labels/2_left.txt", "drone\n");
  Program program = Train(folder, "yolox_small", "out.json", {});
  EXPECT_EQ(program.Wait(), 2);
  EXPECT_THAT(program.Err(), HasSubstr("0_left.png: must have a label file"));
  EXPECT_THAT(program.Err(), HasSubstr("1_left.txt:2: must be \"class x y w h\""));
  EXPECT_THAT(program.Err(), HasSubstr("2_left.txt:1: must be"));
  EXPECT_THAT(program.Err(), Not(HasSubstr("1_left.txt:1:")));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out.json"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out.json.state"));
}

TEST(TrainDetector, RefusesWeightsOfAnotherNetworkAndAShareOfNothing) {
  const TemporaryFolder folder;
  WritePictures(folder);
  Program first = Train(folder, "yolox_small", "first.json", {});
  ASSERT_EQ(first.Wait(), 0) << first.Err();
  Program other =
      Train(folder, "yolox_refine", "out.json", {"--from", folder.path() / "first.onnx"});
  EXPECT_EQ(other.Wait(), 2);
  EXPECT_THAT(other.Err(), HasSubstr("first.onnx: must be a yolox_refine"));
  Program share({kWindhover, "train", "detector", "--out", folder.path() / "out.json",
                 "--labelled-share", "0.5"});
  EXPECT_EQ(share.Wait(), 2);
  EXPECT_THAT(share.Err(), HasSubstr("--labelled"));
}

}  // namespace
}  // namespace windhover
