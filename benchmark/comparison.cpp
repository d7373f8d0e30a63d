#include "comparison.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <numeric>
#include <thread>

#include <opencv2/core/utility.hpp>

#include "evaluation.h"
#include "motion_plan.h"
#include "peers.h"

namespace adaptive_grid_stereo {
namespace {

struct NamedPlan {
  std::string name;
  PathPlan plan;
};

std::vector<NamedPlan> plansFor(cv::Size size) {
  const GuidanceConfig guidance;
  const double v = guidance.max_speed;
  const auto moving = [&](double yaw_rate, double pitch_rate) {
    return planForMotion({v, yaw_rate, pitch_rate}, guidance, size).plan;
  };
  // Those whose ratio counts stand side by side.
  return {{"uniform 16", uniformPlan(size.width, size.height, 16)},
          {"forward", moving(0.0, 0.0)},
          {"uniform 8", uniformPlan(size.width, size.height, 8)},
          {"uniform 4", uniformPlan(size.width, size.height, 4)},
          {"yaw left", moving(guidance.max_yaw_rate, 0.0)},
          {"pitch up", moving(0.0, guidance.max_pitch_rate)}};
}

constexpr long kPlans = 6;

// At its turn a method matches frames until so much time has gone [ms], or so many, and one at
// least.
constexpr double kTurn = 100.0;
constexpr int kMostFrames = 15;

double elapsedMs(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

/// Time of a frame [ms] where frames follow each other as in a stream: the median of those of a
/// turn but the first, which finds other methods' data in the caches and threads asleep.
template <class Frame>
double timeInStream(const Frame& frame) {
  frame();
  std::vector<double> times;
  const auto turn = std::chrono::steady_clock::now();
  for (int i = 0; i < kMostFrames && (i == 0 || elapsedMs(turn) < kTurn); ++i) {
    const auto start = std::chrono::steady_clock::now();
    frame();
    times.push_back(elapsedMs(start));
  }
  return medianOf(times);
}

/// As many matchers as threads, with one thread each, that match a frame each at the same time:
/// what the machine makes of threads that have nothing to do with each other.
class FramesAtOnce {
 public:
  FramesAtOnce(const MatcherConfig& config, int count) {
    MatcherConfig one_thread = config;
    one_thread.threads = 1;
    for (int i = 0; i < count; ++i) {
      matchers_.push_back(std::make_unique<StereoMatcher>(one_thread));
    }
  }

  /// Time of a frame [ms] while all of them match one after the other: a matcher that has had its
  /// turn goes on until all have.
  double timePerFrame(const Setting& setting, const PathPlan& plan) {
    std::atomic<int> ready{0}, done{0};
    const int count = static_cast<int>(matchers_.size());
    std::vector<double> frames_per_ms(matchers_.size());
    const auto work = [&](int i) {
      const auto match = [&] { matchers_[i]->match(setting.left, setting.right, plan); };
      ++ready;
      while (ready < count) std::this_thread::yield();
      frames_per_ms[i] = 1.0 / timeInStream(match);
      ++done;
      while (done < count) match();
    };
    std::vector<std::thread> threads;
    for (int i = 1; i < count; ++i) threads.emplace_back(work, i);
    work(0);
    for (std::thread& thread : threads) thread.join();
    return 1.0 / std::accumulate(frames_per_ms.begin(), frames_per_ms.end(), 0.0);
  }

 private:
  std::vector<std::unique_ptr<StereoMatcher>> matchers_;
};

/// Everything with one number of threads, each with its own buffers.
class Contestants {
 public:
  Contestants(const Setting& setting, int threads) : setting_(setting), threads_(threads) {
    MatcherConfig config;
    config.disparity_range = setting.disparity_range;
    config.threads = threads;
    matcher_ = std::make_unique<StereoMatcher>(config);
    plans_ = plansFor(setting.left.size());
    for (const NamedPlan& plan : plans_) addSeries(plan.name, meanPaths(plan.plan));
    for (const PeerKind kind : kAllPeers) {
      peers_.emplace_back(kind, false, setting.disparity_range);
      addSeries(peers_.back().name(), 0.0);
    }
    if (threads == 1) return;
    at_once_ = std::make_unique<FramesAtOnce>(config, threads);
    for (const NamedPlan& plan : plans_) addSeries(plan.name + kAtOnce, meanPaths(plan.plan));
  }

  void runPlan(std::size_t i) {
    std::vector<StageTimes> stages;
    series_[i].time_ms.push_back(timeInStream([&] {
      stages.push_back(matcher_->match(setting_.left, setting_.right, plans_[i].plan).times);
    }));
    // As for the time of the frame, the first one does not count.
    series_[i].stages.insert(series_[i].stages.end(), stages.begin() + 1, stages.end());
    if (!at_once_) return;
    series_[plans_.size() + peers_.size() + i].time_ms.push_back(
        at_once_->timePerFrame(setting_, plans_[i].plan));
  }

  void runPeer(std::size_t i) {
    cv::setNumThreads(threads_);
    series_[plans_.size() + i].time_ms.push_back(
        timeInStream([&] { peers_[i].match(setting_.left, setting_.right); }));
  }

  std::size_t planCount() const { return plans_.size(); }
  std::size_t peerCount() const { return peers_.size(); }
  const std::vector<Series>& series() const { return series_; }

 private:
  void addSeries(const std::string& method, double mean_paths) {
    Series series;
    series.setting = nameOf(setting_);
    series.method = method;
    series.threads = threads_;
    series.mean_paths = mean_paths;
    series_.push_back(series);
  }

  const Setting& setting_;
  int threads_;
  std::unique_ptr<StereoMatcher> matcher_;
  std::unique_ptr<FramesAtOnce> at_once_;
  std::vector<NamedPlan> plans_;
  std::vector<Peer> peers_;
  std::vector<Series> series_;
};

}  // namespace

std::string nameOf(const Setting& setting) {
  return std::to_string(setting.width) + "x" + std::to_string(setting.height) + "x" +
         std::to_string(setting.disparity_range);
}

std::vector<Series> compare(const Setting& setting, const std::vector<int>& threads, int rounds,
                            const std::function<void()>& step) {
  std::vector<std::unique_ptr<Contestants>> contestants;
  for (const int count : threads) {
    contestants.push_back(std::make_unique<Contestants>(setting, count));
  }
  // Numbers of threads next to each other, and ours before the peers, for those wake OpenCV's
  // threads.
  const auto forAll = [&](std::size_t count, void (Contestants::*runOne)(std::size_t)) {
    for (std::size_t i = 0; i < count; ++i) {
      for (const auto& one : contestants) {
        (one.get()->*runOne)(i);
        step();
      }
    }
  };
  for (int round = 0; round < rounds; ++round) {
    forAll(contestants.front()->planCount(), &Contestants::runPlan);
    forAll(contestants.front()->peerCount(), &Contestants::runPeer);
  }
  std::vector<Series> all;
  for (const auto& one : contestants) {
    all.insert(all.end(), one->series().begin(), one->series().end());
  }
  return all;
}

long runsOf(const std::vector<int>& threads, int rounds) {
  const long methods = kPlans + static_cast<long>(std::size(kAllPeers));
  return methods * static_cast<long>(threads.size()) * rounds;
}

void append(const std::vector<Series>& more, std::vector<Series>* all) {
  for (const Series& one : more) {
    const Series* known = find(*all, one.setting, one.method, one.threads);
    if (known == nullptr) {
      all->push_back(one);
      continue;
    }
    Series& series = (*all)[known - all->data()];
    series.time_ms.insert(series.time_ms.end(), one.time_ms.begin(), one.time_ms.end());
    series.stages.insert(series.stages.end(), one.stages.begin(), one.stages.end());
  }
}

const Series* find(const std::vector<Series>& all, const std::string& setting,
                   const std::string& method, int threads) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const Series& series) {
    return series.setting == setting && series.method == method && series.threads == threads;
  });
  return found == all.end() ? nullptr : &*found;
}

double medianTime(const Series& series) { return medianOf(series.time_ms); }

double medianRatio(const Series& a, const Series& b) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < std::min(a.time_ms.size(), b.time_ms.size()); ++i) {
    ratios.push_back(a.time_ms[i] / b.time_ms[i]);
  }
  return medianOf(ratios);
}

}  // namespace adaptive_grid_stereo
