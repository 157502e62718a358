#include "model/spec.hpp"

namespace sgi {

std::vector<SeedGroup> ModelSpec::groups() const {
  std::vector<SeedGroup> found;
  int start = 0;
  const auto add = [&](GroupName name, int size) {
    found.push_back({name, start, size});
    start += size;
  };
  if (is_plain()) {
    add(GroupName::colour, channels);
    add(GroupName::shape, 3);
  } else {
    add(GroupName::feature, features);
    add(GroupName::scales, 4);
  }
  add(GroupName::offset, 2 * per_seed);
  return found;
}

int ModelSpec::attributes() const { return features + (is_plain() ? 0 : 4) + 2 * per_seed; }

}  // namespace sgi
