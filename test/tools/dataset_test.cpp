#include "dataset.h"
#include "image_file.h"

#include <cmath>
#include <sstream>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "pfm.h"
#include "temporary_folder.h"

namespace adaptive_grid_stereo {
namespace {

constexpr int kWidth = 24;
constexpr int kHeight = 18;

void writeImage(const TemporaryFolder& folder, const std::string& name, int value,
                int type = CV_8UC1) {
  ASSERT_TRUE(
      cv::imwrite(folder.file(name), cv::Mat(kHeight, kWidth, type, cv::Scalar::all(value))));
}

void writeFloat(const TemporaryFolder& folder, const std::string& name, float value) {
  std::ofstream stream(folder.file(name), std::ios::binary);
  writePfm(stream, cv::Mat(kHeight, kWidth, CV_32FC1, cv::Scalar(value)));
}

TEST(Dataset, Middlebury2003) {
  const TemporaryFolder folder;
  writeImage(folder, "teddy/im2.png", 100, CV_8UC3);
  writeImage(folder, "teddy/im6.png", 100, CV_8UC3);
  writeImage(folder, "teddy/disp2.png", 20);
  cv::Mat mask(kHeight, kWidth, CV_8UC1, cv::Scalar(255));
  mask.at<uchar>(3, 4) = 0;
  mask.at<uchar>(3, 5) = 128;
  cv::imwrite(folder.file("teddy/nonocc.png"), mask);
  const std::vector<Scene> scenes = findScenes(folder.path());
  ASSERT_EQ(scenes.size(), 1u);
  EXPECT_EQ(scenes[0].layout, DatasetLayout::kMiddlebury2003);
  EXPECT_EQ(scenes[0].name, "teddy");
  EXPECT_EQ(scenes[0].disparity_range, 64);
  const LoadedScene loaded = loadScene(scenes[0]);
  EXPECT_EQ(loaded.left.type(), CV_8UC1);
  EXPECT_EQ(loaded.truth.at<float>(0, 0), 5.0f);  // quarter size: grey value / 4
  EXPECT_EQ(cv::countNonZero(loaded.visible), kWidth * kHeight - 2);
  EXPECT_EQ(cv::countNonZero(loaded.all), kWidth * kHeight);
}

TEST(Dataset, WithoutMaskTheRightDisparityTellsWhatIsVisible) {
  const TemporaryFolder folder;
  for (const char* name : {"im2", "im6"}) writeImage(folder, std::string("x/") + name + ".png", 9);
  writeImage(folder, "x/disp2.png", 8);  // 2 px
  cv::Mat right(kHeight, kWidth, CV_8UC1, cv::Scalar(8));
  right.at<uchar>(5, 10) = 40;  // seen in the left image at x = 12, but something else
  cv::imwrite(folder.file("x/disp6.png"), right);
  const LoadedScene loaded = loadScene(findScenes(folder.path()).at(0));
  EXPECT_EQ(loaded.visible.at<uchar>(5, 12), 0);
  EXPECT_EQ(loaded.visible.at<uchar>(5, 13), 255);
  EXPECT_EQ(loaded.visible.at<uchar>(5, 1), 0);  // would lie left of the right image
}

TEST(ImageFile, NamesTheFileThatOpenCvThrowsAt) {
  const TemporaryFolder folder;
  folder.write("huge.pgm", "P5 55555555 16 255 <<<<");
  folder.write("text.png", "no image");
  for (const char* name : {"huge.pgm", "text.png", "missing.png"}) {
    try {
      readImage(folder.file(name), cv::IMREAD_GRAYSCALE);
      ADD_FAILURE() << name;
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    }
  }
}

TEST(Dataset, MiddEval3) {
  const TemporaryFolder folder;
  writeImage(folder, "trainingQ/Piano/im0.png", 50);
  writeImage(folder, "trainingQ/Piano/im1.png", 50);
  folder.write("trainingQ/Piano/calib.txt", "cam0=[1 0 1; 0 1 1; 0 0 1]\nndisp=65\nisint=0\n");
  writeFloat(folder, "trainingQ/Piano/disp0GT.pfm", 7.5f);
  writeImage(folder, "trainingQ/Piano/mask0nocc.png", 255);
  const std::vector<Scene> scenes = findScenes(folder.path());
  ASSERT_EQ(scenes.size(), 1u);
  EXPECT_EQ(scenes[0].layout, DatasetLayout::kMiddEval3);
  EXPECT_EQ(scenes[0].disparity_range, 80);
  const LoadedScene loaded = loadScene(scenes[0]);
  EXPECT_EQ(loaded.truth.at<float>(2, 2), 7.5f);
  EXPECT_EQ(cv::countNonZero(loaded.visible), kWidth * kHeight);
}

TEST(Dataset, Eth3dTruthLiesInAFolderBeside) {
  const TemporaryFolder folder;
  writeImage(folder, "two_view_training/forest_1s/im0.png", 50);
  writeImage(folder, "two_view_training/forest_1s/im1.png", 50);
  writeFloat(folder, "two_view_training_gt/forest_1s/disp0GT.pfm", 3.0f);
  const std::vector<Scene> scenes = findScenes(folder.path());
  ASSERT_EQ(scenes.size(), 1u);
  EXPECT_EQ(scenes[0].layout, DatasetLayout::kEth3d);
  EXPECT_EQ(loadScene(scenes[0]).truth.at<float>(0, 0), 3.0f);
}

TEST(Dataset, Kitti2012And2015) {
  const TemporaryFolder folder;
  for (const char* name :
       {"a/training/image_0/000003_10.png", "a/training/image_1/000003_10.png",
        "a/training/image_0/000003_11.png", "a/training/image_1/000003_11.png",
        "b/training/image_2/000007_10.png", "b/training/image_3/000007_10.png"}) {
    writeImage(folder, name, 60);
  }
  cv::Mat truth(kHeight, kWidth, CV_16UC1, cv::Scalar(256 * 20 + 128));
  truth.at<std::uint16_t>(0, 0) = 0;
  cv::imwrite(folder.file("a/training/disp_noc/000003_10.png"), truth);
  cv::imwrite(folder.file("b/training/disp_noc_0/000007_10.png"), truth);
  truth.at<std::uint16_t>(0, 0) = 256;
  cv::imwrite(folder.file("b/training/disp_occ_0/000007_10.png"), truth);
  const std::vector<Scene> scenes = findScenes(folder.path());
  ASSERT_EQ(scenes.size(), 2u);
  EXPECT_EQ(scenes[0].layout, DatasetLayout::kKitti2012);
  EXPECT_EQ(scenes[1].layout, DatasetLayout::kKitti2015);
  const LoadedScene first = loadScene(scenes[0]);
  EXPECT_EQ(first.truth.at<float>(1, 1), 20.5f);
  EXPECT_EQ(cv::countNonZero(first.visible), kWidth * kHeight - 1);
  EXPECT_TRUE(first.all.empty());
  const LoadedScene second = loadScene(scenes[1]);
  EXPECT_EQ(cv::countNonZero(second.visible), kWidth * kHeight - 1);
  EXPECT_EQ(cv::countNonZero(second.all), kWidth * kHeight);
}

TEST(Dataset, DamagedFilesAreNamed) {
  const TemporaryFolder folder;
  writeImage(folder, "t/im2.png", 1);
  folder.write("t/im6.png", "no image");
  EXPECT_NE(messageOf([&] { loadScene(findScenes(folder.path()).at(0)); }).find("im6.png"),
            std::string::npos);
  cv::imwrite(folder.file("t/im6.png"), cv::Mat(20, 20, CV_8UC1, cv::Scalar(0)));
  const std::string fault = messageOf([&] { loadScene(findScenes(folder.path()).at(0)); });
  EXPECT_NE(fault.find("20x20"), std::string::npos) << fault;
  EXPECT_NE(messageOf([] { findScenes("no_such_folder"); }).find("no_such_folder"),
            std::string::npos);
}

TEST(Dataset, NdispOfHostileCalibrations) {
  const auto ndisp = [](const std::string& text) {
    std::istringstream stream(text);
    return readNdisp(stream);
  };
  EXPECT_EQ(ndisp(""), 0);
  EXPECT_EQ(ndisp("width=3\nndisp=70\n"), 70);
  EXPECT_THROW(ndisp("ndisp=\n"), std::runtime_error);
  EXPECT_THROW(ndisp("ndisp=-5\n"), std::runtime_error);
  EXPECT_THROW(ndisp("ndisp=99999999999999\n"), std::runtime_error);
}

}  // namespace
}  // namespace adaptive_grid_stereo
