#include "src/ros/sentence_throttle.h"

#include <gtest/gtest.h>

namespace adaptive_grid_stereo {
namespace {

TEST(SentenceThrottle, LetsOneOfEachKindThrough) {
  SentenceThrottle throttle(1000.0);
  EXPECT_TRUE(throttle.pass("the image is 3 ms late"));
  EXPECT_FALSE(throttle.pass("the image is 12 ms late")) << "only the number is another";
  EXPECT_TRUE(throttle.pass("the image is empty"));
}

TEST(SentenceThrottle, LetsTheNextOneThroughAfterAWhile) {
  SentenceThrottle throttle(0.0);
  EXPECT_TRUE(throttle.pass("again"));
  EXPECT_TRUE(throttle.pass("again"));
}

TEST(SentenceThrottle, IsNotFloodedBySentencesThatAreAllDifferent) {
  SentenceThrottle throttle(1000.0);
  std::string quoted;
  std::size_t passed = 0;
  for (int i = 0; i < 500; ++i) {
    quoted += 'x';
    passed += throttle.pass("unknown encoding " + quoted) ? 1 : 0;
  }
  EXPECT_EQ(passed, SentenceThrottle::kMostKinds);
}

}  // namespace
}  // namespace adaptive_grid_stereo
