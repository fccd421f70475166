#include "render/mesh_loader.h"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace windhover {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class LoadMeshTest : public testing::Test {
 protected:
  LoadMeshTest()
      : folder_(std::filesystem::temp_directory_path() /
                ("windhover_mesh_" +
                 std::string(testing::UnitTest::GetInstance()->current_test_info()->name()))) {
    std::filesystem::create_directories(folder_);
  }
  ~LoadMeshTest() override { std::filesystem::remove_all(folder_); }

  MeshConfig Write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return Named(name);
  }
  MeshConfig Named(const std::string& name) const {
    MeshConfig config;
    config.file = {.as_given = name, .absolute = (folder_ / name).string(), .where = "s.yaml:7:9"};
    return config;
  }
  static std::string ErrorOf(const MeshConfig& config) {
    try {
      LoadMesh(config);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "no error";
  }

  const std::filesystem::path folder_;
};

// A tetrahedron with corners at the origin and 1, 2, 3 along x, y, z.
constexpr char kTetrahedron[] =
    "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\n"
    "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

TEST_F(LoadMeshTest, ReadsAnObj) {
  const Mesh mesh = LoadMesh(Write("t.obj", kTetrahedron));
  EXPECT_EQ(mesh.triangles.size(), 4u);
  EXPECT_TRUE(BoundingBox(mesh).sizes().isApprox(Eigen::Vector3f(1, 2, 3)));
  EXPECT_EQ(mesh.normals.size(), mesh.positions.size());
  EXPECT_EQ(mesh.base_colours.size(), mesh.positions.size());
}

TEST_F(LoadMeshTest, ScalesThenTurnsThenMoves) {
  MeshConfig config = Write("t.obj", kTetrahedron);
  config.scale = 2;
  config.rotation_deg = {90, 0, 0};  // y to z, z to -y.
  config.offset_m = {10, 20, 30};
  const Eigen::AlignedBox3f box = BoundingBox(LoadMesh(config));
  EXPECT_TRUE(box.min().isApprox(Eigen::Vector3f(10, 14, 30), 1e-6f)) << box.min().transpose();
  EXPECT_TRUE(box.max().isApprox(Eigen::Vector3f(12, 20, 34), 1e-6f)) << box.max().transpose();
}

TEST_F(LoadMeshTest, TakesColoursFromMaterials) {
  Write("m.mtl", "newmtl red\nKd 1 0 0\n");
  const Mesh mesh =
      LoadMesh(Write("t.obj", std::string("mtllib m.mtl\nusemtl red\n") + kTetrahedron));
  for (const Eigen::Vector3f& c : mesh.base_colours)
    EXPECT_TRUE(c.isApprox(Eigen::Vector3f(1, 0, 0)));
}

TEST_F(LoadMeshTest, NamesAMissingFile) {
  EXPECT_EQ(ErrorOf(Named("none.obj")), "s.yaml:7:9: no such mesh file (found 'none.obj')");
}

TEST_F(LoadMeshTest, RefusesAFolder) {
  EXPECT_THAT(ErrorOf(Named(".")), HasSubstr("no such mesh"));
}

TEST_F(LoadMeshTest, RefusesAnEmptyFile) {
  EXPECT_THAT(ErrorOf(Write("empty.stl", "")), HasSubstr("is empty"));
}

TEST_F(LoadMeshTest, RefusesUnknownContent) {
  for (const char* name :
       {"x.obj", "x.stl", "x.gltf", "x.glb", "x.dae", "x.ply", "x.fbx", "x.bin"}) {
    EXPECT_THAT(ErrorOf(Write(name, "this is no mesh\n")), StartsWith("s.yaml:7:9: ")) << name;
  }
}

TEST_F(LoadMeshTest, RefusesAMeshWithoutTriangles) {
  EXPECT_THAT(ErrorOf(Write("p.obj", "v 0 0 0\nv 1 0 0\n")), StartsWith("s.yaml:7:9: "));
}

TEST_F(LoadMeshTest, RefusesVerticesThatAreNotFinite) {
  EXPECT_THAT(ErrorOf(Write("n.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")),
              StartsWith("s.yaml:7:9: "));
}

TEST_F(LoadMeshTest, SaysWhenTheScaleIsWrong) {
  MeshConfig config = Write("t.obj", kTetrahedron);
  config.scale = 1e5;
  EXPECT_THAT(ErrorOf(config), HasSubstr("mesh.scale must bring it to"));
}

TEST_F(LoadMeshTest, SurvivesFilesCutShort) {
  const Mesh whole = LoadMesh(Write("t.obj", kTetrahedron));
  const std::string text = kTetrahedron;
  for (std::size_t n = 1; n < text.size(); n += 3) {
    const MeshConfig config = Write("cut.obj", text.substr(0, n));
    try {
      EXPECT_LE(LoadMesh(config).triangles.size(), whole.triangles.size());
    } catch (const ConfigError&) {
    }
  }
}

// A binary STL whose header promises more triangles than the file has.
TEST_F(LoadMeshTest, RefusesAnStlThatLies) {
  std::string stl(80, ' ');
  stl += std::string("\xff\xff\xff\x7f", 4);
  stl += std::string(50, '\0');
  EXPECT_THAT(ErrorOf(Write("lies.stl", stl)), StartsWith("s.yaml:7:9: "));
}

TEST_F(LoadMeshTest, ReadsRealAircraft) {
  const std::filesystem::path meshes = std::filesystem::path(WINDHOVER_REAL_INPUTS_DIR) / "meshes";
  if (!std::filesystem::exists(meshes)) GTEST_SKIP() << "no real inputs beside the repository";
  const auto load = [&](const std::string& name, double scale, double roll_deg) {
    MeshConfig config;
    config.file = {.as_given = name, .absolute = (meshes / name).string(), .where = "s.yaml:1:1"};
    config.scale = scale;
    config.rotation_deg = {roll_deg, 0, 0};
    return LoadMesh(config);
  };
  const Eigen::Vector3f skydio = BoundingBox(load("skydio_2_1000_poly.gltf", 0.00254, 90)).sizes();
  EXPECT_GT(skydio.x(), 0.15f);
  EXPECT_LT(skydio.maxCoeff(), 0.6f);
  EXPECT_EQ(skydio.minCoeff(), skydio.z()) << skydio.transpose();
  const Mesh pelican = load("pelican.dae", 1, 0);
  EXPECT_GT(pelican.triangles.size(), 1000u);
  const Eigen::Vector3f size = BoundingBox(pelican).sizes();
  EXPECT_EQ(size.minCoeff(), size.z()) << size.transpose();
  EXPECT_GT(load("x500_prop_ccw.stl", 1, 0).triangles.size(), 100u);
}

}  // namespace
}  // namespace windhover
