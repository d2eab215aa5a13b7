#pragma once
/// Work over threads whose result does not depend on how many there are: each index writes only its own data.
#include <cstddef>
#include <functional>

namespace sandlot {

/// Runs `body(begin, end)` over [0, count) in chunks of about `grain`, on the threads of the current arena.
void parallel_for(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body);

}  // namespace sandlot
