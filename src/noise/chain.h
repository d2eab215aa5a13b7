#pragma once
/// Errors as a chain of stages in the user's order, for one channel (an axis, a height) or for many values
/// that are measured at once (the beams of a scan):
///
///   noise: [{gaussian: {std: 1 cm}}, {drift: {std: 2 cm, correlation: 10 s}}, {quantise: {step: 1 mm}}]
///
/// Devices hold a ChannelNoiseSpec (noise/channel_noise.h) or a RangeNoiseSpec (noise/range_noise.h) in their
/// Spec, which are read from a map of common keys or from such a list; those call what is here.
///
/// Random   each stage draws from a stream of its own, keyed by the device, the channel, the type of stage
///          and how many of that type come before it. Adding, changing or removing a stage moves no other
///          stage's numbers (but those of later ones of its own type), and what comes in does not either. The
///          stages latency and dropouts with `whole` leave the channel out, so that all channels of a device
///          that have them agree.
/// errors   one factor on all of a chain: 0 exact, 1 as configured, 2 twice. It multiplies amplitudes, steps
///          of quantise, widths of dead zones, delays and their jitter, and how often values are lost or far
///          off (never more often than always). What clip cuts at is what the device can show and stays.
/// Units    the channel's unit U; times in seconds.
/// Errors   none at run time: a spec is validated once, when it is read.
/// Cost     nothing without stages; else those of its stages and a few ns each.
/// Source   of each stage in its own header: additive.h, response.h, faults.h, latency.h. Docs:
///          docs/noise.md.
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/bytes.h"
#include "base/describe.h"
#include "noise/stage.h"

namespace sandlot {

inline constexpr std::size_t max_stages = 16;

/// For the Spec of a device with errors: `visit(errors_field, s.errors)` with `double errors = 1`.
inline constexpr Field errors_field{"errors", "1",  "Factor on all errors: 0 none, 1 as configured.",
                                    0,        1000, Field::tunable | Field::apart};
/// For a spec that can be a chain: `list_key = "stages"` and `visit(stages_field, s.stages)`.
inline constexpr Field stages_field{
    "stages", "", "Stages of errors, one after the other.", 0, 0, Field::none, max_stages, 1};

/// Errors of a channel as a list of stages and nothing else.
struct ChainSpec {
  static constexpr const char* list_key = "stages";
  std::vector<StageSpec> stages;

  static void fields(auto& s, auto&& visit) { visit(stages_field, s.stages); }
};

/// One type of stage, for lists and the schema; the unit of the values is called U.
struct StageType {
  std::string name, help;
  std::vector<FieldInfo> fields;
};
std::vector<StageType> stage_types();

template <class Stages>
std::vector<StageType> types_of(const char* unit) {
  std::vector<StageType> out;
  [&]<std::size_t... i>(std::index_sequence<i...>) {
    const auto one = [&]<class Stage>(const Stage& type) {
      out.push_back({Stage::name, Stage::help, {}});
      describe_struct(type_info<Stage>, &type, "", unit, out.back().fields, false);
    };
    (one(std::variant_alternative_t<i + 1, typename Stages::StageTypes>()), ...);
  }
  (std::make_index_sequence<Stages::types - 1>());
  return out;
}

/// Sum of the variances of the stages about their constant errors, where they have one of their own (walk,
/// proportional and lost values have none).
double variance_of(std::span<const StageSpec> stages, double dt_s, double errors = 1);

/// State of a chain, and the streams it draws from.
struct ChannelChain {
  std::vector<StageState> stages;
  std::vector<std::uint64_t> keys;  ///< per stage: which fork of the device's stream is its own; no State

  static void fields(auto& s, auto&& visit) {
    static constexpr const char* names[max_stages] = {"0", "1", "2",  "3",  "4",  "5",  "6",  "7",
                                                      "8", "9", "10", "11", "12", "13", "14", "15"};
    for (std::size_t i = 0; i < s.stages.size(); ++i)
      visit(Field{names[i], "", "State of this stage."}, s.stages[i]);
  }

  /// Makes ready, draws what is drawn once. Called when the device is created, before any load().
  /// @param random   stream of the device, Purpose::initial; its position does not matter
  /// @param channel  distinguishes several channels of one device: "gyro/x"
  void reset(std::span<const StageSpec> specs, const Stream& random, std::string_view channel = "");
  /// @param truth   [U]
  /// @param dt_s    [s] since the previous sample, > 0
  /// @param random  stream of the device for this sample, Purpose::noise; its position does not matter
  /// @pre reset() was called with as many stages of the same types
  double corrupt(std::span<const StageSpec> specs, double truth, double dt_s, const Stream& random,
                 double errors = 1);
  /// All values of one sample, in place.
  void corrupt(std::span<const StageSpec> specs, std::span<float> values, double dt_s, const Stream& random,
               double errors = 1);
};

// Code from the field lists of all stages is compiled once, not with every kind of device.
SL_EXTERN_FIELDS(StageSpec);
extern template void write_tunables(ByteWriter&, const StageSpec&);
extern template void read_tunables(ByteReader&, StageSpec&);
extern template void write(ByteWriter&, const ChannelChain&);
extern template void read(ByteReader&, ChannelChain&);

}  // namespace sandlot
