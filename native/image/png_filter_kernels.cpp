#include "image/png_filter_kernel.hpp"

namespace sgi {
namespace {

constexpr int kRowsOfOneFilter = 8;

struct None {
  static int of(int, int, int) { return 0; }
};
struct Sub {
  static int of(int left, int, int) { return left; }
};
struct Up {
  static int of(int, int up, int) { return up; }
};
struct Average {
  static int of(int left, int up, int) { return (left + up) >> 1; }
};
struct Paeth {
  static int magnitude(int value) { return value < 0 ? -value : value; }
  static int of(int left, int up, int corner) {
    const int by_left = magnitude(up - corner), by_up = magnitude(left - corner),
              by_corner = magnitude(left + up - 2 * corner);
    const int other = by_up <= by_corner ? up : corner;
    return by_left <= by_up && by_left <= by_corner ? left : other;
  }
};

template <class Filter>
void apply(const uint8_t *row, const uint8_t *above, int64_t size, int step, uint8_t *out) {
  const int64_t head = step < size ? step : size;
  for (int64_t i = 0; i < head; ++i) out[i] = uint8_t(row[i] - Filter::of(0, above[i], 0));
  for (int64_t i = head; i < size; ++i) out[i] = uint8_t(row[i] - Filter::of(row[i - step], above[i], above[i - step]));
}

void apply(int filter, const uint8_t *row, const uint8_t *above, int64_t size, int step, uint8_t *out) {
  switch (filter) {
    case 0: return apply<None>(row, above, size, step, out);
    case 1: return apply<Sub>(row, above, size, step, out);
    case 2: return apply<Up>(row, above, size, step, out);
    case 3: return apply<Average>(row, above, size, step, out);
    default: return apply<Paeth>(row, above, size, step, out);
  }
}

// Sum of the magnitudes of differences, read as signed bytes.
int64_t weight(const uint8_t *out, int64_t size) {
  int64_t sum = 0;
  for (int64_t begin = 0; begin < size; begin += 1 << 16) {
    const int64_t end = begin + (1 << 16) < size ? begin + (1 << 16) : size;
    uint32_t part = 0;
    for (int64_t i = begin; i < end; ++i) part += out[i] < 128 ? out[i] : 256 - out[i];
    sum += part;
  }
  return sum;
}

int best_filter(const uint8_t *row, const uint8_t *above, int64_t size, int step, uint8_t *scratch) {
  int best = 0;
  int64_t least = INT64_MAX;
  for (int filter = 0; filter < 5; ++filter) {
    apply(filter, row, above, size, step, scratch);
    const int64_t sum = weight(scratch, size);
    if (sum < least) {
      least = sum;
      best = filter;
    }
  }
  return best;
}

void filter(const uint8_t *rows, const uint8_t *above, int64_t count, int64_t size, int step, uint8_t *out) {
  int chosen = 0;
  for (int64_t y = 0; y < count; ++y) {
    const uint8_t *row = rows + y * size;
    uint8_t *to = out + y * (size + 1);
    if (y % kRowsOfOneFilter == 0) chosen = best_filter(row, above, size, step, to + 1);
    to[0] = uint8_t(chosen);
    apply(chosen, row, above, size, step, to + 1);
    above = row;
  }
}

}  // namespace

const PngFilterKernel PngFilterKernel::SGI_ISA{sgi::filter};

}  // namespace sgi
