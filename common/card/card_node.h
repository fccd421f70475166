#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "common/config/fields.h"

namespace windhover {

/// A value of a card (JSON that tells what was learned) and the keys that lead there. Every
/// mistake is a ConfigError `NAME: KEY: must be … (found …)`.
class CardNode {
 public:
  using Json = nlohmann::ordered_json;

  /// @param json must outlive the node. @param name of the card. @param path keys that lead here.
  CardNode(const Json& json, std::string name, std::string path = "")
      : json_(json), name_(std::move(name)), path_(std::move(path)) {}

  [[noreturn]] void MustBe(const std::string& must, const std::string& found) const;

  CardNode operator[](const std::string& key) const;
  bool Has(const std::string& key) const { return json_.is_object() && json_.contains(key); }
  /// Of a list of 1 to `most`.
  std::vector<CardNode> Items(std::size_t most) const;
  double Number(double low, double high) const;
  /// Exactly `n`, none beyond ±1e6.
  std::vector<float> Numbers(int n) const;
  /// Words of 1 to 200 bytes.
  std::string Text() const;
  /// It is an object and has no keys but these.
  void AllowOnly(std::initializer_list<const char*> keys) const;

  const Json& json() const { return json_; }

 private:
  void RequireObject() const;
  std::string Found() const;

  const Json& json_;
  std::string name_, path_;
};

/// @throws ConfigError `NAME:LINE:COLUMN: …` where `text` is no JSON.
CardNode::Json ParseCardJson(const std::string& text, const std::string& name);

/// Requires "format": `format` and "version": 1.
void CheckCardFormat(const CardNode& root, const char* format);

/// What a file has to say. @throws ConfigError if it cannot be read or is larger than `max_bytes`.
std::string ReadCardText(const std::filesystem::path& file, std::uintmax_t max_bytes);

}  // namespace windhover
