#include "lcmtypes/layout_generator/lcm_schema.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <map>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace windhover {
namespace {

// Words and single punctuation characters, comments left out.
std::vector<std::string> Tokens(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(fmt::format("{}: cannot be read", file.string()));
  std::vector<std::string> tokens;
  for (std::string line; std::getline(in, line);) {
    line.resize(std::min(line.size(), line.find("//")));
    std::string word;
    for (const char c : line + " ") {
      if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.' || c == '-') {
        word += c;
        continue;
      }
      if (!word.empty()) tokens.push_back(std::exchange(word, {}));
      if (std::isspace(static_cast<unsigned char>(c)) == 0) tokens.emplace_back(1, c);
    }
  }
  return tokens;
}

class Parser {
 public:
  explicit Parser(const std::filesystem::path& file) : file_(file), tokens_(Tokens(file)) {}

  LcmStruct Parse() {
    LcmStruct result;
    Expect("package");
    Next();
    Expect(";");
    Expect("struct");
    result.name = Next();
    Expect("{");
    while (Peek() != "}") {
      if (Peek() == "const") {
        while (Next() != ";") continue;
      } else {
        ParseMembers(&result);
      }
    }
    Expect("}");
    if (position_ != tokens_.size()) Fail("more than one struct");
    if (result.name != file_.stem()) Fail("the struct is named otherwise than the file");
    if (result.members.empty()) Fail("the struct is empty");
    return result;
  }

 private:
  void ParseMembers(LcmStruct* result) {
    const std::string type = Next();
    for (std::string separator = ","; separator != ";"; separator = Next()) {
      if (separator != ",") Fail(fmt::format("expected ',' or ';', found '{}'", separator));
      LcmMember member;
      member.type = type;
      member.name = Next();
      if (Peek() == "[") ParseArray(result, &member);
      result->members.push_back(member);
    }
  }

  void ParseArray(LcmStruct* result, LcmMember* member) {
    Expect("[");
    const std::string size = Next();
    Expect("]");
    if (Peek() == "[") Fail("arrays of arrays are not supported");
    if (std::isdigit(static_cast<unsigned char>(size[0])) != 0) {
      member->n_fixed = std::stoul(size);
      return;
    }
    member->count = size;
    for (LcmMember& earlier : result->members) {
      if (earlier.name != size) continue;
      if (earlier.type != "int32_t") Fail(size + " counts elements but is not an int32_t");
      earlier.is_count = true;
      return;
    }
    Fail(size + " is not declared before " + member->name);
  }

  const std::string& Peek() const {
    if (position_ == tokens_.size()) Fail("ends too early");
    return tokens_[position_];
  }
  const std::string& Next() {
    const std::string& token = Peek();
    ++position_;
    return token;
  }
  void Expect(const std::string& token) {
    if (Next() != token)
      Fail(fmt::format("expected '{}', found '{}'", token, tokens_[position_ - 1]));
  }
  [[noreturn]] void Fail(const std::string& what) const {
    throw std::runtime_error(fmt::format("{}: {}", file_.string(), what));
  }

  std::filesystem::path file_;
  std::vector<std::string> tokens_;
  std::size_t position_ = 0;
};

}  // namespace

LcmStruct ReadLcmFile(const std::filesystem::path& file) { return Parser(file).Parse(); }

std::size_t PrimitiveBytes(const std::string& type) {
  static const std::map<std::string, std::size_t> kBytes = {
      {"int8_t", 1},  {"byte", 1},  {"boolean", 1}, {"int16_t", 2},
      {"int32_t", 4}, {"float", 4}, {"int64_t", 8}, {"double", 8}};
  const auto found = kBytes.find(type);
  return found == kBytes.end() ? 0 : found->second;
}

}  // namespace windhover
