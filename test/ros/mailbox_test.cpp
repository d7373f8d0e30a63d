#include "adaptive_grid_stereo/ros/mailbox.h"

#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace adaptive_grid_stereo {
namespace {

using IntMailbox = Mailbox<int>;

TEST(Mailbox, OfNewestReplacesWhatWasNotFetched) {
  IntMailbox mailbox(IntMailbox::Mode::kNewest);
  EXPECT_EQ(mailbox.put(1), 0U);
  EXPECT_EQ(mailbox.put(2), 1U);
  EXPECT_EQ(mailbox.put(3), 1U);
  int item = 0;
  ASSERT_TRUE(mailbox.take(item));
  EXPECT_EQ(item, 3);
  EXPECT_EQ(mailbox.size(), 0U);
}

TEST(Mailbox, OfEveryKeepsTheOrder) {
  IntMailbox mailbox(IntMailbox::Mode::kEvery);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(mailbox.put(i), 0U);
  for (int i = 0; i < 100; ++i) {
    int item = -1;
    ASSERT_TRUE(mailbox.take(item));
    EXPECT_EQ(item, i);
  }
}

TEST(Mailbox, WakesTheWorkerForAnItemAndForTheEnd) {
  IntMailbox mailbox(IntMailbox::Mode::kEvery);
  std::vector<int> taken;
  std::thread worker([&] {
    int item = 0;
    while (mailbox.take(item)) {
      taken.push_back(item);
      if (item == 2) mailbox.stop();
    }
  });
  mailbox.put(1);
  mailbox.put(2);
  worker.join();
  EXPECT_EQ(taken, (std::vector<int>{1, 2}));
  int item = 0;
  EXPECT_FALSE(mailbox.take(item));
  EXPECT_EQ(mailbox.put(3), 0U);
  EXPECT_EQ(mailbox.size(), 0U) << "a stopped mailbox takes nothing";
}

TEST(Mailbox, CountsWhatItThrowsAway) {
  IntMailbox mailbox(IntMailbox::Mode::kEvery);
  mailbox.put(1);
  mailbox.put(2);
  EXPECT_EQ(mailbox.clear(), 2U);
  EXPECT_EQ(mailbox.clear(), 0U);
}

}  // namespace
}  // namespace adaptive_grid_stereo
