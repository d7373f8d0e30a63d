#ifndef ADAPTIVE_GRID_STEREO_MATCHING_REFINEMENT_H
#define ADAPTIVE_GRID_STEREO_MATCHING_REFINEMENT_H

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "adaptive_grid_stereo/matching/matcher_config.h"
#include "adaptive_grid_stereo/matching/padded_image.h"

namespace adaptive_grid_stereo {

/// Sets pixels of rows [first_row, last_row) to kInvalidDisparity where the grey levels of the left
/// image vary too little to be matched: where their standard deviation within the census window
/// (borders replicate the edge) is below min_contrast [grey levels]. Thread safe for disjoint rows.
void removeLowContrast(const PaddedImage& left, CensusWindow window, double min_contrast,
                       int first_row, int last_row, cv::Mat* disparity);

/// Buffers of removeSmallRegions, reused from frame to frame.
struct RegionBuffers {
  /// Neighbours in a row whose values differ by little enough: columns [begin, end). `parent` leads
  /// to the root of its region, which has the region's `size` [px].
  struct Run {
    std::int32_t begin, end, parent, size;
  };
  std::vector<Run> runs;
  std::vector<std::int32_t> row_begin;  // [y] first run of the row
  std::vector<std::uint8_t> edges;      // [x] 1 where a run begins or ends
};

/// Sets four-connected regions of at most max_size [px] valid pixels to kInvalidDisparity;
/// neighbours belong to one region if their values differ by at most max_step [fixed point]. The
/// result equals that of cv::filterSpeckles. disparity: CV_16SC1, in place.
void removeSmallRegions(int max_size, int max_step, RegionBuffers* buffers, cv::Mat* disparity);

/// 3x3 median of rows [first_row, last_row): invalid neighbours, and those beyond the image, count
/// as the centre, and an invalid centre stays invalid, so that nothing is filled and nothing
/// smeared. source and target: CV_16SC1 of one size, not the same. Thread safe for disjoint rows.
void medianOfValid(const cv::Mat& source, int first_row, int last_row, cv::Mat* target);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_MATCHING_REFINEMENT_H
