#include "navigation/estimation/ekf_step.h"

#include <cmath>

#include "base/math.h"

namespace sandlot::navigation::ekf {
namespace {

constexpr double unknown_place = 1e8;  // [m^2]

Processed answer_of(const Correction& correction, std::size_t count) {
  if (correction.is == Correction::Is::singular) return {Outcome::bad_covariance};
  return {correction.is == Correction::Is::used ? Outcome::used : Outcome::gated, correction.squared_distance,
          count};
}

/// Which of a part's six numbers are used.
/// @param first  index in config of the first of them
std::array<bool, 6> used_of(const Spec& spec, const Sensor& sensor, std::size_t first) {
  std::array<bool, 6> out{};
  for (std::size_t i = 0; i < 6 && first + i < states; ++i)
    out[i] = sensor.config[first + i] && !(spec.two_d_mode && pinned_in_plane[first + i]);
  return out;
}

/// The way and turn since an earlier pose of the filter, by H: p_AB = R_A^T (p_B - p_A), and errors of turns about A's axes.
Processed compare_movement(const Spec& spec, Core& core, const Sample& sample, const Movement& moved,
                           double dt_s) {
  const Sensor& sensor = spec.sensors[sample.sensor];
  const std::size_t slot = spec.clone_slot(sample.sensor);
  const double* a = &core.extra.x[slot * ExtraStates::per_slot];
  const Vector& b = core.x;
  const Pose X_WA = pose_from_rpy({a[0], a[1], a[2]}, {a[3], a[4], a[5]}),
             X_WB = pose_from_rpy({b[X], b[Y], b[Z]}, {b[Roll], b[Pitch], b[Yaw]});
  const Vec3 way_W = X_WB.p - X_WA.p, way_A = rotate_inverse(X_WA.q, way_W);
  const Quat q_AB = conjugate(X_WA.q) * X_WB.q;
  // What a sensor with relative errors measures: (1 + s) way, (1 + t) turn. Turns of one difference are small.
  const auto scale = spec.scale_slot(sample.sensor);
  const double* relative = scale ? &core.extra.x[*scale * ExtraStates::per_slot] : nullptr;
  const double way_scale = relative ? 1 + relative[0] : 1, turn_scale = relative ? 1 + relative[1] : 1;
  const Vec3 turn_AB = scale ? turn_vector(q_AB) : Vec3{};
  const Vec3 turn_A = turn_vector(moved.X_AB.q * conjugate(q_AB)) - (turn_scale - 1) * turn_AB;
  const auto turns_a = turns_by_angles(a[4], a[5]), turns_b = turns_by_angles(b[Pitch], b[Yaw]);
  std::array<Vec3, 3> by_place, by_a, by_b, by_a_way;  // columns of R_A^T, and of it times the turns of both
  for (std::size_t k = 0; k < 3; ++k) {
    Vec3 axis;
    axis[k] = 1;
    const Vec3 e_a{turns_a[k][0], turns_a[k][1], turns_a[k][2]},
        e_b{turns_b[k][0], turns_b[k][1], turns_b[k][2]};
    by_place[k] = rotate_inverse(X_WA.q, axis);
    by_a[k] = rotate_inverse(X_WA.q, e_a), by_b[k] = rotate_inverse(X_WA.q, e_b);
    by_a_way[k] = rotate_inverse(X_WA.q, cross(way_W, e_a));
  }

  Measurement measurement;
  std::array<std::size_t, 6> taken{};
  const std::array<bool, 6> used = used_of(spec, sensor, X);
  for (std::size_t i = 0; i < 6; ++i) {
    if (!used[i]) continue;
    auto& H = measurement.H[measurement.count];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t place = ExtraStates::column(slot, k), angle = ExtraStates::column(slot, 3 + k);
      if (i < 3) {
        H[X + k] = way_scale * by_place[k][i], H[place] = -way_scale * by_place[k][i];
        H[angle] = way_scale * by_a_way[k][i];
      } else {
        H[Roll + k] = turn_scale * by_b[k][i - 3], H[angle] = -turn_scale * by_a[k][i - 3];
      }
    }
    if (scale) H[ExtraStates::column(*scale, i < 3 ? 0 : 1)] = i < 3 ? way_A[i] : turn_AB[i - 3];
    measurement.y[measurement.count] = i < 3 ? moved.X_AB.p[i] - way_scale * way_A[i] : turn_A[i - 3];
    taken[measurement.count++] = i;
  }
  const std::size_t m = measurement.count;
  if (m == 0) return {Outcome::unmeasured};
  auto& N = measurement.noise;
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t j = 0; j < m; ++j) N[i * m + j] = moved.covariance[triangle_index(taken[i], taken[j])];
  if (sensor.deviation.size() == states)
    for (std::size_t i = 0; i < m; ++i) {
      const double deviation = sensor.deviation[Vx + taken[i]] * dt_s;
      if (!(deviation > 0)) continue;
      for (std::size_t j = 0; j < m; ++j) N[i * m + j] = N[j * m + i] = 0;
      N[i * m + i] = deviation * deviation;
    }
  if (!positive_definite(std::span(N).first(m * m), m)) return {Outcome::bad_covariance};
  return answer_of(correct(core.x, core.P, core.extra, measurement, sensor.pose_rejection_threshold), m);
}

