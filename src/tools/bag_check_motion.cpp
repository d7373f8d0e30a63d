#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Geometry>

#include "adaptive_grid_stereo/ros/stamps.h"
#include "bag_check.h"
#include "text_table.h"
#include "threshold_tuning.h"

namespace adaptive_grid_stereo {

namespace {

constexpr double kMoving = 3.0;   // [m/s], from which a course says something
constexpr double kTurning = 0.1;  // [rad/s], from which a turn says something

Eigen::Vector3d vectorOf(const geometry_msgs::Vector3& v) { return {v.x, v.y, v.z}; }

struct ImuLine {
  double stamp;
  Eigen::Vector3d rate, force;
  std::optional<Eigen::Quaterniond> orientation;
};
struct VelocityLine {
  double stamp;
  Eigen::Vector3d velocity;
};

/// The raw numbers, as far as they are finite.
struct MotionContents {
  std::vector<ImuLine> imu;
  std::vector<VelocityLine> odom, gps;
  std::vector<double> imu_delays;  // recorded after stamped [s]
};

MotionContents readContents(BagReader* bag, const MotionTopics& topics, long* damaged) {
  MotionContents contents;
  bag->rewind();
  for (BagMessage message; bag->next(&message);) {
    const std::string& topic = message.connection->topic;
    try {
      if (topic == topics.imu) {
        const auto m = deserialize<sensor_msgs::Imu>(message);
        ImuLine line{m->header.stamp.toSec(), vectorOf(m->angular_velocity),
                     vectorOf(m->linear_acceleration), std::nullopt};
        const Eigen::Quaterniond q(m->orientation.w, m->orientation.x, m->orientation.y,
                                   m->orientation.z);
        if (m->orientation_covariance[0] != -1.0 && std::abs(q.norm() - 1.0) < 0.1) {
          line.orientation = q.normalized();
        }
        contents.imu_delays.push_back(secondsBetween(m->header.stamp, message.time));
        if (line.rate.allFinite() && line.force.allFinite()) contents.imu.push_back(line);
      } else if (topic == topics.odom) {
        const auto m = deserialize<nav_msgs::Odometry>(message);
        const VelocityLine line{m->header.stamp.toSec(), vectorOf(m->twist.twist.linear)};
        if (line.velocity.allFinite()) contents.odom.push_back(line);
      } else if (topic == topics.gps_vel) {
        const auto m = deserialize<geometry_msgs::TwistStamped>(message);
        const VelocityLine line{m->header.stamp.toSec(), vectorOf(m->twist.linear)};
        if (line.velocity.allFinite()) contents.gps.push_back(line);
      }
    } catch (const std::runtime_error&) {
      ++*damaged;
    }
  }
  return contents;
}

template <typename Lines>
std::size_t nearest(const Lines& lines, double stamp) {
  const auto later = [](double value, const auto& line) { return value < line.stamp; };
  const auto place = std::upper_bound(lines.begin(), lines.end(), stamp, later);
  return place == lines.begin() ? 0 : static_cast<std::size_t>(place - lines.begin()) - 1;
}

Finding sourceFinding(const MotionSourceStatus& source, const std::string& topic) {
  Finding finding = {Verdict::kOk, source.name,
                     topic + ": " + std::to_string(source.received) + " messages, " +
                         fixed(source.rate, 1) + " Hz"};
  const auto add = [&](std::uint64_t n, const std::string& what) {
    if (n == 0) return;
    finding.text += ", " + std::to_string(n) + " " + what;
    finding.verdict = Verdict::kWarning;
  };
  add(source.gaps, "gaps longer than motion_timeout");
  add(source.duplicates, "duplicates");
  add(source.out_of_order, "out of order");
  add(source.clock_jumps, "clock jumps");
  add(source.invalid, "refused (" + source.last_error + ")");
  if (source.received == 0 || source.invalid == source.received) finding.verdict = Verdict::kError;
  return finding;
}

Finding gravityFinding(const MotionContents& contents, const MotionConfig& config) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const ImuLine& line : contents.imu) sum += line.force;
  const Eigen::Vector3d mean = sum / static_cast<double>(contents.imu.size());
  const double up = config.rate_axes == RateAxes::kBodyFrd ? -mean.z() : mean.z();
  Finding finding = {Verdict::kOk, "gravity",
                     "mean acceleration (" + fixed(mean.x(), 1) + ", " + fixed(mean.y(), 1) + ", " +
                         fixed(mean.z(), 1) + ") m/s^2, up by rate_axes " +
                         toString(config.rate_axes)};
  if (mean.norm() < 3.0) {
    finding.verdict = Verdict::kWarning;
    finding.text += ": there is no gravity in it, so the attitude cannot be estimated";
  } else if (up < -0.5 * mean.norm()) {
    finding.verdict = Verdict::kError;
    finding.text += ": it points down; is rate_axes " +
                    std::string(config.rate_axes == RateAxes::kBodyFrd ? "body_flu" : "body_frd") +
                    "?";
  } else if (up < 0.5 * mean.norm()) {
    finding.verdict = Verdict::kError;
    finding.text +=
        ": it lies across; the Imu does not sit on the body as declared, so its orientation is not "
        "used, and its rates are right only with TF from its frame to the left camera's";
  }
  return finding;
}

