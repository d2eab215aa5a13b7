/// Several at once are the same hashes as one by one.
#include "base/hash_each.h"

#include <gtest/gtest.h>

#include <vector>

namespace sandlot {
namespace {

TEST(HashEach, IsHash64ForAnyNumberAndLengths) {
  std::vector<std::byte> bytes(4000);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(mix64(i));
  for (std::size_t count = 0; count < 40; ++count) {
    std::vector<std::uint64_t> found(count), expected;
    std::vector<HashJob> jobs;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t size = mix64(100 * count + i) % (i % 3 ? 300 : 20), from = i * 37;
      const auto part = std::span<const std::byte>(bytes).subspan(from, i == 5 ? 0 : size);
      jobs.push_back({part, i, &found[i]});
      expected.push_back(hash64(part, i));
    }
    hash64_each(jobs);
    EXPECT_EQ(found, expected) << count << " sequences";
  }
}

}  // namespace
}  // namespace sandlot