Processed compare(const Spec& spec, Core& core, const Sample& given, bool is_twist_of_difference = false);

/// A pose that counts from the one before. Afterwards it is what the next one counts from.
Processed compare_difference(const Spec& spec, Core& core, const Sample& sample) {
  const Sensor& sensor = spec.sensors[sample.sensor];
  Memory& memory = core.memories[sample.sensor];
  const Memory before = memory;
  memory = {true, false, sample.stamp, sample.value, sample.covariance};
  const double dt_s = (sample.stamp - before.at).s();
  Processed result{Outcome::started};
  if (before.set && dt_s > 0 && dt_s <= sensor.longest_gap_s && before.cloned == core.known) {
    Sample from;
    from.value = before.value, from.covariance = before.covariance;
    if (core.known) {
      result = compare_movement(spec, core, sample, movement(from, sample, sensor.pose_errors, dt_s), dt_s);
    } else {
      Sample twist;
      difference(from, sample, sensor.pose_errors, dt_s, twist);
      // Relative errors make these velocities unsure; what they share with later ones is not kept.
      const double variances[] = {sensor.way_scale_deviation * sensor.way_scale_deviation,
                                  sensor.turn_scale_deviation * sensor.turn_scale_deviation};
      for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t j = i / 3 * 3; j <= i; ++j)
          twist.covariance[triangle_index(i, j)] += variances[i / 3] * twist.value[i] * twist.value[j];
      result = compare(spec, core, twist, true);
    }
  }
  if (result.outcome == Outcome::gated && sensor.pose_errors == PoseErrors::independent) {
    memory = before;
    return result;
  }
  if (core.known) {
    clone_pose(core.extra, spec.clone_slot(sample.sensor), core.x, core.P);
    memory.cloned = true;
  }
  return result;
}

/// A fix, with the antenna's arm and the datum's place. The sample is the antenna's place by the datum.
Processed compare_fix(const Spec& spec, Core& core, const Sample& sample) {
  const Sensor& sensor = spec.sensors[sample.sensor];
  const auto slot = spec.datum_slot();
  const Vec3 arm_W = rotate(quat_from_rpy(core.x[Roll], core.x[Pitch], core.x[Yaw]), sensor.mount.p);
  const auto turns = turns_by_angles(core.x[Pitch], core.x[Yaw]);
  const bool places = slot && !core.datum_set;
  const std::array<bool, 6> used = used_of(spec, sensor, X);
  Measurement measurement;
  std::array<std::size_t, 3> taken{};
  for (std::size_t i = 0; i < 3; ++i) {
    if (!used[i] && !places) continue;
    auto& H = measurement.H[measurement.count];
    H[X + i] = 1;
    for (std::size_t k = 0; k < 3; ++k)
      H[Roll + k] = cross({turns[k][0], turns[k][1], turns[k][2]}, arm_W)[i];
    double expected = core.x[X + i] + arm_W[i];
    if (slot && !places) {
      H[ExtraStates::column(*slot, i)] = -1;
      expected -= core.extra.x[*slot * ExtraStates::per_slot + i];
    }
    measurement.y[measurement.count] = sample.value[i] - expected;
    taken[measurement.count++] = i;
  }
  const std::size_t m = measurement.count;
  if (m == 0) return {Outcome::unmeasured};
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t j = 0; j < m; ++j)
      measurement.noise[i * m + j] = sample.covariance[triangle_index(taken[i], taken[j])];
  if (!places)
    return answer_of(correct(core.x, core.P, core.extra, measurement, sensor.pose_rejection_threshold), m);
  // Place of the datum: where the antenna is thought to be, less where the fix has it. A height that is not measured is not known.
  for (std::size_t i = 0; i < m; ++i) {
    measurement.y[i] = -measurement.y[i];
    if (used[i]) continue;
    measurement.y[i] = 0;
    measurement.H[i] = {};
    for (std::size_t j = 0; j < m; ++j) measurement.noise[i * m + j] = measurement.noise[j * m + i] = 0;
    measurement.noise[i * m + i] = unknown_place;
  }
  set_slot(core.extra, *slot, core.P, measurement);
  core.datum_set = core.known = true;
  return {Outcome::started};
}

