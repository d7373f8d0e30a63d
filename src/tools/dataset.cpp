#include "dataset.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <locale>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>

#include <opencv2/imgcodecs.hpp>

#include "image_file.h"
#include "pfm.h"

namespace fs = std::filesystem;

namespace adaptive_grid_stereo {
namespace {

// The largest disparities in KITTI's truth; its calibration files do not tell.
constexpr int kKittiRange = 160;
constexpr int kDefaultRange = 64;
constexpr float kUnknown = std::numeric_limits<float>::infinity();

/// The file `stem` in one of the formats that the sites ship, or "".
std::string findImage(const fs::path& folder, const std::string& stem) {
  for (const char* extension : {".png", ".ppm", ".pgm"}) {
    const fs::path path = folder / (stem + extension);
    if (fs::is_regular_file(path)) return path.string();
  }
  return "";
}

std::string ifThere(const fs::path& path) { return fs::is_regular_file(path) ? path.string() : ""; }

int roundUpTo16(int value) { return (value + 15) / 16 * 16; }

Scene middlebury2003(const fs::path& folder) {
  Scene scene;
  scene.layout = DatasetLayout::kMiddlebury2003;
  scene.name = folder.filename().string();
  scene.left = findImage(folder, "im2");
  scene.right = findImage(folder, "im6");
  scene.truth = findImage(folder, "disp2");
  scene.right_truth = findImage(folder, "disp6");
  scene.visible_mask = findImage(folder, "nonocc");
  scene.all_mask = findImage(folder, "all");
  return scene;
}

/// MiddEval3 and ETH3D two-view name their files alike; ETH3D ships the truth in a folder of its
/// own.
Scene im0im1(const fs::path& folder) {
  Scene scene;
  scene.name = folder.filename().string();
  scene.left = findImage(folder, "im0");
  scene.right = findImage(folder, "im1");
  const std::string set = folder.parent_path().filename().string();
  static const std::regex eth3d_scene(".*_[0-9]+[ls]");
  const bool eth3d = set.rfind("eth3d", 0) == 0 || set.rfind("two_view", 0) == 0 ||
                     std::regex_match(scene.name, eth3d_scene);
  scene.layout = eth3d ? DatasetLayout::kEth3d : DatasetLayout::kMiddEval3;
  const fs::path beside = folder.parent_path().parent_path() / (set + "_gt") / scene.name;
  for (const fs::path& place : {folder, beside}) {
    if (scene.truth.empty()) scene.truth = ifThere(place / "disp0GT.pfm");
    if (scene.right_truth.empty()) scene.right_truth = ifThere(place / "disp1GT.pfm");
    if (scene.visible_mask.empty()) scene.visible_mask = findImage(place, "mask0nocc");
  }
  std::ifstream calib(folder / "calib.txt");
  const int ndisp = calib ? readNdisp(calib) : 0;
  if (ndisp > 0) scene.disparity_range = std::clamp(roundUpTo16(ndisp), 16, 512);
  return scene;
}

/// The pairs *_10 of one KITTI folder; `left`, `right`, `noc`, `occ` are the names of its folders.
std::vector<Scene> kitti(const fs::path& folder, DatasetLayout layout, const char* left,
                         const char* right, const char* noc, const char* occ) {
  std::vector<Scene> scenes;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder / left)) {
    const std::string file = entry.path().filename().string();
    const std::string stem = entry.path().stem().string();
    if (stem.size() < 3 || stem.compare(stem.size() - 3, 3, "_10") != 0) continue;
    if (!fs::is_regular_file(folder / right / file)) continue;
    Scene scene;
    scene.layout = layout;
    scene.name = stem;
    scene.left = entry.path().string();
    scene.right = (folder / right / file).string();
    scene.disparity_range = kKittiRange;
    scene.truth = ifThere(folder / occ / file);
    scene.visible_truth = ifThere(folder / noc / file);
    scene.truth_scale = 256.0;
    scenes.push_back(scene);
  }
  return scenes;
}

