#include "bag_reader.h"

#include <random>

#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <std_msgs/String.h>
#include <tf2_msgs/TFMessage.h>

#include "raw_message.h"
#include "temporary_folder.h"

namespace adaptive_grid_stereo {
namespace {

constexpr int kMessages = 40;

/// Text that does not compress well.
std::string noise(int seed) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::string text(300, ' ');
  for (char& character : text) character = static_cast<char>(' ' + random() % 90);
  return text;
}

/// Strings "0".."39", recorded backwards, one second apart, several per chunk.
void writeBag(const std::string& path, rosbag::CompressionType compression) {
  rosbag::Bag bag(path, rosbag::bagmode::Write);
  bag.setCompression(compression);
  bag.setChunkThreshold(2000);
  for (int i = kMessages - 1; i >= 0; --i) {
    std_msgs::String message;
    message.data = std::to_string(i) + ' ' + noise(i);
    bag.write(i % 2 == 0 ? "/even" : "/odd", ros::Time(100.0 + i), message);
  }
}

std::vector<int> readNumbers(BagReader* reader) {
  std::vector<int> numbers;
  BagMessage message;
  while (reader->next(&message)) {
    numbers.push_back(std::stoi(deserialize<std_msgs::String>(message)->data));
  }
  return numbers;
}

class BagReaderTest : public ::testing::TestWithParam<rosbag::CompressionType> {
 protected:
  void SetUp() override { writeBag(folder_.file("a.bag"), GetParam()); }
  TemporaryFolder folder_;
};

TEST_P(BagReaderTest, GivesEveryMessageInTheOrderOfTime) {
  BagReader reader(folder_.file("a.bag"));
  EXPECT_EQ(reader.damage(), "");
  EXPECT_EQ(reader.connections().size(), 2u);
  EXPECT_EQ(reader.messageCount(), static_cast<std::size_t>(kMessages));
  EXPECT_EQ(reader.messageCount("/odd"), static_cast<std::size_t>(kMessages / 2));
  EXPECT_EQ(reader.beginTime(), ros::Time(100.0));
  EXPECT_EQ(reader.endTime(), ros::Time(100.0 + kMessages - 1));
  std::vector<int> expected(kMessages);
  for (int i = 0; i < kMessages; ++i) expected[i] = i;
  EXPECT_EQ(readNumbers(&reader), expected);
  reader.rewind();
  EXPECT_EQ(readNumbers(&reader), expected);
}

TEST_P(BagReaderTest, OfABagThatWasCutOffTheBeginningIsRead) {
  const std::string whole = folder_.read("a.bag");
  folder_.write("cut.bag", whole.substr(0, whole.size() / 2));
  BagReader reader(folder_.file("cut.bag"));
  EXPECT_NE(reader.damage(), "");
  const std::vector<int> numbers = readNumbers(&reader);
  EXPECT_GT(numbers.size(), 5u);
  EXPECT_LT(numbers.size(), static_cast<std::size_t>(kMessages));
}

TEST_P(BagReaderTest, AnyCutAndAnyWrongByteIsSurvived) {
  const std::string whole = folder_.read("a.bag");
  for (std::size_t i = 1; i <= 150; ++i) {
    const std::size_t at = whole.size() * i / 151;
    for (const bool cut : {true, false}) {
      std::string bad = cut ? whole.substr(0, at) : whole;
      if (!cut) bad[at] = static_cast<char>(bad[at] ^ 0xff);
      folder_.write("bad.bag", bad);
      std::size_t count = 0;
      const std::string fault = messageOf([&] {
        BagReader reader(folder_.file("bad.bag"));
        BagMessage message;
        while (reader.next(&message)) {
          ++count;
          messageOf([&] { deserialize<std_msgs::String>(message); });
        }
      });
      EXPECT_LE(count, static_cast<std::size_t>(kMessages)) << at;
      if (at > 20) {
        EXPECT_EQ(fault, "") << at;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Compressions, BagReaderTest,
                         ::testing::Values(rosbag::compression::Uncompressed,
                                           rosbag::compression::LZ4, rosbag::compression::BZ2));

TEST(BagReader, AnUnindexedBagIsReadWhole) {
  const TemporaryFolder folder;
  writeBag(folder.file("a.bag"), rosbag::compression::Uncompressed);
  std::string bytes = folder.read("a.bag");
  const std::size_t index = bytes.find("index_pos=");
  ASSERT_NE(index, std::string::npos);
  bytes.replace(index + 10, 8, std::string(8, '\0'));
  folder.write("a.bag", bytes);
  BagReader reader(folder.file("a.bag"));
  EXPECT_NE(reader.damage().find("not indexed"), std::string::npos) << reader.damage();
  EXPECT_EQ(readNumbers(&reader).size(), static_cast<std::size_t>(kMessages));
}

TEST(BagReader, ACorruptChunkCostsItsOwnMessagesOnly) {
  const TemporaryFolder folder;
  writeBag(folder.file("a.bag"), rosbag::compression::LZ4);
  std::string bytes = folder.read("a.bag");
  const std::size_t chunk = bytes.find("compression=lz4", bytes.size() / 3);
  ASSERT_NE(chunk, std::string::npos);
  for (std::size_t i = 60; i < 90; ++i)
    bytes[chunk + i] = static_cast<char>(bytes[chunk + i] ^ 0x55);
  folder.write("a.bag", bytes);
  BagReader reader(folder.file("a.bag"));
  EXPECT_NE(reader.damage().find("chunk"), std::string::npos) << reader.damage();
  const std::size_t count = readNumbers(&reader).size();
  EXPECT_LT(count, static_cast<std::size_t>(kMessages));
  EXPECT_GT(count, static_cast<std::size_t>(kMessages) / 2);
}

TEST(BagReader, OtherFilesAreRefused) {
  const TemporaryFolder folder;
  folder.write("a.bag", "something else");
  EXPECT_NE(messageOf([&] { BagReader reader(folder.file("a.bag")); }).find("no ROS 1 bag"),
            std::string::npos);
  EXPECT_NE(messageOf([&] { BagReader reader(folder.file("none.bag")); }).find("cannot be opened"),
            std::string::npos);
}

TEST(BagReader, AnotherTypeIsRefused) {
  const TemporaryFolder folder;
  writeBag(folder.file("a.bag"), rosbag::compression::Uncompressed);
  BagReader reader(folder.file("a.bag"));
  BagMessage message;
  ASSERT_TRUE(reader.next(&message));
  EXPECT_NE(messageOf([&] { deserialize<sensor_msgs::Image>(message); }).find("/even"),
            std::string::npos);
}

/// A message's bytes, with the four bytes at `position_from_end` replaced by a huge length.
template <typename Message>
std::vector<std::uint8_t> withHugeArray(const Message& message, std::size_t position_from_end) {
  std::vector<std::uint8_t> bytes(ros::serialization::serializationLength(message));
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, message);
  for (std::size_t i = 0; i < 4; ++i) bytes[bytes.size() - position_from_end + i] = 0xf0;
  return bytes;
}

TEST(BagReader, ArraysThatClaimTooMuchAreRefusedBeforeMemoryIsTaken) {
  sensor_msgs::Image image;
  image.encoding = "mono8";
  image.data.resize(8);
  const auto bytes = withHugeArray(image, 12);
  EXPECT_THROW(checkArrayLengths("sensor_msgs/Image", bytes.data(),
                                 static_cast<std::uint32_t>(bytes.size())),
               std::runtime_error);
  sensor_msgs::CameraInfo info;
  // After D come K, R, P, binning and the region of interest: 9 + 9 + 12 doubles, 8 and 17 bytes.
  const auto info_bytes = withHugeArray(info, 4 + 30 * 8 + 8 + 17);
  EXPECT_THROW(checkArrayLengths("sensor_msgs/CameraInfo", info_bytes.data(),
                                 static_cast<std::uint32_t>(info_bytes.size())),
               std::runtime_error);
}

TEST(BagReader, ArraysAreCheckedUnderOtherNamesOfAType) {
  // Bags of older systems hold tf/tfMessage, which has the layout and the md5sum of
  // tf2_msgs/TFMessage.
  BagConnection connection;
  connection.topic = "/tf";
  connection.datatype = "tf/tfMessage";
  connection.md5sum = ros::message_traits::md5sum<tf2_msgs::TFMessage>();
  std::vector<std::uint8_t> bytes(4, 0xff);
  BagMessage message;
  message.connection = &connection;
  message.data = bytes.data();
  message.size = 4;
  EXPECT_NE(messageOf([&] { deserialize<tf2_msgs::TFMessage>(message); }).find("claims"),
            std::string::npos);
  bytes.assign(4, 0);
  EXPECT_TRUE(deserialize<tf2_msgs::TFMessage>(message)->transforms.empty());
}

TEST(BagReader, MessagesAreCopiedUnchanged) {
  const TemporaryFolder folder;
  writeBag(folder.file("a.bag"), rosbag::compression::BZ2);
  BagReader first(folder.file("a.bag"));
  {
    rosbag::Bag copy(folder.file("b.bag"), rosbag::bagmode::Write);
    BagMessage message;
    while (first.next(&message)) {
      copy.write(message.connection->topic, message.time, RawMessage{&message},
                 message.connection->header);
    }
  }
  first.rewind();
  BagReader second(folder.file("b.bag"));
  EXPECT_EQ(second.damage(), "");
  EXPECT_EQ(readNumbers(&first), readNumbers(&second));
  EXPECT_EQ(second.connections().at(0).definition, first.connections().at(0).definition);
}

}  // namespace
}  // namespace adaptive_grid_stereo
