#include "learn/tuple_file.h"

#include <cstdlib>
#include <fstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/config/fields.h"
#include "learn/numpy_pickle.h"
#include "learn/tuple_score.h"
#include "learn/uavde_file.h"
#include "learn/uavde_folder.h"
#include "tests/support/scratch_file.h"
#include "tests/support/temporary_folder.h"

namespace windhover {
namespace {

using ::testing::HasSubstr;
using namespace std::string_literals;

template <typename Function>
std::string MessageOf(const Function& function) {
  try {
    function();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(TupleFile, ComesBackBitByBit) {
  StereoTuple tuple;
  tuple.box.left = {700.1, 300.2, 60.3, 30.4};
  tuple.box.right = {600.5, 301.6, 61.7, 30.8};
  tuple.box.score = 1;
  tuple.range_m = 12.345678901234567;
  tuple.range_true_m = 12.5;
  tuple.flight = 2;
  tuple.utime = 1234567;
  const std::string file = test::ScratchFile("", "tuples");
  WriteTuples({{tuple, tuple}, {tuple}, {tuple}}, file);
  const TupleSplits back = ReadTuples(file, 1280, 720);
  ASSERT_EQ(back.train.size(), 2u);
  EXPECT_EQ(back.test[0].box.left.x_px, 700.1);
  EXPECT_EQ(back.test[0].box.right.w_px, 61.7);
  EXPECT_EQ(back.val[0].range_m, tuple.range_m);
  EXPECT_EQ(back.val[0].range_true_m, 12.5);
  EXPECT_EQ(back.train[1].flight, 2);
  EXPECT_EQ(back.train[1].utime, 1234567);
}

TEST(TupleFile, ReadsSharesOfImages) {
  std::string text;
  for (int i = 0; i < 8; ++i) text += fmt::format("0.5,0.5,0.1,0.1,0.4,0.5,0.1,0.1,{}\n", 20 + i);
  const TupleSplits tuples = ReadTuples(test::ScratchFile(text), 1280, 720);
  EXPECT_EQ(tuples.train.size(), 5u);
  EXPECT_EQ(tuples.val.size(), 1u);
  EXPECT_EQ(tuples.test.back().range_m, 27);  // In their order.
  EXPECT_DOUBLE_EQ(tuples.test[0].box.left.x_px, 639.5);
  EXPECT_DOUBLE_EQ(tuples.test[0].box.right.x_px, 511.5);
  EXPECT_DOUBLE_EQ(tuples.test[0].box.left.h_px, 72);
}

TEST(TupleFile, SaysWhatIsWrongAndWhere) {
  const std::string head = std::string(kTupleColumns) + "\n";
  const auto line = [&](const std::string& text) {
    return MessageOf([&] { ReadTuples(test::ScratchFile(head + text + "\n"), 1280, 720); });
  };
  EXPECT_THAT(line("0,0,0,700,300,60,30,600,300,60,30,nan,12"), HasSubstr(":2: column 12: must"));
  EXPECT_THAT(line("0,0,0,700,300,0,30,600,300,60,30,12,12"),
              HasSubstr(":2: sizes of boxes must be above 0 (found 0)"));
  EXPECT_THAT(line("0,0,0,600,300,60,30,700,300,60,30,12,12"),
              HasSubstr(":2: the left box must be right of the right one"));
  EXPECT_THAT(line("0,0,0,700,300,60,30,600,300,60,30,-1,12"), HasSubstr(":2: distance must be"));
  EXPECT_THAT(line("3,0,0,700,300,60,30,600,300,60,30,12,12"), HasSubstr(":2: split must be"));
  EXPECT_THAT(line("0,0,0,700"), HasSubstr(":2: must have 13 columns (found 4)"));
  EXPECT_THAT(line("0,0,0,700,300,60,30,600,300,60,30,12,12"), HasSubstr("must have tuples to"));
}

// --- UAVDE's .npy, byte by byte: what NumPy 1.24 writes, without its memory of repeated names. ---

std::string Text(const std::string& text) {
  return "X" + std::string{static_cast<char>(text.size()), 0, 0, 0} + text;
}

/// dtype('f4'), stored with its least significant byte first.
const std::string kFloat32 = "cnumpy\ndtype\n" + Text("f4") + "\x89\x88\x87R(K\x03" + Text("<") +
                             "NNNJ\xff\xff\xff\xffJ\xff\xff\xff\xffK\0tb"s;

/// An array of float32; `shape` as pickled.
std::string Array(const std::string& shape, const std::vector<float>& numbers) {
  std::string bytes(numbers.size() * sizeof(float), '\0');
  std::memcpy(bytes.data(), numbers.data(), bytes.size());
  return "cnumpy.core.multiarray\n_reconstruct\ncnumpy\nndarray\nK\0\x85"s + "C\x01"s +
         "b\x87R(K\x01" + shape + kFloat32 + "\x89" + "C" + static_cast<char>(bytes.size()) +
         bytes + "tb";
}

std::string Rows(int n, int columns) {
  return "K"s + static_cast<char>(n) + "K"s + static_cast<char>(columns) + "\x86";
}

std::string Entry(const std::string& left, const std::string& right, const std::string& range) {
  return "}(" + Text("left") + left + Text("right") + right + Text("dist") + range +
         Text("file_id") + Text("2023-03-01-10-15-00042.txt\n") + "u";
}

std::string GoodEntry(float range_m) {
  // Two detections on the left, of which the last counts.
  return Entry(Array(Rows(2, 6), {0, 0, 0, 0, 0, 0.1f, 0, 0.75f, 0.5f, 0.125f, 0.25f, 0.5f}),
               Array(Rows(1, 6), {0, 0.5f, 0.5f, 0.125f, 0.25f, 0.75f}), Array(")", {range_m}));
}

std::string Npy(const std::string& entries) {
  const std::string header = "{'descr': '|O', 'fortran_order': False, 'shape': (1,), }\n";
  return "\x93NUMPY\x01"s + '\0' + static_cast<char>(header.size()) + '\0' + header + "\x80\x03](" +
         entries + "e.";
}

std::vector<StereoTuple> Read(const std::string& content) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "a.npy", std::ios::binary) << content;
  return ReadUavdeFile(folder.path() / "a.npy", 1280, 720);
}

TEST(UavdeFile, ReadsAWorkedExample) {
  const auto tuples = Read(Npy(GoodEntry(12.5f) + GoodEntry(7)));
  ASSERT_EQ(tuples.size(), 2u);
  const StereoTuple& tuple = tuples[0];
  EXPECT_EQ(tuple.box.left.x_px, 0.75 * 1280 - 0.5);
  EXPECT_EQ(tuple.box.left.y_px, 359.5);
  EXPECT_EQ(tuple.box.left.w_px, 160);
  EXPECT_EQ(tuple.box.left.h_px, 180);
  EXPECT_EQ(tuple.box.right.x_px, 639.5);
  EXPECT_EQ(tuple.box.score, 0.5);  // The lesser.
  EXPECT_EQ(tuple.range_m, 12.5);
  EXPECT_EQ(tuples[1].range_m, 7);
}

TEST(UavdeFile, ReadsWhatNumpySaves) {
  const TemporaryFolder folder;
  const std::filesystem::path script = folder.path() / "save.py";
  std::ofstream(script) << R"(
import pickle, sys
import numpy as np
box = lambda x, conf: [0, x, 0.5, 0.125, 0.25, conf]
entry = lambda i: {
    'left': np.array([box(0.1, 0.3), box(0.75, 0.5)], np.float32),
    'right': np.array([box(0.5, 0.75)], np.float32),
    'dist': np.array(4 + i, np.float32), 'file_id': '2023-03-01-10-15-%05d.txt\n' % i}
entries = [entry(i) for i in range(300)]
entries[1]['dist'] = 5.0
entries[2]['dist'] = np.float32(6)
folder = sys.argv[1]
for name in 'train', 'val', 'test':
    np.save(folder + '/' + name + '.npy', entries)
for protocol in 2, 3, 4, 5:
    with open(folder + '/%d.npy' % protocol, 'wb') as out:
        array = np.asanyarray(entries)
        np.lib.format.write_array_header_1_0(out, np.lib.format.header_data_from_array_1_0(array))
        pickle.dump(array, out, protocol)
)";
  const std::string command = fmt::format("/usr/bin/python3 {} {} 2> {}/errors", script.string(),
                                          folder.path().string(), folder.path().string());
  if (std::system("/usr/bin/python3 -c 'import numpy' 2> /dev/null") != 0) {
    GTEST_SKIP() << "python3-numpy is not installed";
  }
  ASSERT_EQ(std::system(command.c_str()), 0);
  for (const char* name : {"train", "2", "3", "4", "5"}) {
    const auto tuples = ReadUavdeFile(folder.path() / (name + ".npy"s), 1280, 720);
    ASSERT_EQ(tuples.size(), 300u) << name;
    for (std::size_t i = 0; i < 300; ++i) {
      EXPECT_EQ(tuples[i].range_m, 4.0 + static_cast<double>(i));
      EXPECT_EQ(tuples[i].box.left.x_px, 959.5);
      EXPECT_EQ(tuples[i].box.right.w_px, 160);
    }
  }
  const TupleSplits splits = ReadTuples(folder.path(), 1280, 720);
  EXPECT_EQ(splits.train.size() + splits.val.size() + splits.test.size(), 900u);
  EXPECT_EQ(ReadTuples(folder.path() / "4.npy", 1280, 720).train.size(), 216u);  // 2815 of 3895
}

TEST(UavdeFile, SaysWhatIsWrongAndWhere) {
  const auto said = [](const std::string& entry) {
    return MessageOf([&] { Read(Npy(GoodEntry(9) + entry)); });
  };
  const std::string left = Array(Rows(1, 5), {0, 0.75f, 0.5f, 0.125f, 0.25f}),
                    range = Array(")", {9});
  EXPECT_THAT(said(Entry(left, Array(Rows(1, 4), {0, 1, 1, 1}), range)),
              HasSubstr("a.npy: entry 1 (\"2023-03-01-10-15-00042.txt\"): right: must be rows of 5 "
                        "or 6 floats (found 1 x 4)"));
  EXPECT_THAT(said(Entry(left, Array(Rows(0, 5), {}), range)), HasSubstr("(found 0 x 5)"));
  EXPECT_THAT(said(Entry(left, Array(Rows(2, 5), {0, 1, 1, 1, 1}), range)),
              HasSubstr("(found none)"));
  EXPECT_THAT(said(Entry(left, Array(Rows(1, 5), {0, 0.9f, 0.5f, 1, 1}), range)),
              HasSubstr("entry 1 (\"2023-03-01-10-15-00042.txt\"): the left box must be right"));
  EXPECT_THAT(said(Entry(left, Array(Rows(1, 5), {0, 0.1f, 0.5f, 0, 1}), range)),
              HasSubstr("sizes of boxes must be above 0"));
  EXPECT_THAT(said(Entry(left, Array(Rows(1, 5), {0, NAN, 0.5f, 1, 1}), range)),
              HasSubstr("numbers must be finite (found nan)"));
  EXPECT_THAT(said(Entry(left, left, Array(Rows(1, 2), {1, 2}))), HasSubstr("(found 1 x 2)"));
  EXPECT_THAT(said(Entry(left, left, "N")), HasSubstr("dist: must be one float (found none)"));
  EXPECT_THAT(said("K\x01"), HasSubstr("entry 1: must be a dictionary"));
}

TEST(UavdeFile, RefusesWhatIsNoSuchFile) {
  const auto said = [](const std::string& content) { return MessageOf([&] { Read(content); }); };
  EXPECT_THAT(said(""), HasSubstr("a.npy: cannot be read"));
  EXPECT_THAT(said("x,y\n"), HasSubstr("a.npy: must be a .npy file of NumPy"));
  EXPECT_THAT(said(std::string((16 << 20) + 1, ' ')), HasSubstr("must be at most 16777216 bytes"));
  std::string floats = Npy("");
  floats.replace(floats.find("|O"), 2, "<f");
  EXPECT_THAT(said(floats), HasSubstr("must be a list of dictionaries"));
  EXPECT_THAT(MessageOf([] { ReadUavdeFolder("/nowhere", 1280, 720); }),
              HasSubstr("/nowhere/train.npy: cannot be read"));
}

TEST(NumpyPickle, CallsNothing) {
  const auto said = [](const std::string& pickle) {
    return MessageOf([&] { NumpyPickle(pickle, 100); });
  };
  EXPECT_EQ(said("\x80\x03"
                 "cos\nsystem\n" +
                 Text("true") + "\x85R."),
            "byte 102: must name an array of NumPy (found \"os.system\")");
  EXPECT_THAT(said("\x80\x04\x8c\x08"
                   "builtins\x8c\x04"
                   "eval\x93."),
              HasSubstr("\"builtins.eval\""));
  EXPECT_THAT(said("cnumpy\nndarray\n)R."), HasSubstr("must be what NumPy gives to numpy.ndarray"));
  EXPECT_THAT(said("\x80\x01N."), HasSubstr("protocol must be 2 to 5 (found 1)"));
  EXPECT_THAT(said("P1\n."), HasSubstr("byte 100: must be an operation that NumPy's save() writes "
                                       "(found 0x50)"));
  EXPECT_THAT(said("."), HasSubstr("a value is missing"));
  EXPECT_THAT(said("(."), HasSubstr("a value is missing"));
  EXPECT_THAT(said("h\x07."), HasSubstr("value 7 was not kept before"));
  EXPECT_THAT(said("X\xff\xff\xff\x7f"
                   "a"),
              HasSubstr("must have 2147483647 more bytes"));
  EXPECT_THAT(said("Nb."), HasSubstr("a value is missing"));
  EXPECT_THAT(said("NNb."), HasSubstr("no list or dictionary"));
  EXPECT_THAT(said("}(NuN."), HasSubstr("has no value"));
  EXPECT_THAT(said(std::string(NumpyPickle::kMostValues + 1, 'N')), HasSubstr("more than 1000000"));
}

// Cut anywhere, or with a byte changed, it is refused or read: never more.
TEST(NumpyPickle, WithstandsDamage) {
  const std::string whole = Npy(GoodEntry(9)), pickle = whole.substr(whole.find('\n') + 1);
  for (std::size_t i = 0; i < pickle.size(); ++i) {
    EXPECT_NE(MessageOf([&] { NumpyPickle(pickle.substr(0, i)); }), "") << i;
    for (int other = 0; other < 256; other += 7) {
      std::string changed = pickle;
      changed[i] = static_cast<char>(other);
      MessageOf([&] { NumpyPickle{changed}; });
    }
  }
}

// So is what the values are taken for.
TEST(UavdeFile, WithstandsDamage) {
  const std::string whole = Npy(GoodEntry(9));
  for (std::size_t i = 0; i < whole.size(); i += 3) {
    std::string changed = whole;
    changed[i] = i % 2 == 0 ? '\0' : '\xff';
    MessageOf([&] { Read(changed); });
  }
}

/// A data set in UAVDE's layout with two frames of one flight and one of another.
class UavdeTexts : public ::testing::Test {
 protected:
  void SetUp() override {
    Write("test_no_prefix.txt",
          "2023-03-01-00042.txt\n2023-03-02-00007.txt\n2023-03-01-00002.txt\n");
    Write("test/annotations.csv",
          ",altitude,distance\n2023-03-01-Left-00042.jpg,3,20.5\n"
          "2023-03-02-Left-00007.jpg,3,10\n2023-03-01-Left-00002.jpg,3,21\n");
    for (const std::string frame :
         {"2023-03-01-{}-00042", "2023-03-02-{}-00007", "2023-03-01-{}-00002"}) {
      for (const char* side : {"Left", "Right"}) {
        const std::string name = fmt::format(fmt::runtime(frame), side);
        const double x = side[0] == 'L' ? 0.5 : 0.25;
        // The last row of a detector counts, the largest of a person.
        Write("test/inference/detected_labels/" + name + ".txt",
              fmt::format("0 0.1 0.1 0.9 0.9 0.2\n0 {} 0.5 0.125 0.25 0.75\n", x));
        Write("test/label/" + name + ".txt",
              fmt::format("0 {} 0.5 0.25 0.25\n0 0.1 0.1 0.01 0.02\n", x));
      }
    }
  }

