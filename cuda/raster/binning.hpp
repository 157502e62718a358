// Which Gaussians touch which tile: pairs in the order of Gaussians, then sorted by tile, stably.
//
// The sort takes kDigitBits of the tile's number at a time. A thread counts its own consecutive pairs, and counts are
// summed digit by digit, block by block and thread by thread: the order never depends on which block ran first.
#pragma once
#include "cuda/raster/tiling.hpp"

namespace sgi {

constexpr int kDigitBits = 5, kDigits = 1 << kDigitBits;
constexpr int kSortThreads = 128, kSortItems = 8;  // pairs of a thread

// Prepares Gaussians and counts the tiles that each touches.
SGI_KERNEL(prepare_splats, 128, RasterArguments) {
  block.each([&](int t) {
    const int i = block.index() * 128 + t;
    if (i >= a.gaussians) return;
    Splat s;
    Ellipse e;
    int touched = 0;
    if (prepared(a, i, s, e)) {
      for_each_tile(s, e, view_of(a), [&](uint32_t) { ++touched; });
      static_cast<TileSplat *>(a.splats)[i] = {s, e};
    }
    a.slot_start[i] = touched;
  });
}

// Lists the pairs of every Gaussian in its slots, after their starts were summed.
SGI_KERNEL(list_pairs, 128, RasterArguments) {
  block.each([&](int t) {
    const int i = block.index() * 128 + t;
    if (i >= a.gaussians || a.slot_start[i] == a.slot_start[i + 1]) return;
    Splat s;
    Ellipse e;
    prepared(a, i, s, e);
    int slot = a.slot_start[i];
    for_each_tile(s, e, view_of(a), [&](uint32_t tile) {
      if (slot < a.capacity) {
        a.keys[slot] = tile;
        a.slots[slot] = uint32_t(slot);
        a.owner[slot] = i;
      }
      ++slot;
    });
  });
}

namespace {

using DigitCounts = uint16_t[kDigits][kSortThreads + 1];

// Calls visit(place, digit) for the pairs of thread t of a block.
template <class Visit>
inline void for_each_digit(const RasterArguments &a, int index, int t, int pairs, Visit visit) {
  const int first = (index * kSortThreads + t) * kSortItems;
  for (int at = first; at < first + kSortItems && at < pairs; ++at)
    visit(at, int(a.keys[at] >> a.shift) & (kDigits - 1));
}

inline void count_digits(const ThreadBlock<kSortThreads> &block, const RasterArguments &a, int pairs,
                         DigitCounts &counts) {
  block.each([&](int t) {
    for (int digit = 0; digit < kDigits; ++digit) counts[digit][t] = 0;
    for_each_digit(a, block.index(), t, pairs, [&](int, int digit) { ++counts[digit][t]; });
  });
}

}  // namespace

// digits [kDigits, sort_blocks]: how many pairs of each block have a digit.
SGI_KERNEL(sort_count, kSortThreads, RasterArguments) {
  SGI_SHARED(DigitCounts, counts);
  count_digits(block, a, pairs_of(a), counts);
  block.each([&](int t) {
    if (t >= kDigits) return;
    int sum = 0;
    for (int i = 0; i < kSortThreads; ++i) sum += counts[t][i];
    a.digits[t * a.sort_blocks + block.index()] = sum;
  });
}

// Moves pairs to where their digit puts them, after `digits` were summed.
SGI_KERNEL(sort_scatter, kSortThreads, RasterArguments) {
  SGI_SHARED(DigitCounts, counts);
  count_digits(block, a, pairs_of(a), counts);
  block.each([&](int t) {
    if (t >= kDigits) return;
    int sum = 0;
    for (int i = 0; i < kSortThreads; ++i) {
      const int count = counts[t][i];
      counts[t][i] = uint16_t(sum);
      sum += count;
    }
  });
  block.each([&](int t) {
    for_each_digit(a, block.index(), t, pairs_of(a), [&](int at, int digit) {
      const int to = a.digits[digit * a.sort_blocks + block.index()] + counts[digit][t]++;
      a.keys_out[to] = a.keys[at];
      a.slots_out[to] = a.slots[at];
    });
  });
}

// tile_start [tiles + 1]: the first pair of every tile in keys, which are sorted.
SGI_KERNEL(find_tiles, 256, RasterArguments) {
  const CudaView view = view_of(a);
  const int pairs = pairs_of(a), tiles = view.tiles_x() * view.tiles_y();
  block.each([&](int t) {
    for (int i = block.index() * 256 + t; i <= pairs; i += block.count() * 256) {
      const int until = i < pairs ? int(a.keys[i]) : tiles;
      for (int tile = i ? int(a.keys[i - 1]) + 1 : 0; tile <= until; ++tile) a.tile_start[tile] = i;
    }
  });
}

}  // namespace sgi