std::vector<Scene> scenesIn(const fs::path& folder) {
  const auto has = [&](const char* name) { return fs::is_directory(folder / name); };
  if (has("image_2") && has("image_3")) {
    return kitti(folder, DatasetLayout::kKitti2015, "image_2", "image_3", "disp_noc_0",
                 "disp_occ_0");
  }
  if (has("image_0") && has("image_1")) {
    return kitti(folder, DatasetLayout::kKitti2012, "image_0", "image_1", "disp_noc", "disp_occ");
  }
  if (has("colored_0") && has("colored_1")) {
    return kitti(folder, DatasetLayout::kKitti2012, "colored_0", "colored_1", "disp_noc",
                 "disp_occ");
  }
  if (!findImage(folder, "im2").empty() && !findImage(folder, "im6").empty()) {
    return {middlebury2003(folder)};
  }
  if (!findImage(folder, "im0").empty() && !findImage(folder, "im1").empty()) {
    return {im0im1(folder)};
  }
  return {};
}

void checkSize(const cv::Mat& image, const cv::Mat& left, const std::string& path) {
  if (image.size() == left.size()) return;
  throw std::runtime_error(path + ": is " + std::to_string(image.cols) + "x" +
                           std::to_string(image.rows) + ", the left image is " +
                           std::to_string(left.cols) + "x" + std::to_string(left.rows));
}

/// Disparity [px] of a PFM, or of an image whose grey values are scale * disparity, 0 = unknown.
cv::Mat readTruth(const std::string& path, double scale) {
  if (fs::path(path).extension() == ".pfm") {
    cv::Mat truth = readPfm(path);
    for (float& value : cv::Mat_<float>(truth)) {
      if (!(value > 0.0f)) value = kUnknown;
    }
    return truth;
  }
  const cv::Mat grey = readImage(path, cv::IMREAD_UNCHANGED);
  if (grey.channels() != 1 || (grey.depth() != CV_8U && grey.depth() != CV_16U)) {
    throw std::runtime_error(path + ": has colours or an unusual depth, expected 8 or 16 bit grey");
  }
  cv::Mat truth;
  grey.convertTo(truth, CV_32F);
  for (float& value : cv::Mat_<float>(truth)) {
    value = value > 0.0f ? value / static_cast<float>(scale) : kUnknown;
  }
  return truth;
}

/// Grey value of a disparity of one pixel: the 2003 pairs come in full, half and quarter size, and
/// the pairs of 2001, which share the layout, use 8.
double scaleOf2003(const Scene& scene, int width) {
  static const std::set<std::string> pairs_of_2001{"barn1",  "barn2",    "bull",
                                                   "poster", "sawtooth", "venus"};
  if (pairs_of_2001.count(scene.name) > 0) return 8.0;
  return width > 1350 ? 1.0 : width > 675 ? 2.0 : 4.0;
}

cv::Mat known(const cv::Mat& truth) {
  cv::Mat mask(truth.size(), CV_8UC1, cv::Scalar(0));
  for (int y = 0; y < truth.rows; ++y) {
    for (int x = 0; x < truth.cols; ++x) {
      if (std::isfinite(truth.at<float>(y, x))) mask.at<uchar>(y, x) = 255;
    }
  }
  return mask;
}

/// Pixels whose match in the right image has the same disparity within a pixel.
cv::Mat consistent(const cv::Mat& truth, const cv::Mat& right_truth) {
  cv::Mat mask(truth.size(), CV_8UC1, cv::Scalar(0));
  for (int y = 0; y < truth.rows; ++y) {
    for (int x = 0; x < truth.cols; ++x) {
      const float disparity = truth.at<float>(y, x);
      if (!std::isfinite(disparity)) continue;
      const long x_right = std::lrint(static_cast<double>(x) - disparity);
      if (x_right < 0 || x_right >= truth.cols) continue;
      const float there = right_truth.at<float>(y, static_cast<int>(x_right));
      if (std::abs(there - disparity) <= 1.0f) mask.at<uchar>(y, x) = 255;
    }
  }
  return mask;
}

