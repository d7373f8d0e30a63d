#ifndef ADAPTIVE_GRID_STEREO_SRC_ROS_SENTENCE_THROTTLE_H
#define ADAPTIVE_GRID_STEREO_SRC_ROS_SENTENCE_THROTTLE_H

#include <cctype>
#include <map>
#include <string>

#include <ros/time.h>

namespace adaptive_grid_stereo {

/// Lets one sentence per kind through, and the next of that kind only after a while; different
/// kinds do not hold each other back. Not thread safe.
class SentenceThrottle {
 public:
  explicit SentenceThrottle(double period) : period_(period) {}

  bool pass(const std::string& sentence) {
    std::string kind;
    for (const char letter : sentence) {
      if (std::isdigit(static_cast<unsigned char>(letter)) == 0) kind += letter;
    }
    const double now = ros::SteadyTime::now().toSec();
    const auto last = last_.find(kind);
    if (last != last_.end() && now < last->second + period_) return false;
    last_[kind] = now;
    return true;
  }

 private:
  const double period_;  // [s]
  std::map<std::string, double> last_;
};

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_ROS_SENTENCE_THROTTLE_H
