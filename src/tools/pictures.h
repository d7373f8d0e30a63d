#ifndef ADAPTIVE_GRID_STEREO_TOOLS_PICTURES_H
#define ADAPTIVE_GRID_STEREO_TOOLS_PICTURES_H

#include <string>

#include <opencv2/core.hpp>

#include "adaptive_grid_stereo/path_plan.h"

namespace adaptive_grid_stereo {

/// Disparity in colour, blue (far) to red (near), black where it is unknown. disparity: CV_32FC1
/// [px], unknown pixels are not finite; the colours span [smallest, largest] [px]. Returns CV_8UC3
/// (BGR).
cv::Mat colourDisparity(const cv::Mat& disparity, double smallest, double largest);

/// Disparity error in colour against `truth` (CV_32FC1, not finite where unknown): grey where there
/// is no truth, black where the disparity is unknown, blue (0 px) to red (4 px and more) elsewhere.
cv::Mat colourError(const cv::Mat& disparity, const cv::Mat& truth);

/// Draws the plan's cell edges and, in each cell, its number of paths onto a BGR picture.
void drawPlan(const PathPlan& plan, cv::Mat* picture);

/// Writes `text` on a dark bar at the picture's top (BGR).
void drawCaption(const std::string& text, cv::Mat* picture);

/// Writes a picture as PNG through an OutputFile. Throws std::runtime_error.
void writePng(const std::string& path, const cv::Mat& picture, bool force);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TOOLS_PICTURES_H
