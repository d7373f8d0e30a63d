#ifndef ADAPTIVE_GRID_STEREO_TOOLS_PEERS_H
#define ADAPTIVE_GRID_STEREO_TOOLS_PEERS_H

#include <memory>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace adaptive_grid_stereo {

/// OpenCV's matchers, which a user could pick instead.
enum class PeerKind { kBm, kSgbm, kSgbm3Way, kSgbmHh4, kSgbmHh };
constexpr PeerKind kAllPeers[] = {PeerKind::kBm, PeerKind::kSgbm3Way, PeerKind::kSgbm,
                                  PeerKind::kSgbmHh4, PeerKind::kSgbmHh};

/// E.g. "StereoBM", "SGBM 3WAY".
const char* toString(PeerKind kind);

/// One of OpenCV's matchers with the parameters of its own sample and documentation:
/// StereoBM: block 15, pre-filter cap 31, texture 10, uniqueness 15 %, speckles 100 px / 32.
/// StereoSGBM: block 5, P1 = 8 * 25, P2 = 32 * 25, pre-filter cap 63, uniqueness 10 %, left-right
/// check 1 px, speckles 100 px / 2.
/// `padded`: the images are first extended at the left by the disparity range, because these
/// matchers leave that many columns without disparity.
class Peer {
 public:
  Peer(PeerKind kind, bool padded, int disparity_range);
  ~Peer();
  Peer(Peer&&) noexcept;

  const std::string& name() const { return name_; }

  /// left, right: CV_8UC1 of one size. Returns CV_16SC1, 16 steps per pixel, negative = invalid,
  /// which the next call overwrites. Threads: cv::setNumThreads().
  const cv::Mat& match(const cv::Mat& left, const cv::Mat& right);

 private:
  struct Impl;
  std::string name_;
  std::unique_ptr<Impl> impl_;
};

/// A result of Peer::match() as CV_32FC1 [px], inf = invalid.
cv::Mat peerToFloat(const cv::Mat& disparity);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TOOLS_PEERS_H
