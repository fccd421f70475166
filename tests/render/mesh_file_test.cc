// Mesh files and images from anywhere: what is said of good ones, and that no bad one does more
// than to be refused with its name.

#include "render/mesh_file.h"

#include <cstdlib>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "common/image/linear_image.h"
#include "common/process/isolated.h"
#include "render/mesh_info.h"
#include "render/mesh_topology.h"
#include "tests/support/program.h"

namespace windhover {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
using testing::StartsWith;

// A tetrahedron with corners at the origin and 1, 2, 3 along x, y, z, wound outwards.
const std::string kTetrahedron =
    "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

std::string Gltf(const std::string& nodes) {
  return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": )" +
         nodes + "}";
}

class MeshFileTest : public testing::Test {
 protected:
  std::string ErrorOf(const std::string& name, const std::string& content) const {
    try {
      ReadMeshFile(folder_.Write(name, content));
    } catch (const MeshFileError& error) {
      return error.place + "|" + error.what();
    }
    return "no error";
  }
  nlohmann::ordered_json InfoOf(const std::string& name, const std::string& content) const {
    return MeshInfo(folder_.Write(name, content));
  }

  const TemporaryFolder folder_;
};

TEST_F(MeshFileTest, InfoOfATetrahedron) {
  const auto info = InfoOf("t.obj", kTetrahedron);
  EXPECT_EQ(info["triangles"], 4);
  EXPECT_EQ(info["vertices"], 4);
  EXPECT_EQ(info["parts"], 1);
  EXPECT_EQ(info["size"], nlohmann::ordered_json({1.0, 2.0, 3.0}));
  EXPECT_EQ(info["centre"], nlohmann::ordered_json({0.5, 1.0, 1.5}));
  EXPECT_EQ(info["winding"]["kind"], "consistent");
  EXPECT_TRUE(info["winding"]["watertight"].get<bool>());
  EXPECT_THAT(MeshInfoText(info), HasSubstr("triangles  4 (0 more without area), 4 vertices"));
}

TEST_F(MeshFileTest, InfoSaysWhatIsWrongWithTheWinding) {
  const auto winding = [&](const std::string& faces) {
    return InfoOf("t.obj", kTetrahedron.substr(0, 32) + faces)["winding"];
  };
  EXPECT_EQ(winding("f 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n")["kind"], "inverted");
  const auto turned = winding("f 1 2 3\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  EXPECT_EQ(turned["kind"], "inconsistent");
  EXPECT_EQ(turned["turned_edges"], 3);
  const auto open = winding("f 1 2 4\nf 1 4 3\nf 2 3 4\n");
  EXPECT_EQ(open["open_edges"], 3);
  EXPECT_FALSE(open["watertight"].get<bool>());
}

TEST_F(MeshFileTest, TurnsAClosedMeshOutwards) {
  Mesh mesh = ReadMeshFile(folder_.Write("t.obj", kTetrahedron)).mesh;
  const Mesh outward = mesh;
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  for (auto& n : mesh.normals) n = -n;
  EXPECT_TRUE(TurnOutwards(&mesh));
  EXPECT_EQ(mesh.triangles, outward.triangles);
  EXPECT_EQ(mesh.normals, outward.normals);
  mesh.triangles.pop_back();
  EXPECT_FALSE(TurnOutwards(&mesh));
}

TEST_F(MeshFileTest, GuessesUnits) {
  const auto likely = [&](double size) {
    const std::string at = std::to_string(size);
    return InfoOf("t.obj", "v 0 0 0\nv " + at + " 0 0\nv 0 " + at + " 0\nf 1 2 3\n")["units"][0];
  };
  EXPECT_EQ(likely(0.9)["unit"], "metres");
  EXPECT_EQ(likely(900)["unit"], "millimetres");
  EXPECT_EQ(likely(900)["scale"], 0.001);
  EXPECT_EQ(likely(0.0009)["unit"], "kilometres");
}

TEST_F(MeshFileTest, CountsTrianglesWithoutArea) {
  const auto info = InfoOf("t.obj", kTetrahedron + "v 2 0 0\nf 1 2 5\n");
  EXPECT_EQ(info["degenerate_triangles"], 1);
  EXPECT_EQ(info["triangles"], 4);
}

// The left half of the texture is red, the right half blue.
TEST_F(MeshFileTest, ColoursVerticesByTheTextureAtTheirPlace) {
  cv::Mat texture(2, 64, CV_8UC3, cv::Scalar(0, 0, 255));
  texture.colRange(32, 64).setTo(cv::Scalar(255, 0, 0));
  cv::imwrite((folder_.path() / "t.png").string(), texture);
  folder_.Write("m.mtl", "newmtl m\nKd 1 1 1\nmap_Kd t.png\n");
  const MeshFile file = ReadMeshFile(
      folder_.Write("t.obj",
                    "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.1 0.5\nvt 0.9 0.5\nvt 0.2 0.5\n"
                    "usemtl m\nf 1/1 2/2 3/3\n"));
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector3f expected =
        file.mesh.positions[i].x() > 0.5f ? Eigen::Vector3f::UnitZ() : Eigen::Vector3f::UnitX();
    EXPECT_TRUE(file.mesh.base_colours[i].isApprox(expected)) << i;
  }
}

TEST_F(MeshFileTest, BadFilesAreNamedWithTheirPlace) {
  EXPECT_THAT(ErrorOf("n.obj", "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n"), StartsWith("2|vertex"));
  EXPECT_THAT(ErrorOf("r.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"),
              StartsWith("4|face of vertex 9, but there are 3"));
  EXPECT_THAT(ErrorOf("j.gltf", "{\n  \"asset\": }"), StartsWith("2:12|glTF is no JSON"));
  EXPECT_THAT(
      ErrorOf("c.gltf", Gltf(R"([{"children": [1]}, {"children": [2]}, {"children": [1]}])")),
      HasSubstr("node 1 is the child of more than one node"));
  EXPECT_THAT(ErrorOf("o.gltf", Gltf(R"([{}, {"children": [2]}, {"children": [1]}])")),
              HasSubstr("nodes go in circles"));
  EXPECT_THAT(ErrorOf("k.gltf", Gltf(R"([{"children": [7]}])")), HasSubstr("not there"));
  EXPECT_THAT(ErrorOf("s.obj", "ply\nformat ascii 1.0\n"), HasSubstr("that of a file .ply"));
  folder_.Write("m.mtl", "newmtl m\nmap_Kd gone.png\n");
  EXPECT_THAT(ErrorOf("t.obj", "mtllib m.mtl\nusemtl m\n" + kTetrahedron),
              HasSubstr("texture 'gone.png': no such image file"));
}

TEST(RunIsolated, OutlivesWhatItRuns) {
  const auto error_of = [](const std::function<std::string()>& work) -> std::string {
    try {
      return RunIsolated(0, work);
    } catch (const ConfigError& error) {
      return error.what();
    }
  };
  const std::string bytes(3'000'000, '\0');
  EXPECT_EQ(RunIsolated(0, [&] { return bytes; }), bytes);
  EXPECT_EQ(error_of([]() -> std::string { throw std::runtime_error("no"); }), "no");
  EXPECT_EQ(error_of([]() -> std::string {
              raise(SIGKILL);
              return "";
            }),
            "the reader crashed (SIGKILL)");
  EXPECT_EQ(error_of([]() -> std::string { _exit(3); }), "the reader ended early");
}

// --- Bytes changed at random ---------------------------------------------------------------------

// More with WINDHOVER_FUZZ=5000.
int Rounds() {
  const char* n = std::getenv("WINDHOVER_FUZZ");
  return n == nullptr ? 25 : std::atoi(n);
}

// Linear congruential, so that a seed is a file for ever (Knuth, TAOCP vol. 2, 3.3.4).
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : state_(seed) { Next(1); }
  std::size_t Next(std::size_t n) {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<std::size_t>(state_ >> 33) % n;
  }

