// The groups in which seeds are coded together (docs/format.md, "Passes").
#pragma once
#include <cstdint>
#include <vector>

#include "model/spec.hpp"

namespace sgi {

// Indices of the seeds of each pass, ascending: all at once without neighbours, else by the parities of the cells of
// each size, from large ones to small ones. corner [N, 2], log_size [N].
std::vector<std::vector<int64_t>> coding_passes(const ContextSpec &context, const std::vector<int32_t> &corner,
                                                const std::vector<int8_t> &log_size);

}  // namespace sgi
