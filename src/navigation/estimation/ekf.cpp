#include "navigation/estimation/ekf.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/check.h"
#include "navigation/estimation/ekf_step.h"

namespace sandlot::navigation::ekf {
namespace {

constexpr Time last_stamp{4'000'000'000'000'000'000};
constexpr std::size_t most_samples = 4096;
constexpr std::int64_t checkpoints_per_history = 8;

/// The order in which samples are processed.
template <class T>
auto order_of(const T& x) {
  if constexpr (std::is_same_v<T, Core>) return std::tuple(x.at, x.sensor, x.part);
  else return std::tuple(x.stamp, x.sensor, x.part);
}

/// For searches: the first sample after a core.
bool later(const Core& core, const Sample& sample) { return order_of(core) < order_of(sample); }

void count(State& state, const Sample& sample, const Processed& result, std::vector<Report>* reports) {
  SensorRecord& record = state.sensors[sample.sensor];
  ++record.counts[static_cast<std::size_t>(result.outcome)];
  record.last = result.outcome;
  if (result.components) {
    record.squared_distance = result.squared_distance;
    record.components = static_cast<std::uint32_t>(result.components);
  }
  if (result.outcome == Outcome::gated) ++record.gated_in_row;
  if (result.outcome == Outcome::used) record.gated_in_row = 0;
  if (reports)
    reports->push_back({sample.stamp, sample.sensor, sample.part, result.outcome, result.squared_distance,
                        result.components});
}

/// Counts what never reaches the queue.
Outcome refuse(State& state, std::size_t sensor, Outcome outcome) {
  ++state.sensors[sensor].counts[static_cast<std::size_t>(outcome)];
  return state.sensors[sensor].last = outcome;
}

/// The answer before a message is looked into: `queued` when it may come in.
Outcome admit(const Spec& spec, const State& state, std::size_t sensor, Time stamp) {
  if (stamp < Time{} || stamp > last_stamp) return Outcome::bad_stamp;
  const auto same = [&](const Sample& each) { return each.sensor == sensor && each.stamp == stamp; };
  if (std::any_of(state.queue.begin(), state.queue.end(), same)) return Outcome::duplicate;
  const auto first = std::lower_bound(state.history.begin(), state.history.end(), stamp,
                                      [](const Sample& each, Time at) { return each.stamp < at; });
  for (auto each = first; each != state.history.end() && each->stamp == stamp; ++each)
    if (each->sensor == sensor) return Outcome::duplicate;
  std::size_t waiting = 0;  // messages: their parts lie side by side
  for (std::size_t i = 0; i < state.queue.size(); ++i)
    if (state.queue[i].sensor == sensor &&
        (i == 0 || state.queue[i - 1].sensor != sensor || state.queue[i - 1].stamp != state.queue[i].stamp))
      ++waiting;
  if (waiting >= static_cast<std::size_t>(spec.sensors[sensor].queue_size)) return Outcome::full;
  return Outcome::queued;
}

Outcome enqueue(State& state, std::size_t sensor, Time stamp, Samples& samples) {
  SensorRecord& record = state.sensors[sensor];
  for (std::size_t i = 0; i < samples.count; ++i) {
    samples.part[i].stamp = stamp;
    samples.part[i].sensor = static_cast<std::uint32_t>(sensor);
    state.queue.push_back(samples.part[i]);
    ++record.counts[static_cast<std::size_t>(Outcome::queued)];
  }
  return record.last = Outcome::queued;
}

/// The way of every message: admit, turn into samples, queue.
template <class ToSamples>
Outcome take(const Spec& spec, State& state, std::size_t sensor, Time stamp, ToSamples&& to_samples_of) {
  SL_CHECK(sensor < spec.sensors.size() && state.sensors.size() == spec.sensors.size());
  Samples samples;
  Outcome outcome = admit(spec, state, sensor, stamp);
  if (outcome == Outcome::queued) outcome = to_samples_of(spec.sensors[sensor], samples);
  if (outcome != Outcome::queued) return refuse(state, sensor, outcome);
  return enqueue(state, sensor, stamp, samples);
}

/// Begins again. What waits for a time that is far ahead now is dropped as `early` afterwards.
void start_again(const Spec& spec, State& state) {
  Core first = first_core(spec);
  keep_datum(spec, state.core, first);
  state.core = std::move(first);
  state.checkpoints.clear();
  state.history.clear();
  for (SensorRecord& each : state.sensors) each.heard = false;
  ++state.resets;
}

/// Moves what is due from the queue into the history.
/// @return  place of the first of them, or the end
std::size_t gather(const Spec& spec, State& state, Time now, std::vector<Report>* reports) {
  const Time oldest = state.core.at - Time::from_s(spec.history_s), last = now + Time::from_s(spec.future_s);
  std::size_t first = state.history.size(), kept = 0;
  std::sort(state.queue.begin(), state.queue.end(),
            [](const Sample& a, const Sample& b) { return order_of(a) < order_of(b); });
  for (std::size_t i = 0; i < state.queue.size(); ++i) {
    const Sample sample = state.queue[i];
    if (sample.stamp > last) {
      count(state, sample, {Outcome::early}, reports);
    } else if (sample.stamp > now) {
      state.queue[kept++] = sample;
    } else if (!state.checkpoints.empty() &&
               (sample.stamp < oldest || order_of(sample) < order_of(state.checkpoints.front()))) {
      count(state, sample, {Outcome::late}, reports);
    } else {
      SensorRecord& record = state.sensors[sample.sensor];
      record.newest = record.heard ? std::max(record.newest, sample.stamp) : sample.stamp;
      record.heard = true;
      std::size_t at = state.history.size();
      state.history.push_back(sample);
      for (; at > 0 && order_of(sample) < order_of(state.history[at - 1]); --at)
        state.history[at] = state.history[at - 1];
      state.history[at] = sample;
      first = std::min(first, at);
    }
  }
  state.queue.resize(kept);
  return first;
}

/// Goes back to the latest core from before a sample.
void go_back(State& state, const Sample& before) {
  if (!(order_of(before) < order_of(state.core))) return;
  while (state.checkpoints.size() > 1 && !(order_of(state.checkpoints.back()) < order_of(before)))
    state.checkpoints.pop_back();
  state.core = state.checkpoints.back();
  ++state.rewinds;
}

std::size_t held_after(const State& state, const Core& core) {
  const auto begin = std::upper_bound(state.history.begin(), state.history.end(), core, later);
  return static_cast<std::size_t>(state.history.end() - begin);
}

/// Keeps the core as the latest checkpoint, and forgets those that no sample may go back to.
void keep_core(const Spec& spec, State& state) {
  std::vector<Core>& kept = state.checkpoints;
  const Time oldest = state.core.at - Time::from_s(spec.history_s);
  std::size_t drop = 0;
  while (drop + 1 < kept.size() &&
         (kept[drop + 1].at < oldest || held_after(state, kept[drop]) > most_samples))
    ++drop;
  if (drop == 0) return kept.push_back(state.core);
  // A dropped one takes the new core, whose list then needs no memory of its own.
  std::rotate(kept.begin(), kept.begin() + static_cast<std::ptrdiff_t>(drop), kept.end());
  kept[kept.size() - drop] = state.core;
  kept.resize(kept.size() - drop + 1);
}

}  // namespace

Status Spec::check(const Node& node, const std::string& path) const {
  const auto within = [](double x, double low, double high) { return x >= low && x <= high; };  // NaN is not
  for (std::size_t i = 0; i < states; ++i)
    if (!within(process_noise[i], 0, 1e12) || !within(initial_covariance[i], 0, 1e12) ||
        !within(initial_state[i], -1e9, 1e9))
      return node.error("component " + std::to_string(i) + " has no finite value and variances",
                        "variances in [0, 1e12], values in [-1e9, 1e9]", path);
  if (!within(history_s, 0, 60) || !within(future_s, 0, 60) || !within(gravity_mps2, 0, 100))
    return node.error("history, future or gravity is out of range", "0 to 60 s, 0 to 60 s, 0 to 100 m/s^2",
                      path);
  if (sensors.size() > 32) return node.error("there are too many sensors", "at most 32", path + "/sensors");
  if (slots() > ExtraStates::most_slots)
    return node.error("there are too many differential sensors",
                      "at most 6, one less with a receiver, and one less for each that has scale deviations",
                      path + "/sensors");
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    const std::string at = path + "/sensors/" + std::to_string(i);
    for (std::size_t j = 0; j < i; ++j)
      if (sensors[j].name == sensors[i].name)
        return node.error("two sensors are called " + sensors[i].name, "a name of its own for each", at);
    bool counts = !two_d_mode;
    for (std::size_t k = 0; k < states; ++k) counts = counts || (sensors[i].config[k] && !pinned_in_plane[k]);
    if (!counts)
      return node.error("sensor " + sensors[i].name + " measures only what two_d_mode holds at 0",
                        "x, y, yaw, vx, vy, vyaw, ax or ay", at);
  }
  return {};
}

