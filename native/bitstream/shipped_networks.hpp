// The networks that ship with the library.
#pragma once
#include <memory>
#include <vector>

#include "base/bytes.hpp"
#include "model/network.hpp"
#include "model/spec.hpp"

namespace sgi {

constexpr int kPrior = 1;  // number of the prior

using Networks = std::vector<std::shared_ptr<const IntNetwork>>;

// Of such a file: for each its inputs, hidden units, outputs, predictions and shift, then W1, b1, W2, b2.
Networks parse_networks(Bytes file);

// Those of the prior that the model names, one for each coding step. Throws Error (unsupported) for one that this
// version does not have or that does not fit the model.
Networks load_prior(const ModelSpec &spec);

}  // namespace sgi
