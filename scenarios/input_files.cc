#include "scenarios/input_files.h"

#include <fmt/format.h>

namespace windhover {
namespace {

// A visitor of Fields that keeps the input files.
class InputFileLister {
 public:
  template <typename T, typename Limit>
  void Field(const char*, T&, const Limit&, const char*) {}
  template <typename Limit>
  void Field(const char* key, InputFile& file, const Limit&, const char*) {
    if (!file.empty()) files_.push_back({prefix_ + key, file});
  }
  template <typename Struct>
  void Section(const char* key, Struct& value, const char*) {
    Descend(fmt::format("{}.", key), value);
  }
  template <typename Struct>
  void List(const char* key, std::vector<Struct>& values, const char*) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      Descend(fmt::format("{}.{}.", key, i), values[i]);
    }
  }

  std::vector<NamedInputFile> TakeFiles() { return std::move(files_); }

 private:
  template <typename Struct>
  void Descend(const std::string& step, Struct& value) {
    const std::string outer = prefix_;
    prefix_ += step;
    value.Fields(*this);
    prefix_ = outer;
  }

  std::string prefix_;
  std::vector<NamedInputFile> files_;
};

}  // namespace

std::vector<NamedInputFile> InputFilesOf(Scenario scenario) {
  InputFileLister lister;
  scenario.Fields(lister);
  return lister.TakeFiles();
}

}  // namespace windhover