  void Write(const std::string& name, const std::string& text) {
    const auto file = folder_.path() / "data" / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text;
  }

  std::vector<StereoTuple> Read(UavdeFolder data = {}) {
    data.folder = folder_.path();
    const TupleSplits splits = ReadUavdeTexts(data);
    std::vector<StereoTuple> all = splits.train;
    all.insert(all.end(), splits.val.begin(), splits.val.end());
    all.insert(all.end(), splits.test.begin(), splits.test.end());
    return all;
  }

  TemporaryFolder folder_;
};

TEST_F(UavdeTexts, FramesComeByFlightAndTime) {
  const std::vector<StereoTuple> tuples = Read({.frame_rate_hz = 20});
  ASSERT_EQ(tuples.size(), 3u);
  EXPECT_EQ(tuples[0].flight, 0);
  EXPECT_EQ(tuples[0].utime, 100'000);
  EXPECT_EQ(tuples[0].range_m, 21);
  EXPECT_EQ(tuples[1].utime, 2'100'000);
  EXPECT_EQ(tuples[1].range_m, 20.5);
  EXPECT_EQ(tuples[1].range_true_m, 20.5);
  EXPECT_EQ(tuples[2].flight, 1);
  // A share of 1/2 lies between the two middle pixels.
  EXPECT_EQ(tuples[0].box.left.x_px, 639.5);
  EXPECT_EQ(tuples[0].box.right.x_px, 319.5);
  EXPECT_EQ(tuples[0].box.left.w_px, 160);
  EXPECT_EQ(tuples[0].box.left.h_px, 180);
  EXPECT_EQ(tuples[0].box.score, 0.75);
  EXPECT_EQ(Read({.boxes = UavdeBoxes::kLabelled})[0].box.left.w_px, 320);
}

TEST_F(UavdeTexts, TakesExactDistancesWhereThereAreSome) {
  Write("test/annotations_exact.csv", ",distance\n2023-03-01-Left-00042.jpg,20.25\n");
  const std::vector<StereoTuple> tuples = Read();
  EXPECT_EQ(tuples[1].range_m, 20.5);
  EXPECT_EQ(tuples[1].range_true_m, 20.25);
  EXPECT_EQ(tuples[0].range_true_m, 21);
}

TEST_F(UavdeTexts, EveryMistakeIsSaidAtOnce) {
  Write("test_no_prefix.txt",
        "2023-03-01-00042.txt\nx/y\n2023-03-02-00007.txt\n2023-03-09-1.txt\n");
  Write("test/inference/detected_labels/2023-03-01-Left-00042.txt", "");
  Write("test/inference/detected_labels/2023-03-01-Right-00042.txt", "0 0.1 nan 0.1 0.1 0.5\n");
  Write("test/inference/detected_labels/2023-03-02-Left-00007.txt", "0 0.1 0.5 0.1 0.1 0.5\n");
  const std::string message = MessageOf([&] { Read(); });
  EXPECT_THAT(message, HasSubstr("2023-03-01-Left-00042.txt: must have a row"));
  EXPECT_THAT(message, HasSubstr("00042.txt:1: column 3: must be a finite number (found 'nan')"));
  EXPECT_THAT(message,
              HasSubstr("test_no_prefix.txt:2: must be PREFIX-NUMBER.txt (found \"x/y\")"));
  EXPECT_THAT(message, HasSubstr("test_no_prefix.txt:3: the left box must be right of the right"));
  EXPECT_THAT(message, HasSubstr("annotations.csv must have 2023-03-09-Left-1.jpg"));
  EXPECT_THAT(message, HasSubstr("2023-03-09-Left-1.txt: cannot be opened"));
}

TEST_F(UavdeTexts, DistancesAreReadStrictly) {
  Write("test/annotations.csv", ",distance\n2023-03-01-Left-00042.jpg,far\nx,1,2\n");
  const std::string message = MessageOf([&] { Read(); });
  EXPECT_THAT(message, HasSubstr("annotations.csv:2: must be 2 columns with a finite distance"));
  EXPECT_THAT(message, HasSubstr("annotations.csv:3: must be 2 columns"));
  Write("test/annotations.csv", "name,range\n");
  EXPECT_THAT(MessageOf([&] { Read(); }), HasSubstr("must have a column 'distance'"));
  std::filesystem::remove(folder_.path() / "data/test_no_prefix.txt");
  EXPECT_THAT(MessageOf([&] { Read(); }), HasSubstr("found none"));
}

// Two flights, each at rest: an offset of the disparity makes one too far and one too near.
TEST(ScoreTuples, IsWhatAPersonWorksOut) {
  AircraftConfig config;
  config.frame_rate_hz = 10;
  config.estimator.methods = {"baseline"};
  const double focal_px = config.rig.FocalPx();
  std::vector<StereoTuple> tuples;
  for (const int flight : {0, 1}) {
    for (int i = 0; i < 40; ++i) {
      StereoTuple& tuple = tuples.emplace_back();
      // Both boxes on the optical axes, half the disparity to each side: Z is the range.
      const double disparity_px = focal_px * config.rig.baseline_m / (flight == 0 ? 11 : 18);
      tuple.box.left = {639.5 + disparity_px / 2, 359.5, 60, 30};
      tuple.box.right = {639.5 - disparity_px / 2, 359.5, 60, 30};
      tuple.box.score = 1;
      tuple.range_m = tuple.range_true_m = flight == 0 ? 10 : 20;
      tuple.flight = flight;
      tuple.utime = i * 100'000;
    }
  }
  const std::vector<MethodScore> scores = ScoreTuples(tuples, config);
  ASSERT_EQ(scores.size(), 1u);
  EXPECT_EQ(scores[0].all.n, 80);
  EXPECT_NEAR(*scores[0].all.abs_rel, 0.1, 1e-9);
  EXPECT_NEAR(*scores[0].all.bias_m, -0.5, 1e-9);
  EXPECT_EQ(scores[0].lt20.n, 40);
  EXPECT_TRUE(scores[0].all.ci95.contains("abs_rel"));
}

}  // namespace
}  // namespace windhover
