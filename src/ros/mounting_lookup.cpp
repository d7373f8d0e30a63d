#include "mounting_lookup.h"

#include <cmath>
#include <cstdio>

#include <geometry_msgs/TransformStamped.h>
#include <tf2/exceptions.h>

namespace adaptive_grid_stereo {

namespace {

/// TF2 refuses names that start with a slash, which old drivers still send.
std::string withoutSlash(const std::string& frame) {
  return !frame.empty() && frame[0] == '/' ? frame.substr(1) : frame;
}

Eigen::Quaterniond rotationOf(const geometry_msgs::TransformStamped& transform) {
  const geometry_msgs::Quaternion& q = transform.transform.rotation;
  return Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized();
}

bool representable(double stamp) {
  return std::isfinite(stamp) && stamp > 0.0 && stamp < 4294967295.0;
}

/// Less than this is no turn but rounding [rad].
constexpr double kSmallestTurn = 1e-6;

}  // namespace

std::optional<Mounting> lookUpMounting(const tf2::BufferCore& tf, const std::string& optical_frame,
                                       const std::string& body_frame, double stamp, double interval,
                                       double timeout) {
  const std::string optical = withoutSlash(optical_frame), body = withoutSlash(body_frame);
  if (optical.empty() || body.empty() || !representable(stamp)) return std::nullopt;
  if (!tf.canTransform(optical, body, ros::Time(0))) return std::nullopt;
  Mounting mounting;
  try {
    // TF's own stamps are asked for as they are: seconds in a double are rounded, and a stamp that
    // is a tenth of a microsecond later than the latest one lies in its future.
    ros::Time at(stamp);
    if (!tf.canTransform(optical, body, at)) {
      at = tf.lookupTransform(optical, body, ros::Time(0)).header.stamp;
      const double age = stamp - at.toSec();
      if (std::abs(age) > timeout) {
        char text[64];
        std::snprintf(text, sizeof(text), "%.2f s %s", std::abs(age),
                      age > 0.0 ? "old" : "ahead of the image");
        mounting.error = "the transform from '" + body + "' to '" + optical + "' is " + text +
                         "; is the gimbal's TF still published?";
        return mounting;
      }
    }
    mounting.optical_from_body = rotationOf(tf.lookupTransform(optical, body, at));
    const double before_at = at.toSec() - interval;
    if (interval > 0.0 && representable(before_at) &&
        tf.canTransform(optical, body, ros::Time(before_at))) {
      const Eigen::Quaterniond before =
          rotationOf(tf.lookupTransform(optical, body, ros::Time(before_at)));
      if (before.angularDistance(mounting.optical_from_body) > kSmallestTurn) {
        mounting.optical_from_body_before = before;
        mounting.interval = interval;
      }
    }
  } catch (const tf2::TransformException& e) {
    mounting.error = std::string("TF: ") + e.what();
  }
  if (!mounting.optical_from_body.coeffs().allFinite() ||
      !mounting.optical_from_body_before.coeffs().allFinite()) {
    mounting.error = "the transform from '" + body + "' to '" + optical + "' holds NaN";
  }
  return mounting;
}

std::optional<ros::Time> newestMounting(const tf2::BufferCore& tf, const std::string& optical_frame,
                                        const std::string& body_frame, double stamp) {
  const std::string optical = withoutSlash(optical_frame), body = withoutSlash(body_frame);
  if (optical.empty() || body.empty() || !representable(stamp)) return std::nullopt;
  if (!tf.canTransform(optical, body, ros::Time(0))) return std::nullopt;
  if (tf.canTransform(optical, body, ros::Time(stamp))) return std::nullopt;
  try {
    return tf.lookupTransform(optical, body, ros::Time(0)).header.stamp;
  } catch (const tf2::TransformException&) {
    return std::nullopt;
  }
}

}  // namespace adaptive_grid_stereo
