#ifndef ADAPTIVE_GRID_STEREO_BENCHMARK_COMPARISON_H
#define ADAPTIVE_GRID_STEREO_BENCHMARK_COMPARISON_H

#include <functional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "adaptive_grid_stereo/matching/stereo_matcher.h"

namespace adaptive_grid_stereo {

/// One size of the comparison.
struct Setting {
  int width = 0;
  int height = 0;
  int disparity_range = 0;
  std::string images;  // what was matched: "textured", or the scene's name
  cv::Mat left;
  cv::Mat right;
};

/// E.g. "450x375x64".
std::string nameOf(const Setting& setting);

/// Follows the name of a plan where as many frames are matched at the same time as there are
/// threads, by one thread each: the time per frame, which is what the machine allows for.
constexpr char kAtOnce[] = ", frames at once";

/// One method with one number of threads: a time per round.
struct Series {
  std::string setting;  // nameOf()
  std::string method;   // "uniform 16", "forward", ..., "StereoBM", "SGBM", ..., or with kAtOnce
  int threads = 1;
  double mean_paths = 0.0;  // of ours; 0 for peers
  std::vector<double> time_ms;
  std::vector<StageTimes> stages;  // of ours: of each frame that counted, in all rounds
};

/// Runs ours (uniform 16, 8, 4, forward at V_max, yaw left, pitch up) and OpenCV's matchers with
/// each number of threads, in rounds: within a round all take turns, so that a slow spell of the
/// machine meets all of them. At its turn each matches frames one after the other, as in a stream,
/// for a tenth of a second: a round's time is the median of all but the first. Ours with several
/// threads then match as many frames at once. `step` is called after each turn. `threads` must not
/// be empty.
std::vector<Series> compare(const Setting& setting, const std::vector<int>& threads, int rounds,
                            const std::function<void()>& step);

/// Number of turns in compare(), for a progress bar.
long runsOf(const std::vector<int>& threads, int rounds);

/// Adds more rounds to the series of the same name, where there are any.
void append(const std::vector<Series>& more, std::vector<Series>* all);

/// The series of that name, or nullptr.
const Series* find(const std::vector<Series>& all, const std::string& setting,
                   const std::string& method, int threads);

double medianTime(const Series& series);

/// Median over the rounds of a's time divided by b's.
double medianRatio(const Series& a, const Series& b);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_BENCHMARK_COMPARISON_H
