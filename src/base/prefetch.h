#pragma once
/// Prefetch: asks the processor for memory that is needed soon, so that it arrives meanwhile.
#include <cstddef>
#include <cstdint>

namespace sandlot {

/// @param values  may point to nothing that is there: nothing is read
template <class T>
void prefetch(const T* values, std::size_t count) {
  constexpr std::size_t line = 64;
  const auto begin = reinterpret_cast<std::uintptr_t>(values) & ~(line - 1);
  // NOLINTNEXTLINE(bugprone-sizeof-expression): the values may be pointers, and then these are what is asked for.
  const std::uintptr_t end = reinterpret_cast<std::uintptr_t>(values) + count * sizeof(T);
  for (std::uintptr_t at = begin; at < end; at += line) __builtin_prefetch(reinterpret_cast<const void*>(at));
}

}  // namespace sandlot