/// The rate that the orientation shows over half seconds, against the gyro.
std::optional<Finding> orientationFinding(const MotionContents& contents) {
  double same = 0.0, gyro_square = 0.0;
  for (std::size_t i = 0; i < contents.imu.size(); ++i) {
    const ImuLine& a = contents.imu[i];
    const std::size_t j = nearest(contents.imu, a.stamp + 0.2);
    const ImuLine& b = contents.imu[j];
    const double dt = b.stamp - a.stamp;
    if (!a.orientation || !b.orientation || dt < 0.1 || dt > 0.3) continue;
    const Eigen::AngleAxisd turn(a.orientation->conjugate() * *b.orientation);
    const double angle = turn.angle() > M_PI ? turn.angle() - 2.0 * M_PI : turn.angle();
    Eigen::Vector3d gyro = Eigen::Vector3d::Zero();
    for (std::size_t k = i; k <= j; ++k) gyro += contents.imu[k].rate / double(j - i + 1);
    if (gyro.norm() < kTurning) continue;
    same += gyro.dot(turn.axis() * angle / dt);
    gyro_square += gyro.squaredNorm();
  }
  if (gyro_square == 0.0) return std::nullopt;
  const double share = same / gyro_square;
  Finding finding = {Verdict::kOk, "orientation against rates",
                     "the orientation turns " + fixed(share, 2) + " times as the rates say"};
  if (share < 0.5 || share > 1.5) {
    finding.verdict = Verdict::kError;
    finding.text += ": they are of different axes or units; do not trust both";
  }
  return finding;
}

/// East, north, up of a GPS velocity as declared.
Eigen::Vector3d enuOf(const Eigen::Vector3d& velocity, const MotionConfig& config) {
  const bool ned =
      config.gps_velocity_axes == "ned" ||
      (config.gps_velocity_axes == "auto" && config.velocity_axes == VelocityAxes::kNed);
  return ned ? Eigen::Vector3d(velocity.y(), velocity.x(), -velocity.z()) : velocity;
}

/// Whether GPS velocities are declared to be of the body, and so tell no course.
bool tellsNoCourse(const MotionConfig& config) {
  return config.gps_velocity_axes == "body_flu" || config.gps_velocity_axes == "body_frd";
}

