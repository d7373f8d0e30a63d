#include "adaptive_grid_stereo/ros/overlay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include <opencv2/imgproc.hpp>

#include "adaptive_grid_stereo/path_plan.h"

namespace adaptive_grid_stereo {
namespace {

/// Pictures narrower than this are enlarged [px].
constexpr int kLegibleWidth = 640;

const cv::Scalar kWhite(255, 255, 255);
const cv::Scalar kBlack(0, 0, 0);
const cv::Scalar kAmber(70, 190, 255);

/// Many paths are green, few are blue; told apart by colour-blind eyes too, since they differ in
/// brightness.
cv::Scalar colorOf(int paths) {
  if (paths >= 16) return {96, 230, 90};
  if (paths >= 8) return {60, 190, 250};
  return {230, 130, 60};
}

std::string format(const char* pattern, double value) {
  char text[64];
  std::snprintf(text, sizeof(text), pattern, value);
  return text;
}

/// Whether cells `a` have more paths than cells `b`; if as many, what the rate says.
bool moreThan(const GridState& state, const std::array<int, 3>& a, const std::array<int, 3>& b,
              double rate) {
  int lead = 0;
  for (int i = 0; i < 3; ++i) lead += state.paths[a[i]] - state.paths[b[i]];
  return lead != 0 ? lead > 0 : rate > 0.0;
}

/// By the plan, not by the rates: a state may be held while a rate has changed its sign.
std::string stateText(const GridState& state) {
  if (!state.motion_valid) return "MOTION UNKNOWN";
  if (state.state & GridState::LOCKED) return "LOCKED";
  std::string text = "FORWARD";
  if (state.state & GridState::YAW) {
    const bool left = moreThan(state, {0, 3, 6}, {2, 5, 8}, state.yaw_rate);
    text += left ? "  YAW left" : "  YAW right";
  }
  if (state.state & GridState::PITCH) {
    const bool up = moreThan(state, {0, 1, 2}, {6, 7, 8}, state.pitch_rate);
    text += up ? "  PITCH up" : "  PITCH down";
  }
  return text;
}

/// Mean paths per pixel, which the time of the frame is proportional to.
std::string pathsText(const GridState& state) {
  PathPlan plan;
  std::copy(state.column_edges.begin(), state.column_edges.end(), plan.column_edges.begin());
  std::copy(state.row_edges.begin(), state.row_edges.end(), plan.row_edges.begin());
  std::copy(state.paths.begin(), state.paths.end(), plan.paths.begin());
  const std::string governor =
      state.governor_step > 0 ? "governor " + std::to_string(state.governor_step) + "   " : "";
  return governor + format("%.1f paths", meanPaths(plan));
}

std::string motionText(const GridState& state) {
  if (!state.motion_valid) return state.motion_status;
  return format("v %.1f m/s", state.forward_speed) + format("   yaw %+.2f", state.yaw_rate) +
         format("   pitch %+.2f rad/s", state.pitch_rate);
}

/// Writes on a picture in sizes that follow the picture's.
class Writer {
 public:
  explicit Writer(cv::Mat& picture) : picture_(picture) {
    unit_ = std::clamp(std::min(picture.cols / 640.0, picture.rows / 360.0), 0.35, 4.0);
    thickness_ = std::max(1, static_cast<int>(std::lround(1.4 * unit_)));
  }

  int line() const { return thickness_; }
  int barHeight() const { return static_cast<int>(std::lround(26.0 * unit_)); }

  cv::Size sizeOf(const std::string& text, double scale) const {
    return cv::getTextSize(text, kFont, scale * unit_, thickness_, nullptr);
  }

  /// Around a centre, with a dark rim that stands out from any ground.
  void centred(const std::string& text, cv::Point centre, double scale, const cv::Scalar& color) {
    const cv::Size size = sizeOf(text, scale);
    const cv::Point origin(centre.x - size.width / 2, centre.y + size.height / 2);
    const int stroke =
        std::max(1, static_cast<int>(std::lround(2.4 * unit_ * std::min(scale, 1.0))));
    put(text, origin, scale, kBlack, stroke + 2 * std::max(1, stroke * 2 / 3));
    put(text, origin, scale, color, stroke);
  }

