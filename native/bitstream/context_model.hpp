// The weights of MLP_p as a tile has them, and the model of attributes that they make.
#pragma once
#include <vector>

#include "bitstream/attributes.hpp"
#include "bitstream/shipped_networks.hpp"
#include "bitstream/symbol_coder.hpp"
#include "model/step_plan.hpp"

namespace sgi {

constexpr int kShiftBits = 5;  // of the unit 2^-shift of weights

// One network for each coding step: from the stream, or the prior, which takes no bits.
template <class Coder>
void code_networks(Coder &coder, const ModelSpec &spec, Networks &networks);

// How attributes are coded: `plan` has the steps of each group in coding order. The networks are made ready for an
// instruction set.
AttributeModel attribute_model(const ModelSpec &spec, const std::vector<GroupSteps> &plan, const Networks &networks,
                               int colour_step, int family, Isa isa);

}  // namespace sgi
