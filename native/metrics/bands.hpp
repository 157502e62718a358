// Loops over the rows of a plane, in bands that threads share.
#pragma once
#include <algorithm>
#include <cstdint>

#include "base/thread_pool.hpp"

namespace sgi {

constexpr int64_t kBandRows = 64;  // rows that a thread takes at a time: sums are added by bands, whatever the threads

inline int64_t bands_of(int64_t height) { return (height + kBandRows - 1) / kBandRows; }

// body(band, begin, end): the band's number and its rows.
template <class Body>
void each_band(int64_t height, int threads, Body body) {
  parallel_for(bands_of(height), threads,
               [&](int64_t band) { body(band, band * kBandRows, std::min(height, (band + 1) * kBandRows)); });
}

}  // namespace sgi
