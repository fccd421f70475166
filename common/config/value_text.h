#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include <fmt/format.h>

#include "common/config/config_node.h"
#include "common/config/fields.h"

// How single values are read from YAML, written to it, and described in messages.
namespace windhover {

// --- Reading: false if the node is not of the type. ------------------------------------------
bool ReadValue(const ConfigNode& node, double& value);
bool ReadValue(const ConfigNode& node, int& value);
bool ReadValue(const ConfigNode& node, std::uint64_t& value);
bool ReadValue(const ConfigNode& node, bool& value);
bool ReadValue(const ConfigNode& node, std::string& value);
bool ReadValue(const ConfigNode& node, std::vector<std::string>& value);
bool ReadValue(const ConfigNode& node, InputFile& value);

template <typename T, std::size_t N>
bool ReadValue(const ConfigNode& node, std::array<T, N>& value) {
  if (!node.IsList() || node.items.size() != N) return false;
  for (std::size_t i = 0; i < N; ++i) {
    if (!ReadValue(node.items[i], value[i])) return false;
  }
  return true;
}

template <typename Enum>
requires std::is_enum_v<Enum>
bool ReadValue(const ConfigNode& node, Enum& value) {
  if (!node.IsScalar()) return false;
  const auto& names = kEnumNames<Enum>;
  for (std::size_t i = 0; i < names.count; ++i) {
    if (node.scalar != names.names[i].second) continue;
    value = names.names[i].first;
    return true;
  }
  return false;
}

// --- Writing: text that reads back as the same value. ----------------------------------------
std::string WriteValue(double value);
std::string WriteValue(int value);
std::string WriteValue(std::uint64_t value);
std::string WriteValue(bool value);
std::string WriteValue(const std::string& value);
std::string WriteValue(const std::vector<std::string>& value);

template <typename T, std::size_t N>
std::string WriteValue(const std::array<T, N>& value) {
  std::string text;
  for (const T& item : value) text += (text.empty() ? "" : ", ") + WriteValue(item);
  return "[" + text + "]";
}

template <typename Enum>
requires std::is_enum_v<Enum> std::string WriteValue(Enum value) {
  const auto& names = kEnumNames<Enum>;
  for (std::size_t i = 0; i < names.count; ++i) {
    if (names.names[i].first == value) return names.names[i].second;
  }
  return "";
}

// --- Types: "number", "2 whole numbers", … ----------------------------------------------------
template <typename T>
struct ValueType;
template <>
struct ValueType<double> {
  static std::string Name() { return "number"; }
  static std::string Described() { return "a number"; }
};
template <>
struct ValueType<int> {
  static std::string Name() { return "whole number"; }
  static std::string Described() { return "a whole number"; }
};
template <>
struct ValueType<std::uint64_t> : ValueType<int> {};
template <>
struct ValueType<bool> {
  static std::string Name() { return "true or false"; }
};
template <>
struct ValueType<std::string> {
  static std::string Name() { return "text"; }
};
template <>
struct ValueType<std::vector<std::string>> {
  static std::string Name() { return "list of words"; }
};
template <>
struct ValueType<InputFile> {
  static std::string Name() { return "file"; }
};
template <typename T, std::size_t N>
struct ValueType<std::array<T, N>> {
  static std::string Name() { return fmt::format("{} {}s", N, ValueType<T>::Name()); }
  static std::string Described() { return fmt::format("a list of {}, each", Name()); }
};
template <typename Enum>
requires std::is_enum_v<Enum>
struct ValueType<Enum> {
  static std::string Name() { return "word"; }
};

// --- Limits: what is allowed, in words. --------------------------------------------------------
std::string Described(const std::vector<std::string>& words);  ///< "a, b or c".
inline bool Within(const InRange& limit, double value) {
  return limit.low <= value && value <= limit.high;  // False for NaN.
}

/// "between 0.1 and 10" for the key reference; Expected() adds the type for messages.
template <typename T>
std::string Described(const T&, const InRange& limit) {
  return fmt::format("{} … {}", limit.low, limit.high);
}
template <typename T>
std::string Expected(const T&, const InRange& limit) {
  return fmt::format("{} between {} and {}", ValueType<T>::Described(), limit.low, limit.high);
}
inline bool Allows(const InRange& limit, double value) { return Within(limit, value); }
inline bool Allows(const InRange& limit, std::uint64_t value) {
  return Within(limit, static_cast<double>(value));
}
inline bool Allows(const InRange& limit, int value) { return Within(limit, value); }
template <typename T, std::size_t N>
bool Allows(const InRange& limit, const std::array<T, N>& value) {
  for (const T& item : value) {
    if (!Within(limit, item)) return false;
  }
  return true;
}

inline std::string Described(bool, const AnyBool&) { return ""; }
inline std::string Expected(bool, const AnyBool&) { return "true or false"; }
inline bool Allows(const AnyBool&, bool) { return true; }

template <typename Enum>
std::string Described(const Enum&, const AnyEnum&) {
  std::vector<std::string> words;
  const auto& names = kEnumNames<Enum>;
  for (std::size_t i = 0; i < names.count; ++i) words.emplace_back(names.names[i].second);
  return Described(words);
}
template <typename Enum>
std::string Expected(const Enum& value, const AnyEnum& limit) {
  return "one of " + Described(value, limit);
}
template <typename Enum>
bool Allows(const AnyEnum&, const Enum&) {
  return true;
}

template <typename T>
std::string Described(const T&, const NotEmpty&) {
  return "not empty";
}
inline std::string Expected(const std::string&, const NotEmpty&) { return "text, not empty"; }
inline std::string Expected(const InputFile&, const NotEmpty&) { return "the name of a file"; }
template <typename T>
bool Allows(const NotEmpty&, const T& value) {
  return !value.empty();
}

template <typename T>
std::string Described(const T&, const MayBeEmpty&) {
  return "may be empty";
}
inline std::string Expected(const std::string&, const MayBeEmpty&) { return "text"; }
inline std::string Expected(const std::vector<std::string>&, const MayBeEmpty&) {
  return "a list of words";
}
inline std::string Expected(const InputFile&, const MayBeEmpty&) { return "the name of a file"; }
template <typename T>
bool Allows(const MayBeEmpty&, const T&) {
  return true;
}

inline std::string Described(double, const Optional&) { return "may be left out"; }
inline std::string Expected(double, const Optional&) { return "a finite number"; }
inline bool Allows(const Optional&, double value) { return std::isfinite(value); }

std::string Described(const std::string&, const OneOf& limit);
std::string Expected(const std::string&, const OneOf& limit);
bool Allows(const OneOf& limit, const std::string& value);

std::string Described(const std::vector<std::string>&, const ItemsOneOf& limit);
std::string Expected(const std::vector<std::string>&, const ItemsOneOf& limit);
bool Allows(const ItemsOneOf& limit, const std::vector<std::string>& value);

}  // namespace windhover