std::size_t Spec::clone_slot(std::size_t sensor) const {
  std::size_t slot = 0;
  for (std::size_t i = 0; i < sensor; ++i) slot += sensors[i].differential;
  return slot;
}

std::optional<std::size_t> Spec::datum_slot() const {
  if (datum) return std::nullopt;
  for (const Sensor& each : sensors)
    if (each.kind == SensorKind::gps) return clone_slot(sensors.size());
  return std::nullopt;
}

std::optional<std::size_t> Spec::scale_slot(std::size_t sensor) const {
  if (!sensors[sensor].scaled()) return std::nullopt;
  std::size_t slot = clone_slot(sensors.size()) + (datum_slot() ? 1 : 0);
  for (std::size_t i = 0; i < sensor; ++i) slot += sensors[i].scaled();
  return slot;
}

std::size_t Spec::slots() const {
  std::size_t slots = clone_slot(sensors.size()) + (datum_slot() ? 1 : 0);
  for (const Sensor& each : sensors) slots += each.scaled();
  return slots;
}

Result<State> begin(const Spec& spec) {
  for (std::size_t i = 0; i < spec.sensors.size(); ++i)
    SL_TRY(spec.sensors[i].check(Node{}, "/sensors/" + std::to_string(i)));
  SL_TRY(spec.check(Node{}, ""));
  State state;
  state.core = first_core(spec);
  state.sensors.resize(spec.sensors.size());
  state.datum = spec.datum;
  return state;
}

