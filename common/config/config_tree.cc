#include "common/config/config_tree.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

#include "common/config/fields.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxFileBytes = 1 << 20;
constexpr std::size_t kMaxChain = 16;

std::string ReadText(const fs::path& file, const std::string& where) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) {
    throw ConfigError(fmt::format("{}: must be a readable file (found {})", where,
                                  fs::exists(file, error) ? "something else" : "no such file"));
  }
  const std::uintmax_t size = fs::file_size(file, error);
  if (size > kMaxFileBytes) {
    throw ConfigError(
        fmt::format("{}: must be at most {} bytes (found {})", where, kMaxFileBytes, size));
  }
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) throw ConfigError(fmt::format("{}: must be a readable file (found no access)", where));
  return text.str();
}

// Takes `extends` out of a tree; returns the file it names, or "" where there is none.
fs::path TakeExtends(ConfigNode& root, const fs::path& folder, std::string* where) {
  if (!root.IsMap()) return {};
  if (root.Find("extends") == nullptr) return {};
  const ConfigNode extends = TakeNode(root, "extends");
  *where = extends.where.ToString() + ": extends";
  if (!extends.IsScalar() || extends.scalar.empty()) {
    throw ConfigError(
        fmt::format("{}: must be the name of a file (found {})", *where, extends.Found()));
  }
  return (folder / extends.scalar).lexically_normal();
}

ConfigNode LoadChain(const fs::path& file, const std::string& where, std::vector<fs::path> chain) {
  const std::string text = ReadText(file, where);
  std::error_code error;
  const fs::path identity = fs::weakly_canonical(file, error);
  if (std::count(chain.begin(), chain.end(), identity) > 0 || chain.size() >= kMaxChain) {
    throw ConfigError(
        fmt::format("{}: must not lead back to itself (found '{}')", where, file.string()));
  }
  chain.push_back(identity);
  ConfigNode root = ParseYaml(text, {file.string(), file.parent_path()});
  std::string extends_where;
  const fs::path base_file = TakeExtends(root, file.parent_path(), &extends_where);
  if (base_file.empty()) return root;
  ConfigNode base = LoadChain(base_file, extends_where, chain);
  MergeInto(base, root);
  base.where = root.where;
  return base;
}

[[noreturn]] void RefuseOverride(const SourceLocation& where, const std::string& path,
                                 const std::string& must_be, const std::string& found) {
  throw ConfigError(
      fmt::format("{}: {}: must be {} (found {})", where.ToString(), path, must_be, found));
}

ConfigNode& ItemOf(ConfigNode& list, const std::string& part, const SourceLocation& where,
                   const std::string& path) {
  std::size_t index = 0;
  const char* end = part.data() + part.size();
  const auto [stop, error] = std::from_chars(part.data(), end, index);
  if (error != std::errc() || stop != end || index >= list.items.size()) {
    RefuseOverride(where, path, fmt::format("an index below {}", list.items.size()),
                   fmt::format("'{}'", part));
  }
  return list.items[index];
}

// The child of `node` that `part` names; made, in a map, if it is not there.
ConfigNode& Descend(ConfigNode& node, const std::string& part, const SourceLocation& where,
                    const std::string& path) {
  if (node.IsList()) return ItemOf(node, part, where, path);
  if (node.IsScalar()) RefuseOverride(where, path, "a key inside a section", node.Found());
  node.kind = ConfigNode::Kind::kMap;
  if (ConfigNode* child = node.Find(part)) return *child;
  ConfigNode nothing;
  nothing.where = where;
  node.entries.push_back({part, where, nothing});
  return node.entries.back().value;
}

}  // namespace

ConfigNode LoadConfigTree(const fs::path& file) { return LoadChain(file, file.string(), {}); }

void SetNode(ConfigNode& root, const std::string& path, const SourceLocation& where,
             const ConfigNode& value) {
  ConfigNode* node = &root;
  for (const std::string& part : SplitPath(path)) node = &Descend(*node, part, where, path);
  MergeInto(*node, value);
}

ConfigNode TakeNode(ConfigNode& root, const std::string& key) {
  const auto it = std::find_if(root.entries.begin(), root.entries.end(),
                               [&](const auto& entry) { return entry.key == key; });
  if (it == root.entries.end()) return {};
  ConfigNode value = std::move(it->value);
  root.entries.erase(it);
  return value;
}

void ApplyOverride(ConfigNode& root, const std::string& assignment, int ordinal) {
  const auto source =
      std::make_shared<const ConfigSource>(ConfigSource{"--set", fs::current_path()});
  const SourceLocation where{source, ordinal, 1};
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0) {
    RefuseOverride(where, assignment, "of the form key.path=value",
                   fmt::format("'{}'", assignment));
  }
  const std::string path = assignment.substr(0, equals);
  // Padding puts the value on its line and column, so that messages point at the option.
  const std::string padding(static_cast<std::size_t>(ordinal) - 1, '\n');
  const std::string indent(equals + 1, ' ');
  const ConfigNode value = ParseYaml(padding + indent + assignment.substr(equals + 1), *source);
  SetNode(root, path, where, value);
}

}  // namespace windhover