/// Compares a sample with the estimate at its time, and corrects that.
/// @param is_twist_of_difference  `config` of poses says what of it is used
Processed compare(const Spec& spec, Core& core, const Sample& given, bool is_twist_of_difference) {
  const Sensor& sensor = spec.sensors[given.sensor];
  const auto slot = spec.datum_slot();
  if (given.part == Part::pose && sensor.differential) return compare_difference(spec, core, given);
  const bool has_arm = sensor.kind == SensorKind::gps && !(sensor.mount.p == Vec3{});
  if (sensor.kind == SensorKind::gps && (slot ? core.known || !core.datum_set : core.known && has_arm))
    return compare_fix(spec, core, given);
  Sample sample = given;
  const std::size_t chosen_from = is_twist_of_difference ? X : first_index(given.part);
  if (given.part == Part::pose && sensor.relative) {
    Memory& memory = core.memories[given.sensor];
    if (!memory.set) memory = {true, false, sample.stamp, sample.value, sample.covariance};
    make_relative(memory.value, sample);
  }
  if (has_arm || sample.holds_gravity) {
    const Quat q_WB = quat_from_rpy(core.x[Roll], core.x[Pitch], core.x[Yaw]);
    const Vec3 less = has_arm ? rotate(q_WB, sensor.mount.p)
                              : rotate_inverse(q_WB, {0, 0, spec.gravity_mps2});
    for (std::size_t i = 0; i < 3; ++i) sample.value[i] -= less[i];
  }
  if (sensor.kind == SensorKind::gps && slot)  // begins again, with a datum from before
    for (std::size_t i = 0; i < 3; ++i) {
      sample.value[i] += core.extra.x[*slot * ExtraStates::per_slot + i];
      for (std::size_t j = 0; j <= i; ++j)
        sample.covariance[triangle_index(i, j)] += core.extra.row(*slot, i)[ExtraStates::column(*slot, j)];
    }

  Innovation innovation;
  std::array<std::size_t, 6> taken{};
  const std::size_t first = first_index(sample.part);
  for (std::size_t i = 0; i < 6 && first + i < states; ++i) {
    const std::size_t index = first + i;
    if (!sensor.config[chosen_from + i] || (spec.two_d_mode && pinned_in_plane[index])) continue;
    taken[innovation.count] = i;
    innovation.index[innovation.count] = index;
    const double y = sample.value[i] - core.x[index];
    innovation.y[innovation.count++] = is_angle(index) ? math::wrap_angle(y) : y;
  }
  const std::size_t m = innovation.count;
  if (m == 0) return {Outcome::unmeasured};
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t j = 0; j < m; ++j)
      innovation.noise[i * m + j] = sample.covariance[triangle_index(taken[i], taken[j])];
  if (is_twist_of_difference) {
    // A difference's covariance was not known when the message was checked.
    if (sensor.deviation.size() == states)
      for (std::size_t i = 0; i < m; ++i) {
        const double deviation = sensor.deviation[innovation.index[i]];
        if (!(deviation > 0)) continue;
        for (std::size_t j = 0; j < m; ++j) innovation.noise[i * m + j] = innovation.noise[j * m + i] = 0;
        innovation.noise[i * m + i] = deviation * deviation;
      }
    if (!positive_definite(std::span(innovation.noise).first(m * m), m)) return {Outcome::bad_covariance};
  }

  if (!core.known) {
    core.known = true;
    for (std::size_t i = 0; i < m; ++i) {
      core.x[innovation.index[i]] += innovation.y[i];
      for (std::size_t j = 0; j < m; ++j)
        core.P.at(innovation.index[i], innovation.index[j]) = innovation.noise[i * m + j];
    }
    wrap_angles(core.x);
    return {Outcome::used, 0, 0};
  }
  const double gate = sample.part == Part::pose    ? sensor.pose_rejection_threshold
                      : sample.part == Part::twist ? sensor.twist_rejection_threshold
                                                   : sensor.acceleration_rejection_threshold;
  if (core.extra.slots() == 0) return answer_of(correct(core.x, core.P, innovation, gate), m);
  Measurement measurement;
  measurement.count = m;
  measurement.y = innovation.y;
  measurement.noise = innovation.noise;
  for (std::size_t i = 0; i < m; ++i) measurement.H[i][innovation.index[i]] = 1;
  return answer_of(correct(core.x, core.P, core.extra, measurement, gate), m);
}

}  // namespace

