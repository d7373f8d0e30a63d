#include "adaptive_grid_stereo/ros/conversions.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <vector>

#include <sensor_msgs/image_encodings.h>
#include <boost/make_shared.hpp>
#include <opencv2/imgproc.hpp>

#include "src/common/eight_bits.h"

namespace adaptive_grid_stereo {
namespace {

namespace encodings = sensor_msgs::image_encodings;

/// How an encoding lies in memory, and how cv::cvtColor makes grey of it.
struct Encoding {
  const char* name;
  int type;
  int to_grey;  // -1: is grey already
};

constexpr Encoding kEncodings[] = {
    {"mono8", CV_8UC1, -1},
    {"8UC1", CV_8UC1, -1},
    {"mono16", CV_16UC1, -1},
    {"16UC1", CV_16UC1, -1},
    {"bgr8", CV_8UC3, cv::COLOR_BGR2GRAY},
    {"8UC3", CV_8UC3, cv::COLOR_BGR2GRAY},
    {"rgb8", CV_8UC3, cv::COLOR_RGB2GRAY},
    {"bgra8", CV_8UC4, cv::COLOR_BGRA2GRAY},
    {"8UC4", CV_8UC4, cv::COLOR_BGRA2GRAY},
    {"rgba8", CV_8UC4, cv::COLOR_RGBA2GRAY},
    {"bgr16", CV_16UC3, cv::COLOR_BGR2GRAY},
    {"rgb16", CV_16UC3, cv::COLOR_RGB2GRAY},
};

const Encoding* findEncoding(const std::string& name) {
  for (const Encoding& encoding : kEncodings) {
    if (name == encoding.name) return &encoding;
  }
  return nullptr;
}

/// Grey in the image's own depth; a view where the image is grey already.
cv::Mat viewAsGrey(const sensor_msgs::Image& image) {
  const std::string fault = imageFault(image);
  if (!fault.empty()) throw std::invalid_argument("image " + fault);
  const Encoding& encoding = *findEncoding(image.encoding);
  const int rows = static_cast<int>(image.height);
  const int columns = static_cast<int>(image.width);
  // Only read from here on: everything below writes into fresh memory.
  cv::Mat view(rows, columns, encoding.type, const_cast<std::uint8_t*>(image.data.data()),
               image.step);
  if (CV_MAT_DEPTH(encoding.type) == CV_16U && image.is_bigendian) {
    cv::Mat swapped(rows, columns, encoding.type);
    for (int y = 0; y < rows; ++y) {
      const std::uint8_t* from = image.data.data() + static_cast<std::size_t>(y) * image.step;
      auto* to = swapped.ptr<std::uint16_t>(y);
      for (int x = 0; x < columns * view.channels(); ++x) {
        to[x] = static_cast<std::uint16_t>(from[2 * x] << 8 | from[2 * x + 1]);
      }
    }
    view = swapped;
  }
  if (encoding.to_grey < 0) return view;
  cv::Mat grey;
  cv::cvtColor(view, grey, encoding.to_grey);
  return grey;
}

sensor_msgs::ImagePtr makeImage(const std_msgs::Header& header, unsigned width, unsigned height,
                                const std::string& encoding, unsigned bytes_per_pixel) {
  auto image = boost::make_shared<sensor_msgs::Image>();
  image->header = header;
  image->width = width;
  image->height = height;
  image->encoding = encoding;
  image->is_bigendian = 0;
  image->step = width * bytes_per_pixel;
  image->data.resize(static_cast<std::size_t>(image->step) * height);
  return image;
}

const float* floatRow(const sensor_msgs::Image& image, unsigned y) {
  return reinterpret_cast<const float*>(image.data.data() +
                                        static_cast<std::size_t>(y) * image.step);
}

/// Depth at a disparity for parallel axes [m].
float depthAt(double focal_times_baseline, double disparity) {
  return disparity > 0.0 ? static_cast<float>(focal_times_baseline / disparity)
                         : std::numeric_limits<float>::infinity();
}

}  // namespace

std::string encodingFault(const std::string& encoding) {
  if (findEncoding(encoding) != nullptr) return "";
  const std::string named = "has the encoding \"" + encoding.substr(0, 40) + "\"";
  if (encoding.compare(0, 6, "bayer_") == 0) {
    return named + "; run image_proc on the raw image and use its image_rect";
  }
  std::string known;
  for (const Encoding& candidate : kEncodings) known += std::string(" ") + candidate.name;
  return named + ", which is not one of" + known + "; convert it, e.g. with image_proc";
}

std::string imageFault(const sensor_msgs::Image& image) {
  const Encoding* encoding = findEncoding(image.encoding);
  if (encoding == nullptr) return encodingFault(image.encoding);
  constexpr unsigned kLargest = std::numeric_limits<int>::max();
  if (image.width == 0 || image.height == 0 || image.width > kLargest || image.height > kLargest) {
    return "is " + std::to_string(image.width) + "x" + std::to_string(image.height) + " pixels";
  }
  const std::uint64_t row = static_cast<std::uint64_t>(image.width) * CV_ELEM_SIZE(encoding->type);
  if (image.step < row) {
    return "has step " + std::to_string(image.step) + ", less than " + std::to_string(image.width) +
           " columns of " + std::to_string(CV_ELEM_SIZE(encoding->type)) + " byte";
  }
  const std::uint64_t needed = static_cast<std::uint64_t>(image.step) * image.height;
  if (image.data.size() < needed) {
    return "has " + std::to_string(image.data.size()) + " bytes of data, less than " +
           std::to_string(image.height) + " rows of " + std::to_string(image.step);
  }
  if (CV_ELEM_SIZE1(encoding->type) == 2 && image.step % 2 != 0) {
    return "has the odd step " + std::to_string(image.step) + " for 16-bit pixels";
  }
  return "";
}

GreyPair toGreyPair(const sensor_msgs::Image& left, const sensor_msgs::Image& right,
                    int mono16_bits) {
  GreyPair pair{viewAsGrey(left), viewAsGrey(right)};
  keepEightBits(mono16_bits, &pair.left, &pair.right);
  return pair;
}

sensor_msgs::RegionOfInterest validWindow(int width, int height, int min_disparity,
                                          int disparity_range) {
  const int max_disparity = min_disparity + disparity_range - 1;
  // Column x has a candidate if x - d lies in [0, width) for one d of the range.
  const int first = std::clamp(min_disparity, 0, width);
  const int end = std::clamp(width + max_disparity, 0, width);
  sensor_msgs::RegionOfInterest window;
  window.x_offset = static_cast<unsigned>(first);
  window.width = static_cast<unsigned>(std::max(0, end - first));
  window.y_offset = 0;
  window.height = window.width > 0 ? static_cast<unsigned>(height) : 0;
  return window;
}

void fillDisparityImage(const MatchResult& result, const StereoGeometry& geometry,
                        const std_msgs::Header& header, stereo_msgs::DisparityImage* message) {
  const int width = result.disparity.cols;
  const int height = result.disparity.rows;
  message->header = header;
  message->f = static_cast<float>(geometry.focal_length);
  message->T = static_cast<float>(geometry.baseline);
  message->valid_window = validWindow(width, height, result.min_disparity, result.disparity_range);
  message->min_disparity = static_cast<float>(result.min_disparity - geometry.center_offset);
  message->max_disparity = static_cast<float>(result.min_disparity + result.disparity_range - 1 -
                                              geometry.center_offset);
  message->delta_d = 1.0F / kDisparityScale;

  sensor_msgs::Image& image = message->image;
  image.header = header;
  image.width = static_cast<unsigned>(width);
  image.height = static_cast<unsigned>(height);
  image.encoding = encodings::TYPE_32FC1;
  image.is_bigendian = 0;
  image.step = image.width * sizeof(float);
  image.data.resize(static_cast<std::size_t>(image.step) * image.height);

  const float offset = message->min_disparity;
  constexpr float kStep = 1.0F / kDisparityScale;
  bool any_invalid = false;
  for (int y = 0; y < height; ++y) {
    const auto* from = result.disparity.ptr<std::int16_t>(y);
    auto* to =
        reinterpret_cast<float*>(image.data.data() + static_cast<std::size_t>(y) * image.step);
    std::int16_t smallest = 0;
    for (int x = 0; x < width; ++x) {
      smallest = std::min(smallest, from[x]);
      to[x] = offset + kStep * static_cast<float>(from[x]);
    }
    any_invalid = any_invalid || smallest < 0;
  }
  if (!any_invalid && !image.data.empty()) {
    const float invalid = offset + kStep * kInvalidDisparity;
    std::memcpy(image.data.data(), &invalid, sizeof(invalid));
  }
}

sensor_msgs::ImagePtr toDepthImage(const stereo_msgs::DisparityImage& disparity) {
  const sensor_msgs::Image& from = disparity.image;
  auto depth = makeImage(disparity.header, from.width, from.height, encodings::TYPE_32FC1, 4);
  const double focal_times_baseline = static_cast<double>(disparity.f) * disparity.T;
  for (unsigned y = 0; y < from.height; ++y) {
    const float* in = floatRow(from, y);
    auto* out =
        reinterpret_cast<float*>(depth->data.data() + static_cast<std::size_t>(y) * depth->step);
    for (unsigned x = 0; x < from.width; ++x) {
      out[x] = in[x] < disparity.min_disparity ? std::numeric_limits<float>::quiet_NaN()
                                               : depthAt(focal_times_baseline, in[x]);
    }
  }
  return depth;
}

sensor_msgs::ImagePtr toColorImage(const stereo_msgs::DisparityImage& disparity) {
  const sensor_msgs::Image& from = disparity.image;
  auto color = makeImage(disparity.header, from.width, from.height, encodings::BGR8, 3);
  const float span = std::max(1.0F, disparity.max_disparity - disparity.min_disparity);
  cv::Mat level(static_cast<int>(from.height), static_cast<int>(from.width), CV_8UC1);
  cv::Mat invalid(level.size(), CV_8UC1);
  for (int y = 0; y < level.rows; ++y) {
    const float* in = floatRow(from, static_cast<unsigned>(y));
    for (int x = 0; x < level.cols; ++x) {
      const float share = (in[x] - disparity.min_disparity) / span;
      level.at<std::uint8_t>(y, x) =
          static_cast<std::uint8_t>(255.0F * std::min(std::max(share, 0.0F), 1.0F));
      invalid.at<std::uint8_t>(y, x) = share < 0.0F ? 255 : 0;
    }
  }
  cv::Mat target(level.size(), CV_8UC3, color->data.data(), color->step);
  cv::applyColorMap(level, target, cv::COLORMAP_TURBO);
  target.setTo(cv::Scalar::all(0), invalid);
  return color;
}

}  // namespace adaptive_grid_stereo
