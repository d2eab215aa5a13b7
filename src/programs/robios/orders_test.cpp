#include "programs/robios/orders.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <limits>

#include "base/test_folder.h"
#include "programs/robios/compile.h"
#include "programs/robios/shared_memory.h"
#include "programs/sandbox.h"

namespace sandlot::programs::robios {
namespace {

using namespace sandlot::robios;
using testing::HasSubstr;

class Written {
 public:
  template <class T>
  Written& add(OrderKind kind, const T& payload, std::string_view more = "") {
    const auto* const begin = reinterpret_cast<const char*>(&payload);
    return add_bytes(kind, std::string(begin, sizeof payload) + std::string(more));
  }
  Written& add_bytes(OrderKind kind, const std::string& payload) {
    const OrderHead head{kind, static_cast<std::uint32_t>(payload.size())};
    put(&head, sizeof head);
    put(payload.data(), payload.size());
    while (bytes.size() % 8 != 0) bytes.push_back({});
    return *this;
  }
  void put(const void* from, std::size_t size) {
    const auto* const at = static_cast<const std::byte*>(from);
    bytes.insert(bytes.end(), at, at + size);
  }
  std::vector<std::byte> bytes;
};

Orders orders_of(const Written& written) { return read_orders(written.bytes); }

TEST(RobiosOrders, AreReadInTheirOrder) {
  Written written;
  written.add(OrderKind::speed, SpeedOrder{0.5, -1});
  written.add(OrderKind::screen, ScreenOrder{3, 4, 2, 1}, "abcdef");
  written.add_bytes(OrderKind::text, std::string("GO\0\0\0END\0first\0second\0", 22));
  written.add(OrderKind::sound, SoundOrder{440, 0.2}, "bell");
  written.add(OrderKind::radio, RadioOrder{2, 3}, "xyz");
  written.add_bytes(OrderKind::picture, "");
  written.add(OrderKind::wait, WaitOrder{7'000'000, wake_key, 0});
  const Orders orders = orders_of(written);
  EXPECT_EQ(orders.refused, 0u) << orders.why;
  ASSERT_EQ(orders.orders.size(), 6u);
  EXPECT_EQ(std::get<SpeedOrder>(orders.orders[0]).w_radps, -1);
  EXPECT_EQ(std::get<ScreenPixels>(orders.orders[1]).at.y, 4u);
  EXPECT_EQ(std::get<ScreenPixels>(orders.orders[1]).rgb.size(), 6u);
  EXPECT_THAT(std::get<ScreenLines>(orders.orders[2]).menu, testing::ElementsAre("GO", "", "", "END"));
  EXPECT_THAT(std::get<ScreenLines>(orders.orders[2]).lines, testing::ElementsAre("first", "second"));
  EXPECT_EQ(std::get<SoundNamed>(orders.orders[3]).name, "bell");
  EXPECT_EQ(std::get<Packet>(orders.orders[4]).bytes.size(), 3u);
  ASSERT_TRUE(orders.wait);
  EXPECT_EQ(orders.wait->until_ns, 7'000'000);
  EXPECT_FALSE(orders.finished);
}

TEST(RobiosOrders, NothingThatCannotBeIsCarriedOut) {
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinite = std::numeric_limits<double>::infinity();
  const auto refused = [](const Written& written) {
    const Orders orders = orders_of(written);
    EXPECT_TRUE(orders.orders.empty());
    EXPECT_NE(orders.why, "");
    return orders.refused;
  };
  EXPECT_EQ(refused(Written().add(OrderKind::speed, SpeedOrder{nan, 0})), 1u);
  EXPECT_EQ(refused(Written().add(OrderKind::speed, SpeedOrder{0, infinite})), 1u);
  EXPECT_EQ(refused(Written().add(OrderKind::speed, SpeedOrder{1e300, 0})), 1u);
  EXPECT_EQ(refused(Written().add(OrderKind::set_pose, PoseOrder{0, 0, nan})), 1u);
  EXPECT_EQ(refused(Written().add(OrderKind::motor, MotorOrder{0, 0, nan})), 1u);
  EXPECT_EQ(refused(Written().add(OrderKind::sound, SoundOrder{440, -1})), 1u);
  EXPECT_EQ(refused(Written().add(OrderKind::set_entity, EntityPose{1, 1, 0, nan, 0, 0})), 1u);
}

TEST(RobiosOrders, SizesAndKindsAreChecked) {
  const auto refused = [](const Written& written) { return orders_of(written).refused; };
  EXPECT_EQ(refused(Written().add(static_cast<OrderKind>(77), SpeedOrder{})), 1u);
  EXPECT_EQ(refused(Written().add(OrderKind::maneuver, SpeedOrder{})), 1u);
  EXPECT_EQ(refused(Written().add(OrderKind::maneuver, ManeuverOrder{5, 0, 0, 0, 0, 0, 0, 0})), 1u);
  EXPECT_EQ(refused(Written().add(OrderKind::maneuver, ManeuverOrder{0, 0, 1, 0, 0, 0, -1, 0})), 1u);
  EXPECT_EQ(refused(Written().add(OrderKind::motor, MotorOrder{most_motors, 0, 0})), 1u);
  EXPECT_EQ(refused(Written().add(OrderKind::servo, MotorOrder{0, 0, 1.5})), 1u);
  EXPECT_EQ(refused(Written().add(OrderKind::screen, ScreenOrder{0, 0, 2, 2}, "abc")), 1u);
  EXPECT_EQ(refused(Written().add(OrderKind::screen, ScreenOrder{0xffffffff, 0, 1, 1}, "abc")), 1u);
  EXPECT_EQ(refused(Written().add(OrderKind::screen, ScreenOrder{0, 0, 0x10000, 0x10000}, "")), 1u);
  EXPECT_EQ(refused(Written().add(OrderKind::radio, RadioOrder{0, 2000}, std::string(2000, 'x'))), 1u);
  EXPECT_EQ(refused(Written().add(OrderKind::radio, RadioOrder{0, 9}, "abc")), 1u);
  EXPECT_EQ(refused(Written().add_bytes(OrderKind::text, "no end")), 1u);
  EXPECT_EQ(refused(Written().add_bytes(OrderKind::picture, "x")), 1u);
  // An order longer than what there is ends the reading; what came before counts.
  Written cut;
  cut.add(OrderKind::speed, SpeedOrder{1, 0});
  const OrderHead head{OrderKind::note, 1u << 30};
  cut.put(&head, sizeof head);
  const Orders orders = orders_of(cut);
  EXPECT_EQ(orders.orders.size(), 1u);
  EXPECT_EQ(orders.refused, 1u);
}

TEST(RobiosOrders, ATurnHasItsLimits) {
  Written many;
  for (int i = 0; i < 5000; ++i) many.add(OrderKind::speed, SpeedOrder{0.1, 0});
  EXPECT_EQ(orders_of(many).orders.size(), 1000u);
  Written messages;
  for (int i = 0; i < 300; ++i) messages.add(OrderKind::radio, RadioOrder{0, 1}, "x");
  EXPECT_EQ(orders_of(messages).orders.size(), 256u);
  EXPECT_EQ(orders_of(messages).refused, 44u);
}

TEST(RobiosOrders, NothingBehindTheEndCounts) {
  Written written;
  written.add(OrderKind::finished, std::int32_t{3}).add(OrderKind::speed, SpeedOrder{1, 1});
  const Orders orders = orders_of(written);
  EXPECT_EQ(orders.finished, 3);
  EXPECT_TRUE(orders.orders.empty());
}

TEST(RobiosMemory, IsAsLongAsItWas) {
  auto memory = SharedMemory::make();
  ASSERT_TRUE(memory);
  EXPECT_NE(ftruncate(memory->descriptor(), 0), 0);
  memory->memory().order_bytes = 0xffffffff;
  EXPECT_EQ(memory->orders().size(), most_order_bytes);
  EXPECT_TRUE(memory->has_turn());
  memory->give_turn();
  EXPECT_FALSE(memory->has_turn());
}

TEST(RobiosPrograms, GenerationsAreToldApart) {
  EXPECT_EQ(api_of("#include \"eyebot.h\"\nint main() { VWStraight(500, 100); }"), 7);
  EXPECT_EQ(api_of("#include \"eyebot.h\"\nint main() { VWHandle vw = VWInit(VW_DRIVE, 1); }"), 6);
  EXPECT_EQ(api_of("#include \"robios6/eyebot.h\"\n"), 6);
}

TEST(RobiosPrograms, WhatIsNoProgramIsSaidSo) {
  const auto none = prepare({"none.c", "/usr", 0, {}, {}});
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().text(), HasSubstr("there is no program 'none.c' in '/usr'"));
  const auto text = prepare({"passwd", "/etc", 0, {}, {}});
  ASSERT_FALSE(text);
  EXPECT_THAT(text.error().text(), HasSubstr("'passwd' is not a program"));
}

TEST(RobiosPrograms, WithoutASandboxWhatNobodyCanReadIsNamed) {
  const test::TestFolder folder;  // mode 0700
  folder.write("drive.c", "int main() {}");
  Source source{"drive.c", folder.path.string(), 0, {}, {}};
  source.budget.sandbox = false;
  const auto made = prepare(source);
  const bool is_refused = !made && made.error().text().find("who cannot read '" + folder.file("drive.c") +
                                                            "'") != std::string::npos;
  EXPECT_EQ(is_refused, program_user().has_value()) << (made ? "" : made.error().text());
}

}  // namespace
}  // namespace sandlot::programs::robios
