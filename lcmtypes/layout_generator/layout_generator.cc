// windhover-layouts OUT_DIR FILE.lcm...: writes OUT_DIR/TYPE.hpp, which is lcm-gen's header plus
// the type's MessageLayout (lcmtypes/bounded_reader.h), and OUT_DIR/layouts.h with all of them.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "lcmtypes/layout_generator/lcm_schema.h"

namespace windhover {
namespace {

constexpr std::size_t kMaxBytes = 64 << 20;       // a message with pixels
constexpr std::size_t kMaxPlainBytes = 16 << 20;  // any other that has arrays or strings

// What one element of a struct needs at least and at most.
struct Size {
  std::size_t least = 0;
  bool fixed = true;
  bool has_bytes = false;
};

using Schema = std::map<std::string, LcmStruct>;

Size SizeOf(const Schema& schema, const std::string& type) {
  if (const std::size_t bytes = PrimitiveBytes(type)) return {.least = bytes};
  if (type == "string") return {.least = 5, .fixed = false};
  Size total;
  for (const LcmMember& member : schema.at(type).members) {
    const Size element = SizeOf(schema, member.type);
    total.has_bytes |= element.has_bytes || (member.type == "byte" && !member.count.empty());
    total.fixed &= element.fixed && member.count.empty();
    if (member.count.empty())
      total.least += element.least * std::max<std::size_t>(member.n_fixed, 1);
  }
  return total;
}

// The statements that walk over one member.
std::string WalkStatement(const LcmMember& member) {
  const std::string label = fmt::format("\"{}\"", member.name);
  if (member.is_count) {
    return fmt::format("const std::size_t {} = in.Count({});", member.name, label);
  }
  const std::string n = member.count.empty()
                            ? fmt::format("{}", std::max<std::size_t>(member.n_fixed, 1))
                            : member.count;
  if (const std::size_t bytes = PrimitiveBytes(member.type)) {
    return fmt::format("in.SkipArray({}, {}, {});", n, bytes, label);
  }
  const bool is_string = member.type == "string";
  const std::string least =
      is_string ? "5" : fmt::format("MessageLayout<{}>::kMinBytes", member.type);
  const std::string step = is_string ? fmt::format("in.SkipString({})", label)
                                     : fmt::format("MessageLayout<{}>::Walk(in)", member.type);
  return fmt::format("in.Room({0}, {1}, {2});\n    for (std::size_t i = 0; i < {0}; ++i) {3};", n,
                     least, label, step);
}

// The statements that compare one member's size with its count.
std::string CheckStatement(const std::string& owner, const LcmMember& member) {
  std::string result;
  if (!member.count.empty()) {
    result += fmt::format("    RequireCount(\"{0}.{1}\", m.{2}, m.{1}.size());\n", owner,
                          member.name, member.count);
  }
  if (PrimitiveBytes(member.type) != 0 || member.type == "string") return result;
  const bool is_array = !member.count.empty() || member.n_fixed > 0;
  result +=
      is_array
          ? fmt::format("    for (const auto& e : m.{}) MessageLayout<{}>::CheckCounts(e);\n",
                        member.name, member.type)
          : fmt::format("    MessageLayout<{1}>::CheckCounts(m.{0});\n", member.name, member.type);
  return result;
}

std::string Header(const Schema& schema, const LcmStruct& type) {
  std::set<std::string> parts;
  std::string walk, check, includes;
  for (const LcmMember& member : type.members) {
    if (schema.contains(member.type)) parts.insert(member.type);
    walk += "    " + WalkStatement(member) + "\n";
    check += CheckStatement(type.name, member);
  }
  for (const std::string& part : parts)
    includes += fmt::format("#include \"lcmtypes/{}.hpp\"\n", part);
  const Size size = SizeOf(schema, type.name);
  const std::size_t most = size.fixed       ? size.least + 8
                           : size.has_bytes ? kMaxBytes
                                            : kMaxPlainBytes;
  return fmt::format(R"(#pragma once
#include "lcmtypes/bounded_reader.h"
{0}#include "windhover/{1}.hpp"

namespace windhover {{

template <>
struct MessageLayout<{1}> {{
  static constexpr const char* kName = "{1}";
  static constexpr std::size_t kMinBytes = {2};
  static constexpr std::size_t kMaxBytes = {3};

  static void Walk([[maybe_unused]] BoundedReader& in) {{
{4}  }}

  static void CheckCounts([[maybe_unused]] const {1}& m) {{
{5}  }}
}};

}}  // namespace windhover
)",
                     includes, type.name, size.least, most, walk, check);
}

std::string AllLayouts(const Schema& schema) {
  std::string includes, names;
  for (const auto& [name, type] : schema) {
    includes += fmt::format("#include \"lcmtypes/{}.hpp\"\n", name);
    names += fmt::format("{}\n    {}", names.empty() ? "" : ",", name);
  }
  return fmt::format(R"(#pragma once
{}
namespace windhover {{

/// Every message type of this project, sorted by name.
template <template <typename...> class List>
using WithAllMessages = List<{}>;

}}  // namespace windhover
)",
                     includes, names);
}

// Leaves an up-to-date file alone, so that a change of one message rebuilds only its readers.
void WriteIfChanged(const std::filesystem::path& file, const std::string& text) {
  std::ifstream old(file, std::ios::binary);
  if (old && std::string(std::istreambuf_iterator<char>(old), {}) == text) return;
  std::ofstream out(file, std::ios::binary);
  out << text;
  if (!out.flush()) throw std::runtime_error(fmt::format("{}: cannot be written", file.string()));
}

void Generate(const std::vector<std::string>& args) {
  const std::filesystem::path out_dir = args.at(0);
  Schema schema;
  for (std::size_t i = 1; i < args.size(); ++i) {
    const LcmStruct type = ReadLcmFile(args[i]);
    schema[type.name] = type;
  }
  std::filesystem::create_directories(out_dir);
  for (const auto& [name, type] : schema) {
    for (const LcmMember& member : type.members) {
      if (PrimitiveBytes(member.type) == 0 && member.type != "string" &&
          !schema.contains(member.type)) {
        throw std::runtime_error(fmt::format("{}.lcm: unknown type '{}'", name, member.type));
      }
    }
    WriteIfChanged(out_dir / (name + ".hpp"), Header(schema, type));
  }
  WriteIfChanged(out_dir / "layouts.h", AllLayouts(schema));
}

}  // namespace
}  // namespace windhover

int main(int argc, char** argv) {
  const std::vector<std::string> args(argv + 1, argv + argc);
  if (args.empty() || args[0] == "--help") {
    std::cout << "Usage: windhover-layouts OUT_DIR FILE.lcm...\n";
    return args.empty() ? 2 : 0;
  }
  try {
    windhover::Generate(args);
    return 0;
  } catch (const std::exception& e) {
    std::cerr << "windhover-layouts: error: " << e.what() << "\n";
    return 2;
  }
}
