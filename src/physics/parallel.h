#pragma once
/// Work over threads whose result does not depend on how many there are: each index writes only its own data.
#include <cstddef>

namespace sandlot {

/// How many threads may share work here; 1: it is done where it is asked for, and what prepares sharing can be spared.
std::size_t parallel_threads();

/// As below, with the body as a plain function of its closure.
void parallel_for(std::size_t count, std::size_t grain, const void* closure,
                  void (*body)(const void* closure, std::size_t begin, std::size_t end));

/// Runs `body(begin, end)` over [0, count) in chunks of about `grain`, on the threads of the current arena.
/// The body is called where it stands, so that a capture of any size costs no heap.
template <class Body>
void parallel_for(std::size_t count, std::size_t grain, const Body& body) {
  parallel_for(count, grain, static_cast<const void*>(&body),
               [](const void* closure, std::size_t begin, std::size_t end) {
                 (*static_cast<const Body*>(closure))(begin, end);
               });
}

}  // namespace sandlot
