// A synthetic flight as a rosbag: stereo images with their true disparity, and the sensors'
// readings.

#include <array>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <map>

#include "adaptive_grid_stereo/guidance/flight_state.h"
#include "adaptive_grid_stereo/simulation/flight_bag_writer.h"
#include "adaptive_grid_stereo/simulation/flight_plan.h"
#include "adaptive_grid_stereo/simulation/landscape.h"
#include "adaptive_grid_stereo/simulation/renderer.h"
#include "command_line.h"
#include "output_file.h"
#include "progress_bar.h"

namespace po = boost::program_options;
using namespace adaptive_grid_stereo;
using namespace adaptive_grid_stereo::simulation;

namespace {

const char kTool[] = "simulate_flight";

struct Options {
  std::string output;
  std::string size = "256x144";
  std::string states = "all";
  double duration = 30.0;
  double noise = 1.0;
  double focal = 0.0;
  bool force = false;
  bool no_truth = false;
  std::uint64_t seed = 1;
  FlightBagConfig bag;
  RendererConfig renderer;
};

void addOptions(Options* o, po::options_description* all) {
  po::options_description flight("flight");
  flight.add_options()("duration", po::value(&o->duration)->value_name("S")->default_value(30.0),
                       "length of the flight [s]")(
      "states", po::value(&o->states)->value_name("LIST")->default_value("all"),
      "manoeuvres in their order, separated by commas: stand, forward, yaw_left, yaw_right, "
      "pitch_up, pitch_down, yaw_pitch; those in the air are repeated until the time is up")(
      "seed", po::value(&o->seed)->value_name("N")->default_value(1),
      "of the landscape and of all noise; the same seed gives the same bag");
  po::options_description camera("camera");
  camera.add_options()("size", po::value(&o->size)->value_name("WxH")->default_value(o->size),
                       "of the images [px], up to 1280x720")(
      "rate", po::value(&o->bag.image_rate)->value_name("HZ")->default_value(10.0),
      "frames a second")("focal", po::value(&o->focal)->value_name("PX"),
                         "focal length [px]; default: 200 at a width of 256, in proportion")(
      "baseline", po::value(&o->renderer.rig.baseline)->value_name("M")->default_value(0.8),
      "between the cameras [m]")("samples",
                                 po::value(&o->renderer.samples)->value_name("N")->default_value(8),
                                 "rays a pixel")(
      "image-noise", po::value(&o->renderer.noise)->value_name("GREY")->default_value(1.5),
      "standard deviation at mid-grey [grey levels]")(
      "motion-blur", po::value(&o->renderer.exposure_time)->value_name("S")->default_value(0.0),
      "exposure time [s]")("exposure-ratio",
                           po::value(&o->renderer.right_gain)->value_name("X")->default_value(1.0),
                           "brightness of the right image against the left");
  po::options_description other("other");
  other.add_options()("sensor-noise", po::value(&o->noise)->value_name("X")->default_value(1.0),
                      "scales the noise of IMU, odometry, GPS and magnetometer; 0: none")(
      "no-truth", po::bool_switch(&o->no_truth), "leave /ground_truth/* out")(
      "threads", po::value(&o->renderer.threads)->value_name("N")->default_value(0),
      "0: one per processor")("force", po::bool_switch(&o->force), "overwrite a file that exists");
  all->add(flight).add(camera).add(other);
}

void require(bool holds, const std::string& sentence) {
  if (!holds) throw UsageError(sentence);
}

void checkOptions(Options* o) {
  StereoRig& rig = o->renderer.rig;
  char x = 0;
  std::istringstream size(o->size);
  require(size >> rig.width >> x >> rig.height && x == 'x' && size.peek() == EOF,
          "--size " + o->size + ": expected width x height, e.g. 256x144");
  require(rig.width >= 16 && rig.height >= 16 && rig.width <= 1280 && rig.height <= 720,
          "--size " + o->size + ": expected 16x16 to 1280x720");
  rig.focal = o->focal != 0.0 ? o->focal : 200.0 * rig.width / 256.0;
  const auto within = [](double value, double low, double high) {
    return std::isfinite(value) && value >= low && value <= high;
  };
  require(within(rig.focal, 1.0, 1e5), "--focal must lie between 1 and 100000 [px]");
  require(within(rig.baseline, 0.01, 10.0), "--baseline must lie between 0.01 and 10 [m]");
  require(within(o->duration, 0.1, 3600.0), "--duration must lie between 0.1 and 3600 [s]");
  require(within(o->bag.image_rate, 0.1, 200.0), "--rate must lie between 0.1 and 200 [Hz]");
  require(within(o->renderer.samples, 1, 1024), "--samples must lie between 1 and 1024");
  require(within(o->renderer.noise, 0.0, 50.0), "--image-noise must lie between 0 and 50");
  require(within(o->renderer.exposure_time, 0.0, 1.0),
          "--motion-blur must lie between 0 and 1 [s]");
  require(within(o->renderer.right_gain, 0.1, 10.0),
          "--exposure-ratio must lie between 0.1 and 10");
  require(within(o->noise, 0.0, 100.0), "--sensor-noise must lie between 0 and 100");
  require(within(o->renderer.threads, 0, 1024), "--threads must lie between 0 and 1024");
  o->bag.rig = rig;
  o->bag.write_truth = !o->no_truth;
  o->renderer.seed = o->seed;
}

/// False if the user asked for help only.
bool readOptions(int argc, char** argv, Options* o) {
  const ToolHelp help{
      kTool, "OUT.bag [options]",
      "Writes a rosbag of a synthetic fixed-wing flight: a stereo pair over a landscape, IMU,\n"
      "odometry, GPS, magnetometer, TF, and the true disparity. Needs no ROS master.",
      "  simulate_flight flight.bag\n"
      "  simulate_flight turns.bag --states forward,yaw_left,yaw_right --duration 12\n"
      "  simulate_flight large.bag --size 1280x720 --rate 5 --motion-blur 0.008\n"};
  po::options_description all;
  addOptions(o, &all);
  po::variables_map values;
  if (!parseCommandLine(argc, argv, help, all, {"output"}, &values)) return false;
  require(values.count("output") > 0, "the name of the bag is missing: simulate_flight OUT.bag");
  o->output = values["output"].as<std::string>();
  checkOptions(o);
  return true;
}

/// The share of frames in each state, by the package's default thresholds and the true motion.
void printStates(const Trajectory& flight, double image_rate, long frames) {
  FlightStateMachine machine;
  const GuidanceConfig config;
  std::map<std::string, long> counts;
  for (long i = 0; i < frames; ++i) {
    const FlightSample sample = flight.at(static_cast<double>(i) / image_rate);
    Motion motion;
    motion.valid = true;
    motion.forward_speed = sample.bodyVelocity().x();
    motion.yaw_rate = sample.angular_rate.z();
    motion.pitch_rate = -sample.angular_rate.y();
    ++counts[toString(machine.update(motion, sample.time, config))];
  }
  std::cout << "frames in each state:\n";
  for (const auto& [state, count] : counts) {
    std::cout << std::setw(6) << count << "  " << state << '\n';
  }
}

int run(int argc, char** argv) {
  Options o;
  if (!readOptions(argc, argv, &o)) return 0;
  std::vector<Manoeuvre> manoeuvres;
  try {
    manoeuvres = manoeuvresFromString(o.states);
  } catch (const std::invalid_argument& error) {
    throw UsageError(std::string("--states: ") + error.what());
  }
  OutputFile file(o.output, o.force);

  const Trajectory flight = makeFlight(manoeuvres, o.duration);
  LandscapeConfig landscape;
  landscape.seed = o.seed;
  const simulation::Scene scene(makeLandscape(flight, landscape));
  SensorConfig noise;
  noise.seed = o.seed;
  noise.noise_scale = o.noise;

  const long frames = FlightBagWriter::frameCount(o.duration, o.bag.image_rate);
  ProgressBar bar("frames", frames);
  FlightBagWriter writer(file.writePath(), o.bag);
  writer.write(flight, Sensors(noise), Renderer(scene, o.renderer),
               [&bar](long done) { bar.update(done); });
  bar.finish();
  file.commit();
  std::cout << o.output << ": " << frames << " stereo frames of " << o.size << ", " << o.duration
            << " s\n";
  printStates(flight, o.bag.image_rate, frames);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return runTool(kTool, [&] { return run(argc, argv); });
}
