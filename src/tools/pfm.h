#ifndef ADAPTIVE_GRID_STEREO_TOOLS_PFM_H
#define ADAPTIVE_GRID_STEREO_TOOLS_PFM_H

#include <iosfwd>
#include <string>

#include <opencv2/core.hpp>

namespace adaptive_grid_stereo {

/// Reads a portable float map of one channel ("Pf"), in either byte order. Returns CV_32FC1 with
/// the top row first; inf and NaN are kept as they are. The stream must be seekable: sizes in the
/// header are compared with what is there before any memory is taken. Throws std::runtime_error
/// with the value found if it is not such a map.
cv::Mat readPfm(std::istream& stream);

/// The same from a file; the message names it.
cv::Mat readPfm(const std::string& path);

/// Writes CV_32FC1 as little-endian PFM; the Middlebury convention marks unknown pixels with inf.
/// Throws std::invalid_argument for another type, std::runtime_error if the stream fails.
void writePfm(std::ostream& stream, const cv::Mat& image);

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TOOLS_PFM_H
