#include "record/recorder.h"

#include <chrono>

#include "record/layout.h"
#include "sim/world/transforms.h"

namespace sandlot {
namespace {

std::size_t log_bytes(const Frame& frame) {
  std::size_t sum = sizeof frame + frame.parts.size() * sizeof(frame.parts[0]);
  for (const LogEntry& entry : frame.log) sum += sizeof entry + entry.bytes.size();
  return sum;
}

std::size_t bytes_of(const Frame& frame) {
  std::size_t sum = log_bytes(frame) + pose_bytes(frame);
  for (const auto& topic : frame.topics) sum += topic->memory_bytes();
  return sum;
}

/// What of a frame proves the run.
std::shared_ptr<const Frame> proof_of(const Frame& frame) {
  auto proof = std::make_shared<Frame>();
  proof->tick = frame.tick;
  proof->now = frame.now;
  proof->revision = frame.revision;
  proof->step = frame.step;
  proof->log = frame.log;
  proof->hash = frame.hash;
  proof->parts = frame.parts;
  proof->part_names = frame.part_names;
  return proof;
}

}  // namespace

Result<std::unique_ptr<Recorder>> Recorder::start(const RecordOptions& options,
                                                  const Simulation& simulation) {
  SL_ASSIGN(FrameWriter writer, FrameWriter::create(options, simulation));
  std::unique_ptr<Recorder> recorder(new Recorder(std::move(writer), options.recording, simulation));
  recorder->thread_ = std::thread([r = recorder.get()] { r->run(); });
  return recorder;
}

Recorder::Recorder(FrameWriter writer, const model::Recording& recording, const Simulation& simulation)
    : simulation_(simulation),
      recording_(recording),
      writer_(std::move(writer)),
      revision_(simulation.revision()),
      now_(simulation.now()) {}

Recorder::~Recorder() {
  if (const Status ignored = finish(); !ignored) return;  // who wants to know has asked
}

Observer::Wants Recorder::wants() const {
  return {.messages = true, .log = true, .hash = recording_.hashes, .links = recording_.tf_hz > 0};
}

void Recorder::on_frame(const std::shared_ptr<const Frame>& frame) {
  Item item{frame, nullptr, bytes_of(*frame)};
  if (frame->revision != revision_) {
    revision_ = frame->revision;
    item.tf_static = std::make_shared<const msg::TFMessage>(static_transforms(simulation_));
  }
  const auto limit = static_cast<std::size_t>(recording_.queue_mb * 1024 * 1024);
  returns_.release();
  {
    std::unique_lock lock(mutex_);
    ++report_.frames;
    now_ = frame->now;
    if (recording_.when_full == model::Recording::WhenFull::wait)
      emptied_.wait(lock,
                    [&] { return waiting_bytes_ == 0 || waiting_bytes_ + item.bytes <= limit || failed_; });
    const bool full = waiting_bytes_ > 0 && waiting_bytes_ + item.bytes > limit;
    if (full || failed_) {
      report_.dropped_messages += frame->topics.size();
      item.bytes = log_bytes(*frame);
      if (failed_ || small_bytes_ + item.bytes > limit / 4) {
        ++report_.lost_frames;
        if (item.tf_static) revision_ = ~std::uint64_t{0};  // the next frame brings them
        return;
      }
      item.frame = proof_of(*frame);
      item.small = true;
    }
    (item.small ? small_bytes_ : waiting_bytes_) += item.bytes;
    queue_.push_back(std::move(item));
    // The thread looks by itself every few milliseconds: waking it at each tick would cost more than the tick's lock.
    if (waiting_bytes_ < limit / 4) return;
  }
  filled_.notify_one();
}

void Recorder::run() {
  mcap::block_signals();
  std::vector<Item> batch;
  std::unique_lock lock(mutex_);
  for (;;) {
    filled_.wait_for(lock, std::chrono::milliseconds(5), [&] { return ending_ || !queue_.empty(); });
    if (queue_.empty() && ending_) return;
    batch.swap(queue_);
    for (Item& item : batch) {
      if (status_) {
        lock.unlock();
        Status status = writer_.write(*item.frame, item.tf_static.get());
        lock.lock();
        status_ = status;
        failed_ = !status_;
        report_.messages = writer_.messages();
        report_.bytes = writer_.bytes();
      }
      // After an error the rest of the batch is lost.
      if (failed_) {
        report_.dropped_messages += item.frame->topics.size();
        ++report_.lost_frames;
      }
      (item.small ? small_bytes_ : waiting_bytes_) -= item.bytes;
      returns_.give_back(std::move(item.frame));
      emptied_.notify_one();
    }
    batch.clear();
  }
}

Recorder::Report Recorder::so_far() {
  const std::lock_guard lock(mutex_);
  return report_;
}

Status Recorder::finish() {
  if (!thread_.joinable()) return status_;
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  filled_.notify_one();
  thread_.join();
  returns_.release();
  const Status ended = writer_.finish({{"ticks", std::to_string(report_.frames)},
                                       {"end_ns", std::to_string(now_.ns)},
                                       {"complete", report_.complete() ? "true" : "false"},
                                       {"dropped_messages", std::to_string(report_.dropped_messages)}});
  if (status_) status_ = ended;
  report_.messages = writer_.messages();
  report_.bytes = writer_.bytes();
  return status_;
}

}  // namespace sandlot
