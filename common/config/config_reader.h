#pragma once

#include <string>
#include <vector>

#include "common/config/config_node.h"
#include "common/config/fields.h"
#include "common/config/findings.h"
#include "common/config/value_text.h"

namespace windhover {

/// Fills a struct from a tree through its `Fields` (fields.h), strictly: an unknown key, a
/// repeated one, a wrong type or a value outside its limits is a finding. A value that is
/// wrong, or left out, leaves the member as it was.
class ConfigReader {
 public:
  /// `path` is the dotted path of `node`, "" for the root.
  ConfigReader(const ConfigNode& node, std::string path, Findings& findings)
      : node_(node), path_(std::move(path)), findings_(findings) {}

  template <typename T, typename Limit>
  void Field(const char* key, T& value, const Limit& limit, const char* /*meaning*/) {
    const ConfigNode* child = Take(key);
    if (child == nullptr) return RequireInitial(key, value, limit);
    if (IsLeftOut(limit, *child)) return;
    T read{};
    if (ReadValue(*child, read) && Allows(limit, read)) {
      value = read;
    } else {
      findings_.MustBe(child->where, Join(key), Expected(value, limit), child->Found());
    }
  }

  template <typename Struct>
  void Section(const char* key, Struct& value, const char* /*meaning*/) {
    const ConfigNode* child = Take(key);
    if (child != nullptr) ReadStruct(*child, Join(key), value);
  }

  template <typename Struct>
  void List(const char* key, std::vector<Struct>& values, const char* /*meaning*/) {
    const ConfigNode* child = Take(key);
    if (child == nullptr) return;
    if (!child->IsList()) {
      return findings_.MustBe(child->where, Join(key), "a list", child->Found());
    }
    values.clear();
    for (std::size_t i = 0; i < child->items.size(); ++i) {
      ReadStruct(child->items[i], fmt::format("{}.{}", Join(key), i), values.emplace_back());
    }
  }

  /// Reports what no Field, Section or List has asked for; call after Fields.
  void ReportOtherKeys();

 private:
  template <typename Struct>
  void ReadStruct(const ConfigNode& node, const std::string& path, Struct& value) {
    if (!node.IsMap()) return findings_.MustBe(node.where, path, "a map", node.Found());
    ConfigReader reader(node, path, findings_);
    value.Fields(reader);
    reader.ReportOtherKeys();
  }

  template <typename T, typename Limit>
  void RequireInitial(const char*, const T&, const Limit&) {}
  template <typename T>
  void RequireInitial(const char* key, const T& value, const NotEmpty& limit) {
    if (Allows(limit, value)) return;
    findings_.MustBe(node_.where, Join(key), Expected(value, limit), "nothing");
  }

  template <typename Limit>
  static bool IsLeftOut(const Limit&, const ConfigNode&) {
    return false;
  }
  static bool IsLeftOut(const Optional&, const ConfigNode& child) {
    return child.kind == ConfigNode::Kind::kNothing;
  }

  const ConfigNode* Take(const char* key);
  std::string Join(const std::string& key) const { return path_.empty() ? key : path_ + "." + key; }

  const ConfigNode& node_;
  std::string path_;
  Findings& findings_;
  std::vector<std::string> known_keys_;
};

/// Reads `root` into `value`; what is wrong with it is added to `findings`.
template <typename Struct>
void ReadConfig(const ConfigNode& root, Struct& value, Findings& findings) {
  if (!root.IsMap()) return findings.MustBe(root.where, "the file", "a map", root.Found());
  ConfigReader reader(root, "", findings);
  value.Fields(reader);
  reader.ReportOtherKeys();
}

}  // namespace windhover