 private:
  std::uint64_t state_;
};

std::string Mutated(std::string bytes, std::uint64_t seed) {
  Dice dice(seed);
  for (std::size_t i = 0, n = 1 + dice.Next(8); i < n && !bytes.empty(); ++i) {
    const std::size_t at = dice.Next(bytes.size());
    switch (dice.Next(5)) {
      case 0:
        bytes.resize(at);
        break;
      case 1:
        bytes.insert(at, bytes.substr(at / 2, dice.Next(40)));
        break;
      case 2:
        bytes.erase(at, dice.Next(20));
        break;
      default:
        bytes[at] = static_cast<char>(dice.Next(256));
    }
  }
  return bytes;
}

// How often each ending was met; crashes are counted by their signal.
using Endings = std::map<std::string, int>;

std::string EndingOf(const std::string& error) {
  const std::size_t crash = error.find("the reader ");
  return crash == std::string::npos ? "refused" : error.substr(crash, 30);
}

std::string BinaryStl() {
  std::string stl(80, ' ');
  stl += std::string("\4\0\0\0", 4);
  for (int i = 0; i < 4; ++i) {
    float facet[12] = {};
    for (int k = 3; k < 12; ++k) facet[k] = static_cast<float>((k * 7 + i * 5) % 11);
    stl.append(reinterpret_cast<const char*>(facet), sizeof facet).append(2, '\0');
  }
  return stl;
}

