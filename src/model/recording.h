#pragma once
/// Keys of a scenario's `record:`; the command line may change them.
#include <span>
#include <string>
#include <vector>

#include "base/fields.h"

namespace sandlot::model {

struct Recording {
  enum class Compression : std::uint8_t { none, lz4, zstd };
  enum class WhenFull : std::uint8_t { drop, wait };

  std::string file;
  std::vector<std::string> topics;
  Compression compression = Compression::lz4;
  double chunk_mb = 1;
  double chunk_s = 1;
  double tf_hz = 50;
  bool hashes = true;
  double queue_mb = 256;
  WhenFull when_full = WhenFull::drop;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"file", "", "File to write, relative to this file: an MCAP file, replaced if it exists.", 0,
                0, Field::none, 4096},
          s.file);
    visit(Field{"topics", "", "Topics to record, with * and ? as in file names; all by default.", 0, 0,
                Field::none, 1000},
          s.topics);
    visit(Field{"compression", "", "Compression of the chunks."}, s.compression);
    visit(Field{"chunk", "1", "Megabytes of messages after which a chunk is closed and written.", 1e-3, 256},
          s.chunk_mb);
    visit(Field{"chunk_time", "s", "Longest simulated time covered by a chunk.", 1e-3, 3600}, s.chunk_s);
    visit(Field{"tf", "Hz", "Rate at which /tf and /clock are recorded; 0: never.", 0, 1e5}, s.tf_hz);
    visit(
        Field{"hashes", "", "Record the hash of the state at every tick, for `replay --verify` and `diff`."},
        s.hashes);
    visit(Field{"queue", "1", "Megabytes that may wait for a slow disk.", 1, 1e5}, s.queue_mb);
    visit(Field{"when_full", "",
                "Behaviour when the queue is full. drop: messages are left out and counted; wait: the run "
                "waits."},
          s.when_full);
  }
};

inline std::span<const EnumName<Recording::Compression>> enum_names(Recording::Compression) {
  using Compression = Recording::Compression;
  static constexpr EnumName<Compression> names[] = {
      {"none", Compression::none}, {"lz4", Compression::lz4}, {"zstd", Compression::zstd}};
  return names;
}
inline std::span<const EnumName<Recording::WhenFull>> enum_names(Recording::WhenFull) {
  using WhenFull = Recording::WhenFull;
  static constexpr EnumName<WhenFull> names[] = {{"drop", WhenFull::drop}, {"wait", WhenFull::wait}};
  return names;
}

}  // namespace sandlot::model
