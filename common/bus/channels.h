#pragma once

#include <string>

#include <fmt/format.h>

// Channels a real aircraft would have, and those of the lock-step. Ground truth has its own
// header, truth_channels.h, which estimator/ and swarm/ may not include
// (tests/architecture/layering_test.cc). lcmtypes/README.md is the table.
namespace windhover::channel {

inline const std::string kTick = "TICK";
inline const std::string kTickDone = "TICK_DONE";
inline const std::string kHello = "HELLO";

inline std::string NavState(int id) { return fmt::format("NAV_STATE_{}", id); }
inline std::string Imu(int id) { return fmt::format("IMU_{}", id); }
inline std::string Uwb(int id) { return fmt::format("UWB_{}", id); }
inline std::string Stereo(int id) { return fmt::format("STEREO_{}", id); }
inline std::string FrameDigest(int id) { return fmt::format("FRAME_DIGEST_{}", id); }
inline std::string Detection(int id) { return fmt::format("DETECTION_{}", id); }
inline std::string Range(int id) { return fmt::format("RANGE_{}", id); }
inline std::string VelocityCommand(int id) { return fmt::format("VELOCITY_COMMAND_{}", id); }
inline std::string ImageLeft(int id) { return fmt::format("IMAGE_LEFT_{}", id); }
inline std::string ImageRight(int id) { return fmt::format("IMAGE_RIGHT_{}", id); }
inline std::string Status(const std::string& process) { return fmt::format("STATUS_{}", process); }

}  // namespace windhover::channel
