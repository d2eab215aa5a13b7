#pragma once
/// The world for viewers: as JSON, sent once and when it changes; poses as compact bytes, 30 times a second; meshes and
/// height grids as bytes. Layouts: docs/viewer_protocol.md.
///
/// Threads  WorldJsonWriter::write() belongs to the simulation's thread (between ticks); PoseWriter and the functions on frames to any one
///          thread, they read frames alone.
/// Cost     poses: one encoding per frame for all clients, no allocation once `out` has its size; 27 bytes for a robot with two
///          wheels; things at rest cost a comparison. World: models and kinds are written once and kept.
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "base/result.h"
#include "sim/world/frame.h"
#include "sim/world/simulation.h"

namespace sandlot::wire {

class AssetTable;  // wire/asset_table.h
struct LinkTree;   // wire/poses.cpp

/// Numbers of the things that a world's JSON names instead of holding: "a5" is a mesh, "g1" a grid, "t2" a texture.
/// Given out once and kept as long as this is alive, so that clients need nothing twice; what has the same content has the
/// same number, also in the worlds that follow. Any thread; copies are the same table.
class Assets {
 public:
  Assets();
  /// HTTP body of "mesh/a5", "grid/g1", "texture/t2", with its type; errors: there is no such thing, or its file cannot be read any more.
  struct Body {
    std::string type;
    std::shared_ptr<const std::vector<std::byte>> bytes;
  };
  Result<Body> get(std::string_view path) const;

 private:
  friend class WorldJsonWriter;
  std::shared_ptr<AssetTable> table_;
};

/// Largest file of a texture.
inline constexpr std::size_t most_texture_bytes = std::size_t{64} << 20;

/// Writes the JSON of /sandlot/world.
class WorldJsonWriter {
 public:
  explicit WorldJsonWriter(Assets assets) : assets_(std::move(assets)) {}
  std::string write(const Simulation& simulation, std::uint64_t epoch);

 private:
  struct WrittenModel {
    std::uint64_t number = 0;
    bool used = false;  ///< in the world that is being written
  };
  using ByContent = std::map<std::string, WrittenModel>;  ///< JSON of a model, without its id
  ByContent::iterator written_model(const std::shared_ptr<const model::Model>& model);
  const std::string& kind_json(const void* kind, const char* help, std::span<const LevelInfo> levels,
                               std::vector<FieldInfo> (*describe)(), const Kind* common_keys_of = nullptr);

  Assets assets_;
  ByContent models_;
  struct Known {
    std::weak_ptr<const model::Model> model;
    ByContent::iterator written;
  };
  std::unordered_map<const model::Model*, Known> known_models_;
  std::map<std::pair<const void*, bool>, std::string> kinds_;
  std::uint64_t next_model_ = 0;
};

/// Writes the bytes of /sandlot/poses.
class PoseWriter {
 public:
  PoseWriter();
  ~PoseWriter();
  PoseWriter(PoseWriter&&) noexcept;
  PoseWriter& operator=(PoseWriter&&) noexcept;
  /// Replaces `out` by a message. A frame of another epoch than the last is a key frame in any case.
  /// @param key  everything, not only what has changed since the last call
  /// @return false: nothing has changed, `out` has no records
  /// @pre the frame was requested with links
  bool write(const Frame& frame, std::uint64_t epoch, bool key, std::vector<std::byte>& out);

 private:
  struct Entry {
    std::shared_ptr<const LinkTree> tree;
    std::vector<Pose> X_WL;         ///< when last sent
    std::vector<std::byte> record;  ///< that was last sent
    std::uint64_t round = 0;        ///< of the last frame that had it
  };
  void encode(const FrameInstance& instance, const LinkTree& tree, std::vector<std::byte>& out);
  bool encode_joints(const FrameInstance& instance, const LinkTree& tree, std::vector<std::byte>& out);
  std::shared_ptr<const LinkTree> tree_of(const std::shared_ptr<const model::Model>& model);
  void forget_those_gone();

  std::unordered_map<std::uint64_t, Entry> entries_;  ///< by serial
  std::unordered_map<const model::Model*, std::shared_ptr<const LinkTree>> trees_;
  std::uint64_t epoch_ = 0, revision_ = 0, round_ = 0;
  std::vector<Pose> decoded_;      ///< scratch: what a viewer makes of the record
  std::vector<std::byte> record_;  ///< scratch
};

/// Replaces `out` by the bytes of /sandlot/contacts.
void write_contacts(const Frame& frame, std::vector<std::byte>& out);

/// Pairs of instances in one message of /sandlot/deliveries.
inline constexpr std::uint32_t most_links = 1000;
/// Replaces `out` by the bytes of /sandlot/deliveries: one record per medium, sender and receiver. Sorts `deliveries`.
/// @param tick, now  of the latest of them
void write_deliveries(std::vector<FrameDelivery>& deliveries, std::uint64_t tick, Time now,
                      std::vector<std::byte>& out);
/// Replaces `out` by the bytes of /sandlot/batteries. On the simulation's thread, between ticks.
void write_batteries(const Simulation& simulation, std::vector<std::byte>& out);

/// The JSON of /sandlot/commands; "" when nothing came from outside in this frame.
std::string commands_json(const Frame& frame);
/// What a request asks for, in words: "noise/white = 0.02", "pose 1 2 0".
std::string describe_request(const LogEntry& entry);

}  // namespace sandlot::wire
