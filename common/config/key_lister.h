#pragma once

#include <string>
#include <vector>

#include "common/config/fields.h"
#include "common/config/value_text.h"

namespace windhover {

/// What there is to know about one key.
struct KeyDescription {
  std::string path;  ///< "aircraft.N.position_m"; N is an index.
  std::string type, unit, limits, initial, meaning;
};

/// Unit that the name of a key ends in ("m", "px", "m/s"), or "".
std::string UnitOfKey(const std::string& key);

/// Lists every key of a struct through its `Fields`.
class KeyLister {
 public:
  template <typename T, typename Limit>
  void Field(const char* key, T& value, const Limit& limit, const char* meaning) {
    keys_.push_back({prefix_ + key, ValueType<T>::Name(), UnitOfKey(key), Described(value, limit),
                     WriteValue(value), meaning});
  }
  void Field(const char* key, double& value, const Optional& limit, const char* meaning) {
    keys_.push_back(
        {prefix_ + key, "number", UnitOfKey(key), Described(value, limit), "", meaning});
  }
  template <typename Limit>
  void Field(const char* key, InputFile& value, const Limit& limit, const char* meaning) {
    keys_.push_back(
        {prefix_ + key, "file", "", Described(value, limit), WriteValue(value.as_given), meaning});
  }

  template <typename Struct>
  void Section(const char* key, Struct& value, const char* meaning) {
    Descend(std::string(key) + ".", "section", meaning, value);
  }
  template <typename Struct>
  void List(const char* key, std::vector<Struct>&, const char* meaning) {
    Struct item;
    Descend(std::string(key) + ".N.", "list", meaning, item);
  }

  const std::vector<KeyDescription>& keys() const { return keys_; }

 private:
  template <typename Struct>
  void Descend(const std::string& step, const char* type, const char* meaning, Struct& value) {
    const std::string outer = prefix_;
    const std::string name = step.substr(0, step.find('.'));
    keys_.push_back({outer + name, type, "", "", "", meaning});
    prefix_ += step;
    value.Fields(*this);
    prefix_ = outer;
  }

  std::string prefix_;
  std::vector<KeyDescription> keys_;
};

/// Every key of `Struct`, with its initial values, in the order of its Fields.
template <typename Struct>
std::vector<KeyDescription> ListKeys() {
  Struct value;
  KeyLister lister;
  value.Fields(lister);
  return lister.keys();
}

}  // namespace windhover
