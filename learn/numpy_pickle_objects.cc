// What the names in a pickle stand for.

#include <initializer_list>

#include <fmt/format.h>

#include "learn/numpy_pickle.h"

namespace windhover {
namespace {

using Kind = PickleValue::Kind;

bool AreKinds(const std::vector<PickleValue*>& items, std::initializer_list<Kind> kinds) {
  if (items.size() != kinds.size()) return false;
  std::size_t i = 0;
  for (const Kind kind : kinds) {
    if (!items[i++]->Is(kind)) return false;
  }
  return true;
}

// Protocol 2 has no bytes: NumPy's data is a text whose letters, of at most two bytes in UTF-8,
// are the bytes.
bool BytesOfLatin1(const std::string& text, std::string* bytes) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto lead = static_cast<unsigned char>(text[i]);
    if (lead < 0x80) {
      *bytes += text[i];
      continue;
    }
    if (lead != 0xC2 && lead != 0xC3) return false;
    if (++i == text.size()) return false;
    const auto next = static_cast<unsigned char>(text[i]);
    if ((next & 0xC0) != 0x80) return false;
    *bytes += static_cast<char>(((lead & 3) << 6) | (next & 0x3F));
  }
  return true;
}

bool IsOf(const std::string& name, std::string_view function) {
  // NumPy 2 has renamed its modules.
  return name == fmt::format("numpy.core.{}", function) ||
         name == fmt::format("numpy._core.{}", function);
}

}  // namespace

void NumpyPickle::Name(const std::string& module, const std::string& name) {
  const std::string whole = module + "." + name;
  const bool is_known = IsOf(whole, "multiarray._reconstruct") ||
                        IsOf(whole, "multiarray.scalar") || IsOf(whole, "numeric._frombuffer") ||
                        whole == "numpy.ndarray" || whole == "numpy.dtype" ||
                        whole == "_codecs.encode";
  if (!is_known) {
    Refuse(fmt::format("must name an array of NumPy (found {:?})", whole.substr(0, 80)));
  }
  Push(Kind::kName)->text = whole;
}

// What calling a name would make of its arguments.
void NumpyPickle::Reduce() {
  const PickleValue *tuple = Pop(), *function = Pop();
  if (!tuple->Is(Kind::kTuple) || !function->Is(Kind::kName)) Refuse("must be a name's arguments");
  const std::string& name = function->text;
  const auto& of = tuple->items;
  if (IsOf(name, "multiarray._reconstruct") && of.size() == 3) {
    Push(Kind::kUnready);
  } else if (name == "numpy.dtype" && AreKinds(of, {Kind::kText, Kind::kInt, Kind::kInt})) {
    Push(Kind::kUnready)->text = of[0]->text;
  } else if (name == "_codecs.encode" && AreKinds(of, {Kind::kText, Kind::kText}) &&
             of[1]->text == "latin1") {
    if (!BytesOfLatin1(of[0]->text, &Push(Kind::kBytes)->text)) Refuse("bytes must be Latin-1");
  } else if (IsOf(name, "multiarray.scalar") && AreKinds(of, {Kind::kDtype, Kind::kBytes})) {
    PickleValue* shape = Push(Kind::kTuple);
    stack_.pop_back();
    Push(Kind::kArray)->items = {shape, of[0], of[1]};
  } else if (IsOf(name, "numeric._frombuffer") &&
             AreKinds(of, {Kind::kBytes, Kind::kDtype, Kind::kTuple, Kind::kText}) &&
             of[3]->text == "C") {
    Push(Kind::kArray)->items = {of[2], of[1], of[0]};
  } else {
    Refuse(fmt::format("must be what NumPy gives to {}", name));
  }
}

void NumpyPickle::Build() {
  const PickleValue* state = Pop();
  PickleValue* value = Top(Kind::kUnready);
  const auto& of = state->items;
  const bool is_tuple = state->Is(Kind::kTuple);
  if (!value->text.empty()) {  // (3, byte order, None, …)
    if (!is_tuple || of.size() < 5 || !of[1]->Is(Kind::kText) || !of[2]->Is(Kind::kNone)) {
      Refuse("must be a plain dtype of NumPy");
    }
    value->kind = Kind::kDtype;
    value->text = of[1]->text + value->text;
    return;
  }
  // (version, shape, dtype, column by column?, data)
  if (!is_tuple || of.size() != 5 || !of[1]->Is(Kind::kTuple) || !of[2]->Is(Kind::kDtype)) {
    Refuse("must be the state of an array of NumPy");
  }
  if (!of[3]->Is(Kind::kInt) || of[3]->integer != 0) Refuse("arrays must be stored row by row");
  value->kind = Kind::kArray;
  value->items = {of[1], of[2], of[4]};
}

}  // namespace windhover