std::optional<Finding> courseFinding(const MotionContents& contents, const MotionConfig& config) {
  if (tellsNoCourse(config)) return std::nullopt;
  std::vector<double> angles;
  for (const VelocityLine& line : contents.gps) {
    const Eigen::Vector3d velocity = enuOf(line.velocity, config);
    if (velocity.head<2>().norm() < kMoving || contents.imu.empty()) continue;
    const ImuLine& imu = contents.imu[nearest(contents.imu, line.stamp)];
    if (!imu.orientation) continue;
    Eigen::Vector3d forward = *imu.orientation * Eigen::Vector3d::UnitX();
    if (config.rate_axes == RateAxes::kBodyFrd) {
      forward = Eigen::Vector3d(forward.y(), forward.x(), -forward.z());
    }
    angles.push_back(std::atan2(velocity.x() * forward.y() - velocity.y() * forward.x(),
                                velocity.head<2>().dot(forward.head<2>())));
  }
  if (angles.size() < 10) return std::nullopt;
  std::vector<double> sizes;
  for (const double angle : angles) sizes.push_back(std::abs(angle));
  const double degrees = quantile(sizes, 0.5) * 180.0 / M_PI;
  Finding finding = {Verdict::kOk, "course against heading",
                     "half of the time within " + fixed(degrees, 0) + " deg"};
  if (degrees > 60.0) {
    finding.verdict = Verdict::kError;
    finding.text +=
        ": orientation and velocity are of different axes; check velocity_axes (enu, ned) and "
        "rate_axes (body_frd goes with an orientation against NED)";
  } else if (degrees > 35.0) {
    finding.verdict = Verdict::kWarning;
    finding.text += ": strong wind, or the magnetometer is off";
  }
  return finding;
}

/// The course's turn against the vertical part of the rates, over two seconds.
std::optional<Finding> turnFinding(const MotionContents& contents, const MotionConfig& config) {
  if (tellsNoCourse(config)) return std::nullopt;
  double same = 0.0, course_square = 0.0;
  for (std::size_t i = 0; i < contents.gps.size(); ++i) {
    const std::size_t j = nearest(contents.gps, contents.gps[i].stamp + 2.0);
    const double dt = contents.gps[j].stamp - contents.gps[i].stamp;
    const Eigen::Vector3d a = enuOf(contents.gps[i].velocity, config);
    const Eigen::Vector3d b = enuOf(contents.gps[j].velocity, config);
    if (dt < 1.5 || a.head<2>().norm() < kMoving || b.head<2>().norm() < kMoving) continue;
    const double course =
        std::atan2(a.x() * b.y() - a.y() * b.x(), a.head<2>().dot(b.head<2>())) / dt;
    if (std::abs(course) < kTurning) continue;
    const std::size_t from = nearest(contents.imu, contents.gps[i].stamp);
    const std::size_t to = nearest(contents.imu, contents.gps[j].stamp);
    if (to <= from) continue;
    double left = 0.0;
    for (std::size_t k = from; k < to; ++k) {
      const ImuLine& line = contents.imu[k];
      // Gravity's direction in the body gives the vertical, whatever the orientation says.
      const Eigen::Vector3d up =
          line.orientation
              ? Eigen::Vector3d(line.orientation->conjugate() * Eigen::Vector3d::UnitZ())
              : Eigen::Vector3d::UnitZ();
      left += line.rate.dot(up) / static_cast<double>(to - from);
    }
    if (config.rate_axes == RateAxes::kBodyFrd) left = -left;
    same += left * course;
    course_square += course * course;
  }
  if (course_square == 0.0) return std::nullopt;
  const double share = same / course_square;
  Finding finding = {Verdict::kOk, "turns of the course against rates",
                     "the rates show " + fixed(share, 2) + " of the course's turns"};
  if (share < 0.0) {
    finding.verdict = Verdict::kError;
    finding.text += ": left is right; is rate_axes " +
                    std::string(config.rate_axes == RateAxes::kBodyFrd ? "body_flu" : "body_frd") +
                    ", or velocity_axes the other of enu and ned?";
  } else if (share < 0.5 || share > 1.5) {
    finding.verdict = Verdict::kError;
    finding.text += ": axes or units of the rates (rad/s) are wrong";
  }
  return finding;
}