constexpr char kPly[] =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
    "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

constexpr char kGltf[] =
    R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],)"
    R"("meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "accessors": [{"bufferView": 0,)"
    R"("componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],)"
    R"("bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"byteLength": 36, "uri":)"
    R"("data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";

TEST_F(MeshFileTest, NoMutatedMeshDoesMoreThanBeRefused) {
  const std::map<std::string, std::string> seeds = {
      {"m.obj", kTetrahedron}, {"m.stl", BinaryStl()}, {"m.ply", kPly}, {"m.gltf", kGltf}};
  for (const auto& [name, bytes] : seeds) {
    ASSERT_EQ(ErrorOf(name, bytes), "no error") << name;
    Endings endings;
    for (int i = 0; i < Rounds(); ++i) {
      const std::string error = ErrorOf(name, Mutated(bytes, static_cast<std::uint64_t>(i)));
      ++endings[error == "no error" ? error : EndingOf(error)];
    }
    EXPECT_GT(endings["refused"], 0) << name;
    RecordProperty(name, testing::PrintToString(endings));
    if (Rounds() > 100) std::cout << name << ' ' << testing::PrintToString(endings) << '\n';
  }
}

class ImageFileTest : public testing::Test {
 protected:
  std::string ErrorOf(const std::string& name, const std::string& content) const {
    const auto file = folder_.Write(name, content);
    try {
      ReadLinearImage({.as_given = name, .absolute = file.string(), .where = "s.yaml:1:2"});
    } catch (const ConfigError& error) {
      EXPECT_THAT(error.what(), AllOf(StartsWith("s.yaml:1:2: "), HasSubstr("'" + name + "'")));
      return error.what();
    }
    return "no error";
  }
  static std::string Encoded(const std::string& extension) {
    cv::Mat image(24, 48, extension == ".hdr" ? CV_32FC3 : CV_8UC3, cv::Scalar(9, 90, 200));
    image.rowRange(0, 9).setTo(cv::Scalar(200, 20, 5));
    std::vector<unsigned char> bytes;
    cv::imencode(extension, image, bytes);
    return {bytes.begin(), bytes.end()};
  }

  const TemporaryFolder folder_;
};

TEST_F(ImageFileTest, RefusesBombsBeforeMakingRoom) {
  std::string png = Encoded(".png");
  png.replace(16, 8, std::string("\0\0\xff\xff\0\0\xff\xff", 8));
  EXPECT_THAT(ErrorOf("b.png", png), HasSubstr("larger than 128 Mpx (65535x65535)"));
  std::string hdr = Encoded(".hdr");
  hdr.replace(hdr.find("-Y 24 +X 48"), 11, "-Y 99999 +X 99999");
  EXPECT_THAT(ErrorOf("b.hdr", hdr), HasSubstr("larger than 128 Mpx (99999x99999)"));
}

TEST_F(ImageFileTest, RefusesImagesCutShortAndOthers) {
  for (const char* extension : {".png", ".jpg", ".hdr"}) {
    const std::string bytes = Encoded(extension);
    EXPECT_EQ(ErrorOf(std::string("w") + extension, bytes), "no error");
    EXPECT_NE(ErrorOf(std::string("h") + extension, bytes.substr(0, bytes.size() / 2)), "no error")
        << extension;
    EXPECT_THAT(ErrorOf(std::string("x") + extension, "no image\n"), HasSubstr("is not an image"));
  }
}

TEST_F(ImageFileTest, NoMutatedImageDoesMoreThanBeRefused) {
  for (const std::string extension : {".png", ".jpg", ".hdr"}) {
    const std::string bytes = Encoded(extension);
    Endings endings;
    for (int i = 0; i < Rounds(); ++i) {
      const std::string error =
          ErrorOf("m" + extension, Mutated(bytes, static_cast<std::uint64_t>(i)));
      ++endings[error == "no error" ? error : EndingOf(error)];
    }
    EXPECT_GT(endings["refused"], 0) << extension;
    if (Rounds() > 100) std::cout << extension << ' ' << testing::PrintToString(endings) << '\n';
  }
}

}  // namespace
}  // namespace windhover
