#include "adaptive_grid_stereo/ros/diagnostics.h"

#include <gtest/gtest.h>

namespace adaptive_grid_stereo {
namespace {

using diagnostic_msgs::DiagnosticStatus;
using diagnostic_updater::DiagnosticStatusWrapper;

/// A node in which all is well.
NodeReport goodReport() {
  NodeReport report;
  report.sync.subscribed = true;
  const char* names[] = {"/s/left/image_rect", "/s/right/image_rect", "/s/left/camera_info",
                         "/s/right/camera_info"};
  for (int i = 0; i < 4; ++i) {
    report.sync.inputs[i].topic = names[i];
    report.sync.inputs[i].received = 100;
    report.sync.inputs[i].publishers = 1;
    report.sync.inputs[i].silence = 0.05;
    report.sync.inputs[i].newest_stamp = 50.0;
  }
  report.sync.silence = 0.05;
  report.has_geometry = true;
  report.geometry.baseline = 0.11;
  report.motion.valid = true;
  for (int i = 0; i < 20; ++i) {
    FrameRecord frame;
    frame.time = 0.1 * i;
    frame.latency = 0.03;
    frame.processing_time = 0.02;
    frame.density = 0.7;
    report.frames.push_back(frame);
  }
  report.min_density = 0.1;
  return report;
}

using Describe = void (*)(const NodeReport&, DiagnosticStatusWrapper&);
constexpr Describe kTasks[] = {describeInputs, describeSynchronisation, describeCalibration,
                               describeOutput, describeProcessing,      describeMotion,
                               describeScene};

DiagnosticStatusWrapper statusOf(Describe describe, const NodeReport& report) {
  DiagnosticStatusWrapper status;
  describe(report, status);
  EXPECT_FALSE(status.message.empty());
  return status;
}

TEST(Diagnostics, AreOkWhenAllIsWell) {
  for (const Describe describe : kTasks) {
    const auto status = statusOf(describe, goodReport());
#ifndef NDEBUG
    if (describe == describeProcessing) continue;  // warns of the debug build
#endif
    EXPECT_EQ(status.level, DiagnosticStatus::OK) << status.message;
    EXPECT_FALSE(status.values.empty()) << status.message;
  }
}

TEST(Diagnostics, AreOkWhenIdle) {
  NodeReport report = goodReport();
  report.sync.subscribed = false;
  report.frames.clear();
  report.motion.valid = false;
  for (InputStatus& input : report.sync.inputs) input.silence = 100.0;
  for (const Describe describe :
       {describeInputs, describeSynchronisation, describeOutput, describeMotion, describeScene}) {
    const auto status = statusOf(describe, report);
    EXPECT_EQ(status.level, DiagnosticStatus::OK) << status.message;
    EXPECT_NE(status.message.find("idle"), std::string::npos) << status.message;
  }
}

TEST(Diagnostics, NameASilentTopic) {
  NodeReport report = goodReport();
  report.sync.inputs[3].silence = 7.0;
  const auto status = statusOf(describeInputs, report);
  EXPECT_EQ(status.level, DiagnosticStatus::ERROR);
  EXPECT_NE(status.message.find("/s/right/camera_info"), std::string::npos) << status.message;
  EXPECT_EQ(status.message.find("/s/left/camera_info"), std::string::npos) << status.message;
}

TEST(Diagnostics, RepeatTheSentenceOfARefusal) {
  NodeReport report = goodReport();
  report.error = "right/camera_info gives a baseline of 0 m";
  const auto status = statusOf(describeCalibration, report);
  EXPECT_EQ(status.level, DiagnosticStatus::ERROR);
  EXPECT_EQ(status.message, report.error);
}

TEST(Diagnostics, TellAPairThatCouldNotBeProcessedFromOneThatWasRefused) {
  NodeReport report = goodReport();
  report.failure = "no memory";
  const auto status = statusOf(describeProcessing, report);
  EXPECT_EQ(status.level, DiagnosticStatus::ERROR);
  EXPECT_NE(status.message.find("no memory"), std::string::npos) << status.message;
  EXPECT_EQ(statusOf(describeCalibration, report).level, DiagnosticStatus::OK);
}

TEST(Diagnostics, WarnOfPicturesThatCouldNotBeMade) {
  NodeReport report = goodReport();
  report.side_failure = "no memory";
  const auto status = statusOf(describeOutput, report);
  EXPECT_EQ(status.level, DiagnosticStatus::WARN);
  EXPECT_NE(status.message.find("no memory"), std::string::npos) << status.message;
}

TEST(Diagnostics, WarnWherePairsComeFasterThanTheyCanBeMatched) {
  NodeReport report = goodReport();
  report.replaced_lately = 1;
  report.frames.resize(20);
  EXPECT_EQ(statusOf(describeProcessing, report).level,
            statusOf(describeProcessing, goodReport()).level);
  report.replaced_lately = 60;
  const auto status = statusOf(describeProcessing, report);
  EXPECT_EQ(status.level, DiagnosticStatus::WARN);
  EXPECT_NE(status.message.find("60 of the last 80"), std::string::npos) << status.message;
}

TEST(Diagnostics, CountWhatTheMotionSourcesSentWrong) {
  NodeReport report = goodReport();
  MotionSourceStatus source;
  source.name = "imu";
  source.duplicates = 3;
  source.clock_jumps = 2;
  source.future = 5;
  report.motion_inputs.sources = {source};
  const std::string line = statusOf(describeMotion, report).values.back().value;
  for (const char* count : {"3 twice", "2 clock jumps", "5 from the future"}) {
    EXPECT_NE(line.find(count), std::string::npos) << line;
  }
}

TEST(Diagnostics, WarnOfTooFewFrames) {
  NodeReport report = goodReport();  // 10 Hz
  report.expected_rate = 10.5;
  EXPECT_EQ(statusOf(describeOutput, report).level, DiagnosticStatus::OK);
  report.expected_rate = 20.0;
  EXPECT_EQ(statusOf(describeOutput, report).level, DiagnosticStatus::WARN);
}

TEST(Diagnostics, WarnOfFramesThatHaveStopped) {
  NodeReport report = goodReport();
  report.expected_rate = 10.0;
  report.now = report.frames.back().time + 0.1;
  EXPECT_EQ(statusOf(describeOutput, report).level, DiagnosticStatus::OK);
  report.now = report.frames.back().time + 2.0;
  EXPECT_EQ(statusOf(describeOutput, report).level, DiagnosticStatus::WARN);
}

TEST(Diagnostics, WarnOfStampsThatJumpAgainAndAgain) {
  NodeReport report = goodReport();
  report.sync.clock_jumps = 1;
  report.sync.jumps_lately = 1;
  EXPECT_EQ(statusOf(describeSynchronisation, report).level, DiagnosticStatus::OK)
      << "a recording that loops";
  report.sync.jumps_lately = 3;
  report.sync.inputs[2].publishers = 2;
  const auto status = statusOf(describeSynchronisation, report);
  EXPECT_EQ(status.level, DiagnosticStatus::WARN);
  EXPECT_NE(status.message.find("/s/left/camera_info has 2 publishers"), std::string::npos)
      << status.message;
}

TEST(Diagnostics, WarnOfStampsInTheFuture) {
  NodeReport report = goodReport();
  for (FrameRecord& frame : report.frames) frame.latency = -2.0;
  const auto status = statusOf(describeOutput, report);
  EXPECT_EQ(status.level, DiagnosticStatus::WARN);
  EXPECT_NE(status.message.find("future"), std::string::npos) << status.message;
}

TEST(Diagnostics, WarnOfTheGovernor) {
  NodeReport report = goodReport();
  report.frames.back().governor_step = 2;
  const auto status = statusOf(describeProcessing, report);
  EXPECT_EQ(status.level, DiagnosticStatus::WARN);
  EXPECT_NE(status.message.find("step 2"), std::string::npos) << status.message;
}

TEST(Diagnostics, WarnOfUnknownMotion) {
  NodeReport report = goodReport();
  report.motion.valid = false;
  report.motion.reason = "odom is 2 s old";
  const auto status = statusOf(describeMotion, report);
  EXPECT_EQ(status.level, DiagnosticStatus::WARN);
  EXPECT_NE(status.message.find("odom is 2 s old"), std::string::npos) << status.message;
}

TEST(Diagnostics, WarnOfAxesThatContradictTheirDeclaration) {
  NodeReport report = goodReport();
  report.motion_inputs.warning = "imu: gravity points up in body_flu";
  const auto status = statusOf(describeMotion, report);
  EXPECT_EQ(status.level, DiagnosticStatus::WARN);
  EXPECT_NE(status.message.find("gravity points up"), std::string::npos) << status.message;
}

TEST(Diagnostics, WarnOfAnEmptyScene) {
  NodeReport report = goodReport();
  for (FrameRecord& frame : report.frames) frame.density = 0.03;
  EXPECT_EQ(statusOf(describeScene, report).level, DiagnosticStatus::WARN);
}

TEST(SyncAdvice, IsSilentWhilePairsComeOrNobodyListens) {
  SyncStatus status = goodReport().sync;
  EXPECT_EQ(syncAdvice(status), "");
  status.silence = 10.0;
  status.subscribed = false;
  EXPECT_EQ(syncAdvice(status), "");
}

TEST(SyncAdvice, NamesTheTopicOnWhichNothingArrives) {
  SyncStatus status = goodReport().sync;
  status.silence = 6.0;
  status.inputs[1].silence = 6.0;
  status.inputs[1].received = 0;
  status.inputs[1].publishers = 0;
  const std::string advice = syncAdvice(status);
  EXPECT_NE(advice.find("Nothing arrives on /s/right/image_rect;"), std::string::npos) << advice;
  EXPECT_NE(advice.find("0 messages, 0 publishers"), std::string::npos) << advice;
}

TEST(SyncAdvice, NamesTheCureForStampsThatDiffer) {
  SyncStatus status = goodReport().sync;
  status.silence = 6.0;
  status.inputs[1].offset = -0.0042;
  const std::string exact = syncAdvice(status);
  EXPECT_NE(exact.find("4.2 ms"), std::string::npos) << exact;
  EXPECT_NE(exact.find("set approximate_sync"), std::string::npos) << exact;
  status.approximate = true;
  const std::string approximate = syncAdvice(status);
  EXPECT_NE(approximate.find("approximate_sync_max_interval"), std::string::npos) << approximate;
}

TEST(SyncAdvice, TellsOtherClocksAndStampsThatAreNotSetFromStampsThatDiffer) {
  SyncStatus status = goodReport().sync;
  status.silence = 6.0;
  status.inputs[3].offset = 3600.0;
  std::string advice = syncAdvice(status);
  EXPECT_NE(advice.find("/s/right/camera_info are never nearer than 3600000.0 ms"),
            std::string::npos)
      << advice;
  EXPECT_EQ(advice.find("approximate_sync"), std::string::npos) << advice;
  status.inputs[2].newest_stamp = 0.0;
  advice = syncAdvice(status);
  EXPECT_NE(advice.find("/s/left/camera_info are 0"), std::string::npos) << advice;
}

TEST(SyncAdvice, DoesNotBlameStampsThatAreEqual) {
  SyncStatus status = goodReport().sync;
  status.silence = 6.0;
  std::string advice = syncAdvice(status);
  EXPECT_NE(advice.find("raise queue_size"), std::string::npos) << advice;
  EXPECT_EQ(advice.find("approximate_sync"), std::string::npos) << advice;
  status.repeated = 20;
  advice = syncAdvice(status);
  EXPECT_NE(advice.find("do not advance"), std::string::npos) << advice;
}

}  // namespace
}  // namespace adaptive_grid_stereo
