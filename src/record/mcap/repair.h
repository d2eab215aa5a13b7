#pragma once
/// Examination and repair of recordings that are not whole: the process was killed, the disk was full, bytes were
/// damaged.
///
/// Kept      every chunk, attachment and metadata record whose bytes are whole. Message indexes, summary and footer are
///           written again; messages that stood outside chunks get one.
/// Dropped   the torn tail and damaged pieces; their size in bytes is reported.
/// Safety    the new file is written next to the old one and takes its place when it is complete and on the disk. An old
///           file that had damage before its end stays as FILE.damaged, since somebody may get more out of it.
#include "record/mcap/reader.h"

namespace sandlot::mcap {

struct Damage {
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;  ///< up to the next piece that could be read
  std::string what;
  bool at_end = false;  ///< nothing readable follows
};

struct Examination {
  Header header;
  Summary found;  ///< by walking through the file
  std::vector<Damage> damages;
  std::optional<Error> summary_trouble;  ///< the end of the file is missing or does not fit its data
  std::uint64_t file_bytes = 0;
  std::uint64_t loose_messages = 0;  ///< outside chunks
  bool whole() const { return damages.empty() && !summary_trouble; }
};

/// Checks everything: each record, each checksum, the indexes and the summary against the data.
Result<Examination> examine(const std::string& path, const Limits& limits = {});

struct Repaired {
  Examination before;
  std::uint64_t kept_messages = 0, lost_bytes = 0, new_bytes = 0;
  std::string kept_original;  ///< "" unless the old file was kept next to it
};

/// @pre  examine() said that the file is not whole
Result<Repaired> repair(const std::string& path, Examination before, const Limits& limits = {});

}  // namespace sandlot::mcap
