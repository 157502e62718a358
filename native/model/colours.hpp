// The colours of a tile's model: channels of luma and differences, and the samples that they are (docs/format.md,
// "Channels").
#pragma once
#include <vector>

#include "model/spec.hpp"

namespace sgi {

// [3, 3]; rows: one of the first three samples each as a mix of the first three channels; empty where channels are
// samples.
std::vector<float> sample_mix(const ModelSpec &spec);

}  // namespace sgi