std::optional<Finding> odometryFinding(const MotionContents& contents, const MotionConfig& config) {
  if (config.velocity_axes != VelocityAxes::kBodyFlu &&
      config.velocity_axes != VelocityAxes::kBodyFrd) {
    return std::nullopt;
  }
  double along = 0.0, total = 0.0;
  for (const VelocityLine& line : contents.odom) {
    if (line.velocity.norm() < 0.3) continue;
    along += std::abs(line.velocity.x());
    total += line.velocity.norm();
  }
  if (total == 0.0) return std::nullopt;
  Finding finding = {Verdict::kOk, "odometry axes",
                     fixed(100.0 * along / total, 0) + " % of the velocity is along x"};
  if (along < 0.8 * total) {
    finding.verdict = Verdict::kError;
    finding.text += ": that is no body's velocity; is velocity_axes enu or ned?";
  }
  return finding;
}

Finding knownFinding(BagReader* bag, const MotionTopics& topics, const MotionConfig& config,
                     const std::string& optical_frame, MotionSubscriber* subscriber) {
  MotionReplay replay;
  replay.topics = topics;
  replay.optical_frame = optical_frame;
  long known = 0, asked = 0;
  std::string speed_source, rate_source, reason;
  replayMotion(bag, replay, subscriber, [&](double, const Motion& motion) {
    ++asked;
    known += motion.valid;
    if (motion.valid) {
      speed_source = motion.speed_source;
      rate_source = motion.rate_source;
    } else {
      reason = motion.reason;
    }
  });
  const double share = asked > 0 ? static_cast<double>(known) / static_cast<double>(asked) : 0.0;
  Finding finding = {Verdict::kOk, "motion known", fixed(100.0 * share, 1) + " % of the time"};
  if (known > 0) finding.text += ", speed from " + speed_source + ", rates from " + rate_source;
  if (share < 0.98) {
    finding.verdict = known > 0 ? Verdict::kWarning : Verdict::kError;
    finding.text +=
        "; else the plan is uniform: " + (reason.empty() ? "no motion topics" : reason) +
        " (motion_timeout " + fixed(config.motion_timeout, 2) + " s)";
  }
  return finding;
}

}  // namespace

std::vector<Finding> checkMotion(BagReader* bag, const MotionTopics& topics,
                                 const MotionConfig& config, const std::string& optical_frame) {
  std::vector<Finding> findings;
  MotionSubscriber subscriber(config);
  const Finding known = knownFinding(bag, topics, config, optical_frame, &subscriber);
  const MotionInputStatus status = subscriber.status();
  const std::string names[] = {topics.imu, topics.odom, topics.gps_vel, topics.gps_fix, topics.mag};
  for (std::size_t i = 0; i < status.sources.size(); ++i) {
    if (!names[i].empty()) findings.push_back(sourceFinding(status.sources[i], names[i]));
  }
  long damaged = 0;
  const MotionContents contents = readContents(bag, topics, &damaged);
  if (damaged > 0) {
    findings.push_back(
        {Verdict::kError, "damage", std::to_string(damaged) + " motion messages cannot be read"});
  }
  if (!contents.imu.empty()) {
    findings.push_back(gravityFinding(contents, config));
    const double delay = quantile(contents.imu_delays, 0.5);
    if (std::abs(delay) > 0.2) {
      findings.push_back({Verdict::kWarning, "imu stamps",
                          "recorded " + fixed(delay, 2) +
                              " s after their stamps: check the time synchronisation, or set "
                              "motion_delay"});
    }
  }
  for (const auto& finding : {contents.imu.empty() ? std::nullopt : orientationFinding(contents),
                              courseFinding(contents, config), turnFinding(contents, config),
                              odometryFinding(contents, config)}) {
    if (finding) findings.push_back(*finding);
  }
  findings.push_back(known);
  return findings;
}

}  // namespace adaptive_grid_stereo