void loadMasks(const Scene& scene, double scale, LoadedScene* loaded) {
  loaded->all = known(loaded->truth);
  if (!scene.visible_mask.empty()) {
    const cv::Mat mask = readImage(scene.visible_mask, cv::IMREAD_GRAYSCALE);
    checkSize(mask, loaded->left, scene.visible_mask);
    loaded->visible = (mask == 255) & loaded->all;
  } else if (!scene.right_truth.empty()) {
    const cv::Mat right_truth = readTruth(scene.right_truth, scale);
    checkSize(right_truth, loaded->left, scene.right_truth);
    loaded->visible = consistent(loaded->truth, right_truth);
  }
  if (!scene.all_mask.empty()) {
    const cv::Mat mask = readImage(scene.all_mask, cv::IMREAD_GRAYSCALE);
    checkSize(mask, loaded->left, scene.all_mask);
    loaded->all = (mask == 255) & loaded->all;
  }
}

void loadKittiTruth(const Scene& scene, LoadedScene* loaded) {
  if (!scene.visible_truth.empty()) {
    loaded->truth = readTruth(scene.visible_truth, scene.truth_scale);
    checkSize(loaded->truth, loaded->left, scene.visible_truth);
    loaded->visible = known(loaded->truth);
  }
  if (!scene.truth.empty()) {
    loaded->truth = readTruth(scene.truth, scene.truth_scale);
    checkSize(loaded->truth, loaded->left, scene.truth);
    loaded->all = known(loaded->truth);
  }
}

}  // namespace

const char* toString(DatasetLayout layout) {
  switch (layout) {
    case DatasetLayout::kMiddlebury2003:
      return "Middlebury 2003";
    case DatasetLayout::kMiddEval3:
      return "MiddEval3";
    case DatasetLayout::kEth3d:
      return "ETH3D";
    case DatasetLayout::kKitti2012:
      return "KITTI 2012";
    case DatasetLayout::kKitti2015:
      return "KITTI 2015";
  }
  return "unknown";
}

const char* familyOf(DatasetLayout layout) {
  switch (layout) {
    case DatasetLayout::kMiddlebury2003:
    case DatasetLayout::kMiddEval3:
      return "Middlebury";
    default:
      return toString(layout);
  }
}

int readNdisp(std::istream& calib) {
  static const std::string key = "ndisp=";
  std::string line;
  while (std::getline(calib, line)) {
    if (line.compare(0, key.size(), key) != 0) continue;
    std::istringstream text(line.substr(key.size(), 16));
    text.imbue(std::locale::classic());
    int value = 0;
    if (!(text >> value) || value < 1 || value > 100000) {
      throw std::runtime_error("calib.txt: '" + line.substr(0, 40) +
                               "', expected ndisp to be a number from 1 to 100000");
    }
    return value;
  }
  return 0;
}

std::vector<Scene> findScenes(const std::string& directory) {
  std::error_code error;
  if (!fs::is_directory(directory, error)) {
    throw std::runtime_error(directory + ": is no directory");
  }
  // Without a trailing slash the last component is the folder's name.
  fs::path root = fs::canonical(directory, error);
  std::vector<Scene> scenes = scenesIn(root);
  const auto options = fs::directory_options::skip_permission_denied;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root, options)) {
    if (!entry.is_directory(error)) continue;
    const std::vector<Scene> found = scenesIn(entry.path());
    scenes.insert(scenes.end(), found.begin(), found.end());
  }
  std::sort(scenes.begin(), scenes.end(),
            [](const Scene& a, const Scene& b) { return a.left < b.left; });
  return scenes;
}

LoadedScene loadScene(const Scene& scene) {
  LoadedScene loaded;
  const ImagePair images = readGreyPair(scene.left, scene.right);
  loaded.left = images.left;
  loaded.right = images.right;
  checkSize(loaded.right, loaded.left, scene.right);
  const bool is_kitti =
      scene.layout == DatasetLayout::kKitti2012 || scene.layout == DatasetLayout::kKitti2015;
  if (is_kitti) {
    loadKittiTruth(scene, &loaded);
  } else if (!scene.truth.empty()) {
    const double scale = scene.layout == DatasetLayout::kMiddlebury2003
                             ? scaleOf2003(scene, loaded.left.cols)
                             : scene.truth_scale;
    loaded.truth = readTruth(scene.truth, scale);
    checkSize(loaded.truth, loaded.left, scene.truth);
    loadMasks(scene, scale, &loaded);
  }
  return loaded;
}

}  // namespace adaptive_grid_stereo
