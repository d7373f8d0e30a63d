#ifndef ADAPTIVE_GRID_STEREO_ROS_OVERLAY_H
#define ADAPTIVE_GRID_STEREO_ROS_OVERLAY_H

#include <opencv2/core.hpp>

#include "adaptive_grid_stereo/GridState.h"

namespace adaptive_grid_stereo {

/// Whole factor by which an image of this width [px] is enlarged so that the writing is legible.
int overlayScale(int width);

/// The grey (CV_8UC1) or BGR (CV_8UC3) image, enlarged `scale` times, with what the grid did
/// written into it: the nine cells tinted by their path counts, the counts, the state, speed and
/// rates. Returns CV_8UC3. Edges outside of the image are cut off; it never throws on the state's
/// content.
cv::Mat drawGridOverlay(const cv::Mat& left, const GridState& state, int scale = 1);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_ROS_OVERLAY_H
