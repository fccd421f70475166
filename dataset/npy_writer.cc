#include "dataset/npy_writer.h"

#include <bit>
#include <cstring>

#include <fmt/format.h>

namespace windhover {
namespace {

// Opcodes of pickles.
constexpr char kInt = 'J', kText = 'X', kBytes = 'B', kMark = '(', kTuple = 't', kReduce = 'R',
               kBuild = 'b', kNone = 'N', kTrue = '\x88', kFalse = '\x89', kEmptyDict = '}',
               kEmptyList = ']', kAppend = 'a', kSetItems = 'u', kPut = 'q', kGet = 'h',
               kStop = '.';
// What is written once and referred to.
constexpr char kMakeArray = 0, kArrayClass = 1, kTypeCode = 2, kFloat32 = 3;

constexpr int kHeaderBytes = 128;

std::string Op(char code, char argument) { return {code, argument}; }

static_assert(std::endian::native == std::endian::little);

std::string_view BytesOf(const void* data, std::size_t n) {
  return {static_cast<const char*>(data), n};
}

}  // namespace

UavdeNpyWriter::UavdeNpyWriter(const std::filesystem::path& file) : whole_(file) {
  Put(std::string(kHeaderBytes, ' '));  // Finish() knows it.
  Put("\x80\x03");
  Put("cnumpy.core.multiarray\n_reconstruct\n" + Op(kPut, kMakeArray));
  Put("cnumpy\nndarray\n" + Op(kPut, kArrayClass));
  Put("K");
  Put(std::string(1, '\0'));
  Put("\x85");
  Put(std::string("C\1b") + Op(kPut, kTypeCode) + '\x87' + kReduce + kMark);
  PutInt(1);
  shape_at_ = whole_.out().tellp();
  PutInt(0);
  Put("\x85");
  constexpr std::uint32_t kHoldsObjects = 63;
  PutType("O8", "|", kHoldsObjects);
  Put(std::string{kFalse, kEmptyList});
}

void UavdeNpyWriter::Add(const UavdeRows& left, const UavdeRows& right, float distance_m,
                         const std::string& file_id) {
  const auto put_rows = [&](const char* key, const UavdeRows& rows) {
    PutText(key);
    PutArray({static_cast<std::uint32_t>(rows.size()), 6},
             BytesOf(rows.data(), rows.size() * sizeof rows[0]));
  };
  Put(std::string{kEmptyDict, kMark});
  put_rows("left", left);
  put_rows("right", right);
  PutText("dist");
  PutArray({}, BytesOf(&distance_m, sizeof distance_m));
  PutText("file_id");
  PutText(file_id);
  Put(std::string{kSetItems, kAppend});
  ++n_;
}

void UavdeNpyWriter::Finish() {
  Put(std::string{kTuple, kBuild, kStop});
  whole_.out().seekp(shape_at_);
  PutInt(n_);
  std::string header = std::string("\x93NUMPY\1\0", 8);
  header += {static_cast<char>(kHeaderBytes - 10), '\0'};
  header += fmt::format("{{'descr': '|O', 'fortran_order': False, 'shape': ({},), }}", n_);
  header.resize(kHeaderBytes - 1, ' ');
  whole_.out().seekp(0);
  Put(header + '\n');
  whole_.Commit();
}

void UavdeNpyWriter::PutInt(std::uint32_t value) {
  Put(std::string(1, kInt));
  Put(BytesOf(&value, sizeof value));
}

void UavdeNpyWriter::PutText(std::string_view text) {
  const auto n = static_cast<std::uint32_t>(text.size());
  Put(std::string(1, kText));
  Put(BytesOf(&n, sizeof n));
  Put(text);
}

void UavdeNpyWriter::PutType(std::string_view name, std::string_view byte_order,
                             std::uint32_t flags) {
  constexpr std::uint32_t kVersion = 3, kNoSize = 0xffffffff;
  Put("cnumpy\ndtype\n");
  PutText(name);
  Put(std::string{kFalse, kTrue, '\x87', kReduce, kMark});
  PutInt(kVersion);
  PutText(byte_order);
  Put(std::string(3, kNone));
  PutInt(kNoSize);
  PutInt(kNoSize);
  PutInt(flags);
  Put(std::string{kTuple, kBuild});
}

void UavdeNpyWriter::PutArray(const std::vector<std::uint32_t>& shape, std::string_view bytes) {
  Put(Op(kGet, kMakeArray) + Op(kGet, kArrayClass) + Op('K', 0) + '\x85' + Op(kGet, kTypeCode) +
      '\x87' + kReduce + kMark);
  PutInt(1);
  Put(std::string(1, kMark));
  for (const std::uint32_t n : shape) PutInt(n);
  Put(std::string(1, kTuple));
  if (knows_float32_) {
    Put(Op(kGet, kFloat32));
  } else {
    PutType("f4", "<", 0);
    Put(Op(kPut, kFloat32));
    knows_float32_ = true;
  }
  const auto n = static_cast<std::uint32_t>(bytes.size());
  Put(std::string{kFalse, kBytes});
  Put(BytesOf(&n, sizeof n));
  Put(bytes);
  Put(std::string{kTuple, kBuild});
}

}  // namespace windhover
