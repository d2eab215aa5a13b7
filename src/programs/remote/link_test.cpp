/// The link between a remote program and its client: who is attached, whatever the order in which threads say so.
#include "programs/remote/link.h"

#include <gtest/gtest.h>

#include <vector>

namespace sandlot::programs::remote {
namespace {

struct Heard {
  std::vector<std::uint64_t> steps;
  Link::Client client(std::uint64_t claim, double deadline_s = 1) {
    return {.deadline_s = deadline_s,
            .step = [this](const Link::Step& step) { steps.push_back(step.number); },
            .claim = claim};
  }
};

TEST(RemoteLink, TellsAStepOnceAndTakesOneAnswerOfIt) {
  Link link;
  Heard heard;
  link.put({.number = 7});
  link.release();
  link.attach(heard.client(1));  // of a step that waits it is told at once
  link.release();
  EXPECT_EQ(heard.steps, std::vector<std::uint64_t>{7});
  EXPECT_FALSE(link.answer(6, "{}"));
  EXPECT_FALSE(link.take());
  EXPECT_TRUE(link.answer(7, "{}"));
  EXPECT_FALSE(link.answer(7, "{}")) << "one answer";
  EXPECT_EQ(**link.take(), "{}");
  EXPECT_FALSE(link.take());
}

TEST(RemoteLink, AClientThatGoesAwayIsTheAnswerOfTheStep) {
  Link link;
  Heard heard;
  link.attach(heard.client(1));
  link.put({.number = 7});
  link.release();
  link.detach(1, "it has gone");
  const auto answer = link.take();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->error().what, "it has gone");
  EXPECT_FALSE(link.deadline_s());
}

/// A program that ends as soon as it has claimed its robot: its end is heard before the simulation attaches it. Nobody may wait for it.
TEST(RemoteLink, AClaimThatHasEndedIsAttachedNoMore) {
  Link link;
  Heard heard;
  link.detach(3, "it has gone");
  link.attach(heard.client(3));
  EXPECT_FALSE(link.deadline_s());
  EXPECT_EQ(link.attachments(), 0u);
  link.attach(heard.client(4, 0.5));
  EXPECT_EQ(link.deadline_s(), 0.5);
  // The end of a claim before it, heard late, takes nothing from the one that has come.
  link.detach(3, "it has gone");
  EXPECT_EQ(link.deadline_s(), 0.5);
}

/// The deadline is compared with the time of the answer, whenever the simulation comes to take it.
TEST(RemoteLink, AnAnswerIsTakenByTheTimeAtWhichItCame) {
  Link link;
  Heard heard;
  link.attach(heard.client(1));
  link.put({.number = 7});
  EXPECT_FALSE(link.told_at());
  const auto before = Link::Clock::now();
  link.release();
  EXPECT_GE(link.told_at(), before);
  EXPECT_TRUE(link.answer(7, "{}"));
  EXPECT_FALSE(link.take(before - std::chrono::milliseconds(1)));
  EXPECT_EQ(**link.take(Link::Clock::now()), "{}");
  link.put({.number = 8});
  EXPECT_FALSE(link.told_at()) << "not sent yet";
}

TEST(RemoteLink, GivingUpHoldsUntilAClientComes) {
  Link link;
  Heard heard;
  EXPECT_FALSE(link.given_up());
  link.give_up();
  EXPECT_TRUE(link.given_up());
  link.detach(1, "it has gone");
  link.attach(heard.client(1));
  EXPECT_TRUE(link.given_up()) << "that one has gone already";
  link.attach(heard.client(2));
  EXPECT_FALSE(link.given_up());
}

}  // namespace
}  // namespace sandlot::programs::remote
