#include "model/coding_passes.hpp"

#include <algorithm>

namespace sgi {

std::vector<std::vector<int64_t>> coding_passes(const ContextSpec &context, const std::vector<int32_t> &corner,
                                                const std::vector<int8_t> &log_size) {
  constexpr int kCoarsest = 5;             // log2 of the cells that are coded first; larger ones go with them
  constexpr int kOrder[4] = {0, 2, 3, 1};  // of the parities x + 2 y
  std::vector<std::vector<int64_t>> passes(context.neighbours ? 4 * kCoarsest : 1);
  for (size_t i = 0; i < log_size.size(); ++i) {
    int pass = 0;
    if (context.neighbours) {
      const int x = corner[2 * i] >> log_size[i] & 1, y = corner[2 * i + 1] >> log_size[i] & 1;
      pass = kOrder[x + 2 * y] + 4 * (kCoarsest - std::clamp<int>(log_size[i], 1, kCoarsest));
    }
    passes[size_t(pass)].push_back(int64_t(i));
  }
  passes.erase(std::remove_if(passes.begin(), passes.end(), [](const auto &pass) { return pass.empty(); }),
               passes.end());
  return passes;
}

}  // namespace sgi
