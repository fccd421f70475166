#include "render/mesh_checks.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace windhover {
namespace {

constexpr std::uintmax_t kMaxBytes = std::uintmax_t{256} << 20;

std::string LowerExtension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

std::string ContentOf(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) throw MeshFileError("no such mesh file");
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  if (error || bytes == 0) throw MeshFileError("mesh file is empty or cannot be read");
  if (bytes > kMaxBytes) throw MeshFileError("mesh file is larger than 256 MiB");
  std::string content(bytes, '\0');
  std::ifstream in(file, std::ios::binary);
  if (!in.read(content.data(), static_cast<std::streamsize>(bytes))) {
    throw MeshFileError("mesh file cannot be read");
  }
  return content;
}

bool IsBinaryStl(const std::string& content) {
  if (content.size() < 84) return false;
  std::uint32_t n = 0;
  std::memcpy(&n, content.data() + 80, 4);
  return content.size() == 84 + std::size_t{50} * n;
}

// The extension that the content's first bytes ask for; empty if they do not say.
std::string ExtensionByContent(const std::string& content) {
  const auto begins = [&](const char* word) { return content.rfind(word, 0) == 0; };
  if (begins("glTF")) return ".glb";
  if (begins("ply\n") || begins("ply\r")) return ".ply";
  if (begins("\x89PNG") || begins("\xff\xd8\xff")) return "of an image";
  if (IsBinaryStl(content) || (begins("solid") && content.find("facet") < 1000)) return ".stl";
  if (content.substr(0, 1000).find("<COLLADA") != std::string::npos) return ".dae";
  return "";
}

void CheckExtension(const std::string& extension, const std::string& content) {
  const std::string expected = ExtensionByContent(content);
  if (expected.empty() || expected == extension) return;
  throw MeshFileError(fmt::format("its content is that of a file {}, not {}", expected, extension));
}

// One line of an OBJ file at a time.
class ObjChecker {
 public:
  void Check(const char* line, int number) {
    number_ = number;
    if (line[0] == 'v' && std::isblank(static_cast<unsigned char>(line[1])) != 0) Vertex(line + 2);
    if (line[0] == 'f' && std::isblank(static_cast<unsigned char>(line[1])) != 0) Face(line + 2);
  }
  void End() const {
    if (highest_ <= n_vertices_) return;
    throw MeshFileError(fmt::format("face of vertex {}, but there are {}", highest_, n_vertices_),
                        fmt::format("{}", highest_line_));
  }

 private:
  void Vertex(const char* text) {
    ++n_vertices_;
    for (int axis = 0; axis < 3; ++axis) {
      char* end = nullptr;
      const double value = std::strtod(text, &end);
      if (end == text || !std::isfinite(value) || std::abs(value) > 1e30) {
        throw MeshFileError("vertex must have three finite coordinates",
                            fmt::format("{}", number_));
      }
      text = end;
    }
  }
  void Face(const char* text) {
    for (char* end = nullptr;; text = end) {
      const long index = std::strtol(text, &end, 10);
      if (end == text) return;
      if (index == 0 || index < -n_vertices_) {
        throw MeshFileError(fmt::format("face of vertex {}, which cannot be", index),
                            fmt::format("{}", number_));
      }
      if (index > highest_) {
        highest_ = index;
        highest_line_ = number_;
      }
      while (*end != '\0' && std::isspace(static_cast<unsigned char>(*end)) == 0) ++end;
    }
  }

  int number_ = 0, highest_line_ = 0;
  long n_vertices_ = 0, highest_ = 0;
};

void CheckObj(const std::string& content) {
  ObjChecker checker;
  int number = 0;
  for (std::size_t begin = 0; begin < content.size();) {
    const std::size_t end = std::min(content.find('\n', begin), content.size());
    checker.Check(content.substr(begin, end - begin).c_str(), ++number);
    begin = end + 1;
  }
  checker.End();
}

std::string JsonOf(const std::string& content, const std::string& extension) {
  if (extension == ".gltf") return content;
  std::uint32_t length = 0;
  if (content.size() >= 20) std::memcpy(&length, content.data() + 12, 4);
  if (content.size() < 20 || length > content.size() - 20) {
    throw MeshFileError("glTF is cut short");
  }
  return content.substr(20, length);
}

// 1-based line and column of a byte.
std::string PlaceOf(const std::string& text, std::size_t byte) {
  const std::string before = text.substr(0, byte == 0 ? 0 : byte - 1);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t last = before.rfind('\n');
  return fmt::format("{}:{}", line, before.size() - (last == std::string::npos ? 0 : last + 1) + 1);
}

std::vector<std::vector<std::size_t>> ChildrenOfNodes(const nlohmann::json& gltf) {
  std::vector<std::vector<std::size_t>> children;
  if (!gltf.is_object() || !gltf.contains("nodes")) return children;
  const nlohmann::json& nodes = gltf["nodes"];
  if (!nodes.is_array()) throw MeshFileError("nodes must be an array");
  for (const nlohmann::json& node : nodes) {
    children.emplace_back();
    if (!node.is_object() || !node.contains("children")) continue;
    if (!node["children"].is_array()) throw MeshFileError("children of a node must be an array");
    for (const nlohmann::json& child : node["children"]) {
      if (!child.is_number_unsigned() || child.get<std::size_t>() >= nodes.size()) {
        throw MeshFileError(fmt::format("node {} has a child that is not there ({})",
                                        children.size() - 1, child.dump()));
      }
      children.back().push_back(child.get<std::size_t>());
    }
  }
  return children;
}

// In a forest each node is the child of at most one; then a circle has no way in from a root.
void CheckGltf(const std::string& json_text) {
  nlohmann::json gltf;
  try {
    gltf = nlohmann::json::parse(json_text);
  } catch (const nlohmann::json::parse_error& error) {
    throw MeshFileError("glTF is no JSON", PlaceOf(json_text, error.byte));
  }
  const auto children = ChildrenOfNodes(gltf);
  std::vector<int> n_parents(children.size());
  for (const auto& list : children) {
    for (const std::size_t child : list) {
      if (++n_parents[child] > 1) {
        throw MeshFileError(fmt::format("node {} is the child of more than one node", child));
      }
    }
  }
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < children.size(); ++i) {
    if (n_parents[i] == 0) open.push_back(i);
  }
  std::size_t n_reached = 0;
  for (; !open.empty(); ++n_reached) {
    const std::size_t node = open.back();
    open.pop_back();
    open.insert(open.end(), children[node].begin(), children[node].end());
  }
  if (n_reached != children.size()) throw MeshFileError("nodes go in circles");
}

}  // namespace

void CheckMeshFile(const std::filesystem::path& file) {
  const std::string content = ContentOf(file);
  const std::string extension = LowerExtension(file);
  CheckExtension(extension, content);
  if (extension == ".ply" && content.find("end_header") == content.npos) {
    throw MeshFileError("PLY is cut short");
  }
  if (extension == ".obj") CheckObj(content);
  if (extension == ".gltf" || extension == ".glb") CheckGltf(JsonOf(content, extension));
}

}  // namespace windhover
