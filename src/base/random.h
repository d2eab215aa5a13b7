#pragma once
/// Random numbers as an argument: Stream(seed, entity, purpose, sample) always yields the same sequence.
///
/// Counter-based (Philox4x32-10 of Random123), so a stream is a key, not a generator that somebody shares:
/// adding a robot, a viewer or a device changes nobody else's numbers, and nothing has to be saved.
///
/// Source   J. K. Salmon et al., Parallel random numbers: as easy as 1, 2, 3 (SC'11).
///          Normals: Box-Muller on base/math.h, so the same bits everywhere.
/// Cost     about 10 ns per 128 random bits; a normal about 50 ns.
#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "base/hash.h"

namespace sandlot {

/// Purpose of a stream: one enumerator per independent use of randomness by one entity.
enum class Purpose : std::uint32_t {
  noise = 1,       ///< sensor errors, drawn for each sample
  initial = 2,     ///< values drawn once when an entity is created (biases)
  placement = 3,   ///< start poses
  controller = 4,  ///< decisions of a control program
  actuation = 5,   ///< errors of actuators
  physics = 6,     ///< solver-internal choices
  medium = 7,      ///< propagation in a medium
  experiment = 8,  ///< parameters drawn by scenarios and studies
};

/// Hash of an entity's path ("robot1/laser"): stable against insertion order.
inline std::uint64_t entity_key(std::string_view path) { return hash64(path); }

/// A sequence of random numbers. Copying it copies the position in the sequence.
class Stream {
 public:
  /// @param seed    the run's seed
  /// @param entity  entity_key(path)
  /// @param sample  index of the sample (or tick) the numbers are for
  Stream(std::uint64_t seed, std::uint64_t entity, Purpose purpose, std::uint64_t sample);

  std::uint32_t bits32();
  std::uint64_t bits64();
  /// Uniform in [0, 1), 53 bits.
  double uniform();
  /// Uniform in [lo, hi); lo when there is nothing between them. @pre lo <= hi
  double uniform(double lo, double hi) {
    const double x = lo + (hi - lo) * uniform();
    return x < hi ? x : lo;  // the sum may round up to hi, once in about 2^53
  }
  /// Uniform integer in [0, n), unbiased. @pre n > 0
  std::uint32_t below(std::uint32_t n);
  /// Normal deviate with mean 0 and standard deviation 1.
  double normal();
  /// A stream of its own for one use among several of this one's: it depends on the stream's key and sample
  /// and on `use`, not on how many numbers were drawn.
  Stream fork(std::uint64_t use) const;
  /// The words (as of bits32) from the block of four number `block` on, for those who draw very many and not
  /// in one order, such as the rows of a picture. Moves nothing and does not depend on how many numbers were
  /// drawn.
  void words(std::uint32_t block, std::span<std::uint32_t> out) const;

 private:
  void refill();
  std::array<std::uint32_t, 2> key_;
  std::array<std::uint32_t, 4> counter_;
  std::array<std::uint32_t, 4> block_{};
  int used_ = 4;
  bool has_spare_ = false;
  double spare_ = 0;
};

}  // namespace sandlot
