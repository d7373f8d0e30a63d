// Images and camera_infos with hostile fields: sizes that overflow, data that is short, numbers
// that are none.

#include <boost/make_shared.hpp>

#include "test/fuzz/stereo_pair_check.h"

namespace {

using namespace adaptive_grid_stereo;
using fuzz::FuzzInput;

std_msgs::Header headerOf(FuzzInput* input) {
  std_msgs::Header header;
  const bool odd = input->between(0, 7) == 0;
  header.stamp =
      odd ? ros::Time{input->bits<std::uint32_t>(), input->bits<std::uint32_t>() % 1000000000U}
          : ros::Time(1000, 0);
  header.frame_id = odd ? input->text(40) : "left_optical";
  return header;
}

struct Shape {
  std::string encoding;
  unsigned width, height, bytes;
};

Shape shapeOf(FuzzInput* input) {
  static const std::pair<const char*, unsigned> kEncodings[] = {
      {"mono8", 1}, {"8UC1", 1},  {"mono16", 2}, {"16UC1", 2},  {"bgr8", 3},       {"8UC3", 3},
      {"rgb8", 3},  {"bgra8", 4}, {"8UC4", 4},   {"rgba8", 4},  {"bgr16", 6},      {"rgb16", 6},
      {"", 1},      {"32FC1", 4}, {"yuv422", 2}, {"64FC4", 32}, {"bayer_rggb8", 1}};
  const auto& [encoding, bytes] = kEncodings[input->between(0, 16)];
  return {encoding, static_cast<unsigned>(input->between(16, 40)),
          static_cast<unsigned>(input->between(16, 24)), bytes};
}

sensor_msgs::ImagePtr imageOf(FuzzInput* input, const Shape& shape) {
  const auto image = boost::make_shared<sensor_msgs::Image>();
  image->header = headerOf(input);
  image->encoding = shape.encoding;
  image->width = shape.width;
  image->height = shape.height;
  image->step = shape.width * shape.bytes + static_cast<unsigned>(input->between(0, 3));
  std::size_t size = static_cast<std::size_t>(image->step) * image->height;
  switch (input->between(0, 15)) {
    case 0:
      image->width = input->length();
      break;
    case 1:
      image->height = input->length();
      break;
    case 2:
      image->step = input->length();
      break;
    case 3:
      size = static_cast<std::size_t>(input->between(0, 4000));
      break;
    case 4:
      image->encoding = input->text(60);
      break;
    case 5:  // all that a sum or a product can be made of
      image->width = input->length();
      image->height = input->length();
      image->step = input->length();
      size = static_cast<std::size_t>(input->between(0, 4000));
      break;
    default:
      break;
  }
  image->is_bigendian = input->bits<std::uint8_t>();
  image->data.resize(size);
  std::uint32_t state = input->bits<std::uint32_t>();
  for (std::uint8_t& byte : image->data)
    byte = static_cast<std::uint8_t>((state = state * 1664525U + 1013904223U) >> 24);
  return image;
}

sensor_msgs::CameraInfoPtr infoOf(FuzzInput* input, const Shape& shape, double tx) {
  const auto info = boost::make_shared<sensor_msgs::CameraInfo>();
  info->header = headerOf(input);
  info->width = shape.width;
  info->height = shape.height;
  info->P = {input->near(100.0),
             0,
             input->near(20.0),
             input->near(tx),
             0,
             input->near(100.0),
             input->near(12.0),
             0,
             0,
             0,
             1,
             0};
  if (input->between(0, 15) == 0)
    info->P[static_cast<std::size_t>(input->between(0, 11))] = input->number();
  if (input->between(0, 7) == 0) info->width = input->length();
  if (input->between(0, 7) == 0) info->height = input->length();
  if (input->between(0, 3) == 0) {
    info->binning_x = input->length();
    info->binning_y = input->length();
    info->roi.width = input->length();
    info->roi.height = input->length();
    info->roi.x_offset = input->length();
    info->roi.y_offset = input->length();
  }
  return info;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzInput input(data, size);
  const Shape shape = shapeOf(&input);
  StereoPair pair;
  pair.left = imageOf(&input, shape);
  pair.right = imageOf(&input, shape);
  pair.left_info = infoOf(&input, shape, 0.0);
  pair.right_info = infoOf(&input, shape, -20.0);
  InputLimits limits;
  if (input.flag()) limits.baseline = 0.1;
  if (input.flag()) limits.max_stamp_difference = 0.02;
  ProcessorConfig config;
  config.matcher.threads = 1;
  config.matcher.disparity_range = 16;
  config.matcher.min_disparity = input.between(-40, 40);
  if (input.between(0, 7) == 0) config.matcher.min_disparity = input.flag() ? 1024 : -1024;
  config.mono16_bits = input.between(7, 16);
  config.validate();
  fuzz::checkAndProcess(pair, limits, config);
  return 0;
}
