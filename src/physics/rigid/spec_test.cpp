/// Every setting does something.
#include "physics/rigid/spec.h"

#include <gtest/gtest.h>

#include <map>

#include "physics/rigid/rigid_engine.h"
#include "physics/test_world.h"

namespace sandlot::rigid {
namespace {

using namespace test;

/// A pile that falls, settles and sleeps: its final bytes depend on every setting.
std::vector<std::byte> final_bytes(const Settings& config) {
  World world(rigid::engine, settings(config));
  world.add(ground());
  for (int i = 0; i < 9; ++i)
    world.add(
        body_of("box", Box{{0.2, 0.2, 0.2}}, 1,
                {{0.12 * (i % 3), 0.02 * i, 0.15 + 0.25 * (i / 3)}, quat_from_rpy(0.02 * i, 0.1, 0.3 * i)}));
  // One that lies still before the others do, turning slowly at first.
  world.add(body_of("still", Sphere{0.1}, 1, {{5, 0, 0.1}, {}}));
  world.push(world.ids.back(), {}, {0, 0, 0.004 * 0.03 / 0.01});
  world.run(120);
  std::vector<std::byte> all;
  for (const InstanceId id : world.ids) {
    const auto bytes = world.bytes(id);
    all.insert(all.end(), bytes.begin(), bytes.end());
  }
  return all;
}

TEST(RigidSpec, EverySettingChangesTheRun) {
  const std::map<std::string, std::vector<const char*>> others{{"solver", {"direct", "quick"}},
                                                               {"quick_iterations", {"20"}},
                                                               {"direct_limit", {"5"}},
                                                               {"erp", {"0.3"}},
                                                               {"cfm", {"1e-5"}},
                                                               {"contact_correction", {"0.01"}},
                                                               {"max_contacts", {"3"}},
                                                               {"sleeping", {"false"}},
                                                               {"sleep_speed", {"1e-9", "0.3"}},
                                                               {"sleep_spin", {"0.001"}},
                                                               {"sleep_time", {"0.1", "10"}},
                                                               {"max_speed", {"0.01"}},
                                                               {"max_spin", {"0.01"}}};
  const Settings base{{"direct_limit", "16"}};
  const auto usual = final_bytes(base);
  EXPECT_EQ(usual, final_bytes(base));
  for (const FieldInfo& field : rigid::engine.describe()) {
    const auto found = others.find(field.path);
    ASSERT_NE(found, others.end()) << "no test of the setting " << field.path;
    for (const char* value : found->second) {
      Settings changed = base;
      if (field.path == "direct_limit") changed[0].second = value;
      else changed.emplace_back(field.path, value);
      EXPECT_NE(usual, final_bytes(changed)) << field.path << " = " << value;
    }
  }
}

TEST(RigidSpec, ValuesOutOfRangeAreRefused) {
  for (const auto& [key, value] : Settings{{"solver", "magic"},
                                           {"erp", "1.5"},
                                           {"cfm", "0"},
                                           {"max_contacts", "0"},
                                           {"quick_iterations", "0"},
                                           {"sleep_time", "nan"},
                                           {"direct_limit", "-1"}}) {
    const auto made = rigid::engine.create(settings({{key, value}}), {});
    ASSERT_FALSE(made) << key;
    EXPECT_NE(made.error().text().find(key), std::string::npos);
  }
}

TEST(RigidSpec, ErpAndCorrectionSpeedLiftWhatIsSunkIn) {
  // A ball 0.01 deep, no gravity: per sub-step ERP of the depth, at most correction * h.
  const auto depth_after_one = [](const Settings& config) {
    World world(rigid::engine, settings(config), Vec3{});
    world.add(ground());
    const InstanceId id = world.add(body_of("ball", Sphere{0.1}, 1, {{0, 0, 0.09}, {}}));
    world.run(1, 0.01);
    return 0.1 - world.state(id).X_WB.p.z;
  };
  EXPECT_NEAR(depth_after_one({}), 0.01 * 0.8, 1e-6);
  EXPECT_NEAR(depth_after_one({{"erp", "0.5"}}), 0.01 * 0.5, 1e-6);
  EXPECT_NEAR(depth_after_one({{"contact_correction", "0.1"}}), 0.01 - 0.1 * 0.01, 1e-6);
}

TEST(RigidSpec, CfmIsCompliance) {
  // At rest: ERP * depth / h = CFM * weight.
  World world(rigid::engine, settings({{"cfm", "1e-4"}}));
  world.add(ground());
  const InstanceId id = world.add(body_of("ball", Sphere{0.1}, 2, {{0, 0, 0.1}, {}}, {}, true));
  world.run(500, 0.01);
  EXPECT_NEAR(0.1 - world.state(id).X_WB.p.z, 1e-4 * 2 * 9.81 * 0.01 / 0.2, 1e-9);
}

TEST(RigidSpec, MaxContactsBoundsAPair) {
  for (const std::size_t n : {1u, 3u, 4u}) {
    World world(rigid::engine, settings({{"max_contacts", std::to_string(n)}}));
    world.add(ground());
    world.add(body_of("box", Box{{0.2, 0.2, 0.2}}, 1, {{0, 0, 0.099}, {}}));
    world.run(1);
    EXPECT_EQ(world.engine->contacts().size(), n);
  }
}

}  // namespace
}  // namespace sandlot::rigid
