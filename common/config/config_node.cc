#include "common/config/config_node.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

namespace windhover {
namespace {

// The child that one part of a path names, or null.
const ConfigNode* Child(const ConfigNode& node, const std::string& part) {
  if (node.IsMap()) return node.Find(part);
  if (!node.IsList()) return nullptr;
  std::size_t index = 0;
  const char* end = part.data() + part.size();
  const auto [stop, error] = std::from_chars(part.data(), end, index);
  if (error != std::errc() || stop != end || index >= node.items.size()) return nullptr;
  return &node.items[index];
}

}  // namespace

std::string SourceLocation::ToString() const {
  return fmt::format("{}:{}:{}", source ? source->name : "?", line, column);
}

const ConfigNode* ConfigNode::Find(const std::string& key) const {
  const auto it = std::find_if(entries.begin(), entries.end(),
                               [&](const Entry& entry) { return entry.key == key; });
  return it == entries.end() ? nullptr : &it->value;
}

ConfigNode* ConfigNode::Find(const std::string& key) {
  return const_cast<ConfigNode*>(std::as_const(*this).Find(key));
}

std::string ConfigNode::Found() const {
  constexpr std::size_t kLongest = 80;
  switch (kind) {
    case Kind::kNothing:
      return "nothing";
    case Kind::kMap:
      return "a map";
    case Kind::kList:
      return fmt::format("a list of {}", items.size());
    case Kind::kScalar:
      break;
  }
  if (scalar.size() <= kLongest) return fmt::format("'{}'", scalar);
  return fmt::format("'{}…'", scalar.substr(0, kLongest));
}

const ConfigNode& NearestNode(const ConfigNode& root, const std::string& path) {
  const ConfigNode* node = &root;
  for (const std::string& part : SplitPath(path)) {
    const ConfigNode* child = Child(*node, part);
    if (child == nullptr) break;
    node = child;
  }
  return *node;
}

std::vector<std::string> SplitPath(const std::string& path) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  while (true) {
    const std::size_t dot = path.find('.', begin);
    parts.push_back(path.substr(begin, dot - begin));
    if (dot == std::string::npos) return parts;
    begin = dot + 1;
  }
}

void MergeInto(ConfigNode& base, const ConfigNode& over) {
  if (!base.IsMap() || !over.IsMap()) {
    base = over;
    return;
  }
  const std::size_t n_inherited = base.entries.size();
  for (const ConfigNode::Entry& entry : over.entries) {
    const auto end = base.entries.begin() + static_cast<std::ptrdiff_t>(n_inherited);
    const auto inherited =
        std::find_if(base.entries.begin(), end,
                     [&](const ConfigNode::Entry& other) { return other.key == entry.key; });
    // A key repeated within one file stays repeated, for the reader to report.
    if (inherited == end || inherited->where.source == entry.where.source) {
      base.entries.push_back(entry);
    } else {
      MergeInto(inherited->value, entry.value);
      inherited->where = entry.where;
    }
  }
}

}  // namespace windhover
