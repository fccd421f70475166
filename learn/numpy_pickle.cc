#include "learn/numpy_pickle.h"

#include <bit>
#include <stdexcept>

#include <fmt/format.h>

namespace windhover {

using Kind = PickleValue::Kind;

const PickleValue* PickleValue::At(std::string_view key) const {
  for (std::size_t i = 0; i + 1 < items.size(); i += 2) {
    if (items[i]->Is(Kind::kText) && items[i]->text == key) return items[i + 1];
  }
  return nullptr;
}

NumpyPickle::NumpyPickle(std::string_view bytes, std::size_t offset)
    : bytes_(bytes), offset_(offset) {
  while (root_ == nullptr) {
    opcode_at_ = at_;
    const auto opcode = static_cast<unsigned char>(Take(1)[0]);
    if (Execute(opcode)) continue;
    Refuse(fmt::format("must be an operation that NumPy's save() writes (found 0x{:02x})", opcode));
  }
}

void NumpyPickle::Refuse(const std::string& what) const {
  throw std::runtime_error(fmt::format("byte {}: {}", offset_ + opcode_at_, what));
}

bool NumpyPickle::Execute(unsigned char opcode) {
  switch (opcode) {
    case 0x80: {  // PROTO
      const std::uint64_t protocol = TakeUnsigned(1);
      if (protocol < 2 || protocol > 5) {
        Refuse(fmt::format("protocol must be 2 to 5 (found {})", protocol));
      }
      return true;
    }
    case 0x95:  // FRAME: how many bytes follow, for readers of streams.
      TakeUnsigned(8);
      return true;
    case '.':
      root_ = Pop();
      return true;
    default:
      return ExecuteNumber(opcode) || ExecuteString(opcode) || ExecuteContainer(opcode) ||
             ExecuteMemo(opcode) || ExecuteObject(opcode);
  }
}

bool NumpyPickle::ExecuteNumber(unsigned char opcode) {
  const auto push = [&](std::int64_t value) { Push(Kind::kInt)->integer = value; };
  switch (opcode) {
    case 'N':
      Push(Kind::kNone);
      return true;
    case 0x88:  // NEWTRUE
    case 0x89:  // NEWFALSE
      push(opcode == 0x88);
      return true;
    case 'J':
      push(static_cast<std::int32_t>(TakeUnsigned(4)));
      return true;
    case 'K':
      push(static_cast<std::int64_t>(TakeUnsigned(1)));
      return true;
    case 'M':
      push(static_cast<std::int64_t>(TakeUnsigned(2)));
      return true;
    case 'G': {  // The most significant byte comes first.
      std::uint64_t bits = 0;
      for (const char byte : Take(8)) bits = bits << 8 | static_cast<unsigned char>(byte);
      Push(Kind::kFloat)->number = std::bit_cast<double>(bits);
      return true;
    }
    default:
      return false;
  }
}

bool NumpyPickle::ExecuteString(unsigned char opcode) {
  switch (opcode) {
    case 'C':
      PushString(Kind::kBytes, TakeUnsigned(1));
      return true;
    case 'B':
      PushString(Kind::kBytes, TakeUnsigned(4));
      return true;
    case 0x96:  // BYTEARRAY8
      PushString(Kind::kBytes, TakeUnsigned(8));
      return true;
    case 0x8c:  // SHORT_BINUNICODE
      PushString(Kind::kText, TakeUnsigned(1));
      return true;
    case 'X':
      PushString(Kind::kText, TakeUnsigned(4));
      return true;
    default:
      return false;
  }
}

bool NumpyPickle::ExecuteContainer(unsigned char opcode) {
  const auto extend = [&](Kind kind, std::vector<PickleValue*> more) {
    if (kind == Kind::kDict && more.size() % 2 != 0) Refuse("a key of a dictionary has no value");
    std::vector<PickleValue*>& items = Top(kind)->items;
    items.insert(items.end(), more.begin(), more.end());
  };
  const auto popped = [&](std::size_t n) {
    std::vector<PickleValue*> items(n);
    while (n > 0) items[--n] = Pop();
    return items;
  };
  switch (opcode) {
    case '(':
      marks_.push_back(stack_.size());
      return true;
    case ')':
      Push(Kind::kTuple);
      return true;
    case 0x85:  // TUPLE1, TUPLE2, TUPLE3
    case 0x86:
    case 0x87:
      PushTuple(popped(opcode - 0x84U));
      return true;
    case 't':
      PushTuple(PopToMark());
      return true;
    case ']':
      Push(Kind::kList);
      return true;
    case 'a':
      extend(Kind::kList, popped(1));
      return true;
    case 'e':
      extend(Kind::kList, PopToMark());
      return true;
    case '}':
      Push(Kind::kDict);
      return true;
    case 's':
      extend(Kind::kDict, popped(2));
      return true;
    case 'u':
      extend(Kind::kDict, PopToMark());
      return true;
    default:
      return false;
  }
}

bool NumpyPickle::ExecuteMemo(unsigned char opcode) {
  switch (opcode) {
    case 'q':
      Remember(TakeUnsigned(1));
      return true;
    case 'r':
      Remember(TakeUnsigned(4));
      return true;
    case 0x94:  // MEMOIZE
      Remember(memo_.size());
      return true;
    case 'h':
      Recall(TakeUnsigned(1));
      return true;
    case 'j':
      Recall(TakeUnsigned(4));
      return true;
    default:
      return false;
  }
}

bool NumpyPickle::ExecuteObject(unsigned char opcode) {
  switch (opcode) {
    case 'c': {
      const std::string module(TakeLine());
      Name(module, std::string(TakeLine()));
      return true;
    }
    case 0x93: {  // STACK_GLOBAL
      const PickleValue *name = Pop(), *module = Pop();
      if (!name->Is(Kind::kText) || !module->Is(Kind::kText)) Refuse("a name must be a text");
      Name(module->text, name->text);
      return true;
    }
    case 'R':
      Reduce();
      return true;
    case 'b':
      Build();
      return true;
    default:
      return false;
  }
}

std::string_view NumpyPickle::Take(std::uint64_t n) {
  if (n > bytes_.size() - at_) {
    Refuse(fmt::format("must have {} more bytes: is the file cut short? (found {})", n,
                       bytes_.size() - at_));
  }
  at_ += n;
  return bytes_.substr(at_ - n, n);
}

std::uint64_t NumpyPickle::TakeUnsigned(int n_bytes) {
  std::uint64_t value = 0;
  int shift = 0;
  for (const char byte : Take(static_cast<std::uint64_t>(n_bytes))) {
    value |= static_cast<std::uint64_t>(static_cast<unsigned char>(byte)) << shift;
    shift += 8;
  }
  return value;
}

std::string_view NumpyPickle::TakeLine() {
  const std::size_t end = bytes_.find('\n', at_);
  if (end == std::string_view::npos) Refuse("a name must end with its line");
  const std::string_view line = Take(end - at_);
  Take(1);
  return line;
}

PickleValue* NumpyPickle::Push(Kind kind) {
  if (values_.size() == kMostValues) Refuse(fmt::format("more than {} values", kMostValues));
  values_.emplace_back().kind = kind;
  stack_.push_back(&values_.back());
  return stack_.back();
}

void NumpyPickle::PushString(Kind kind, std::uint64_t size) {
  const std::string_view content = Take(size);
  Push(kind)->text = content;
}

PickleValue* NumpyPickle::Pop() {
  if (stack_.empty() || (!marks_.empty() && marks_.back() == stack_.size())) {
    Refuse("a value is missing here");
  }
  PickleValue* value = stack_.back();
  stack_.pop_back();
  return value;
}

PickleValue* NumpyPickle::Top(Kind kind) {
  PickleValue* value = Pop();
  if (!value->Is(kind)) Refuse("what is filled here is no list or dictionary");
  stack_.push_back(value);
  return value;
}

std::vector<PickleValue*> NumpyPickle::PopToMark() {
  if (marks_.empty()) Refuse("what ends here has no beginning");
  const auto begin = stack_.begin() + static_cast<std::ptrdiff_t>(marks_.back());
  marks_.pop_back();
  std::vector<PickleValue*> items(begin, stack_.end());
  stack_.erase(begin, stack_.end());
  return items;
}

void NumpyPickle::PushTuple(std::vector<PickleValue*> items) {
  Push(Kind::kTuple)->items = std::move(items);
}

void NumpyPickle::Remember(std::uint64_t slot) {
  PickleValue* value = Pop();
  stack_.push_back(value);
  if (memo_.size() == kMostValues) Refuse(fmt::format("more than {} values", kMostValues));
  memo_[slot] = value;
}

void NumpyPickle::Recall(std::uint64_t slot) {
  const auto found = memo_.find(slot);
  if (found == memo_.end()) Refuse(fmt::format("value {} was not kept before", slot));
  stack_.push_back(found->second);
}

}  // namespace windhover
