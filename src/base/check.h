#pragma once
/// SL_CHECK: an assertion about our own code, armed in every build type.
///
/// It guards against bugs only. Anything a user can cause (a file, a flag, a message) is answered with a
/// Result instead; a check that user input can reach is itself a defect.
namespace sandlot {

/// Prints the broken expression with its place and aborts.
[[noreturn]] void check_failed(const char* expression, const char* message, const char* file, int line);

}  // namespace sandlot

#define SL_CHECK(expression) \
  ((expression) ? void() : ::sandlot::check_failed(#expression, "", __FILE__, __LINE__))
#define SL_CHECK_MSG(expression, message) \
  ((expression) ? void() : ::sandlot::check_failed(#expression, message, __FILE__, __LINE__))
