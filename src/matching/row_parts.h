#ifndef ADAPTIVE_GRID_STEREO_SRC_MATCHING_ROW_PARTS_H
#define ADAPTIVE_GRID_STEREO_SRC_MATCHING_ROW_PARTS_H

#include "src/matching/thread_pool.h"

namespace adaptive_grid_stereo {

/// Rows [first, last) of an image.
struct RowRange {
  int first, last;
};

/// Those of a part among `parts` of about the same size. What is done row by row is divided alike
/// in all jobs of a frame, so that a thread finds its rows in its caches.
constexpr RowRange rowsOfPart(int height, int part, int parts) {
  return {height * part / parts, height * (part + 1) / parts};
}

/// Calls f(part, its rows) for all parts of an image, one for each thread of the pool.
template <class F>
void forRowParts(int height, ThreadPool* pool, const F& f) {
  const int parts = pool->size();
  pool->run([&](int part) { f(part, rowsOfPart(height, part, parts)); });
}

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_SRC_MATCHING_ROW_PARTS_H
