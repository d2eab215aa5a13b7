#pragma once
/// Frame writer: frames of a simulation as the messages of a recording: device topics, /tf, /clock, the log and the hashes.
///
/// Frames   of /tf and /tf_static: sim/world/transforms.h.
/// Time     every message of a frame carries the frame's simulated time.
/// Units    as the messages say.
#include <unordered_map>

#include "messages/sandlot_msgs.h"
#include "messages/tf2_msgs.h"
#include "record/mcap/writer.h"
#include "sim/world/simulation.h"

namespace sandlot {

struct MessageInfo;

struct RecordOptions {
  model::Recording recording;
  std::string version;        ///< of Sandlot
  std::string scenario_file;  ///< name of what was run
  std::string scenario_text;  ///< its content; "" when there is none
};

class FrameWriter {
 public:
  /// Opens the file and writes what stands at its beginning: the state, the scenario, where everything is mounted.
  static Result<FrameWriter> create(const RecordOptions& options, const Simulation& simulation);

  /// @param tf_static  when devices have come or gone
  Status write(const Frame& frame, const msg::TFMessage* tf_static);
  /// Writes the end.
  Status finish(const mcap::TextMap& end);

  std::uint64_t messages() const { return messages_; }
  std::uint64_t bytes() const { return writer_.bytes_written(); }
  bool wants(std::string_view topic) const;

 private:
  struct Target {
    const MessageInfo* type = nullptr;  ///< null: not recorded
    std::uint16_t channel = 0;
  };
  FrameWriter(mcap::Writer writer, const model::Recording& recording);
  Result<Target*> target(const std::string& topic, const MessageInfo& type);
  Status put(Target& target, Time now, const void* message);
  template <class M>
  Status put(const char* topic, Time now, const M& message);
  Status put_parts(std::uint64_t tick, std::uint64_t revision, Time now,
                   const std::vector<std::string>& names);
  Status put_transforms(const Frame& frame);

  mcap::Writer writer_;
  model::Recording recording_;
  std::unordered_map<std::string, Target> targets_;
  std::unordered_map<std::string, std::uint16_t> schemas_;
  std::vector<std::byte> bytes_;
  std::shared_ptr<const std::vector<std::string>> part_names_;
  msg::TFMessage transforms_;
  msg::LogEntry entry_;
  msg::StateHash hash_;
  Time tf_begin_;
  std::int64_t tf_sample_ = 0;
  std::uint64_t messages_ = 0;
};

}  // namespace sandlot
