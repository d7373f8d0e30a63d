#ifndef ADAPTIVE_GRID_STEREO_SRC_ROS_SENTENCE_THROTTLE_H
#define ADAPTIVE_GRID_STEREO_SRC_ROS_SENTENCE_THROTTLE_H

#include <cctype>
#include <cstddef>
#include <iterator>
#include <map>
#include <string>

#include <ros/time.h>

namespace adaptive_grid_stereo {

/// Lets one sentence per kind through, and the next of that kind only after a while; different
/// kinds do not hold each other back, up to kMostKinds within that while: sentences quote what
/// damaged messages hold, which may be another thing each time. Not thread safe.
class SentenceThrottle {
 public:
  static constexpr std::size_t kMostKinds = 32;

  explicit SentenceThrottle(double period) : period_(period) {}

  bool pass(const std::string& sentence) {
    std::string kind;
    for (const char letter : sentence) {
      if (std::isdigit(static_cast<unsigned char>(letter)) == 0) kind += letter;
    }
    const double now = ros::SteadyTime::now().toSec();
    const auto last = last_.find(kind);
    if (last != last_.end() && now < last->second + period_) return false;
    if (last == last_.end() && !makeRoom(now)) return false;
    last_[kind] = now;
    return true;
  }

 private:
  bool makeRoom(double now) {
    for (auto kind = last_.begin(); last_.size() >= kMostKinds && kind != last_.end();) {
      kind = now < kind->second + period_ ? std::next(kind) : last_.erase(kind);
    }
    return last_.size() < kMostKinds;
  }

  const double period_;  // [s]
  std::map<std::string, double> last_;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_ROS_SENTENCE_THROTTLE_H
