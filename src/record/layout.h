#pragma once
/// Names in a recording of Sandlot's. Its content in addition to topics: docs/recordings.md.
namespace sandlot::recording {

inline constexpr const char* clock_topic = "/clock";          ///< rosgraph_msgs/msg/Clock
inline constexpr const char* tf_topic = "/tf";                ///< tf2_msgs/msg/TFMessage
inline constexpr const char* tf_static_topic = "/tf_static";  ///< the same
inline constexpr const char* log_topic = "/sandlot/log";      ///< sandlot_msgs/msg/LogEntry
inline constexpr const char* hash_topic = "/sandlot/hash";    ///< sandlot_msgs/msg/StateHash
inline constexpr const char* parts_topic = "/sandlot/parts";  ///< sandlot_msgs/msg/StateParts

inline constexpr const char* snapshot_attachment = "snapshot";  ///< the state that the recording begins with
inline constexpr const char* scenario_attachment = "scenario";  ///< the file as the user wrote it

/// Metadata `run`: version, profile, seed, scenario, engine, step_ns, clock, start_tick, start_ns.
inline constexpr const char* run_metadata = "sandlot";
/// Metadata of the end; missing when the run was killed: ticks, end_ns, complete ("true": no log entry or hash is
/// missing), dropped_messages.
inline constexpr const char* end_metadata = "sandlot_end";

}  // namespace sandlot::recording
