#include "noise/chain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/bytes.h"
#include "noise/channel_noise.h"
#include "noise/range_noise.h"

namespace sandlot {
namespace {

Stream stream(Purpose purpose, std::uint64_t sample) { return {1, 2, purpose, sample}; }

std::vector<double> run(const std::vector<StageSpec>& stages, int n = 50, double errors = 1, double truth = 1,
                        const char* channel = "") {
  ChannelChain chain;
  chain.reset(stages, stream(Purpose::initial, 0), channel);
  std::vector<double> out;
  for (int k = 0; k < n; ++k)
    out.push_back(
        chain.corrupt(stages, truth, 0.1, stream(Purpose::noise, static_cast<std::uint64_t>(k)), errors));
  return out;
}

/// {name: {key: value, ...}}
Node stage(const char* name, std::initializer_list<std::pair<const char*, const char*>> keys) {
  Node inner = Node::map(), out = Node::map();
  for (const auto& [key, value] : keys) inner.set(key, Node::scalar(value));
  out.set(name, std::move(inner));
  return out;
}
Node list(std::initializer_list<Node> stages) {
  Node out = Node::sequence();
  for (const Node& each : stages) out.push(each);
  return out;
}

/// As a device does: the key `noise` with the unit m.
struct Holder {
  RangeNoiseSpec noise;
  static void fields(auto& s, auto&& visit) { visit(Field{"noise", "m", "Errors."}, s.noise); }
};
Result<Holder> read_noise(Node noise) {
  Node root = Node::map();
  root.set("noise", std::move(noise));
  return read_spec<Holder>(root);
}

TEST(Chain, StagesActInTheUsersOrder) {
  const StageSpec shift = BiasSpec{.mean = 0.3}, round = QuantiseSpec{.step = 1};
  EXPECT_NEAR(run({shift, round}, 1, 1, 1.4)[0], 2, 1e-15);    // 1.7 rounds to 2
  EXPECT_NEAR(run({round, shift}, 1, 1, 1.4)[0], 1.3, 1e-15);  // 1, then 1.3
}

TEST(Chain, AStageMovesNoOthersNumbers) {
  // Additive stages: what one adds is the difference to the chain without it, in whatever company.
  const StageSpec noise = GaussianSpec{.std = 0.25}, drift = DriftSpec{.std = 0.5, .correlation_s = 1},
                  fill = UniformSpec{.min = -1, .max = 1};
  const auto alone = run({drift}, 50, 1, 0), behind = run({noise, drift}, 50, 1, 0),
             only = run({noise}, 50, 1, 0), crowd = run({fill, noise, drift}, 50, 1, 0),
             filled = run({fill}, 50, 1, 0);
  for (std::size_t k = 0; k < alone.size(); ++k) {
    EXPECT_NEAR(behind[k] - only[k], alone[k], 1e-14);
    EXPECT_NEAR(crowd[k] - only[k] - filled[k], alone[k], 1e-14);
  }
  // What a stage draws does not depend on what comes in either, not even on its being a number.
  std::vector<float> plain(100, 1.0f), holes = plain;
  for (std::size_t i = 0; i < 100; i += 3) holes[i] = INFINITY;
  ChannelChain a, b;
  const std::vector<StageSpec> stages{noise};
  a.reset(stages, stream(Purpose::initial, 0));
  b.reset(stages, stream(Purpose::initial, 0));
  a.corrupt(stages, plain, 0.1, stream(Purpose::noise, 3));
  b.corrupt(stages, holes, 0.1, stream(Purpose::noise, 3));
  for (std::size_t i = 0; i < 100; ++i) {
    if (i % 3 == 0) EXPECT_EQ(holes[i], INFINITY);
    else EXPECT_EQ(holes[i], plain[i]);
  }
}

TEST(Chain, TwoStagesOfOneSortAndTwoChannelsDiffer) {
  const StageSpec noise = GaussianSpec{.std = 1};
  const auto one = run({noise}, 50, 1, 0), two = run({noise, noise}, 50, 1, 0),
             other = run({noise}, 50, 1, 0, "y");
  for (std::size_t k = 0; k < one.size(); ++k) {
    EXPECT_NE(two[k], 2 * one[k]);
    EXPECT_NE(one[k], other[k]);
  }
  // But what is lost as a whole is lost in all channels.
  const std::vector<StageSpec> whole{
      DropoutsSpec{.rate = 0.5, .shows = DropoutsSpec::Shows::value, .whole = true}};
  const std::vector<StageSpec> each{DropoutsSpec{.rate = 0.5, .shows = DropoutsSpec::Shows::value}};
  EXPECT_EQ(run(whole, 50, 1, 1, "x"), run(whole, 50, 1, 1, "y"));
  EXPECT_NE(run(each, 50, 1, 1, "x"), run(each, 50, 1, 1, "y"));
}

TEST(Chain, ErrorsScaleAllOfIt) {
  const std::vector<StageSpec> additive{GaussianSpec{.std = 0.25, .mean = 0.1}, WhiteSpec{.density = 0.1},
                                        UniformSpec{.min = -1, .max = 2},       DriftSpec{.std = 0.5},
                                        BiasSpec{.mean = 1, .std = 2},          WalkSpec{.density = 0.1}};
  const auto once = run(additive, 50, 1, 0), twice = run(additive, 50, 2, 0), none = run(additive, 50, 0, 0);
  for (std::size_t k = 0; k < once.size(); ++k) {
    EXPECT_NEAR(twice[k], 2 * once[k], 1e-13);
    EXPECT_EQ(none[k], 0);
  }
  std::vector<StageSpec> all = additive;
  for (const StageSpec& more :
       {StageSpec(ProportionalSpec{.std = 0.3}), StageSpec(ScaleSpec{.error = 0.1, .std = 0.1}),
        StageSpec(QuantiseSpec{.step = 0.3}), StageSpec(DeadZoneSpec{.width = 5}),
        StageSpec(DropoutsSpec{.rate = 0.5}), StageSpec(OutliersSpec{.rate = 0.5, .std = 3}),
        StageSpec(LatencySpec{.delay_s = 1})})
    all.push_back(more);
  for (const double shown : run(all, 50, 0, 1.0625)) EXPECT_EQ(shown, 1.0625);
  EXPECT_EQ(run({QuantiseSpec{.step = 0.5}}, 1, 2, 1.4)[0], 1);  // the step is 1 now
}

TEST(Chain, AMapIsUnchangedBeforeItsStages) {
  // The numbers of the map come from the device's own stream and are the same with and without stages behind.
  const ChannelNoiseSpec plain{.white = 0.2, .mean = 0.1, .mean_std = 0.3, .bias = {.bias_std = 0.4}};
  ChannelNoiseSpec longer = plain;
  longer.stages = {StageSpec(ScaleSpec{.error = 1})};
  ChannelNoise a, b;
  Stream first = stream(Purpose::initial, 0), second = first;
  a.reset(plain, first);
  b.reset(longer, second);
  for (std::uint64_t k = 0; k < 20; ++k) {
    Stream one = stream(Purpose::noise, k), two = one, three = one;
    ChannelNoise half = a;
    const double shown = a.corrupt(plain, 5, 0.1, one);
    EXPECT_EQ(2 * shown, b.corrupt(longer, 5, 0.1, two));
    EXPECT_NEAR(half.corrupt(plain, 5, 0.1, three, 0.5), 0.5 * (5 + shown), 1e-14);
  }
}

TEST(Chain, RangesStayWithinTheDevicesAndHonourErrors) {
  RangeNoiseSpec spec;
  spec.white_m = 0.1;
  spec.stages = {StageSpec(GaussianSpec{.std = 5})};
  RangeNoise noise;
  Stream first = stream(Purpose::initial, 0);
  noise.reset(spec, first);
  std::vector<float> ranges(200, 2.0f), exact(200, 2.0f);
  Stream random = stream(Purpose::noise, 0), again = random;
  noise.corrupt(spec, 0.1, random, 1, 3, ranges);
  for (const float r : ranges) EXPECT_TRUE(r >= 1 && r <= 3);
  EXPECT_NE(ranges, exact);
  std::vector<float> none = exact;
  noise.corrupt(spec, 0.1, again, 1, 3, none, 0.0);
  EXPECT_EQ(none, exact);
}

TEST(Chain, IsReadFromAListWithUnits) {
  const auto read = read_noise(
      list({stage("gaussian", {{"std", "1 cm"}}), stage("white", {{"density", "2 mm/sqrt(Hz)"}}),
            stage("drift", {{"std", "2 cm"}, {"correlation", "10 s"}}),
            stage("dropouts", {{"rate", "5 %"}, {"shows", "hold"}})}));
  ASSERT_TRUE(read) << read.error().text();
  const auto& stages = read->noise.stages;
  ASSERT_EQ(stages.size(), 4u);
  EXPECT_EQ(std::get<GaussianSpec>(stages[0].stage).std, 0.01);
  EXPECT_EQ(std::get<WhiteSpec>(stages[1].stage).density, 0.002);
  EXPECT_EQ(std::get<DriftSpec>(stages[2].stage).correlation_s, 10);
  EXPECT_EQ(std::get<DropoutsSpec>(stages[3].stage).shows, DropoutsSpec::Shows::hold);
}

TEST(Chain, RefusesWhatIsNoChain) {
  const auto why = [](Node noise) {
    const auto read = read_noise(std::move(noise));
    if (read) return std::string("accepted");
    return read.error().path + ": " + read.error().what + "; " + read.error().fix;
  };
  EXPECT_EQ(why(list({stage("gausian", {{"std", "1"}})})).substr(0, 48),
            "/noise/0: unknown key 'gausian'; did you mean 'g");
  EXPECT_EQ(why(list({stage("gaussian", {})})).substr(0, 44), "/noise/0/gaussian: key 'std' is missing; Sta");
  EXPECT_EQ(why(list({stage("gaussian", {{"std", "-1"}})})).substr(0, 33),
            "/noise/0/gaussian/std: must be in");
  EXPECT_EQ(why(list({stage("gaussian", {{"std", "1 kg"}})})).substr(0, 47),
            "/noise/0/gaussian/std: unit 'kg' does not fit; ");
  EXPECT_EQ(why(list({Node::scalar("gaussian")})).substr(0, 20), "/noise/0: expected a");
  EXPECT_EQ(why(list({Node()})), "/noise/0: a stage without a name; write it as {gaussian: {std: 0.1}}");
  EXPECT_EQ(why(list({})), "/noise: the list is empty; at least 1 element is needed");
  Node two = stage("gaussian", {{"std", "1"}});
  two.set("clip", Node::map());
  EXPECT_EQ(why(list({two})), "/noise/0: two stages in one entry of the list; begin a new entry for 'clip'");
  Node many = Node::sequence();
  for (int i = 0; i < 17; ++i) many.push(stage("gaussian", {{"std", "1"}}));
  EXPECT_EQ(why(many), "/noise: list has 17 elements; at most 16 are allowed");
  EXPECT_EQ(why(list({stage("uniform", {{"min", "2"}, {"max", "1"}})})),
            "/noise/0/uniform: min is greater than max; exchange them");
  EXPECT_EQ(why(list({stage("dropouts", {{"rate", "0.1"}, {"per_second", "1"}})})),
            "/noise/0/dropouts: rate and per_second are both given; keep one of them");
  EXPECT_NE(why(stage("gaussian", {{"std", "1"}})).find("stages are written as a list"), std::string::npos);
}

TEST(Chain, PartsOfStagesAreTunable) {
  auto holder = read_noise(
      list({stage("gaussian", {{"std", "1 cm"}}), stage("uniform", {{"min", "0"}, {"max", "1"}})}));
  ASSERT_TRUE(holder);
  EXPECT_TRUE(set_tunable(*holder, "noise/0/gaussian/std", Node::scalar("5 mm")));
  EXPECT_EQ(std::get<GaussianSpec>(holder->noise.stages[0].stage).std, 0.005);
  EXPECT_TRUE(set_tunable(*holder, "noise/stages/1/uniform/max", Node::scalar("2")));
  const auto why = [&](const char* path, const char* value) {
    Holder copy = *holder;
    const Status status = set_tunable(copy, path, Node::scalar(value));
    return status ? std::string("done") : status.error().what;
  };
  EXPECT_EQ(why("noise/0/drift/std", "1"), "there is no 'drift' here");
  EXPECT_EQ(why("noise/2/gaussian/std", "1"), "no element '2'");
  EXPECT_EQ(why("noise/0/gaussian/stdd", "1"), "no parameter 'stdd'");
  EXPECT_EQ(why("noise/0", "1"), "an element of a list is fixed; its parts may be tunable");
  EXPECT_EQ(why("noise/1/uniform/min", "3"), "min is greater than max");
  EXPECT_EQ(why("noise/1e99/uniform/min", "3"), "no element '1e99'");
}

TEST(Chain, StateAndTunablesGoThroughBytes) {
  Holder holder;
  holder.noise.stages = {StageSpec(DriftSpec{.std = 0.5}), StageSpec(LatencySpec{.delay_s = 0.3}),
                         StageSpec(DropoutsSpec{.rate = 0.3, .shows = DropoutsSpec::Shows::hold})};
  const auto& stages = holder.noise.stages;
  ChannelChain chain, restored;
  chain.reset(stages, stream(Purpose::initial, 0));
  for (std::uint64_t k = 0; k < 10; ++k)
    chain.corrupt(stages, static_cast<double>(k), 0.1, stream(Purpose::noise, k));
  Holder same = holder;
  std::get<DriftSpec>(holder.noise.stages[0].stage).std = 0.7;
  ByteWriter w;
  write_tunables(w, holder);
  write(w, chain);
  restored.reset(stages, stream(Purpose::initial, 99));
  ByteReader r(w.bytes());
  read_tunables(r, same);
  read(r, restored);
  EXPECT_TRUE(r.ok() && r.remaining() == 0);
  EXPECT_EQ(std::get<DriftSpec>(same.noise.stages[0].stage).std, 0.7);
  for (std::uint64_t k = 10; k < 20; ++k)
    EXPECT_EQ(chain.corrupt(stages, 1, 0.1, stream(Purpose::noise, k)),
              restored.corrupt(stages, 1, 0.1, stream(Purpose::noise, k)));
  // Without stages there is nothing: the states of devices are what they were before there were chains.
  ByteWriter empty;
  write(empty, ChannelChain());
  EXPECT_EQ(empty.size(), 0u);
}

TEST(Chain, ADamagedStateDoesNoHarm) {
  const std::vector<StageSpec> stages{LatencySpec{.delay_s = 0.3},
                                      DropoutsSpec{.rate = 0.3, .shows = DropoutsSpec::Shows::hold}};
  ChannelChain chain;
  chain.reset(stages, stream(Purpose::initial, 0));
  auto& latency = std::get<LatencySpec::State>(chain.stages[0].state);
  latency.time_s = {1, 2, 3};
  latency.held_values = {1, 2};
  std::get<DropoutsSpec::State>(chain.stages[1].state).held_values = {1};
  std::vector<float> scan(5, 2.0f);
  for (std::uint64_t k = 0; k < 10; ++k) chain.corrupt(stages, scan, 0.1, stream(Purpose::noise, k));
  EXPECT_EQ(scan, std::vector<float>(5, 2.0f));
}

TEST(Chain, SortsAreDescribed) {
  const auto types = stage_types();
  ASSERT_EQ(types.size(), StageSpec::types - 1);
  EXPECT_EQ(types[0].name, "gaussian");
  EXPECT_EQ(types[0].fields[0].unit, "U");
  EXPECT_EQ(types[1].fields[0].unit, "U/sqrt(Hz)");
  const auto fields = describe_fields<Holder>();
  ASSERT_EQ(fields.back().path, "noise/stages");
  EXPECT_EQ(fields.back().elements, "noise");
  EXPECT_TRUE(fields.back().for_map);
}

}  // namespace
}  // namespace sandlot
