#pragma once

#include <string>
#include <vector>

#include "common/config/fields.h"
#include "common/config/value_text.h"

namespace windhover {

/// Writes a struct as YAML through its `Fields`, every key with its value. Numbers are the
/// shortest text that reads back as the same bits.
class ConfigWriter {
 public:
  explicit ConfigWriter(PathStyle style) : style_(style) {}

  template <typename T, typename Limit>
  void Field(const char* key, T& value, const Limit&, const char* /*meaning*/) {
    Line(key, WriteValue(value));
  }
  void Field(const char* key, double& value, const Optional&, const char* /*meaning*/) {
    if (std::isfinite(value)) Line(key, WriteValue(value));
  }
  template <typename Limit>
  void Field(const char* key, InputFile& value, const Limit&, const char* /*meaning*/) {
    Line(key, WriteValue(NameOf(value)));
  }

  template <typename Struct>
  void Section(const char* key, Struct& value, const char* /*meaning*/) {
    Line(key, "");
    depth_ += 1;
    value.Fields(*this);
    depth_ -= 1;
  }

  template <typename Struct>
  void List(const char* key, std::vector<Struct>& values, const char* /*meaning*/) {
    Line(key, values.empty() ? "[]" : "");
    depth_ += 2;
    for (Struct& value : values) {
      starts_item_ = true;
      value.Fields(*this);
    }
    depth_ -= 2;
  }

  const std::string& text() const { return text_; }

 private:
  std::string NameOf(const InputFile& file) const;
  void Line(const std::string& key, const std::string& value);

  PathStyle style_;
  int depth_ = 0;
  bool starts_item_ = false;  // The next line is the first of a list's item.
  std::string text_;
};

/// `value` as YAML; reading it back gives the same struct and the same text.
template <typename Struct>
std::string WriteConfig(Struct value, PathStyle style) {
  ConfigWriter writer(style);
  value.Fields(writer);
  return writer.text();
}

}  // namespace windhover
