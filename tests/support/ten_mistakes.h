#pragma once

namespace windhover {

/// A scenario file with ten different mistakes.
inline constexpr char kTenMistakes[] = R"(description: ""
frame_rat_hz: 20
duration_s: -1
observe: pictures
exposure: {duration_ms: 200}
estimator: {methods: [baseline], in_loop: size}
vibration: {source: recorded}
environment: {type: photo, file: none.jpg}
aircraft:
  - {id: 1, controller: trajectory}
  - {id: 1, position_m: [5, 0, 0]}
)";

}  // namespace windhover
