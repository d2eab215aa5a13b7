#pragma once
/// Exports of a shared library of controllers, and the proof that it fits this program.
///
///   namespace {
///   struct Wall { ... };                                       // as in control/controller.h
///   constexpr sandlot::ControllerKind wall = sandlot::make_controller<Wall>({.name = "wall", .help = "..."});
///   }
///   SANDLOT_PLUGIN("my_robots", &wall)
///
/// Fit      the simulator asks for `sandlot_plugin`, compares the version of this border and the build id, and refuses
///          what differs, since messages and field lists cross the border as C++ objects.
/// Process  a plugin lives in the simulator's process: what crashes in it ends the run at once, and its global
///          variables are shared by all robots that use it. It is loaded once and never unloaded.
#include <array>
#include <cstdint>

#include "base/sanitizers.h"
#include "control/border.h"  // made by the build: sandlot::border_hash
#include "control/controller.h"

namespace sandlot {

/// The table behind the one symbol. The members up to `name` never change their places, so that the simulator can
/// read the versions of any plugin; those after them are read only when the versions fit.
struct PluginTable {
  std::array<char, 8> magic;
  std::uint32_t api_version;
  const char* build_id;
  const char* name;
  const ControllerKind* const* controllers;
  std::uint32_t controller_count;
};

inline constexpr std::array<char, 8> plugin_magic{'S', 'A', 'N', 'D', 'L', 'P', 'L', 'G'};
inline constexpr const char* plugin_symbol = "sandlot_plugin";
extern "C" using PluginEntry = const PluginTable * ();

#define SL_TEXT_(x) #x
#define SL_TEXT(x) SL_TEXT_(x)
#if defined(__clang__)
#define SL_COMPILER "clang " SL_TEXT(__clang_major__)
#else
#define SL_COMPILER "gcc " SL_TEXT(__GNUC__)
#endif
#if defined(_GLIBCXX_DEBUG)
#define SL_LIBRARY "libstdc++ debug"
#elif defined(_GLIBCXX_USE_CXX11_ABI) && _GLIBCXX_USE_CXX11_ABI
#define SL_LIBRARY "libstdc++ cxx11"
#elif defined(_LIBCPP_VERSION)
#define SL_LIBRARY "libc++"
#else
#define SL_LIBRARY "libstdc++"
#endif
// What changes the last bits of a result. -ffp-contract leaves no trace in the preprocessor: the CMake target carries it.
#if defined(__AVX512F__)
#define SL_MACHINE "avx512"
#elif defined(__AVX2__) && defined(__FMA__)
#define SL_MACHINE "avx2 fma"
#elif defined(__AVX2__)
#define SL_MACHINE "avx2"
#else
#define SL_MACHINE "baseline"
#endif
#if defined(__FAST_MATH__)
#define SL_MATH " fast-math"
#else
#define SL_MATH ""
#endif
#if SL_ADDRESS_SANITIZER
#define SL_SANITIZER " asan"
#elif SL_THREAD_SANITIZER
#define SL_SANITIZER " tsan"
#else
#define SL_SANITIZER ""
#endif

/// What a plugin and the simulator must have in common. Compiled into both.
inline constexpr const char* build_id = SL_COMPILER
    ", C++ " SL_TEXT(__cplusplus) ", " SL_LIBRARY ", " SL_MACHINE SL_MATH SL_SANITIZER
                                  ", headers " SANDLOT_BORDER_HASH;

/// True where the CMake target sandlot::control was linked, which carries the flags that leave no trace.
#if defined(SANDLOT_CONTROL_FLAGS)
inline constexpr bool has_control_flags = true;
#else
inline constexpr bool has_control_flags = false;
#endif

/// Makes the table from the kinds.
template <std::size_t n>
constexpr PluginTable plugin_table(const char* name, const ControllerKind* const (&kinds)[n]) {
  return {plugin_magic, controller_api_version, build_id, name, kinds, n};
}

}  // namespace sandlot

/// Once per shared library: SANDLOT_PLUGIN("name", &kind, &another_kind)
#define SANDLOT_PLUGIN(name, ...)                                                                    \
  static_assert(::sandlot::has_control_flags, "link to the CMake target sandlot::control");          \
  extern "C" __attribute__((visibility("default"))) const ::sandlot::PluginTable* sandlot_plugin() { \
    static constexpr const ::sandlot::ControllerKind* kinds[] = {__VA_ARGS__};                       \
    static constexpr ::sandlot::PluginTable table = ::sandlot::plugin_table(name, kinds);            \
    return &table;                                                                                   \
  }
