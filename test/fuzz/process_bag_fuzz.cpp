// The whole way of process_bag: whatever a bag holds, the frames that can be processed are written.

#include <sstream>

#include <console_bridge/console.h>
#include <ros/console.h>
#include <ros/time.h>

#include "bag_processor.h"
#include "test/fuzz/fuzz_input.h"
#include "test/fuzz/temporary_file.h"

namespace {

using namespace adaptive_grid_stereo;

BagJob jobOf(fuzz::FuzzInput* options) {
  BagJob job;
  job.config.processor.matcher.threads = 1;
  job.config.processor.matcher.disparity_range = 16;
  job.config.approximate_sync = options->flag();
  job.rectify = static_cast<RectifyMode>(options->between(0, 2));
  job.wanted.depth = job.wanted.overlay = job.wanted.disparity_color = options->flag();
  return job;
}

/// Nothing here is about large images, which would only be slow.
bool isSmall(BagReader* bag) {
  BagMessage message;
  while (bag->next(&message)) {
    if (message.size > 20000) return false;
  }
  bag->rewind();
  return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const bool ready = [] {
    ros::Time::init();
    console_bridge::noOutputHandler();
    return true;
  }();
  static_cast<void>(ready);
  static const fuzz::TemporaryFile file("_in.bag"), result("_out.bag");
  // The job's options stand at the front, in one number each, the bag behind them.
  constexpr std::size_t kOptions = 6;
  if (size < kOptions) return 0;
  fuzz::FuzzInput options(data, kOptions);
  BagJob job = jobOf(&options);
  try {
    BagReader bag(file.write(data + kOptions, size - kOptions));
    std::vector<std::string> notes;
    job.topics = chooseTopics(bag.connections(), NamedTopics(), &notes);
    job.output_namespace = outputNamespace(job.topics.left_image);
    if (!isSmall(&bag)) return 0;
    rosbag::Bag output(result.path(), rosbag::bagmode::Write);
    std::ostringstream csv;
    const BagReport report = processBag(&bag, job, &output, &csv, [](long) {});
    output.close();
    fuzz::require(report.frames <= report.left_images, "more frames than images");
  } catch (const std::runtime_error& error) {
    // The bag itself, or its topics; no message inside may end the processing.
    const std::string sentence = error.what();
    fuzz::require(job.topics.left_image.empty(), sentence.c_str());
  }
  return 0;
}
