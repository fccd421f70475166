#pragma once

#include <filesystem>
#include <string_view>

namespace windhover {

/// Looks at an encoded PNG, JPEG, Radiance HDR or OpenEXR before anybody makes room for its pixels;
/// content of other kinds passes.
/// @throws ConfigError if its header speaks of more than 128 Mpx or of none, or if it is a PNG or
/// JPEG that is cut short, of which decoders would make a partly grey image.
void CheckImageHeader(std::string_view bytes);

/// The same for a file. @throws ConfigError also if it is missing, empty, or beyond 1 GiB.
void CheckImageFile(const std::filesystem::path& file);

}  // namespace windhover
