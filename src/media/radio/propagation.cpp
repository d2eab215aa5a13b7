#include "media/radio/propagation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/math.h"
#include "base/random.h"
#include "media/radio/bit_errors.h"
#include "model/substance.h"

namespace sandlot::media::radio {
namespace {

constexpr double most_deviations = 3;
constexpr double default_range_m = 100;  ///< of the model range

double cut_normal(Stream& random) { return std::clamp(random.normal(), -most_deviations, most_deviations); }

/// What a pair of radios loses for the whole run: symmetric, and independent of all other radios.
double shadowing_dB(const Spec& spec, std::uint64_t seed, std::uint64_t a, std::uint64_t b) {
  constexpr std::uint64_t use = 0x736861646f77;  // "shadow"
  Stream random(seed, hash_combine(hash_combine(std::min(a, b), std::max(a, b)), use), Purpose::medium, 0);
  return spec.shadowing_dB * cut_normal(random);
}

double fading_dB(const Spec& spec, std::uint64_t seed, std::uint64_t from, std::uint64_t to,
                 std::uint64_t number) {
  constexpr std::uint64_t use = 0x666164696e67;  // "fading"
  Stream random(seed, hash_combine(hash_combine(from, to), use), Purpose::medium, number);
  return spec.fading_dB * cut_normal(random);
}

double path_loss_dB(const Spec& spec, double distance_m) {
  return spec.reference_loss_dB +
         spec.exponent * decibels(std::max(1.0, distance_m / spec.reference_distance_m));
}

/// Distance beyond which no receiver can be reached, whatever is drawn.
double reach_m(const Spec& spec, double power_dBm) {
  if (spec.model == Model::range) return spec.range_m.value_or(default_range_m);
  const double margin_dB = power_dBm - spec.reference_loss_dB - floor_dBm(spec) +
                           most_deviations * (spec.shadowing_dB + spec.fading_dB);
  const double carries_m = margin_dB < 0
                               ? 0
                               : spec.reference_distance_m *
                                     math::exp(margin_dB * (std::numbers::ln10 / 10) / spec.exponent);
  // A little farther, so that rounding leaves nobody out: the power itself decides.
  return std::min(1.001 * carries_m, spec.range_m.value_or(std::numeric_limits<double>::infinity()));
}

bool loses_by_obstacles(const Spec& spec) {
  return spec.obstacle_loss_dB > 0 || std::any_of(spec.obstacles.begin(), spec.obstacles.end(),
                                                  [](const ObstacleLoss& each) { return each.loss_dB > 0; });
}

/// Loss by one body: that of its label, else of its substance, else that of all others.
double loss_dB(const Spec& spec, const BodyName& body, const WorldView& world) {
  if (spec.obstacles.empty()) return spec.obstacle_loss_dB;
  const auto named = [&](std::string_view name) -> const ObstacleLoss* {
    if (name.empty()) return nullptr;
    const auto found = std::find_if(spec.obstacles.begin(), spec.obstacles.end(),
                                    [&](const ObstacleLoss& each) { return each.of == name; });
    return found == spec.obstacles.end() ? nullptr : &*found;
  };
  if (const EntityView* const entity = world.find_entity(body.instance)) {
    if (const auto* const found = named(entity->instance->label)) return found->loss_dB;
    if (const auto* const found = named(entity->instance->model->label)) return found->loss_dB;
  }
  for (const model::Collision& collision : body.link->collisions) {
    if (!collision.surface.substance) continue;
    const std::string text = model::text_of(*collision.surface.substance);
    if (const auto* const found = named(std::string_view(text).substr(0, text.find('('))))
      return found->loss_dB;
  }
  return spec.obstacle_loss_dB;
}

/// Sum of the losses by the bodies between sender and receiver.
/// @param hit_m, hit_body  the first surface on the way
double obstacles_dB(const Spec& spec, const MediumContext& context, Vec3 from_W, Vec3 direction_W,
                    double distance_m, BodyId sender, BodyId receiver, float hit_m, std::uint32_t hit_body) {
  constexpr std::size_t most_bodies = 8;
  constexpr int most_surfaces = 32;
  constexpr double behind_m = 1e-4;  // rays go on a little behind the surface that they met
  const Engine& engine = context.world.engine();
  const std::string_view sender_name = engine.name(sender).instance;
  const std::string_view receiver_name = engine.name(receiver).instance;
  std::array<std::uint32_t, most_bodies> counted{};
  std::size_t count = 0;
  double sum_dB = 0;
  for (int surface = 0; surface < most_surfaces; ++surface) {
    if (!(hit_m < distance_m) || hit_body == no_body) break;
    if (std::find(counted.begin(), counted.begin() + static_cast<std::ptrdiff_t>(count), hit_body) ==
        counted.begin() + static_cast<std::ptrdiff_t>(count)) {
      const BodyName body = engine.name(engine.body_at(hit_body));
      if (body.link && body.instance != sender_name && body.instance != receiver_name) {
        sum_dB += loss_dB(spec, body, context.world);
        counted[count++] = hit_body;
        if (count == most_bodies) break;
      }
    }
    const RayJob job{.X_WS = {from_W, {}},
                     .directions = {&direction_W, 1},
                     .min_m = static_cast<double>(hit_m) + behind_m,
                     .max_m = distance_m,
                     .ignore_body = sender.index,
                     .distance_m = {&hit_m, 1},
                     .body = {&hit_body, 1}};
    if (job.min_m >= job.max_m) break;
    context.rays.cast({&job, 1});
  }
  return sum_dB;
}

}  // namespace

void look(const Spec& spec, const Start& start, const Places& places, const MediumContext& context,
          Reached& to) {
  to.directions.clear();
  const Receiver& sender = context.receivers[start.sender];
  const Vec3 from_W = places.point(start.sender);
  const double limit_m = reach_m(spec, start.power_dBm), least_dBm = floor_dBm(spec);
  const bool by_distance = spec.model == Model::log_distance;
  const std::span<const Places::Near> near = places.find_within(from_W, limit_m, to.near);
  to.receivers.resize(near.size());
  to.distances_m.resize(near.size());
  to.powers_dBm.resize(near.size());
  double farthest_m = 0;
  std::size_t count = 0;
  for (const auto& [index, squared_m2] : near) {
    if (index == start.sender || !places.hears(index, start.channel)) continue;
    const double distance_m = std::sqrt(squared_m2);
    if (!(distance_m <= limit_m)) continue;
    double power_dBm = start.power_dBm;
    if (by_distance) {
      power_dBm -= path_loss_dB(spec, distance_m);
      const std::uint64_t key = places.key(index);
      if (spec.shadowing_dB > 0) power_dBm -= shadowing_dB(spec, context.seed, sender.key, key);
      if (spec.fading_dB > 0) power_dBm -= fading_dB(spec, context.seed, sender.key, key, start.number);
    }
    if (power_dBm < least_dBm) continue;
    to.receivers[count] = index;
    to.distances_m[count] = distance_m;
    to.powers_dBm[count++] = power_dBm;
    farthest_m = std::max(farthest_m, distance_m);
  }
  to.receivers.resize(count);
  to.distances_m.resize(count);
  to.powers_dBm.resize(count);
  if (to.receivers.empty() || farthest_m == 0 || !loses_by_obstacles(spec)) return;
  for (std::size_t i = 0; i < to.receivers.size(); ++i)
    to.directions.push_back(to.distances_m[i] > 0
                                ? (places.point(to.receivers[i]) - from_W) * (1 / to.distances_m[i])
                                : Vec3{1, 0, 0});
  to.hit_m.resize(to.receivers.size());
  to.hit_bodies.resize(to.receivers.size());
  const RayJob job{.X_WS = {from_W, {}},
                   .directions = to.directions,
                   .max_m = farthest_m,
                   .ignore_body = sender.body.index,
                   .distance_m = to.hit_m,
                   .body = to.hit_bodies};
  context.rays.cast({&job, 1});
  std::size_t kept = 0;
  for (std::size_t i = 0; i < to.receivers.size(); ++i) {
    const double power_dBm = to.powers_dBm[i] - obstacles_dB(spec, context, from_W, to.directions[i],
                                                             to.distances_m[i], sender.body,
                                                             context.receivers[to.receivers[i]].body,
                                                             to.hit_m[i], to.hit_bodies[i]);
    if (power_dBm < least_dBm) continue;
    to.receivers[kept] = to.receivers[i];
    to.distances_m[kept] = to.distances_m[i];
    to.powers_dBm[kept++] = power_dBm;
  }
  to.receivers.resize(kept);
  to.distances_m.resize(kept);
  to.powers_dBm.resize(kept);
}

}  // namespace sandlot::media::radio