  /// A dark translucent bar across the picture, from y on, with writing at its left and right end.
  void bar(int y, const std::string& left, const std::string& right, const cv::Scalar& color) {
    const cv::Rect area =
        cv::Rect(0, y, picture_.cols, barHeight()) & cv::Rect({0, 0}, picture_.size());
    if (area.empty()) return;
    cv::Mat ground = picture_(area);
    ground.convertTo(ground, -1, 0.3);
    const int baseline = y + static_cast<int>(std::lround(18.0 * unit_));
    const int margin = static_cast<int>(std::lround(8.0 * unit_));
    const double room = picture_.cols - 2.0 * margin;
    // What does not fit is written smaller, rather than over the edge.
    const auto fitting = [&](const std::string& text, double width) {
      return text.empty() ? kBarScale
                          : kBarScale * std::min(1.0, width / sizeOf(text, kBarScale).width);
    };
    const double right_scale = fitting(right, room / 2);
    const double right_width = right.empty() ? 0 : sizeOf(right, right_scale).width + margin;
    put(left, {margin, baseline}, fitting(left, room - right_width), color, thickness_);
    put(right, {static_cast<int>(picture_.cols - right_width), baseline}, right_scale, color,
        thickness_);
  }

 private:
  static constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
  static constexpr double kBarScale = 0.55;

  void put(const std::string& text, cv::Point origin, double scale, const cv::Scalar& color,
           int thickness) {
    cv::putText(picture_, text, origin, kFont, scale * unit_, color, thickness, cv::LINE_AA);
  }

  cv::Mat& picture_;
  double unit_ = 1.0;
  int thickness_ = 1;
};

/// The cell's rectangle in the enlarged picture, cut to it.
cv::Rect cellArea(const GridState& state, int cell, int scale, const cv::Size& picture) {
  const auto edge = [scale](int value, int size) {
    return static_cast<int>(std::clamp<long>(static_cast<long>(value) * scale, 0, size));
  };
  const cv::Point top_left(edge(state.column_edges[cell % 3], picture.width),
                           edge(state.row_edges[cell / 3], picture.height));
  const cv::Point bottom_right(edge(state.column_edges[cell % 3 + 1], picture.width),
                               edge(state.row_edges[cell / 3 + 1], picture.height));
  if (bottom_right.x <= top_left.x || bottom_right.y <= top_left.y) return {};
  return {top_left, bottom_right};
}

void drawCell(cv::Mat& picture, const cv::Rect& area, int paths, Writer& writer) {
  const cv::Scalar color = colorOf(paths);
  cv::Mat cell = picture(area);
  cell.convertTo(cell, -1, 0.84);
  cv::add(cell, 0.16 * color, cell);
  // Drawn inside the cell, so that neighbours with different counts show both colours at their
  // edge.
  const int line = writer.line();
  const cv::Rect frame(area.x + line / 2, area.y + line / 2, area.width - line, area.height - line);
  if (frame.width > 0 && frame.height > 0) cv::rectangle(picture, frame, color, line, cv::LINE_8);
}

/// The number in the middle of what the two bars leave of the cell; none where it does not fit.
void writeCount(const cv::Rect& area, const cv::Rect& free, int paths, Writer& writer) {
  const std::string text = std::to_string(paths);
  const cv::Rect visible = area & free;
  for (const double scale : {1.1, 0.7, 0.45}) {
    const cv::Size size = writer.sizeOf(text, scale);
    if (visible.width < 1.3 * size.width || visible.height < 1.4 * size.height) continue;
    writer.centred(text, {visible.x + visible.width / 2, visible.y + visible.height / 2}, scale,
                   colorOf(paths));
    return;
  }
}

}  // namespace

int overlayScale(int width) {
  return width > 0 ? std::max(1, (kLegibleWidth + width - 1) / width) : 1;
}

cv::Mat drawGridOverlay(const cv::Mat& left, const GridState& state, int scale) {
  cv::Mat picture;
  if (scale > 1) {
    cv::resize(left, picture, {}, scale, scale, cv::INTER_CUBIC);
  } else {
    left.copyTo(picture);
  }
  // Enlarged before it has three channels, which are three times the work.
  if (picture.channels() == 1) cv::cvtColor(picture, picture, cv::COLOR_GRAY2BGR);

  Writer writer(picture);
  const int bar = writer.barHeight();
  const cv::Rect free(0, bar, picture.cols, std::max(0, picture.rows - 2 * bar));
  std::array<cv::Rect, 9> areas;
  for (int cell = 0; cell < 9; ++cell) {
    areas[cell] = cellArea(state, cell, scale, picture.size());
    if (!areas[cell].empty()) drawCell(picture, areas[cell], state.paths[cell], writer);
  }
  const cv::Scalar color = state.motion_valid ? kWhite : kAmber;
  writer.bar(0, stateText(state), pathsText(state), color);
  writer.bar(picture.rows - bar, motionText(state), "", color);
  for (int cell = 0; cell < 9; ++cell) {
    if (!areas[cell].empty()) writeCount(areas[cell], free, state.paths[cell], writer);
  }
  return picture;
}

}  // namespace adaptive_grid_stereo
