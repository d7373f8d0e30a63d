// Pairing: messages of any stamps in any order; later pairs are found whatever came before.

#include <boost/make_shared.hpp>

#include "adaptive_grid_stereo/ros/stereo_pairing.h"
#include "test/fuzz/fuzz_input.h"

namespace {

using namespace adaptive_grid_stereo;

ros::Time stampOf(fuzz::FuzzInput* input) {
  switch (input->between(0, 5)) {
    case 0:
      return ros::Time(0, 0);
    case 1:
      return ros::Time(0xffffffffU, 999999999U);
    case 2:
      return ros::Time{input->bits<std::uint32_t>(), input->bits<std::uint32_t>() % 1000000000U};
    default:
      return ros::Time(1000U + static_cast<unsigned>(input->between(0, 3)),
                       static_cast<unsigned>(input->between(0, 9)) * 1000000U);
  }
}

template <typename Message>
boost::shared_ptr<const Message> stamped(const ros::Time& stamp) {
  const auto message = boost::make_shared<Message>();
  message->header.stamp = stamp;
  return message;
}

void feed(StereoPairing* pairs, int side, const ros::Time& stamp) {
  const ros::Time recorded(5000, 0);
  if (side == 0) pairs->addLeft(stamped<sensor_msgs::Image>(stamp), recorded);
  if (side == 1) pairs->addRight(stamped<sensor_msgs::Image>(stamp), recorded);
  if (side == 2) pairs->addLeftInfo(stamped<sensor_msgs::CameraInfo>(stamp), recorded);
  if (side == 3) pairs->addRightInfo(stamped<sensor_msgs::CameraInfo>(stamp), recorded);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ros::Time::init();
  fuzz::FuzzInput input(data, size);
  PairingOptions options;
  options.approximate = input.flag();
  options.max_interval = input.between(0, 2) * 0.01;
  options.queue_size = input.between(2, 8);
  ros::Time served;
  StereoPairing pairs(
      options, [&](const ReceivedPair& pair) { served = pair.pair.left->header.stamp; },
      [](const ros::Time&) {});
  while (input.left() > 0) {
    const int side = input.between(0, 4);
    const ros::Time stamp = stampOf(&input);
    for (int i = 0; i < 4; ++i) {
      if (side == 4 || side == i) feed(&pairs, i, stamp);
    }
  }
  // A camera that goes on with good stamps is served again.
  bool again = false;
  for (unsigned i = 0; i < 40; ++i) {
    const ros::Time stamp(2000 + i / 10, (i % 10) * 100000000U);
    for (int side = 0; side < 4; ++side) feed(&pairs, side, stamp);
    again = again || served == stamp;
  }
  fuzz::require(again, "good pairs after the stamps of the input are not served");
  return 0;
}
