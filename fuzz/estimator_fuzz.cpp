/// Any messages at any times to a filter, and states with bytes changed: it answers each message with an outcome, an estimate that it
/// knows is finite, what it keeps is bounded, and a state that passes fits() can be gone on with.
///
/// The first four bytes choose the spec; then come orders of one byte each with what they need.
#include <algorithm>
#include <cmath>

#include "base/bytes.h"
#include "base/check.h"
#include "input.h"
#include "navigation/estimation/ekf.h"

namespace {

using namespace sandlot;
namespace ekf = navigation::ekf;

using fuzz::Input;

ekf::Spec spec_of(Input& in) {
  ekf::Spec spec;
  const std::uint8_t flags = in.byte(), masks = in.byte(), differences = in.byte(), gates = in.byte();
  spec.two_d_mode = flags & 1;
  spec.reset_on_time_jump = flags & 2;
  spec.history_s = flags & 4 ? 0 : 0.5;
  if (flags & 8) spec.datum = navigation::Datum{};
  static constexpr ekf::SensorKind kinds[] = {ekf::SensorKind::odometry, ekf::SensorKind::pose,
                                              ekf::SensorKind::twist, ekf::SensorKind::imu,
                                              ekf::SensorKind::gps};
  static constexpr unsigned measured[] = {0x0fff, 0x003f, 0x0fc0, 0x7e38, 0x0007};
  for (std::size_t i = 0; i < 5; ++i) {
    ekf::Sensor sensor;
    sensor.name = "sensor" + std::to_string(i);
    sensor.kind = kinds[i];
    // One bit for what each kind measures.
    for (std::size_t k = 0; k < ekf::states; ++k)
      sensor.config[k] = (measured[i] >> k & 1) != 0 && (masks >> ((k + i) % 8) & 1) != 0;
    if (sensor.kind != ekf::SensorKind::gps && sensor.kind != ekf::SensorKind::twist) {
      sensor.differential = differences >> i & 1;
      sensor.relative = !sensor.differential && (differences >> (i + 3) & 1) != 0;
    }
    if (sensor.kind == ekf::SensorKind::odometry && sensor.differential)
      sensor.pose_errors = static_cast<ekf::PoseErrors>(gates % 3);
    if (gates >> i & 1) sensor.pose_rejection_threshold = sensor.twist_rejection_threshold = 3;
    sensor.mount.p = {0.1, -0.2, 0.3};
    spec.sensors.push_back(sensor);
  }
  return spec;
}

template <std::size_t n>
void fill(std::array<double, n>& covariance, Input& in) {
  std::size_t side = 1;
  while (side * side < n) ++side;
  const std::uint8_t how = in.byte();
  const double variance = how < 200 ? 1e-6 * (1 + how) : in.number();
  for (std::size_t i = 0; i < side; ++i) covariance[i * side + i] = variance;
  if (how % 16 == 15) covariance[in.byte() % n] = in.number();
}
Vec3 vector(Input& in) { return {in.number(), in.number(), in.number()}; }
Quat turn(Input& in) {
  const std::uint8_t how = in.byte();
  if (how < 200)
    return quat_from_rpy((how % 8) * 0.4 - 1.4, (how / 8 % 8) * 0.4 - 1.4, (how / 64) * 2.0 - 3.0);
  return {in.number(), in.number(), in.number(), in.number()};
}
Time stamp(Input& in, Time now) {
  const std::uint8_t how = in.byte();
  if (how == 255) return {in.whole()};
  return now + Time{(static_cast<std::int64_t>(how) - 200) * 5'000'000};
}

void add(const ekf::Spec& spec, ekf::State& state, std::size_t sensor, Time now, Input& in) {
  const Time at = stamp(in, now);
  const auto put = [&](auto& message) {
    message.header.stamp = at;
    ekf::add(spec, state, sensor, message);
  };
  switch (sensor) {
    case 0: {
      msg::Odometry m;
      m.pose.pose = {vector(in), turn(in)};
      m.twist.twist = {vector(in), vector(in)};
      fill(m.pose.covariance, in);
      fill(m.twist.covariance, in);
      return put(m);
    }
    case 1: {
      msg::PoseWithCovarianceStamped m;
      m.pose.pose = {vector(in), turn(in)};
      fill(m.pose.covariance, in);
      return put(m);
    }
    case 2: {
      msg::TwistWithCovarianceStamped m;
      m.twist.twist = {vector(in), vector(in)};
      fill(m.twist.covariance, in);
      return put(m);
    }
    case 3: {
      msg::Imu m;
      m.orientation = turn(in);
      m.angular_velocity = vector(in);
      m.linear_acceleration = vector(in);
      fill(m.orientation_covariance, in);
      fill(m.angular_velocity_covariance, in);
      fill(m.linear_acceleration_covariance, in);
      return put(m);
    }
    default: {
      msg::NavSatFix m;
      m.status.status = static_cast<std::int8_t>(in.byte() % 4 - 1);
      m.latitude = in.number() / 1e4;
      m.longitude = in.number() / 1e4;
      m.altitude = in.number();
      fill(m.position_covariance, in);
      m.position_covariance_type = in.byte() % 4;
      return put(m);
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input in(data, size);
  const ekf::Spec spec = spec_of(in);
  auto begun = ekf::begin(spec);
  if (!begun) {
    SL_CHECK(!begun.error().what.empty());
    return 0;
  }
  ekf::State state = std::move(*begun);
  Time now;
  for (int orders = 0; !in.empty() && orders < 2000; ++orders) {
    const std::uint8_t order = in.byte();
    if (order % 8 < 5) {
      add(spec, state, order % 8, now, in);
    } else if (order % 8 < 7) {
      now = order == 6 ? Time{in.whole()} : now + Time{(1 + order / 8) * std::int64_t{10'000'000}};
      // A clock of simulations does not go beyond the year 2096.
      now.ns = std::clamp(now.ns, std::int64_t{0}, std::int64_t{4'000'000'000'000'000'000});
      ekf::advance(spec, state, now);
    } else {
      ByteWriter w;
      write(w, state);
      std::vector<std::byte> bytes(w.bytes().begin(), w.bytes().end());
      for (int changes = in.byte() % 4; changes > 0; --changes)
        bytes[static_cast<std::size_t>(in.byte() << 16 | in.byte() << 8 | in.byte()) % bytes.size()] =
            std::byte{in.byte()};
      ekf::State forged;
      ByteReader r(bytes);
      read(r, forged);
      if (!r.ok() || r.remaining() > 0 || !forged.fits(spec)) return 0;
      state = std::move(forged);
    }
    if (order % 8 < 5) continue;
    const ekf::Estimate estimate = ekf::estimate(spec, state, now);
    for (std::size_t i = 0; i < ekf::states && estimate.known; ++i)
      SL_CHECK(std::isfinite(estimate.x[i]) && estimate.P.at(i, i) >= 0 &&
               std::isfinite(estimate.P.at(i, i)));
    SL_CHECK(state.fits(spec));
    SL_CHECK(state.history.size() <= 5000 && state.checkpoints.size() <= 64 && state.queue.size() <= 400);
  }
  return 0;
}
