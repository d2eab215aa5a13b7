#include "noise/chain.h"

#include <algorithm>
#include <array>

#include "base/check.h"

namespace sandlot {
SL_COMPILE_FIELDS(StageSpec);
template void write_tunables(ByteWriter&, const StageSpec&);
template void read_tunables(ByteReader&, StageSpec&);
template void write(ByteWriter&, const ChannelChain&);
template void read(ByteReader&, ChannelChain&);

namespace {

/// Calls work(spec, state) with the stage's own types.
template <class Work>
void with_stage(const StageSpec& spec, StageState& state, Work&& work) {
  [&]<std::size_t... i>(std::index_sequence<i...>) {
    const auto one = [&]<std::size_t type>(std::integral_constant<std::size_t, type>) {
      if (spec.stage.index() != type) return false;
      work(std::get<type>(spec.stage), std::get<type>(state.state));
      return true;
    };
    // The first that fits ends the search.
    const bool found = (one(std::integral_constant<std::size_t, i + 1>()) || ...);
    SL_CHECK(found);
  }
  (std::make_index_sequence<StageSpec::types - 1>());
}

template <class Spec, class State>
double corrupt_one(const Spec& spec, State& state, double x, const NoiseSample& sample, Stream& random) {
  if constexpr (requires { spec.advance(state, sample, random); }) {
    spec.advance(state, sample, random);
    return std::isfinite(x) ? spec.show(state, x, sample) : x;
  } else if constexpr (requires { spec.corrupt(state, x, sample, random); }) {
    return spec.corrupt(state, x, sample, random);
  } else {
    (void)state;
    return spec.corrupt(x, sample, random);
  }
}

template <class Spec, class State>
void corrupt_all(const Spec& spec, State& state, std::span<float> values, const NoiseSample& sample,
                 Stream& random) {
  if constexpr (requires { spec.advance(state, sample, random); }) {
    spec.advance(state, sample, random);
    for (float& value : values)
      if (std::isfinite(value))
        value = static_cast<float>(spec.show(state, static_cast<double>(value), sample));
  } else if constexpr (requires { spec.corrupt(state, values, sample, random); }) {
    spec.corrupt(state, values, sample, random);
  } else {
    (void)state;
    for (float& value : values)
      value = static_cast<float>(spec.corrupt(static_cast<double>(value), sample, random));
  }
}

}  // namespace

std::vector<StageType> stage_types() { return types_of<StageSpec>("U"); }

double variance_of(std::span<const StageSpec> stages, double dt_s, double errors) {
  double sum = 0;
  for (const StageSpec& each : stages)
    std::visit(
        [&](const auto& spec) {
          if constexpr (requires { spec.variance(dt_s); }) sum += spec.variance(dt_s);
        },
        each.stage);
  return errors * errors * sum;
}

void ChannelChain::reset(std::span<const StageSpec> specs, const Stream& random, std::string_view channel) {
  stages.assign(specs.size(), {});
  keys.assign(specs.size(), 0);
  std::array<std::uint64_t, StageSpec::types> before{};
  for (std::size_t i = 0; i < specs.size(); ++i) {
    const std::size_t type = specs[i].stage.index();
    const auto* const dropouts = std::get_if<DropoutsSpec>(&specs[i].stage);
    const bool common = (dropouts && dropouts->whole) || std::holds_alternative<LatencySpec>(specs[i].stage);
    keys[i] = hash_combine(hash64(specs[i].name(), hash64(common ? "" : channel)), before[type]++);
    [&]<std::size_t... k>(std::index_sequence<k...>) {
      (void)((type == k + 1 && (stages[i].state.template emplace<k + 1>(), true)) || ...);
    }
    (std::make_index_sequence<StageSpec::types - 1>());
    with_stage(specs[i], stages[i], [&](const auto& spec, auto& state) {
      Stream own = random.fork(keys[i]);
      if constexpr (requires { spec.reset(state, own); }) spec.reset(state, own);
    });
  }
}

double ChannelChain::corrupt(std::span<const StageSpec> specs, double truth, double dt_s,
                             const Stream& random, double errors) {
  SL_CHECK(specs.size() == stages.size());
  const NoiseSample sample{dt_s, errors};
  double x = truth;
  for (std::size_t i = 0; i < specs.size(); ++i) {
    Stream own = random.fork(keys[i]);
    with_stage(specs[i], stages[i],
               [&](const auto& spec, auto& state) { x = corrupt_one(spec, state, x, sample, own); });
  }
  return x;
}

void ChannelChain::corrupt(std::span<const StageSpec> specs, std::span<float> values, double dt_s,
                           const Stream& random, double errors) {
  SL_CHECK(specs.size() == stages.size());
  const NoiseSample sample{dt_s, errors};
  for (std::size_t i = 0; i < specs.size(); ++i) {
    Stream own = random.fork(keys[i]);
    with_stage(specs[i], stages[i],
               [&](const auto& spec, auto& state) { corrupt_all(spec, state, values, sample, own); });
  }
}

}  // namespace sandlot
