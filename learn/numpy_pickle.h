#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace windhover {

/// What a pickle holds, as far as numbers, texts and NumPy arrays in lists and dictionaries go.
struct PickleValue {
  enum class Kind {
    kNone,
    kInt,    ///< integer; False and True are 0 and 1
    kFloat,  ///< number
    kText,
    kBytes,
    kTuple,
    kList,
    kDict,     ///< items: key, value, key, value, …
    kName,     ///< text: module and name of a class or function, which is never called
    kDtype,    ///< text: byte order and NumPy's type, "<f4", "|O8"
    kArray,    ///< items: shape (tuple), dtype, data (bytes, or a list of objects), row by row
    kUnready,  ///< an array or dtype whose state is yet to come
  };
  Kind kind = Kind::kNone;
  std::int64_t integer = 0;
  double number = 0;
  std::string text;  ///< Also of bytes.
  std::vector<PickleValue*> items;

  bool Is(Kind what) const { return kind == what; }
  /// The value of a dictionary's key; nullptr if there is none.
  const PickleValue* At(std::string_view key) const;
};

/// Reads what NumPy's save() pickles of a list of dictionaries of arrays, protocols 2 to 5.
/// Nothing is imported or called: of what a pickle may name, arrays and dtypes of NumPy and
/// encoded bytes are understood, all else is refused. Source: Python's pickletools.
class NumpyPickle {
 public:
  static constexpr std::size_t kMostValues = 1'000'000;  // UAVDE has 200,000.

  /// @throws std::runtime_error `byte N: what is wrong (what was found)`, bytes from `offset` on.
  explicit NumpyPickle(std::string_view bytes, std::size_t offset = 0);
  NumpyPickle(const NumpyPickle&) = delete;
  NumpyPickle& operator=(const NumpyPickle&) = delete;

  /// Lives as long as this.
  const PickleValue& root() const { return *root_; }

 private:
  using Kind = PickleValue::Kind;

  [[noreturn]] void Refuse(const std::string& what) const;
  bool Execute(unsigned char opcode);
  bool ExecuteNumber(unsigned char opcode);
  bool ExecuteString(unsigned char opcode);
  bool ExecuteContainer(unsigned char opcode);
  bool ExecuteMemo(unsigned char opcode);
  bool ExecuteObject(unsigned char opcode);

  std::string_view Take(std::uint64_t n);
  std::uint64_t TakeUnsigned(int n_bytes);
  std::string_view TakeLine();

  PickleValue* Push(Kind kind);
  void PushString(Kind kind, std::uint64_t size);
  PickleValue* Pop();
  PickleValue* Top(Kind kind);
  std::vector<PickleValue*> PopToMark();
  void PushTuple(std::vector<PickleValue*> items);
  void Remember(std::uint64_t slot);
  void Recall(std::uint64_t slot);
  void Name(const std::string& module, const std::string& name);
  void Reduce();
  void Build();

  std::string_view bytes_;
  std::size_t at_ = 0, offset_, opcode_at_ = 0;
  std::deque<PickleValue> values_;  ///< Keeps addresses.
  std::vector<PickleValue*> stack_;
  std::vector<std::size_t> marks_;
  std::map<std::uint64_t, PickleValue*> memo_;
  PickleValue* root_ = nullptr;
};

}  // namespace windhover