Core first_core(const Spec& spec) {
  Core core;
  core.extra = ExtraStates(spec.slots());
  core.x = spec.initial_state;
  for (std::size_t i = 0; i < states; ++i) {
    core.P.at(i, i) = spec.initial_covariance[i];
    if (spec.two_d_mode && pinned_in_plane[i]) core.x[i] = core.P.at(i, i) = 0;
  }
  wrap_angles(core.x);
  core.memories.resize(spec.sensors.size());
  for (std::size_t s = 0; s < spec.sensors.size(); ++s) {
    const Sensor& sensor = spec.sensors[s];
    const auto slot = spec.scale_slot(s);
    if (!slot) continue;
    const double deviations[] = {sensor.way_scale_deviation, sensor.turn_scale_deviation};
    for (std::size_t i = 0; i < 2; ++i)
      core.extra.row(*slot, i)[ExtraStates::column(*slot, i)] = deviations[i] * deviations[i];
  }
  return core;
}

Vector process_noise(const Spec& spec) {
  Vector noise = spec.process_noise;
  for (std::size_t i = 0; i < states; ++i)
    if (spec.two_d_mode && pinned_in_plane[i]) noise[i] = 0;
  return noise;
}

void keep_datum(const Spec& spec, const Core& from, Core& to) {
  const auto slot = spec.datum_slot();
  if (!slot || !from.datum_set || !from.extra.sound(spec.slots(), most_core)) return;
  constexpr std::size_t n = ExtraStates::per_slot;
  to.datum_set = true;
  for (std::size_t i = 0; i < n; ++i) {
    to.extra.x[*slot * n + i] = from.extra.x[*slot * n + i];
    for (std::size_t j = 0; j < n; ++j) {
      const std::size_t column = ExtraStates::column(*slot, j);
      to.extra.row(*slot, i)[column] = from.extra.row(*slot, i)[column];
    }
  }
}

bool sound_core(const Core& core) {
  for (std::size_t s = 0; s < core.extra.slots(); ++s)
    for (std::size_t i = 0; i < ExtraStates::per_slot; ++i) {
      const double variance = core.extra.variance(s, i);
      if (!(variance >= 0 && variance <= most_core)) return false;
      if (!(std::abs(core.extra.x[s * ExtraStates::per_slot + i]) <= most_core)) return false;
    }
  for (std::size_t i = 0; i < states; ++i)
    if (!(std::abs(core.x[i]) <= most_core) || !(core.P.at(i, i) >= 0 && core.P.at(i, i) <= most_core))
      return false;
  return true;
}

Processed process(const Spec& spec, const Vector& noise, Core& core, const Sample& sample) {
  if (core.known && sample.stamp > core.at) {
    const double dt_s = (sample.stamp - core.at).s();
    if (core.extra.slots() > 0) carry(core.extra, transition(core.x, dt_s));
    predict(core.x, core.P, noise, dt_s);
  }
  core.at = sample.stamp, core.sensor = sample.sensor, core.part = sample.part;
  const Processed result = compare(spec, core, sample);
  if (sound_core(core)) return result;
  // The next sample begins again.
  Core first = first_core(spec);
  first.at = core.at, first.sensor = core.sensor, first.part = core.part;
  keep_datum(spec, core, first);
  core = std::move(first);
  return {Outcome::diverged};
}

}  // namespace sandlot::navigation::ekf
