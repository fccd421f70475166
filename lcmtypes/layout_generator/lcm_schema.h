#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace windhover {

/// One member of a message, as declared in its .lcm file.
struct LcmMember {
  std::string type;  ///< "double", "string", "image_t", ...
  std::string name;
  std::string count;        ///< Member that counts the elements; empty: not a vector.
  std::size_t n_fixed = 0;  ///< Elements of an array of constant size; 0: not one.
  bool is_count = false;    ///< Another member is counted by this one.
};

struct LcmStruct {
  std::string name;
  std::vector<LcmMember> members;
};

/// Reads the part of LCM's type language that this project uses: one struct a file, members
/// that are scalars, strings, structs or one-dimensional arrays of them.
/// @throws std::runtime_error `file: what` for anything else.
LcmStruct ReadLcmFile(const std::filesystem::path& file);

/// Encoded bytes of one value of a primitive type of fixed size; 0 for strings and structs.
std::size_t PrimitiveBytes(const std::string& type);

}  // namespace windhover
