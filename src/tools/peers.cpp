#include "peers.h"

#include <limits>

#include <opencv2/calib3d.hpp>

namespace adaptive_grid_stereo {
namespace {

constexpr int kBmBlock = 15;
constexpr int kSgbmBlock = 5;

cv::Ptr<cv::StereoMatcher> makeBm(int disparity_range) {
  const cv::Ptr<cv::StereoBM> matcher = cv::StereoBM::create(disparity_range, kBmBlock);
  matcher->setPreFilterCap(31);
  matcher->setTextureThreshold(10);
  matcher->setUniquenessRatio(15);
  matcher->setSpeckleWindowSize(100);
  matcher->setSpeckleRange(32);
  matcher->setDisp12MaxDiff(1);
  return matcher;
}

cv::Ptr<cv::StereoMatcher> makeSgbm(int disparity_range, int mode) {
  const int area = kSgbmBlock * kSgbmBlock;
  return cv::StereoSGBM::create(0, disparity_range, kSgbmBlock, 8 * area, 32 * area, 1, 63, 10, 100,
                                2, mode);
}

cv::Ptr<cv::StereoMatcher> make(PeerKind kind, int disparity_range) {
  switch (kind) {
    case PeerKind::kBm:
      return makeBm(disparity_range);
    case PeerKind::kSgbm:
      return makeSgbm(disparity_range, cv::StereoSGBM::MODE_SGBM);
    case PeerKind::kSgbm3Way:
      return makeSgbm(disparity_range, cv::StereoSGBM::MODE_SGBM_3WAY);
    case PeerKind::kSgbmHh4:
      return makeSgbm(disparity_range, cv::StereoSGBM::MODE_HH4);
    case PeerKind::kSgbmHh:
      return makeSgbm(disparity_range, cv::StereoSGBM::MODE_HH);
  }
  return {};
}

}  // namespace

const char* toString(PeerKind kind) {
  switch (kind) {
    case PeerKind::kBm:
      return "StereoBM";
    case PeerKind::kSgbm:
      return "SGBM";
    case PeerKind::kSgbm3Way:
      return "SGBM 3WAY";
    case PeerKind::kSgbmHh4:
      return "SGBM HH4";
    case PeerKind::kSgbmHh:
      return "SGBM HH";
  }
  return "unknown";
}

struct Peer::Impl {
  cv::Ptr<cv::StereoMatcher> matcher;
  int padding = 0;
  cv::Mat left;
  cv::Mat right;
  cv::Mat padded;
  cv::Mat disparity;
};

Peer::Peer(PeerKind kind, bool padded, int disparity_range)
    : name_(std::string(toString(kind)) + (padded ? " padded" : "")),
      impl_(std::make_unique<Impl>()) {
  impl_->matcher = make(kind, disparity_range);
  impl_->padding = padded ? disparity_range : 0;
}

Peer::~Peer() = default;
Peer::Peer(Peer&&) noexcept = default;

const cv::Mat& Peer::match(const cv::Mat& left, const cv::Mat& right) {
  Impl& o = *impl_;
  if (o.padding == 0) {
    o.matcher->compute(left, right, o.disparity);
    return o.disparity;
  }
  cv::copyMakeBorder(left, o.left, 0, 0, o.padding, 0, cv::BORDER_REPLICATE);
  cv::copyMakeBorder(right, o.right, 0, 0, o.padding, 0, cv::BORDER_REPLICATE);
  o.matcher->compute(o.left, o.right, o.padded);
  o.disparity = o.padded.colRange(o.padding, o.padded.cols);
  return o.disparity;
}

cv::Mat peerToFloat(const cv::Mat& disparity) {
  cv::Mat result(disparity.size(), CV_32FC1);
  for (int y = 0; y < disparity.rows; ++y) {
    for (int x = 0; x < disparity.cols; ++x) {
      const std::int16_t value = disparity.at<std::int16_t>(y, x);
      result.at<float>(y, x) =
          value < 0 ? std::numeric_limits<float>::infinity() : static_cast<float>(value) / 16.0f;
    }
  }
  return result;
}

}  // namespace adaptive_grid_stereo
