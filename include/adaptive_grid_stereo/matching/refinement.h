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

/// Finds four-connected regions of valid pixels, neighbours of which belong together if their
/// values differ by at most max_step [fixed point], and drops the small ones. The image is cut into
/// parts, bands of rows, which threads may work at: start(), find() for each part, join(), and
/// erase() for each part. find() and erase() are thread safe for different parts; the result does
/// not depend on their number. Keeps its buffers from frame to frame.
class SmallRegions {
 public:
  /// disparity: CV_16SC1; its values must stay as they are until join() has returned.
  void start(const cv::Mat& disparity, int max_step, int parts);

  /// Finds the regions of a part.
  void find(int part);

  /// Joins regions across the parts' borders.
  void join();

  /// Sets regions of at most max_size [px] to kInvalidDisparity within a part.
  void erase(int part, int max_size, cv::Mat* disparity) const;

 private:
  // Neighbours in a row that belong together: columns [begin, end). `parent` leads to the root of
  // the part's region. The root's `size` is that of the region [px], or, where the region reaches
  // into another part, ~place (below zero) of its place among the joined ones.
  struct Run {
    std::int32_t begin, end, parent, size;
  };
  // A part's region that reaches into another part; `parent` leads to the root of all those that
  // are one region, which has the `size` of all of them [px].
  struct Joined {
    std::int32_t parent, size;
  };
  // On cache lines of its own, since the thread that has it changes it with every row.
  struct alignas(64) Part {
    int first_row = 0, end_row = 0;
    std::vector<Run> runs;
    std::vector<std::int32_t> row_begin;  // first run of each row, and the end of the last one's
    std::vector<std::uint8_t> edges;      // [x] 1 where a run begins or ends
    std::vector<std::int32_t> ends;       // columns where a row's runs end
  };

  void addRow(int y, Part* part) const;
  template <class Join>
  void findTouching(int y, const Part& above, const Part& here, const Join& join) const;
  std::int32_t joinedPlace(Part* part, std::int32_t run);

  cv::Mat disparity_;
  int max_step_ = 0;
  std::vector<Part> parts_;
  std::vector<Joined> joined_;
};

/// Sets four-connected regions of at most max_size [px] valid pixels to kInvalidDisparity;
/// neighbours belong to one region if their values differ by at most max_step [fixed point]. The
/// result equals that of cv::filterSpeckles. disparity: CV_16SC1, in place.
void removeSmallRegions(int max_size, int max_step, SmallRegions* regions, cv::Mat* disparity);

/// 3x3 median of rows [first_row, last_row): invalid neighbours, and those beyond the image, count
/// as the centre, and an invalid centre stays invalid, so that nothing is filled and nothing
/// smeared. source and target: CV_16SC1 of one size, not the same. Thread safe for disjoint rows.
void medianOfValid(const cv::Mat& source, int first_row, int last_row, cv::Mat* target);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_MATCHING_REFINEMENT_H
