#pragma once
/// What viewers draw: the world as JSON, sent once and when it changes; poses as compact bytes, 30 times a second; meshes and
/// height grids as bytes. Layouts: docs/viewer_protocol.md.
///
/// Threads  WorldTeller::tell() belongs to the simulation's thread (between ticks); PoseWriter and the functions on shapes to any one
///          thread, they read frames alone.
/// Cost     poses: one encoding per frame for all clients, no allocation once `out` has its size; 27 bytes for a robot with two wheels.
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "base/result.h"
#include "sim/frame.h"
#include "sim/simulation.h"

namespace sandlot::wire {

/// Numbers of the things that a world's JSON names instead of holding: "a5" is a mesh, "g1" a grid, "t2" a texture, "m3" a model.
/// Given out once and kept as long as this is alive, so that clients need nothing twice. Any thread.
class Assets {
 public:
  /// HTTP body of "mesh/a5", "grid/g1", "texture/t2", with its type; errors: there is no such thing, or its file cannot be read any more.
  struct Body {
    std::string type;
    std::shared_ptr<const std::vector<std::byte>> bytes;
  };
  Result<Body> get(std::string_view path) const;

 private:
  friend class WorldTeller;
  struct Shared;
  std::shared_ptr<Shared> shared_;

 public:
  Assets();
};

/// Writes the JSON of /sandlot/world.
class WorldTeller {
 public:
  explicit WorldTeller(Assets assets) : assets_(std::move(assets)) {}
  std::string tell(const Simulation& simulation, std::uint64_t epoch);

 private:
  Assets assets_;
};

/// Writes the bytes of /sandlot/poses.
class PoseWriter {
 public:
  /// @param key  everything, not only what has changed since the last call
  /// @return false: nothing has changed, `out` is empty of records
  bool write(const Frame& frame, std::uint64_t epoch, bool key, std::vector<std::byte>& out);

 private:
  std::unordered_map<std::uint64_t, std::vector<std::byte>> last_;  ///< records, by serial
};

/// The bytes of /sandlot/contacts.
void write_contacts(const Frame& frame, std::vector<std::byte>& out);

/// The JSON of /sandlot/commands; "" when nothing came from outside in this frame.
std::string commands_json(const Frame& frame);

}  // namespace sandlot::wire
