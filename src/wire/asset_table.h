#pragma once
/// The table behind Assets: what a world's JSON names by number. Safe for any thread.
#include <map>
#include <mutex>
#include <unordered_map>

#include "geometry/height_grid.h"
#include "geometry/mesh.h"
#include "wire/scene.h"

namespace sandlot::wire {

class AssetTable {
 public:
  /// The number of a thing; one of the same content has the same.
  std::uint32_t number_of(const std::shared_ptr<const TriangleMesh>& mesh);
  std::uint32_t number_of(const std::shared_ptr<const HeightGrid>& grid);
  std::uint32_t number_of_texture(const std::string& file);

  Result<Assets::Body> get(std::string_view path);

 private:
  template <class LabelledObject>
  struct Kept {
    std::shared_ptr<const LabelledObject> thing;
    std::vector<std::uint32_t> textures;                  ///< of a mesh's parts: the number + 1, 0 for none
    std::shared_ptr<const std::vector<std::byte>> bytes;  ///< from the first request on
  };
  template <class LabelledObject>
  struct Table {
    std::vector<Kept<LabelledObject>> all;
    std::unordered_multimap<std::uint64_t, std::uint32_t> by_hash;
    struct Known {
      std::weak_ptr<const LabelledObject> thing;
      std::uint32_t number = 0;
    };
    std::unordered_map<const LabelledObject*, Known> by_pointer;
  };
  template <class LabelledObject>
  std::uint32_t find_or_add(Table<LabelledObject>& table, const std::shared_ptr<const LabelledObject>& thing);
  template <class LabelledObject>
  Result<Assets::Body> body(Table<LabelledObject>& table, std::string_view path, std::uint32_t number);
  Result<Assets::Body> texture(std::string_view path, std::uint32_t number);
  std::uint32_t texture_number(const std::string& file);  ///< the mutex is held

  std::mutex mutex_;
  Table<TriangleMesh> meshes_;
  Table<HeightGrid> grids_;
  std::vector<std::string> textures_;
  std::map<std::string, std::uint32_t, std::less<>> texture_numbers_;
};

}  // namespace sandlot::wire
