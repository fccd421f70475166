#include "common/config/key_lister.h"

#include <array>
#include <string_view>

namespace windhover {

std::string UnitOfKey(const std::string& key) {
  struct Suffix {
    std::string_view ending, unit;
  };
  // Longer endings first: _px_s before _s.
  constexpr std::array kSuffixes = {
      Suffix{"_rms_radps", "rad/s rms"},
      Suffix{"_radps", "rad/s"},
      Suffix{"_mps2", "m/s²"},
      Suffix{"_mps", "m/s"},
      Suffix{"_per_s", "1/s"},
      Suffix{"_deg", "deg"},
      Suffix{"_rad", "rad"},
      Suffix{"_px", "px"},
      Suffix{"_mm", "mm"},
      Suffix{"_um", "µm"},
      Suffix{"_ms", "ms"},
      Suffix{"_hz", "Hz"},
      Suffix{"_kg", "kg"},
      Suffix{"_m", "m"},
      Suffix{"_s", "s"},
      Suffix{"_e", "electrons"},
  };
  for (const Suffix& suffix : kSuffixes) {
    if (key.ends_with(suffix.ending)) return std::string(suffix.unit);
  }
  return "";
}

}  // namespace windhover
