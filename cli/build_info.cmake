# Writes ${OUTPUT}, a header with the commit that is being built ("-dirty" when files differ from
# it), if it has changed. Run at every build: cmake -DSOURCE=… -DOUTPUT=… -P build_info.cmake
execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=12 --exclude=*
  OUTPUT_VARIABLE hash OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  set(hash "")
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT
"#pragma once

namespace windhover {

/// Commit that this was built from; empty if not from a git checkout.
inline constexpr const char* kGitHash = \"${hash}\";

}  // namespace windhover
")
