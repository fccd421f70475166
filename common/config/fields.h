#pragma once

#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace windhover {

/// Everything wrong with configuration or input files, one finding per line, in the form
/// compilers use: `FILE:LINE:COLUMN: key.path: must be … (found …)`.
class ConfigError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

// A config struct describes itself once,
//
//     template <typename Visitor> void Fields(Visitor& v) {
//       v.Field("key", member, Limit{…}, "meaning");     // one value; the unit is in the key
//       v.Section("key", member, "meaning");             // a struct with Fields
//       v.List("key", vector_of_structs, "meaning");
//     }
//
// and the strict reader, the limits, `windhover keys`, resolved.yaml and --set all follow.
// A key that the file leaves out keeps the member's initial value, except under NotEmpty.

/// An input file as named in a scenario, and where it is.
struct InputFile {
  std::string as_given;
  std::string absolute;  ///< Relative names are taken from the folder of the file that has them.
  std::string where;     ///< file:line:col of the name, for messages about the file's content.

  bool empty() const { return as_given.empty(); }
};

/// How the names of input files are written: kNameOnly leaves out folders, which differ between
/// machines.
enum class PathStyle { kAsGiven, kAbsolute, kNameOnly };

/// The names of an enum in YAML; specialise kEnumNames for each enum.
template <typename Enum>
struct EnumNames {
  constexpr EnumNames(std::initializer_list<std::pair<Enum, const char*>> list) {
    for (const auto& entry : list) names[count++] = entry;
  }
  std::array<std::pair<Enum, const char*>, 16> names{};
  std::size_t count = 0;
};
template <typename Enum>
inline constexpr EnumNames<Enum> kEnumNames{};

/// "Not given", for Optional numbers.
inline constexpr double kUnset = std::numeric_limits<double>::quiet_NaN();

// --- Limits: each says what it allows. The reader turns them into messages. ------------------

struct InRange {
  double low, high;  ///< Inclusive; of each element of an array.
};
struct AnyBool {};
struct AnyEnum {};
struct NotEmpty {};
struct MayBeEmpty {};
struct Optional {};  ///< A finite number, or left out: kUnset.
struct OneOf {
  std::vector<std::string> values;
};
struct ItemsOneOf {  ///< A list of distinct words, at least one.
  std::vector<std::string> values;
};

}  // namespace windhover
