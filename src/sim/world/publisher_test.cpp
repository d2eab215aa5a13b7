/// Frames whose memory goes round, and hashes that are kept: what is shown is what is.
#include <gtest/gtest.h>

#include "sim/test_world.h"

namespace sandlot::test {
namespace {

/// Compares each frame with the simulation, and each frame with itself when it is given back `delay` ticks later.
struct Comparer : Observer {
  Comparer(const Simulation& s, std::size_t d) : simulation(s), delay(d) {}
  Wants wants() const override { return {.messages = true, .log = true, .hash = hash, .links = true}; }
  static std::vector<std::byte> bytes_of(const Frame& frame) {
    ByteWriter w;
    write(w, frame.tick);
    write(w, frame.now);
    for (const FrameInstance& instance : frame.instances) {
      write(w, instance.name);
      for (const Pose& pose : instance.X_WL) write(w, pose.p), write(w, pose.q);
    }
    for (const auto& topic : frame.topics) write(w, topic->name()), topic->save(w);
    for (const LogEntry& entry : frame.log) write(w, entry.target), write(w, entry.bytes);
    write(w, frame.parts);
    return std::move(w.buffer());
  }
  void on_frame(const std::shared_ptr<const Frame>& frame) override {
    for (const auto& topic : frame->topics) {
      const TopicBase* const now = simulation.find_topic(topic->name());
      ByteWriter shown, is;
      topic->save(shown);
      now->save(is);
      EXPECT_TRUE(std::ranges::equal(shown.bytes(), is.bytes())) << topic->name() << " at " << frame->tick;
      EXPECT_EQ(topic->stamp, frame->now);
      ++messages;
    }
    if (hash) {
      const std::vector<SubHash> parts = simulation.sub_hashes();
      ASSERT_EQ(frame->parts.size(), parts.size());
      for (std::size_t i = 0; i < parts.size(); ++i) {
        EXPECT_EQ(frame->parts[i], parts[i].hash) << parts[i].path << " at " << frame->tick;
        EXPECT_EQ((*frame->part_names)[i], parts[i].path);
      }
      EXPECT_EQ(frame->hash, simulation.state_hash());
    }
    held.push_back({frame, bytes_of(*frame)});
    if (held.size() <= delay) return;
    EXPECT_EQ(bytes_of(*held.front().frame), held.front().bytes) << "was filled while it was held";
    held.erase(held.begin());
  }
  struct Held {
    std::shared_ptr<const Frame> frame;
    std::vector<std::byte> bytes;
  };
  const Simulation& simulation;
  std::size_t delay;
  bool hash = true;
  int messages = 0;
  std::vector<Held> held;
};

TEST(Publish, FramesAndKeptHashesTellTheStateWhateverIsAsked) {
  for (const std::size_t delay : {0u, 7u, 100u}) {
    const auto simulation = build(arena("planar", 3));
    Comparer comparer(*simulation, delay);
    simulation->add_observer(&comparer);
    advance(*simulation, 60);
    // Each of these changes a State between two samples of its device or two steps of its program.
    const auto ask = [&](Request request) {
      simulation->submit(std::move(request));
      advance(*simulation, 1);
      EXPECT_EQ(simulation->outcomes().size(), 1u);
      for (const Outcome& outcome : simulation->outcomes())
        EXPECT_TRUE(outcome.status) << outcome.status.error().text();
      advance(*simulation, 3);
    };
    ask(ParameterRequest{"rover1/laser", "noise/white", Node::scalar("0.02")});
    ask(SampleRequest{"rover2/truth"});
    ask(PoseRequest{"rover3", {{0, 0, 0}, {}}});
    ask(DeleteRequest{"rover1"});
    // Not asked for during some ticks in which something changes.
    comparer.hash = false;
    ask(ParameterRequest{"rover2/laser", "noise/white", Node::scalar("0.03")});
    comparer.hash = true;
    advance(*simulation, 3);
    ask(DeleteRequest{"crate1"});
    advance(*simulation, 150);
    EXPECT_GT(comparer.messages, 100);
  }
}

TEST(Publish, KeptHashesFollowDrainsAndMessagesOnTheirWay) {
  // Nothing but a drain, and nothing but a message that is 35 ms late, changes the two sensors between their samples.
  for (const auto& [key, text] : {std::pair("drain", "1 W"), {"delay", "35 ms"}}) {
    model::Setup setup = arena("planar", 1);
    model::DeviceDecl battery, late;
    battery.name = battery.kind = "battery";
    battery.config = map({{"capacity", "10 J"}});
    late.name = "late";
    late.kind = "ground_truth";
    late.config = map({{"rate", "10"}, {key, text}});
    for (model::Instance& each : setup.instances)
      if (each.is_robot) {
        if (key == std::string("drain")) each.devices.push_back(battery);
        each.devices.push_back(late);
      }
    const auto simulation = build(std::move(setup));
    Comparer comparer(*simulation, 0);
    simulation->add_observer(&comparer);
    advance(*simulation, 30);
    EXPECT_GT(comparer.messages, 0);
    simulation->remove_observer(&comparer);
  }
}

}  // namespace
}  // namespace sandlot::test
