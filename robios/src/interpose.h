#pragma once
/// Definition of a function that stands in front of the C library's of the same name. Its name in C++ is another one, so that the
/// declarations of the system's headers do not matter.
#define ROBIOS_INTERPOSE(result, name, ...)                                                              \
  extern "C" [[gnu::visibility("default"), gnu::used]] result robios_##name(__VA_ARGS__) __asm__(#name); \
  extern "C" result robios_##name(__VA_ARGS__)
