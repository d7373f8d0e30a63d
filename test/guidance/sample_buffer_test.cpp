#include "adaptive_grid_stereo/guidance/sample_buffer.h"

#include <gtest/gtest.h>

namespace adaptive_grid_stereo {
namespace {

struct Sample {
  double stamp = 0.0;
  int value = 0;
};
using Buffer = SampleBuffer<Sample>;
constexpr double kGap = 0.5;

std::vector<double> stamps(const Buffer& buffer) {
  std::vector<double> result;
  for (std::size_t i = 0; i < buffer.size(); ++i) result.push_back(buffer[i].stamp);
  return result;
}

TEST(SampleBufferTest, KeepsTheNewestInOrder) {
  Buffer buffer(3);
  for (const double stamp : {1.0, 1.1, 1.2, 1.3}) EXPECT_EQ(buffer.insert({stamp}, kGap), stamp);
  EXPECT_EQ(stamps(buffer), (std::vector<double>{1.1, 1.2, 1.3}));
  EXPECT_EQ(buffer.latest(1.25)->stamp, 1.2);
  EXPECT_EQ(buffer.latest(1.2)->stamp, 1.2);
  EXPECT_EQ(buffer.latest(1.0), nullptr);
  EXPECT_NEAR(buffer.period(), 0.1, 1e-9);
}

TEST(SampleBufferTest, SortsStragglersAndRefusesDuplicates) {
  Buffer buffer(10);
  buffer.insert({1.0, 1}, kGap);
  buffer.insert({1.2, 2}, kGap);
  EXPECT_EQ(buffer.insert({1.1, 3}, kGap), 1.1);
  EXPECT_EQ(buffer.insert({1.1, 4}, kGap), Buffer::kNothing);
  EXPECT_EQ(stamps(buffer), (std::vector<double>{1.0, 1.1, 1.2}));
  EXPECT_EQ(buffer[1].value, 3) << "the first one stays";
  EXPECT_EQ(buffer.counts().out_of_order, 1u);
  EXPECT_EQ(buffer.counts().duplicates, 1u);
  EXPECT_EQ(buffer.counts().accepted, 3u);
}

TEST(SampleBufferTest, RefusesWhatIsOlderThanAFullBuffer) {
  Buffer buffer(2);
  buffer.insert({1.0}, kGap);
  buffer.insert({1.1}, kGap);
  EXPECT_EQ(buffer.insert({0.9}, kGap), Buffer::kNothing);
  EXPECT_EQ(buffer.counts().too_late, 1u);
  EXPECT_EQ(buffer.size(), 2u);
}

TEST(SampleBufferTest, StartsOverWithWhatCameAfterTheStepBack) {
  Buffer buffer(100);
  for (const double stamp : {1.0, 1.1, 4.0, 4.1}) buffer.insert({stamp, 1}, kGap);
  for (const double stamp : {1.0, 1.05}) buffer.insert({stamp, 2}, kGap);
  buffer.startOver(1.0);
  EXPECT_EQ(stamps(buffer), (std::vector<double>{1.0, 1.05}));
  EXPECT_EQ(buffer[0].value, 2) << "the one of the old run with the same stamp is no duplicate";
  EXPECT_FALSE(buffer.awaited());
}

TEST(SampleBufferTest, AwaitsASourceThatHasNotStartedOverYet) {
  Buffer buffer(100), never_heard(100);
  for (const double stamp : {1.0, 1.1, 4.0, 4.1}) buffer.insert({stamp, 1}, kGap);
  buffer.startOver(1.0);
  never_heard.startOver(1.0);
  EXPECT_TRUE(buffer.empty());
  EXPECT_TRUE(buffer.awaited());
  EXPECT_FALSE(never_heard.awaited());
  buffer.insert({1.0, 2}, kGap);
  EXPECT_FALSE(buffer.awaited());
  EXPECT_EQ(stamps(buffer), (std::vector<double>{1.0}));
}

TEST(SampleBufferTest, CountsGaps) {
  Buffer buffer(10);
  for (const double stamp : {1.0, 1.4, 2.0, 2.1}) buffer.insert({stamp}, kGap);
  EXPECT_EQ(buffer.counts().gaps, 1u);
}

TEST(SampleBufferTest, ClockSetBackDropsWhatWasLater) {
  Buffer buffer(100);
  for (int i = 0; i < 50; ++i) buffer.insert({100.0 + 0.1 * i}, kGap);
  for (int i = 0; i < 3; ++i) buffer.insert({10.0 + 0.1 * i}, kGap);
  EXPECT_EQ(buffer.size(), 3u);
  EXPECT_EQ(buffer.counts().clock_jumps, 1u);
  EXPECT_EQ(buffer.counts().out_of_order, 0u);
  EXPECT_NEAR(buffer.back().stamp, 10.2, 1e-9);
}

TEST(SampleBufferTest, OneSampleFromTheFutureCostsNothingElse) {
  Buffer buffer(100);
  for (int i = 0; i < 10; ++i) buffer.insert({1.0 + 0.1 * i}, kGap);
  buffer.insert({500.0}, kGap);
  for (int i = 10; i < 20; ++i) buffer.insert({1.0 + 0.1 * i}, kGap);
  EXPECT_EQ(buffer.size(), 20u);
  EXPECT_NEAR(buffer.back().stamp, 2.9, 1e-9);
}

TEST(SampleBufferTest, OneStragglerFromFarBackIsNoClockJump) {
  Buffer buffer(100);
  for (int i = 0; i < 50; ++i) {
    buffer.insert({10.0 + 0.1 * i}, kGap);
    if (i == 40) buffer.insert({10.05}, kGap);
  }
  EXPECT_EQ(buffer.counts().clock_jumps, 0u);
  EXPECT_EQ(buffer.size(), 51u);
}

TEST(SampleBufferTest, ShortBagThatLoopsStartsOver) {
  Buffer buffer(1000);
  for (int lap = 0; lap < 3; ++lap) {
    for (int i = 0; i < 50; ++i) buffer.insert({1.0 + 0.1 * i, lap}, kGap);
  }
  EXPECT_EQ(buffer.counts().clock_jumps, 2u);
  EXPECT_EQ(buffer.size(), 50u);
  EXPECT_EQ(buffer.back().value, 2);
}

}  // namespace
}  // namespace adaptive_grid_stereo