std::optional<std::size_t> find_sensor(const Spec& spec, std::string_view name) {
  for (std::size_t i = 0; i < spec.sensors.size(); ++i)
    if (spec.sensors[i].name == name) return i;
  return std::nullopt;
}

Outcome add(const Spec& spec, State& state, std::size_t sensor, const msg::Odometry& message) {
  return take(spec, state, sensor, message.header.stamp, [&](const Sensor& of, Samples& out) {
    SL_CHECK(of.kind == SensorKind::odometry);
    return to_samples(of, message, out);
  });
}

Outcome add(const Spec& spec, State& state, std::size_t sensor,
            const msg::PoseWithCovarianceStamped& message) {
  return take(spec, state, sensor, message.header.stamp, [&](const Sensor& of, Samples& out) {
    SL_CHECK(of.kind == SensorKind::pose);
    return to_samples(of, message.pose, out);
  });
}

Outcome add(const Spec& spec, State& state, std::size_t sensor,
            const msg::TwistWithCovarianceStamped& message) {
  return take(spec, state, sensor, message.header.stamp, [&](const Sensor& of, Samples& out) {
    SL_CHECK(of.kind == SensorKind::twist);
    return to_samples(of, message.twist, out);
  });
}

Outcome add(const Spec& spec, State& state, std::size_t sensor, const msg::Imu& message) {
  return take(spec, state, sensor, message.header.stamp, [&](const Sensor& of, Samples& out) {
    SL_CHECK(of.kind == SensorKind::imu);
    return to_samples(of, message, spec.gravity_mps2, out);
  });
}

Outcome add(const Spec& spec, State& state, std::size_t sensor, const msg::NavSatFix& message) {
  return take(spec, state, sensor, message.header.stamp, [&](const Sensor& of, Samples& out) {
    SL_CHECK(of.kind == SensorKind::gps);
    if (const Outcome outcome = usable_fix(of, message); outcome != Outcome::queued) return outcome;
    if (!state.datum) {
      // The fix is that of the antenna, where the robot is by the estimate at present.
      const geodesy::Geodetic place = place_of(message, 0);
      const Pose X_WB = estimate(spec, state, state.core.at).pose();
      const Vec3 antenna = X_WB * of.mount.p;
      state.datum = Datum{place.latitude_rad, place.longitude_rad, place.height_m, 0, antenna};
    }
    return to_samples(of, message, *state.datum, out);
  });
}

