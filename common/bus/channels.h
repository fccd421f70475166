#pragma once

#include <string>

// Channels a real aircraft would have, and those of the lock-step. Ground truth has its own
// header, truth_channels.h, which estimator/ and swarm/ may not include
// (tests/architecture/layering_test.cc). lcmtypes/README.md is the table.
namespace windhover::channel {

inline const std::string kTick = "TICK";
inline const std::string kTickDone = "TICK_DONE";
inline const std::string kHello = "HELLO";

inline std::string Numbered(const char* prefix, int id) { return prefix + std::to_string(id); }

inline std::string NavState(int id) { return Numbered("NAV_STATE_", id); }
inline std::string Imu(int id) { return Numbered("IMU_", id); }
inline std::string Uwb(int id) { return Numbered("UWB_", id); }
inline std::string Stereo(int id) { return Numbered("STEREO_", id); }
inline std::string FrameDigest(int id) { return Numbered("FRAME_DIGEST_", id); }
inline std::string Detection(int id) { return Numbered("DETECTION_", id); }
inline std::string Range(int id) { return Numbered("RANGE_", id); }
inline std::string VelocityCommand(int id) { return Numbered("VELOCITY_COMMAND_", id); }
inline std::string ImageLeft(int id) { return Numbered("IMAGE_LEFT_", id); }
inline std::string ImageRight(int id) { return Numbered("IMAGE_RIGHT_", id); }
inline std::string Status(const std::string& process) { return "STATUS_" + process; }

}  // namespace windhover::channel
