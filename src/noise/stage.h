#pragma once
/// Stage of a chain of errors: in files a map with one key, the name of its type.
///
///   {gaussian: {std: 1 cm}}
///
/// A type of stage is a struct with `name`, `help`, a field list, a State and one of three forms of work:
///   double corrupt(x, sample, random) const                  each value by itself, no state
///   void advance(state, sample, random) const, double show(state, x, sample) const     once per sample, shared
///   corrupt(state, x, sample, random), corrupt(state, span, sample, random)            both written out
/// and, where they mean something, reset(state, random) and variance(dt_s) about its constant part, at errors
/// = 1.
#include <concepts>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "noise/faults.h"
#include "noise/latency.h"
#include "noise/ranging.h"
#include "noise/response.h"

namespace sandlot {

/// Stage of one of the types of a family. The family has the name for descriptions (`described_as`) and the
/// types as a std::variant<std::monostate, ...> `Spec`.
template <class Family>
struct StageOf {
  using StageTypes = typename Family::Spec;
  static constexpr const char* described_as = Family::described_as;
  static constexpr std::size_t types = std::variant_size_v<StageTypes>;
  StageTypes stage;

  StageOf() = default;
  template <class Stage>
  requires std::constructible_from<StageTypes, Stage> StageOf(Stage s)
      : stage(std::move(s)) {}  // NOLINT: a stage of a type is a stage

  /// "gaussian"; "" before it was read.
  const char* name() const {
    return std::visit(
        [](const auto& s) -> const char* {
          if constexpr (requires { s.name; }) return s.name;
          else return "";
        },
        stage);
  }
  /// The key of each type is a field; the one that is there is the stage.
  static void fields(auto& s, auto&& visit) {
    [&]<std::size_t... i>(std::index_sequence<i...>) { (field<i + 1>(s, visit), ...); }
    (std::make_index_sequence<types - 1>());
  }
  Status check(const Node& node, const std::string& path) const {
    if (std::holds_alternative<std::monostate>(stage))
      return node.error("a stage without a name", "write it as {gaussian: {std: 0.1}}", path);
    if (node.is_map() && node.entries().size() > 1)
      return node.error("two stages in one entry of the list",
                        "begin a new entry for '" + node.entries()[1].key + "'", path);
    return {};
  }

 private:
  template <std::size_t i>
  static void field(auto& s, auto&& visit) {
    using Stage = std::variant_alternative_t<i, StageTypes>;
    std::optional<Stage> here;
    if (s.stage.index() == i) here = std::get<i>(s.stage);
    visit(Field{Stage::name, "", Stage::help}, here);
    if constexpr (!std::is_const_v<std::remove_reference_t<decltype(s)>>)
      if (here) s.stage = std::move(*here);
  }
};

namespace noise_detail {
template <class... Stages>
struct StageTypes {
  static constexpr const char* described_as = "noise";
  using Spec = std::variant<std::monostate, Stages...>;
  using State = std::variant<std::monostate, typename Stages::State...>;
};
using All = StageTypes<GaussianSpec, WhiteSpec, UniformSpec, ProportionalSpec, DriftSpec, BiasSpec, WalkSpec,
                       ScaleSpec, QuantiseSpec, ClipSpec, DeadZoneSpec, DropoutsSpec, OutliersSpec,
                       LatencySpec, GrowingSpec, MixedSpec, ShortSpec, MultipathSpec, LagSpec>;
}  // namespace noise_detail

/// A stage for values: a reading, an axis, the beams of a scan.
using StageSpec = StageOf<noise_detail::All>;

struct StageState {
  noise_detail::All::State state;  ///< of the type of its StageSpec

  static void fields(auto& s, auto&& visit) {
    [&]<std::size_t... i>(std::index_sequence<i...>) { (field<i + 1>(s, visit), ...); }
    (std::make_index_sequence<StageSpec::types - 1>());
  }

 private:
  template <std::size_t i>
  static void field(auto& s, auto&& visit) {
    using Stage = std::variant_alternative_t<i, noise_detail::All::Spec>;
    if (s.state.index() == i) visit(Field{Stage::name, "", Stage::help}, std::get<i>(s.state));
  }
};

}  // namespace sandlot
