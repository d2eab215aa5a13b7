#include <fmt/format.h>

#include "validation/world.h"

namespace sandlot::validation {
namespace {

constexpr double ball_m = 0.11, ball_kg = 0.45;

model::Instance ball(const std::string& name, Vec3 p, double mass_kg, double restitution, double mu = 0) {
  return test::body_of(name, Sphere{ball_m}, mass_kg, {p, {}}, surface(mu, restitution));
}

struct After {
  Vec3 a, b;
};

/// Two smooth balls without gravity; the first comes along x with 2 m/s, off centre by `offset_m`.
After collide(const char* engine, double ma_kg, double mb_kg, double e, double offset_m) {
  constexpr double h_s = 0.001;
  test::World w = world(engine, {});
  const InstanceId a = w.add(ball("a", {-0.5, offset_m, ball_m}, ma_kg, e));
  const InstanceId b = w.add(ball("b", {0, 0, ball_m}, mb_kg, e));
  kick(w, a, ma_kg, {2, 0, 0}, h_s);
  w.run(600, h_s);
  return {w.state(a).V_WB.linear, w.state(b).V_WB.linear};
}

void two_bodies(Section& s) {
  struct Case {
    const char* what;
    double ma_kg, mb_kg, e, offset_m;
  };
  for (const Case c : {Case{"equal balls head on, e 1", 1, 1, 1, 0}, Case{"3 kg onto 1 kg, e 1", 3, 1, 1, 0},
                       Case{"1 kg onto 3 kg, e 0.5", 1, 3, 0.5, 0},
                       Case{"equal balls off centre by a radius, e 0.8", 1, 1, 0.8, ball_m}})
    for (const char* engine : engine_names) {
      const After after = collide(engine, c.ma_kg, c.mb_kg, c.e, c.offset_m);
      const double reduced_kg = c.ma_kg * c.mb_kg / (c.ma_kg + c.mb_kg);
      // The line of centres at contact: offset / (2 r) is its sine.
      const double sine = c.offset_m / (2 * ball_m), normal_mps = 2 * std::sqrt(1 - sine * sine);
      const double lost_J = 0.5 * reduced_kg * (1 - c.e * c.e) * normal_mps * normal_mps;
      const Vec3 momentum = c.ma_kg * after.a + c.mb_kg * after.b;
      const double energy_J = 0.5 * (c.ma_kg * dot(after.a, after.a) + c.mb_kg * dot(after.b, after.b));
      const std::string where = fmt::format("{}, 1 ms", engine);
      s.rows.push_back(
          {fmt::format("{}: momentum", c.what), where, "kg m/s", norm(momentum), c.ma_kg * 2, 1e-6});
      s.rows.push_back({fmt::format("{}: energy after", c.what), where, "J", energy_J,
                        0.5 * c.ma_kg * 4 - lost_J, c.offset_m > 0 ? 0.02 : 0.005});
    }
}

/// A ball that falls from 1 m onto the ground: heights of its first two rebounds.
void bouncing(Section& s) {
  Figure figure{"rebound", "A ball dropped from 1 m, e 0.8", {"time"}, {"s"}, {{}}};
  for (const double h_s : {0.001, 0.004}) {
    constexpr double e = 0.8;
    test::World w = world("rigid");
    w.add(test::ground(surface(0.5, e)));
    const InstanceId id = w.add(ball("ball", {0, 0, ball_m + 1}, ball_kg, e, 0.5));
    std::vector<double> heights_m, tops_m;
    bool rising = false;
    const int steps = static_cast<int>(std::lround(2.0 / h_s));
    for (int i = 0; i < steps; ++i) {
      const double before_m = w.state(id).X_WB.p.z;
      w.run(1, h_s);
      const double z_m = w.state(id).X_WB.p.z;
      if (rising && z_m < before_m) tops_m.push_back(before_m - ball_m);
      rising = z_m > before_m;
      heights_m.push_back(z_m - ball_m);
    }
    tops_m.resize(2);
    const std::string where = fmt::format("rigid, {:g} ms", 1000 * h_s);
    // The ball hits within a step: up to g h of its speed is a matter of phase, 2 g h / v of its energy per
    // impact.
    const double phase = 2 * g_mps2 * h_s / std::sqrt(2 * g_mps2);
    s.rows.push_back({"dropped from 1 m, e 0.8: first rebound", where, "m", tops_m[0], e * e, phase});
    s.rows.push_back(
        {"dropped from 1 m, e 0.8: second rebound", where, "m", tops_m[1], e * e * e * e, 3 * phase});
    if (h_s == 0.001) {
      figure.names.push_back("rigid, 1 ms");
      figure.names.push_back("closed form");
      figure.units.insert(figure.units.end(), {"m", "m"});
      figure.columns.push_back(heights_m);
      std::vector<double> exact_m;
      for (int i = 0; i < steps; ++i) {
        const double t = (i + 1) * h_s, fall_s = std::sqrt(2 / g_mps2);
        figure.columns[0].push_back(t);
        double z_m = 1 - 0.5 * g_mps2 * t * t, since_s = t - fall_s, v_mps = e * g_mps2 * fall_s;
        while (since_s >= 0) {
          z_m = v_mps * since_s - 0.5 * g_mps2 * since_s * since_s;
          since_s -= 2 * v_mps / g_mps2;
          v_mps *= e;
        }
        exact_m.push_back(z_m);
      }
      figure.columns.push_back(exact_m);
    }
  }
  s.figures.push_back(figure);
  for (const char* engine : engine_names) {
    constexpr double h_s = 0.002;
    test::World w = world(engine, {});
    w.add(test::static_of("wall", Box{{0.1, 4, 1}}, {{1, 0, 0.5}, {}}, surface(0, 0.7)));
    const InstanceId id = w.add(ball("ball", {0, 0, ball_m}, ball_kg, 0.7));
    kick(w, id, ball_kg, {2, 1, 0}, h_s);
    w.run(400, h_s);
    const std::string where = fmt::format("{}, 2 ms", engine);
    s.rows.push_back({"obliquely onto a smooth wall, e 0.7: speed away from it", where, "m/s",
                      -w.state(id).V_WB.linear.x, 1.4, 1e-3});
    s.rows.push_back({"obliquely onto a smooth wall, e 0.7: speed along it", where, "m/s",
                      w.state(id).V_WB.linear.y, 1, 1e-3});
  }
}

/// Five balls in a row with gaps, the first comes with 1 m/s: the last leaves with it.
void cradle(Section& s) {
  for (const char* engine : engine_names) {
    constexpr double h_s = 0.001;
    test::World w = world(engine, {});
    std::vector<InstanceId> balls;
    for (int i = 0; i < 5; ++i)
      balls.push_back(
          w.add(ball(fmt::format("ball{}", i), {(2 * ball_m + 0.005) * i, 0, ball_m}, ball_kg, 1)));
    kick(w, balls[0], ball_kg, {1, 0, 0}, h_s);
    w.run(200, h_s);
    const std::string where = fmt::format("{}, 1 ms", engine);
    s.rows.push_back({"Newton's cradle, five balls 5 mm apart: speed of the last", where, "m/s",
                      w.state(balls[4]).V_WB.linear.x, 1, 1e-3});
    double rest_mps = 0;
    for (std::size_t i = 0; i < 4; ++i) rest_mps = std::max(rest_mps, norm(w.state(balls[i]).V_WB.linear));
    s.rows.push_back({"Newton's cradle: fastest of the others", where, "m/s", rest_mps, 0, 1e-3, false});
  }
}

}  // namespace

Section impacts() {
  Section s{
      "impacts",
      "Impacts",
      "Momentum is kept; of the energy of the approach along the line of centres the share 1 - e^2 is lost. "
      "Balls "
      "without friction and gravity, except for the dropped one. The line of centres is that of the step in "
      "which "
      "the balls meet: at 1 ms they may be 2 mm on, which turns it, and so changes the loss off centre.",
      {},
      {}};
  two_bodies(s);
  bouncing(s);
  cradle(s);
  return s;
}

}  // namespace sandlot::validation
