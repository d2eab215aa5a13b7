/// Rules that count and set, against what can be said beforehand.
#include "sim/world/test_elements.h"

namespace sandlot::test {
namespace {

TEST(Statistics, OfAValueOverTimeAreThoseOfItsSamples) {
  model::Setup setup = weightless();
  Node config = map({{"value", "sim.time + 0.01"}, {"interval", "100 ms"}, {"bins", "4"}});
  config.set("quantiles", numbers({0.5}));
  setup.rules.push_back(element("statistics", config, "clock"));
  const auto simulation = build(setup);
  advance(*simulation, 100);
  // Samples at 0, 0.1, ... 1 s: 0.01, 0.11, ... 1.01. The sample variance of 0 ... 10 is 11.
  EXPECT_EQ(value(*simulation, "rules/clock.count"), 11);
  EXPECT_NEAR(value(*simulation, "rules/clock.mean"), 0.51, 1e-14);
  EXPECT_NEAR(value(*simulation, "rules/clock.deviation"), 0.1 * std::sqrt(11.0), 1e-14);
  EXPECT_NEAR(value(*simulation, "rules/clock.min"), 0.01, 1e-15);
  EXPECT_NEAR(value(*simulation, "rules/clock.max"), 1.01, 1e-15);
  // .01 .11 .21 | .31 .41 | .51 .61 .71 | .81 .91 | 1.01
  const double histogram[] = {3, 2, 3, 2};
  for (int i = 0; i < 4; ++i)
    EXPECT_EQ(value(*simulation, ("rules/clock.histogram[" + std::to_string(i) + "]").c_str()), histogram[i])
        << i;
  EXPECT_EQ(value(*simulation, "rules/clock.above"), 1);
  // Half of 11 numbers: 5 lie in the first two bins, half a number of three in the third.
  EXPECT_NEAR(value(*simulation, "rules/clock.quantile[0]"), 0.5 + 0.25 * 0.5 / 3, 1e-14);
}

TEST(Statistics, OfEachThingCountAllThingsAtEverySample) {
  model::Setup setup = weightless();
  const auto ball = one_shape("ball", Sphere{0.1}, 1);
  for (const double x_m : {1.0, 2.0, 6.0})
    setup.instances.push_back(
        placed("ball" + std::to_string(static_cast<int>(x_m)), ball, {{x_m, 0, 0}, {}}));
  Node config = map({{"each", "ball*.pose.x"}, {"interval", "50 ms"}, {"from", "20 ms"}, {"bins", "2"}});
  config.set("range", numbers({0, 4}));
  setup.rules.push_back(element("statistics", config));
  const auto simulation = build(setup);
  advance(*simulation, 1);
  EXPECT_EQ(value(*simulation, "rules/statistics.count"), 0);
  advance(*simulation, 7);  // samples at 20 and 70 ms
  EXPECT_EQ(value(*simulation, "rules/statistics.samples"), 2);
  EXPECT_EQ(value(*simulation, "rules/statistics.count"), 6);
  EXPECT_NEAR(value(*simulation, "rules/statistics.mean"), 3, 1e-14);
  // 4 + 1 + 9 per sample, by n - 1 = 5.
  EXPECT_NEAR(value(*simulation, "rules/statistics.deviation"), std::sqrt(2 * 14 / 5.0), 1e-14);
  EXPECT_EQ(value(*simulation, "rules/statistics.histogram[0]"), 2);
  EXPECT_EQ(value(*simulation, "rules/statistics.histogram[1]"),
            2);  // 2 belongs to the bin that begins there
  EXPECT_EQ(value(*simulation, "rules/statistics.above"), 2);
  for (const char* name : {"ball1", "ball2", "ball6"}) simulation->submit(DeleteRequest{name});
  advance(*simulation, 5);
  EXPECT_EQ(value(*simulation, "rules/statistics.skipped"), 1);
}

TEST(Statistics, WhatCannotBeCountedIsRefused) {
  const auto refusal = [](Node config) {
    model::Setup setup = weightless();
    setup.rules.push_back(element("statistics", std::move(config)));
    return refused(std::move(setup));
  };
  EXPECT_NE(refusal(Node::map()).find("neither `value` nor `each`"), std::string::npos);
  EXPECT_NE(refusal(map({{"value", "sim.time"}, {"each", "a*.pose.x"}})).find("both"), std::string::npos);
  EXPECT_NE(
      refusal(with(map({{"value", "sim.time"}, {"bins", "3"}}), "range", numbers({2, 2}))).find("empty"),
      std::string::npos);
  EXPECT_NE(refusal(with(map({{"value", "sim.time"}}), "quantiles", numbers({0.5}))).find("histogram"),
            std::string::npos);
}

TEST(Statistics, SamplesKeepTheirIntervalWhereItIsNoMultipleOfTheTick) {
  // Due at 0, 25, 50, ... 1000 ms, taken in the first tick of 10 ms not before: 0, 30, 50, 80, 100, ...: 41 of them.
  model::Setup setup = weightless();
  setup.rules.push_back(element("statistics", map({{"value", "sim.time"}, {"interval", "25 ms"}}), "clock"));
  const auto simulation = build(setup);
  advance(*simulation, 100);
  EXPECT_EQ(value(*simulation, "rules/clock.count"), 41);
  EXPECT_NEAR(value(*simulation, "rules/clock.mean"), (20 * 0.005 + 41 * 0.5) / 41, 1e-14);
}

TEST(Rules, UseTheValuesAndCriteriaOfTheScenarioWhichReadRules) {
  // The value counts ticks from the second on by way of a rule; the rule `set` begins with it at 0.05 s, also when restored.
  model::Setup setup = talkers({10});
  setup.values.push_back({"ticks", "rules/clock.count - 1", {}});
  setup.criterion = model::CriterionDecl{"2 * ticks", "", {}, {}};
  setup.rules.push_back(element("statistics", map({{"value", "ticks - ticks + sim.tick"}}), "clock"));
  setup.rules.push_back(element(
      "set", with(map({{"when", "values.ticks >= 5 and criterion >= 10"}}), "set",
                  list({map({{"parameter", "media/air.threshold"}, {"expression", "50 + ticks"}})}))));
  const auto simulation = build(setup);
  advance(*simulation, 3);
  const auto restored = again(*simulation);
  for (Simulation* each : {simulation.get(), restored.get()}) {
    advance(*each, 2);
    EXPECT_EQ(value(*each, "rules/clock.count"), 6);
    EXPECT_EQ(value(*each, "rules/set.count"), 1);
    advance(*each, 1);
    EXPECT_EQ(value(*each, "media/air.threshold"), 55);
  }
  EXPECT_EQ(restored->state_hash(), simulation->state_hash());
  setup.rules.back().config.set("when", Node::scalar("tick > 5"));
  EXPECT_NE(refused(setup).find("there is no 'tick'"), std::string::npos) << refused(setup);
}

TEST(Goals, OfATeamCountTogether) {
  model::Setup setup = weightless();
  setup.instances.push_back(placed("ball", one_shape("ball", Sphere{0.1}, 1), {}));
  for (const auto& [name, x] : {std::pair("left", -2.0), {"right", 2.0}})
    setup.markers.push_back(element("disc", with(map({{"radius", "0.3"}}), "centre", numbers({x, 0})), name));
  Node goals = map({{"object", "ball"}, {"stop_at", "2"}});
  goals.set("goals",
            list({map({{"marker", "left"}, {"team", "red"}}), map({{"marker", "right"}, {"team", "red"}})}));
  setup.rules.push_back(element("goals", goals));
  const auto simulation = build(setup);
  for (const double x_m : {-2.0, 2.0}) {
    EXPECT_FALSE(simulation->stop_reason());
    simulation->submit(PoseRequest{"ball", {{x_m, 0, 0}, {}}});
    advance(*simulation, 2);
  }
  EXPECT_EQ(simulation->stop_reason(), "red has scored 2");
}

TEST(Set, ChangesParametersInTheTickAfterItsConditionBegan) {
  model::Setup setup = talkers({10});
  Node rule = map({{"when", "sim.time >= 0.05 and sim.time < 0.08 or sim.time >= 0.1"}});
  rule.set("set",
           list({map({{"parameter", "media/air.threshold"}, {"value", "55 dB"}}),
                 map({{"parameter", "listener1/ear.threshold"}, {"expression", "10 + 100 * sim.time"}}),
                 map({{"parameter", "speaker/voice.failure"}, {"value", "dead"}})}));
  setup.rules.push_back(element("set", rule));
  setup.rules.push_back(element("set", with(rule, "once", Node::scalar("true")), "first"));
  const auto simulation = build(setup);
  advance(*simulation, 5);
  EXPECT_EQ(value(*simulation, "rules/set.count"), 1);
  EXPECT_EQ(value(*simulation, "media/air.threshold"), 40);
  advance(*simulation, 1);
  EXPECT_EQ(value(*simulation, "media/air.threshold"), 55);
  EXPECT_NEAR(value(*simulation, "listener1/ear.threshold"), 15, 1e-13);
  say(*simulation, "I am dead");
  advance(*simulation, 5);  // 0.11 s: the condition has begun again at 0.1 s
  EXPECT_EQ(value(*simulation, "media/air.words"), 0);
  EXPECT_EQ(value(*simulation, "rules/set.count"), 2);
  EXPECT_EQ(value(*simulation, "rules/first.count"), 1);
  EXPECT_NEAR(value(*simulation, "listener1/ear.threshold"), 20, 1e-13);
}

TEST(Set, ParametersThatAreNotThereAreRefusedWithTheNearest) {
  const auto refusal = [](const char* parameter, const char* given, const char* text) {
    model::Setup setup = talkers({10});
    setup.rules.push_back(element("set", with(map({{"when", "sim.time > 1"}}), "set",
                                              list({map({{"parameter", parameter}, {given, text}})}))));
    return refused(std::move(setup));
  };
  EXPECT_EQ(refusal("speaker/voice.loudness", "value", "3 dB"), "");
  EXPECT_NE(refusal("speaker/voice.loudnes", "value", "3").find("speaker/voice.loudness"), std::string::npos);
  EXPECT_NE(refusal("speaker/voice.loudness", "value", "loud").find("loud"), std::string::npos);
  EXPECT_NE(refusal("speaker/voices.loudness", "value", "3").find("speaker/voice"), std::string::npos);
  EXPECT_NE(refusal("speaker", "value", "3").find("not the address"), std::string::npos);
  EXPECT_NE(refusal("speaker/voice.max_length", "value", "3").find("not a parameter that can be set"),
            std::string::npos);
  EXPECT_NE(refusal("speaker/voice.loudness", "expression", "sim.tim").find("sim.time"), std::string::npos);
}

TEST(Place, IntoAWallEndsTheRunWithTheRulesPlaceAndWhatWasSoFar) {
  const auto run = [](const char* at) {
    model::Setup setup = talkers({10});
    setup.instances.push_back(placed("wall", one_shape("wall", Box{{1, 4, 2}}, 0), {{5, 0, 0}, {}}));
    Node rule = map({{"object", "speaker"}, {"when", "sim.time >= 0.05"}});
    Node place = Node::sequence();
    for (const char* const number : {at, "0", "0"}) place.push(Node::scalar(number));
    rule.set("place", place);
    model::ElementDecl decl = element("place", rule);
    decl.place = {std::make_shared<const std::string>("s.yaml"), 7, 3};
    setup.rules.push_back(decl);
    return build(setup);
  };
  const auto blocked = run("5.2");
  advance(*blocked, 5);
  const Status status = blocked->tick();
  ASSERT_FALSE(status);
  EXPECT_EQ(
      status.error().text(),
      "s.yaml:7:3: rule 'place': 'speaker' cannot be put where 'wall' stands; choose a place that is free");
  EXPECT_EQ(value(*blocked, "speaker.pose.x"), 0);
  const auto beside = run("5.7");
  advance(*beside, 6);
  EXPECT_EQ(value(*beside, "speaker.pose.x"), 5.7);
}

// --- coverage, path, episodes ---

TEST(Coverage, CountsTheCellsThatValuesComeTo) {
  model::Setup setup = weightless();
  Node config = map({{"bins", "4"}, {"interval", "100 ms"}, {"at_least", "2"}});
  config.set("values", texts({"sim.time", "if(sim.time < 0.55, 0.1, 7)"}));
  config.set("ranges", list({numbers({0, 1}), numbers({0, 2})}));
  setup.rules.push_back(element("coverage", config));
  const auto simulation = build(setup);
  advance(*simulation, 105);
  // Times 0, 0.1 ... 1 in quarters: 3, 2 (0.3, 0.4) | 0.5 alone in the third, beside the lower second value; then beyond the upper
  // end of the second range: 0.6, 0.7 in the third quarter, 0.8, 0.9, 1 in the last one.
  EXPECT_EQ(value(*simulation, "rules/coverage.samples"), 11);
  EXPECT_EQ(value(*simulation, "rules/coverage.cells[0]"), 3);
  EXPECT_EQ(value(*simulation, "rules/coverage.cells[1]"), 2);
  EXPECT_EQ(value(*simulation, "rules/coverage.cells[2]"), 1);
  EXPECT_EQ(value(*simulation, "rules/coverage.cells[14]"), 2);
  EXPECT_EQ(value(*simulation, "rules/coverage.cells[15]"), 3);
  EXPECT_EQ(value(*simulation, "rules/coverage.visited"), 4) << "a single sample is not enough";
  EXPECT_EQ(value(*simulation, "rules/coverage.share"), 4 / 16.0);
}

TEST(Path, IsTheSumOfThePiecesBetweenSamples) {
  model::Setup setup = weightless();
  Node config = map({{"interval", "100 ms"}, {"from", "200 ms"}});
  // There and back within 0.4 s: a triangle between 0 and 0.2; along the other axis at 1 m/s.
  config.set("values", texts({"3 * abs(mod(sim.time, 0.4) - 0.2)", "4 * abs(mod(sim.time, 0.4) - 0.2)"}));
  setup.rules.push_back(element("path", config));
  const auto simulation = build(setup);
  advance(*simulation, 105);
  // From 0.2 to 1 s eight pieces of 0.5 m each; 5 m/s; at 0.4 s and 0.8 s it is 1 m from where it began.
  EXPECT_EQ(value(*simulation, "rules/path.samples"), 9);
  EXPECT_NEAR(value(*simulation, "rules/path.length"), 4, 1e-12);
  EXPECT_NEAR(value(*simulation, "rules/path.speed"), 5, 1e-12);
  EXPECT_NEAR(value(*simulation, "rules/path.farthest"), 1, 1e-12);
}

TEST(Episodes, CountWhatLastsLongEnough) {
  model::Setup setup = weightless();
  Node config = map(
      {{"when", "(sim.time > 0.095 and sim.time < 0.295) or (sim.time > 0.395 and sim.time < 0.445)"},
       {"at_least", "100 ms"}});
  setup.rules.push_back(element("episodes", config));
  const auto simulation = build(setup);
  advance(*simulation, 15);
  EXPECT_EQ(value(*simulation, "rules/episodes.count"), 0);
  EXPECT_EQ(value(*simulation, "rules/episodes.first"), -1);
  advance(*simulation, 85);
  // Holds at 0.1 ... 0.29 s, 190 ms from the first sample to the last; at 0.4 ... 0.44 s for 40 ms only.
  EXPECT_EQ(value(*simulation, "rules/episodes.count"), 1);
  EXPECT_NEAR(value(*simulation, "rules/episodes.first"), 0.1, 1e-12);
  EXPECT_NEAR(value(*simulation, "rules/episodes.longest"), 0.19, 1e-12);
  EXPECT_EQ(value(*simulation, "rules/episodes.holds"), 0);
}

TEST(Coverage, RefusesSpacesThatAreNone) {
  const auto refusal = [](Node config) {
    model::Setup setup = weightless();
    setup.rules.push_back(element("coverage", std::move(config)));
    return refused(std::move(setup));
  };
  const Node two = with(Node::map(), "values", texts({"sim.time", "sim.tick"}));
  EXPECT_NE(refusal(with(two, "ranges", list({numbers({1, 1})}))).find("a range is empty"),
            std::string::npos);
  EXPECT_NE(refusal(with(two, "ranges", list({numbers({0, 1}), numbers({0, 1}), numbers({0, 1})})))
                .find("more or fewer ranges"),
            std::string::npos);
  Node many = with(two, "ranges", list({numbers({0, 1})}));
  many.set("bins", Node::scalar("1000"));
  EXPECT_EQ(refusal(many), "") << "a million cells";
  many.set("values", texts({"sim.time", "sim.tick", "sim.time"}));
  EXPECT_NE(refusal(many).find("more than a million cells"), std::string::npos);
}

}  // namespace
}  // namespace sandlot::test
