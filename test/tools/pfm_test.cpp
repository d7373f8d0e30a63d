#include "pfm.h"

#include <cmath>
#include <limits>
#include <sstream>

#include <gtest/gtest.h>

#include "temporary_folder.h"

namespace adaptive_grid_stereo {
namespace {

cv::Mat readText(const std::string& text) {
  std::istringstream stream(text);
  return readPfm(stream);
}

std::string faultOf(const std::string& text) {
  return messageOf([&] { readText(text); });
}

TEST(Pfm, WhatIsWrittenIsRead) {
  cv::Mat image(3, 5, CV_32FC1);
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 5; ++x) image.at<float>(y, x) = 10.0f * y + x + 0.0625f;
  }
  image.at<float>(1, 2) = std::numeric_limits<float>::infinity();
  std::stringstream stream;
  writePfm(stream, image);
  const cv::Mat back = readPfm(stream);
  ASSERT_EQ(back.size(), image.size());
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 5; ++x) EXPECT_EQ(back.at<float>(y, x), image.at<float>(y, x));
  }
}

TEST(Pfm, TheFirstRowInTheFileIsTheLowest) {
  const float values[] = {1.0f, 2.0f};
  const std::string data(reinterpret_cast<const char*>(values), sizeof(values));
  const cv::Mat image = readText("Pf\n1 2\n-1.0\n" + data);
  EXPECT_EQ(image.at<float>(1, 0), 1.0f);
  EXPECT_EQ(image.at<float>(0, 0), 2.0f);
}

TEST(Pfm, BothByteOrdersAreRead) {
  const std::string little("\x00\x00\x80\x3f", 4);  // 1.0f
  const std::string big("\x3f\x80\x00\x00", 4);
  EXPECT_EQ(readText("Pf 1 1 -1 " + little).at<float>(0, 0), 1.0f);
  EXPECT_EQ(readText("Pf 1 1 1 " + big).at<float>(0, 0), 1.0f);
  EXPECT_EQ(readText("Pf 1 1 -0.003922 " + little).at<float>(0, 0), 1.0f);
}

TEST(Pfm, HostileHeadersAreRefusedInWords) {
  EXPECT_NE(faultOf("").find("ends too early"), std::string::npos);
  EXPECT_NE(faultOf("P5\n1 1\n255\nx").find("no PFM"), std::string::npos);
  EXPECT_NE(faultOf("PF\n1 1\n-1\n            ").find("three channels"), std::string::npos);
  EXPECT_NE(faultOf("Pf\n0 1\n-1\n").find("width is 0"), std::string::npos);
  EXPECT_NE(faultOf("Pf\n-3 1\n-1\n").find("width is -3"), std::string::npos);
  EXPECT_NE(faultOf("Pf\n99999999999999999999 1\n-1\n").find("expected a number"),
            std::string::npos);
  EXPECT_NE(faultOf("Pf\n2x 1\n-1\n").find("expected a number"), std::string::npos);
  EXPECT_NE(faultOf("Pf\n1 1\n0\n    ").find("scale"), std::string::npos);
  EXPECT_NE(faultOf("Pf\n1 1\nnan\n    ").find("scale"), std::string::npos);
  EXPECT_NE(faultOf("Pf\n" + std::string(1000, '1') + " 1\n-1\n").find("no text"),
            std::string::npos);
}

TEST(Pfm, SizesLargerThanTheFileTakeNoMemory) {
  const std::string fault = faultOf("Pf\n65536 65536\n-1\nabcd");
  EXPECT_NE(fault.find("cut off"), std::string::npos) << fault;
  EXPECT_NE(fault.find("4 are there"), std::string::npos) << fault;
}

TEST(Pfm, AMissingFileIsNamed) {
  EXPECT_NE(messageOf([] { readPfm("no_such_file.pfm"); }).find("no_such_file.pfm"),
            std::string::npos);
}

}  // namespace
}  // namespace adaptive_grid_stereo
