#include "model/gaussian_block.hpp"

namespace sgi {
namespace {

void evaluate(const SeedModel &model, const SeedsView &seeds, int64_t count, const double *values, int64_t begin,
              int64_t end, const SeedGaussians &out) {
  for (int64_t at = begin; at < end; at += LANES) {
    const Block block(at, count);
    write_gaussians(
        model, seeds, block, [&](int column) { return block.gather(values, model.attributes(), column); }, out);
  }
}

}  // namespace

const GaussianKernel GaussianKernel::SGI_ISA{sgi::evaluate};

}  // namespace sgi
