#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "common/file/whole_file.h"

namespace windhover {

/// The boxes of one camera: class, x, y, w, h in shares of the image, confidence; best last.
using UavdeRows = std::vector<std::array<float, 6>>;

/// Writes the `.npy` of UAVDE: what numpy.save makes of a list of dictionaries
///
///     {'left': float32 [n, 6], 'right': float32 [n, 6], 'dist': float32 [], 'file_id': str}
///
/// which is an array of objects, pickled. Entries go to the file as they come. Source: NEP 1
/// (format 1.0), PEP 3154 and earlier (pickle protocol 3).
class UavdeNpyWriter {
 public:
  /// @throws std::runtime_error if the file cannot be created.
  explicit UavdeNpyWriter(const std::filesystem::path& file);

  void Add(const UavdeRows& left, const UavdeRows& right, float distance_m,
           const std::string& file_id);

  /// @throws std::runtime_error if not all could be written.
  void Finish();

 private:
  void Put(std::string_view bytes) { whole_.out().write(bytes.data(), std::ssize(bytes)); }
  void PutInt(std::uint32_t value);
  void PutText(std::string_view text);
  void PutArray(const std::vector<std::uint32_t>& shape, std::string_view bytes);
  void PutType(std::string_view name, std::string_view byte_order, std::uint32_t flags);

  WholeFile whole_;
  std::streamoff shape_at_ = 0;
  std::uint32_t n_ = 0;
  bool knows_float32_ = false;
};

}  // namespace windhover
