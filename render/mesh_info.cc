#include "render/mesh_info.h"

#include <algorithm>
#include <array>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/config/fields.h"
#include "render/mesh_file.h"
#include "render/mesh_topology.h"

namespace windhover {
namespace {

using nlohmann::ordered_json;

constexpr double kSmallest_m = 0.2, kLargest_m = 3;  // Of a UAV.

struct Unit {
  const char* name;
  double scale;  ///< Metres.
};
constexpr std::array kUnits = {
    Unit{"metres", 1},      Unit{"millimetres", 1e-3},    Unit{"centimetres", 1e-2},
    Unit{"inches", 0.0254}, Unit{"inches / 10", 0.00254}, Unit{"kilometres", 1e3}};

// Units that make the longest side that of a UAV, the most usual first.
ordered_json UnitsOf(double longest) {
  ordered_json units = ordered_json::array();
  for (const Unit& unit : kUnits) {
    const double size_m = longest * unit.scale;
    if (size_m < kSmallest_m || size_m > kLargest_m) continue;
    units.push_back({{"unit", unit.name}, {"scale", unit.scale}, {"longest_side_m", size_m}});
  }
  if (units.empty()) {
    constexpr double kUsual_m = 0.8;
    units.push_back(
        {{"unit", "unknown"}, {"scale", kUsual_m / longest}, {"longest_side_m", kUsual_m}});
  }
  return units;
}

std::string WindingOf(const MeshTopology& topology) {
  if (topology.turned_edges > 0) return "inconsistent";
  if (topology.inverted == topology.parts && topology.IsWatertight()) return "inverted";
  if (topology.inverted > 0 && topology.IsWatertight()) return "some parts inverted";
  return "consistent";
}

ordered_json Triple(const Eigen::Vector3f& v) { return {v.x(), v.y(), v.z()}; }

ordered_json MaterialsOf(const MeshFile& file) {
  std::vector<std::size_t> n_triangles(file.materials.size());
  for (const std::uint32_t m : file.material_of_triangle) {
    if (m < n_triangles.size()) ++n_triangles[m];
  }
  ordered_json materials = ordered_json::array();
  for (std::size_t i = 0; i < file.materials.size(); ++i) {
    const MeshMaterial& material = file.materials[i];
    if (n_triangles[i] == 0) continue;
    materials.push_back({{"name", material.name},
                         {"triangles", n_triangles[i]},
                         {"colour", Triple(material.base_colour)},
                         {"texture", material.texture},
                         {"metallic", material.metallic}});
  }
  return materials;
}

MeshFile Read(const std::filesystem::path& file) {
  try {
    return ReadMeshFile(file);
  } catch (const MeshFileError& error) {
    throw ConfigError(fmt::format("{}{}{}: {}", file.string(), error.place.empty() ? "" : ":",
                                  error.place, error.what()));
  }
}

}  // namespace

nlohmann::ordered_json MeshInfo(const std::filesystem::path& path) {
  const MeshFile file = Read(path);
  const MeshTopology topology = TopologyOf(file.mesh);
  const Eigen::AlignedBox3f box = BoundingBox(file.mesh);
  return {{"file", path.string()},
          {"triangles", file.mesh.triangles.size()},
          {"degenerate_triangles", file.degenerate},
          {"vertices", topology.vertices},
          {"parts", topology.parts},
          {"size", Triple(box.sizes())},
          {"centre", Triple(box.center())},
          {"units", UnitsOf(box.sizes().maxCoeff())},
          {"winding",
           {{"kind", WindingOf(topology)},
            {"watertight", topology.IsWatertight()},
            {"open_edges", topology.open_edges},
            {"turned_edges", topology.turned_edges},
            {"branching_edges", topology.branching_edges},
            {"inverted_parts", topology.inverted}}},
          {"materials", MaterialsOf(file)}};
}

std::string MeshInfoText(const nlohmann::ordered_json& info) {
  const auto triple = [](const ordered_json& v) {
    return fmt::format("{:.4g} {:.4g} {:.4g}", v[0].get<double>(), v[1].get<double>(),
                       v[2].get<double>());
  };
  const auto count = [&](const ordered_json& v) { return v.get<std::size_t>(); };
  const ordered_json& winding = info["winding"];
  std::vector<std::string> units;
  for (const ordered_json& unit : info["units"]) {
    units.push_back(fmt::format("{} (mesh.scale {:.4g}: {:.3g} m)", unit["unit"].get<std::string>(),
                                unit["scale"].get<double>(), unit["longest_side_m"].get<double>()));
  }
  std::string text = fmt::format(
      "{}\n  triangles  {} ({} more without area), {} vertices, {} part(s)\n"
      "  size       {} (x y z, in units of the file, z up)\n"
      "  centre     {}; mesh.offset_m: its negative, scaled, brings it to the origin\n"
      "  units      {}\n"
      "  winding    {}; {} ({} open, {} turned, {} branching edges)\n",
      info["file"].get<std::string>(), count(info["triangles"]),
      count(info["degenerate_triangles"]), count(info["vertices"]), count(info["parts"]),
      triple(info["size"]), triple(info["centre"]), fmt::join(units, " or "),
      winding["kind"].get<std::string>(),
      winding["watertight"].get<bool>() ? "watertight" : "not watertight",
      count(winding["open_edges"]), count(winding["turned_edges"]),
      count(winding["branching_edges"]));
  for (const ordered_json& m : info["materials"]) {
    const std::string texture = m["texture"];
    text += fmt::format("  material   '{}': {} triangles, linear RGB {}{}\n",
                        m["name"].get<std::string>(), count(m["triangles"]), triple(m["colour"]),
                        texture.empty() ? "" : ", texture " + texture);
  }
  return text;
}

}  // namespace windhover
