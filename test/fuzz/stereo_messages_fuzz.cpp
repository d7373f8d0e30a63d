// Images and camera_infos as they come over the wire: the fuzzer shapes their serialised bytes.

#include <ros/serialization.h>
#include <boost/make_shared.hpp>

#include "bag_reader.h"
#include "test/fuzz/stereo_pair_check.h"

namespace {

using namespace adaptive_grid_stereo;

/// The next message: its length in 16 bits, then its bytes. Null if roscpp would drop it.
template <typename Message>
boost::shared_ptr<const Message> nextMessage(fuzz::FuzzInput* input) {
  const std::size_t size = std::min<std::size_t>(input->bits<std::uint16_t>(), input->left());
  std::vector<std::uint8_t> bytes(size);
  for (std::uint8_t& byte : bytes) byte = input->bits<std::uint8_t>();
  const auto message = boost::make_shared<Message>();
  try {
    // roscpp itself takes as much memory as the message claims to need.
    checkArrayLengths(ros::message_traits::datatype<Message>(), bytes.data(),
                      static_cast<std::uint32_t>(bytes.size()));
    ros::serialization::IStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
    ros::serialization::deserialize(stream, *message);
  } catch (const std::exception&) {
    return nullptr;
  }
  return message;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::FuzzInput input(data, size);
  ProcessorConfig config;
  config.matcher.threads = 1;
  config.matcher.disparity_range = 16;
  config.mono16_bits = input.flag() ? 12 : 0;
  StereoPair pair;
  pair.left = nextMessage<sensor_msgs::Image>(&input);
  pair.right = nextMessage<sensor_msgs::Image>(&input);
  pair.left_info = nextMessage<sensor_msgs::CameraInfo>(&input);
  pair.right_info = nextMessage<sensor_msgs::CameraInfo>(&input);
  fuzz::checkAndProcess(pair, InputLimits(), config);
  return 0;
}
