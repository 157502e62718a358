// LANES rows of arrays side by side in a vector.
#pragma once
#include "base/vector.hpp"

namespace sgi {
namespace {

// Rows behind the last stand for the last one and count nothing.
struct Block {
  int64_t first;
  int64_t row[LANES];
  vf live;

  Block(int64_t begin, int64_t count) : first(begin), live() {
    for (int i = 0; i < LANES; ++i) {
      row[i] = begin + i < count ? begin + i : count - 1;
      set_lane(live, i, begin + i < count ? 1.0f : 0.0f);
    }
  }
  template <class T>
  vf gather(const T *rows, int width, int column) const {
    vf v;
    for (int i = 0; i < LANES; ++i) set_lane(v, i, float(rows[row[i] * width + column]));
    return v;
  }
  void scatter(vf v, float *rows, int width, int column) const {
    for (int i = 0; i < LANES; ++i)
      if (lane(live, i) != 0.0f) rows[row[i] * width + column] = lane(v, i);
  }
  int64_t number() const { return first / LANES; }
};

}  // namespace
}  // namespace sgi
