#include "model/spec.hpp"

namespace sgi {

std::vector<SeedGroup> ModelSpec::groups() const {
  std::vector<SeedGroup> found;
  int start = 0;
  const auto add = [&](GroupName name, int size) {
    if (size) found.push_back({name, start, size});
    start += size;
  };
  if (skip) {
    add(GroupName::colour, per_seed * channels);
    add(GroupName::shape, 3 * per_seed);
    add(GroupName::feature, features - start);
  } else {
    add(GroupName::feature, features);
  }
  if (seed_scales) add(GroupName::scales, 4);
  add(GroupName::offset, 2 * per_seed);
  return found;
}

int ModelSpec::attributes() const { return features + (seed_scales ? 4 : 0) + 2 * per_seed; }

bool ModelSpec::is_plain() const {
  const bool held = features == per_seed * (channels + 3);
  return skip && held && shape == ShapeKind::log_covariance && !hidden && !seed_scales;
}

}  // namespace sgi
