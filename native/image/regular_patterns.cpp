#include "image/regular_patterns.hpp"

#include <algorithm>
#include <vector>

#include "base/thread_pool.hpp"

namespace sgi {

void find_regular_patterns(const Patterns &patterns, const float *plane, int64_t width, int64_t rows, int64_t columns,
                           int threads, Isa isa, float *ratio, float *power, int32_t *number) {
  const RegularPatternKernel &kernel = kernel_for<RegularPatternKernel>(isa);
  const int64_t lanes = lanes_of(isa);
  parallel_for((columns + lanes - 1) / lanes, threads, [&](int64_t part) {
    const int64_t first = part * lanes, count = std::min(lanes, columns - first);
    std::vector<float> ratios(size_t(rows * lanes)), powers(size_t(rows * lanes));
    std::vector<int32_t> numbers(size_t(rows * lanes));
    kernel.find(patterns, plane + first * kPatternBlock, width, rows, ratios.data(), powers.data(), numbers.data());
    for (int64_t row = 0; row < rows; ++row) {
      std::copy_n(&ratios[size_t(row * lanes)], count, ratio + row * columns + first);
      std::copy_n(&powers[size_t(row * lanes)], count, power + row * columns + first);
      std::copy_n(&numbers[size_t(row * lanes)], count, number + row * columns + first);
    }
  });
}

}  // namespace sgi
