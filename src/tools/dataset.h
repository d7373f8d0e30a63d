#ifndef ADAPTIVE_GRID_STEREO_TOOLS_DATASET_H
#define ADAPTIVE_GRID_STEREO_TOOLS_DATASET_H

#include <iosfwd>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace adaptive_grid_stereo {

/// How a public stereo set lays out its files.
enum class DatasetLayout { kMiddlebury2003, kMiddEval3, kEth3d, kKitti2012, kKitti2015 };

/// E.g. "Middlebury 2003"; means are taken over the scenes of one family.
const char* toString(DatasetLayout layout);
const char* familyOf(DatasetLayout layout);

/// One stereo pair of a set: where its files are. Paths of what the set does not have are empty.
struct Scene {
  DatasetLayout layout = DatasetLayout::kMiddlebury2003;
  std::string name;
  std::string left;
  std::string right;
  int disparity_range = 64;   // that the set asks for, rounded up to a multiple of 16 [px]
  std::string truth;          // left disparity, of all pixels where the set has that
  std::string visible_truth;  // KITTI: left disparity of pixels that both images see
  std::string right_truth;    // right disparity, to find the pixels that both images see
  std::string visible_mask;   // 255: both images see the pixel
  std::string all_mask;       // 255: counted among "all"
  double truth_scale = 1.0;   // grey value of a pixel in images of disparity
};

/// The images of a scene and what to score against.
struct LoadedScene {
  cv::Mat left;   // CV_8UC1
  cv::Mat right;  // CV_8UC1
  cv::Mat truth;  // CV_32FC1 [px], inf = unknown; empty if the set has none
  cv::Mat
      visible;  // CV_8UC1, 255: has truth and both images see it; empty if the set does not tell
  cv::Mat all;  // CV_8UC1, 255: has truth; empty if the set has visible pixels only
};

/// Every stereo pair below `directory`, in the order of their paths: Middlebury 2003 (im2, im6),
/// MiddEval3 and ETH3D two-view (im0, im1), KITTI 2012 and 2015 (training or testing folder).
/// Throws std::runtime_error if the directory cannot be read.
std::vector<Scene> findScenes(const std::string& directory);

/// Reads the files of a scene. Throws std::runtime_error, naming the file, if one is damaged or has
/// another size than the left image.
LoadedScene loadScene(const Scene& scene);

/// The value of `ndisp` in a calib.txt of the Middlebury kind (`key=value` lines); 0 if there is
/// none. Throws std::runtime_error if the value is not a number from 1 to 100000.
int readNdisp(std::istream& calib);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TOOLS_DATASET_H
