// Bags of any content: every message that is found lies in memory, and is read as its type or
// refused.

#include <geometry_msgs/TwistStamped.h>
#include <nav_msgs/Odometry.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/MagneticField.h>
#include <sensor_msgs/NavSatFix.h>
#include <tf2_msgs/TFMessage.h>

#include "bag_reader.h"
#include "bag_topics.h"
#include "test/fuzz/fuzz_input.h"
#include "test/fuzz/temporary_file.h"

namespace {

using namespace adaptive_grid_stereo;

template <typename Type>
void readAs(const BagMessage& message) {
  try {
    deserialize<Type>(message);
  } catch (const std::runtime_error&) {
  }
}

void readAll(BagReader* bag) {
  BagMessage message;
  unsigned sum = 0;
  while (bag->next(&message)) {
    for (std::uint32_t i = 0; i < message.size; ++i) sum += message.data[i];
    readAs<sensor_msgs::Image>(message);
    readAs<sensor_msgs::CameraInfo>(message);
    readAs<sensor_msgs::Imu>(message);
    readAs<nav_msgs::Odometry>(message);
    readAs<geometry_msgs::TwistStamped>(message);
    readAs<sensor_msgs::NavSatFix>(message);
    readAs<sensor_msgs::MagneticField>(message);
    readAs<tf2_msgs::TFMessage>(message);
  }
  volatile unsigned used = sum;
  static_cast<void>(used);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::TemporaryFile file(".bag");
  try {
    BagReader bag(file.write(data, size));
    fuzz::require(bag.beginTime() <= bag.endTime(), "the end lies before the beginning");
    readAll(&bag);
    std::vector<std::string> notes;
    const BagTopics topics = chooseTopics(bag.connections(), NamedTopics(), &notes);
    outputNamespace(topics.left_image);
  } catch (const std::runtime_error&) {
  }
  return 0;
}
