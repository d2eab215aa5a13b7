#pragma once
/// Recording as a replay needs it: the snapshot of its beginning, and every tick after that.
///
/// Reads    attachment `snapshot`, metadata `sandlot`, and the channels /sandlot/log, /sandlot/hash and /sandlot/parts.
///          The rest of the file is not looked at.
/// Errors   no recording of Sandlot's; a message of these channels that cannot be decoded. A file that is torn off or
///          damaged gives its ticks up to there.
#include <optional>
#include <string>
#include <vector>

#include "record/layout.h"
#include "record/mcap/reader.h"
#include "record/replay.h"
#include "sim/world/snapshot.h"

namespace sandlot::record {

class Recording {
 public:
  static Result<Recording> open(const std::string& path);

  const std::vector<std::byte>& snapshot() const { return snapshot_; }
  const SnapshotInfo& begin() const { return begin_; }
  /// Metadata of the recorder: profile, seed, scenario ...; empty when it is gone.
  const mcap::TextMap& facts() const { return facts_; }

  /// The next tick, or null at the end. What it points at is valid until the next call. An error: the file is damaged
  /// there, or lacks a tick; do not call again.
  Result<const RecordedTick*> next();
  /// Set when the file was torn off: the ticks are whole as far as they go.
  const std::optional<Error>& torn() const { return reader_->trouble(); }

 private:
  explicit Recording(mcap::Reader reader);
  struct Take;

  std::unique_ptr<mcap::Reader> reader_;  ///< stays where the cursor knows it
  mcap::Cursor cursor_;
  mcap::TextMap facts_;
  std::vector<std::byte> snapshot_;
  SnapshotInfo begin_;
  bool ended_ = false;
  RecordedTick tick_, next_;  ///< handed out; being put together
  bool next_has_hash_ = false, next_begun_ = false;
  std::shared_ptr<const std::vector<std::string>> part_names_;
};

}  // namespace sandlot::record
