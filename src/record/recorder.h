#pragma once
/// Recorder: writes a run to a file while it runs, in a thread of its own.
///
///   SL_ASSIGN(auto recorder, Recorder::start({.recording = {.file = "out.mcap"}}, simulation));
///   simulation.add_observer(recorder.get());
///   ... ticks ...
///   const Status status = recorder->finish();
///
/// Frames wait in a queue of `queue` megabytes for the thread that encodes and writes them. When it is full the messages
/// of a frame are left out and counted; its log entries and hashes, which prove the run, are kept, up to a quarter as
/// much again. Beyond that they are lost too, and the recording says that it is incomplete. The run never waits, unless
/// `when_full: wait` asks for it, and its results never depend on any of this.
///
/// Errors   start(): what keeps the file from being opened. finish(): what ended the writing, such as a full disk; what
///          was written until then stays readable and the run goes on.
/// Cost     on the simulation's thread: a lock per tick, and what filling a frame with messages, log and hash costs.
#include <condition_variable>
#include <mutex>
#include <thread>

#include "record/frame_writer.h"
#include "sim/world/frame_returns.h"

namespace sandlot {

class Recorder final : public Observer {
 public:
  static Result<std::unique_ptr<Recorder>> start(const RecordOptions& options, const Simulation& simulation);
  /// Ends the recording as finish() does.
  ~Recorder() override;
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  Wants wants() const override;
  void on_frame(const std::shared_ptr<const Frame>& frame) override;

  /// Waits until all is written and closes the file. @return the first error
  Status finish();

  struct Report {
    std::uint64_t frames = 0;
    std::uint64_t messages = 0, bytes = 0;  ///< in the file
    std::uint64_t dropped_messages = 0;     ///< of frames that found the queue full, or came after an error
    std::uint64_t lost_frames = 0;          ///< whose log and hash are missing too
    bool complete() const { return lost_frames == 0; }
  };
  /// What is in the file by now; from any thread.
  Report so_far();
  /// @pre finish() was called
  const Report& report() const { return report_; }

 private:
  struct Item {
    std::shared_ptr<const Frame> frame;
    std::shared_ptr<const msg::TFMessage> tf_static;
    std::size_t bytes = 0;
    bool small = false;  ///< only its log and hash
  };
  Recorder(FrameWriter writer, const model::Recording& recording, const Simulation& simulation);
  void run();

  const Simulation& simulation_;
  model::Recording recording_;
  FrameWriter writer_;
  std::uint64_t revision_ = 0;
  Time now_;
  Report report_;

  std::mutex mutex_;
  std::condition_variable filled_, emptied_;
  std::vector<Item> queue_;
  FrameReturns returns_;
  std::size_t waiting_bytes_ = 0, small_bytes_ = 0;
  bool ending_ = false, failed_ = false;
  Status status_;
  std::thread thread_;
};

}  // namespace sandlot
