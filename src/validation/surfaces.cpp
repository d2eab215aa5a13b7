#include <fmt/format.h>

#include "model/substance.h"
#include "validation/world.h"

namespace sandlot::validation {
namespace {

constexpr double h_s = 0.002;

model::Surface of(const char* substance) {
  model::Surface s;
  s.substance = model::substance_from(substance).value().substance;
  return s;
}

/// Mean deceleration of a block kicked to 3 m/s, while it slides.
double deceleration(const char* engine, const model::Surface& block, const model::Surface& floor,
                    double direction_rad) {
  test::World w = world(engine);
  w.add(test::ground(floor));
  const InstanceId id = w.add(test::body_of("block", Box{{0.3, 0.3, 0.1}}, 2, {{0, 0, 0.05}, {}}, block));
  w.run(250, h_s);  // it settles
  kick(w, id, 2, {3 * math::cos(direction_rad), 3 * math::sin(direction_rad), 0}, h_s);
  const double begin = norm(w.state(id).V_WB.linear);
  constexpr int steps = 30;
  w.run(steps, h_s);
  return (begin - norm(w.state(id).V_WB.linear)) / (steps * h_s);
}

void substances(Section& s) {
  struct Pair {
    const char *block, *floor;
    double mu, stiffness_N_per_m;  ///< by hand: r1 r2, and 100 h1 h2 / (h1 + h2)
  };
  for (const Pair p :
       {Pair{"metal(0.6)", "metal(0.5)", 0.3, 10000}, Pair{"plastic(0.8)", "plastic(0.8)", 0.64, 2000},
        Pair{"metal(0.5)", "plastic(0.8)", 0.4, 100 * 200.0 * 40 / 240},
        Pair{"rubber(20)", "metal(0.2)", 0.6, 100 * 20.0 * 200 / 220},
        Pair{"foam(10)", "snow(0.7)", 0.6, 800}}) {
    const std::string what = fmt::format("{} on {}", p.block, p.floor);
    s.rows.push_back({what + ": deceleration of a sliding block", "rigid, 2 ms", "m/s^2",
                      deceleration("rigid", of(p.block), of(p.floor), 0.3), p.mu * g_mps2, 0.02});
    test::World w = world("rigid");
    w.add(test::ground(of(p.floor)));
    const InstanceId id = w.add(test::body_of("ball", Sphere{0.1}, 1, {{0, 0, 0.1}, {}}, of(p.block), true));
    w.run(2500, h_s);
    s.rows.push_back({what + ": a ball of 1 kg rests so deep", "rigid, 2 ms", "mm",
                      1000 * (0.1 - w.state(id).X_WB.p.z), 1000 * g_mps2 / p.stiffness_N_per_m, 0.01});
  }
}

void special(Section& s) {
  {
    test::World w = world("rigid");
    model::Surface belt = surface(0.6);
    belt.belt_velocity_mps = {0.7, 0, 0};
    w.add(test::static_of("conveyor", Box{{20, 1, 0.2}}, {{0, 0, 0.1}, {}}, belt));
    const InstanceId id = w.add(
        test::body_of("box", Box{{0.2, 0.2, 0.2}}, 1, {{0, 0, 0.3}, {}}, surface(0.6)));
    w.run(1000, h_s);
    s.rows.push_back(
        {"box on a conveyor of 0.7 m/s", "rigid, 2 ms", "m/s", w.state(id).V_WB.linear.x, 0.7, 1e-4});
  }
  model::Surface scales = surface(0.5);
  scales.skin = model::Skin{{1, 0, 0}, 0.2};
  s.rows.push_back({"skin of ratio 0.2, friction 0.5: deceleration along", "rigid, 2 ms", "m/s^2",
                    deceleration("rigid", scales, surface(0.5), 0), 0.1 * g_mps2, 0.005});
  s.rows.push_back({"skin of ratio 0.2, friction 0.5: deceleration across", "rigid, 2 ms", "m/s^2",
                    deceleration("rigid", scales, surface(0.5), math::pi / 2), 0.5 * g_mps2, 0.005});
  {
    constexpr double resistance_m = 0.002, radius_m = 0.1;
    test::World w = world("rigid");
    model::Surface felt = surface(0.8);
    felt.rolling_resistance_m = resistance_m;
    w.add(test::ground(felt));
    const InstanceId id = w.add(
        test::body_of("ball", Sphere{radius_m}, 1, {{0, 0, radius_m}, {}}, surface(0.8), true));
    w.run(1, h_s);
    kick(w, id, 1, {1, 0, 0}, h_s);
    w.run(500, h_s);  // it slips at first, and rolls from 2/7 / (mu g) on
    const double begin = w.state(id).V_WB.linear.x;
    w.run(500, h_s);
    s.rows.push_back({"ball rolling on felt, resistance 2 mm, radius 100 mm: deceleration", "rigid, 2 ms",
                      "m/s^2", begin - w.state(id).V_WB.linear.x, 5.0 / 7 * resistance_m * g_mps2 / radius_m,
                      0.01});
  }
  for (const char* engine : engine_names) {
    test::World w = world(engine);
    model::SurfaceZone ice;
    ice.name = "ice";
    ice.outline_W = {{-5, 0, 0}, {5, 0, 0}, {5, 2, 0}, {-5, 2, 0}};
    ice.surface = surface(0.05);
    w.engine->set_zones({&ice, 1});
    w.add(test::ground(surface(0.4)));
    const auto puck = [&](double y) {
      return w.add(test::body_of(fmt::format("puck{}", y), Box{{0.1, 0.1, 0.04}}, 1, {{0, y, 0.02}, {}},
                                 surface(0.9)));
    };
    const InstanceId on_ice = puck(1), on_floor = puck(-1);
    w.run(1, h_s);
    for (const InstanceId id : {on_ice, on_floor}) w.push(id, {2 / h_s, 0, 0});
    w.run(51, h_s);
    // The kick works for a step of its own; 50 and one more steps of friction follow it.
    s.rows.push_back({"puck on a zone of ice, friction 0.05: speed lost in 0.1 s",
                      fmt::format("{}, 2 ms", engine), "m/s", 2 - w.state(on_ice).V_WB.linear.x,
                      0.05 * g_mps2 * 51 * h_s, 0.005});
    s.rows.push_back({"puck next to it, friction 0.4: speed lost in 0.1 s", fmt::format("{}, 2 ms", engine),
                      "m/s", 2 - w.state(on_floor).V_WB.linear.x, 0.4 * g_mps2 * 51 * h_s, 0.005});
  }
}

}  // namespace

Section surfaces() {
  Section s{"surfaces",
            "Substances and surfaces",
            "Substances after LpzRobots: friction r1 r2, and a spring of 100 h1 h2 / (h1 + h2) N/m per "
            "contact point, on which a "
            "ball of mass m rests m g / k deep; a soft block rocks on its springs when it is kicked, by up "
            "to 2 % of its friction. Belts carry with their own speed, a skin slides more easily "
            "along than "
            "across, resistance to rolling slows a ball by 5/7 rho g / r, and a zone of the ground has its "
            "own friction.",
            {},
            {}};
  substances(s);
  special(s);
  return s;
}

}  // namespace sandlot::validation