void advance(const Spec& spec, State& state, Time now, std::vector<Report>* reports) {
  SL_CHECK(state.sensors.size() == spec.sensors.size());
  now = std::clamp(now, Time{}, last_stamp);
  if (spec.reset_on_time_jump && state.core.at > now && state.core.at - now > Time::from_s(spec.history_s))
    start_again(spec, state);
  state.now = now;
  if (state.queue.empty()) return;
  const std::size_t first = gather(spec, state, now, reports);
  if (first == state.history.size()) return;
  go_back(state, state.history[first]);

  const Vector noise = process_noise(spec);
  const auto next = std::upper_bound(state.history.begin(), state.history.end(), state.core, later);
  const Time spacing{Time::from_s(spec.history_s).ns / checkpoints_per_history};
  std::size_t since = state.checkpoints.empty() ? 0
                                                : held_after(state, state.checkpoints.back()) -
                                                      static_cast<std::size_t>(state.history.end() - next);
  for (auto sample = next; sample != state.history.end(); ++sample, ++since) {
    // Before the first sample, then at the first of a new time when enough has come since the last checkpoint.
    if (state.checkpoints.empty() ||
        (since > 0 && sample->stamp > state.core.at &&
         (sample->stamp - state.checkpoints.back().at >= spacing || since >= most_samples / 8))) {
      keep_core(spec, state);
      since = 0;
    }
    const Processed result = process(spec, noise, state.core, *sample);
    if (!sample->counted) count(state, *sample, result, reports);
    sample->counted = true;
  }
  state.history.erase(state.history.begin(), state.history.end() - static_cast<std::ptrdiff_t>(held_after(
                                                                       state, state.checkpoints.front())));
}

Pose Estimate::pose() const { return pose_from_rpy({x[X], x[Y], x[Z]}, {x[Roll], x[Pitch], x[Yaw]}); }

Estimate estimate(const Spec& spec, const State& state, Time at) {
  const Core& core = state.core;
  Estimate out{core.known, std::max(at, core.at), core.x, core.P};
  out.at = std::min(out.at, last_stamp);
  if (core.known && out.at > core.at) predict(out.x, out.P, process_noise(spec), (out.at - core.at).s());
  return out;
}

void write_message(const Estimate& estimate, msg::Odometry& out) {
  out.header.stamp = estimate.at;
  out.pose.pose = estimate.pose();
  out.twist.twist.linear = {estimate.x[Vx], estimate.x[Vy], estimate.x[Vz]};
  out.twist.twist.angular = {estimate.x[Vroll], estimate.x[Vpitch], estimate.x[Vyaw]};
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j) {
      out.pose.covariance[6 * i + j] = estimate.P.at(X + i, X + j);
      out.twist.covariance[6 * i + j] = estimate.P.at(Vx + i, Vx + j);
    }
}

Pose map_to_odom(const Estimate& in_map, const Estimate& in_odom) {
  Pose X = in_map.pose() * inverse(in_odom.pose());
  X.q = normalised(X.q);
  return X;
}

bool State::fits(const Spec& spec) const {
  const auto finite = [](const auto& list) {
    return std::all_of(list.begin(), list.end(), [](double each) { return std::isfinite(each); });
  };
  const auto stamped = [](Time at) { return at >= Time{-1} && at <= last_stamp; };
  const auto complete = [&](const Core& each) {
    if (!stamped(each.at) || !sound_core(each) || !finite(each.P.padded)) return false;
    if (each.memories.size() != spec.sensors.size() || !each.extra.sound(spec.slots(), most_core))
      return false;
    return std::all_of(each.memories.begin(), each.memories.end(), [&](const Memory& memory) {
      return stamped(memory.at) && finite(memory.value) && finite(memory.covariance);
    });
  };
  const auto sound_samples = [&](const std::vector<Sample>& samples) {
    return std::all_of(samples.begin(), samples.end(), [&](const Sample& each) {
      return each.sensor < spec.sensors.size() && each.stamp >= Time{} && stamped(each.stamp) &&
             finite(each.value) && finite(each.covariance);
    });
  };
  const auto in_order = [](const auto& list) {
    return std::is_sorted(list.begin(), list.end(),
                          [](const auto& a, const auto& b) { return order_of(a) < order_of(b); });
  };
  return sensors.size() == spec.sensors.size() && stamped(now) && complete(core) &&
         std::all_of(checkpoints.begin(), checkpoints.end(), complete) && in_order(checkpoints) &&
         sound_samples(history) && sound_samples(queue) && in_order(history) &&
         (checkpoints.empty() ? history.empty() && !core.known
                              : order_of(checkpoints.back()) < order_of(core)) &&
         (!datum ||
          (finite(std::array{datum->latitude_rad, datum->longitude_rad, datum->altitude_m, datum->yaw_rad}) &&
           is_finite(datum->offset_m)));
}

}  // namespace sandlot::navigation::ekf
