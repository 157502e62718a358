// How the seeds of a tile are coded, from arrays.
#pragma once
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <tuple>

#include "bindings/checks.hpp"
#include "bitstream/context_model.hpp"
#include "bitstream/header.hpp"

namespace sgi {

using Plan = std::vector<std::tuple<Array<const int64_t, 2>, int>>;
using NetworkArrays = std::vector<std::tuple<Array<const int64_t, 2>, Array<const int64_t, 1>, Array<const int64_t, 2>,
                                             Array<const int64_t, 1>, int>>;

template <class T>
std::vector<T> copy(const T *from, size_t count) {
  return {from, from + count};
}

inline std::vector<GroupSteps> plan_of(const ModelSpec &spec, const Plan &given) {
  const std::vector<SeedGroup> groups = spec.groups();
  require(given.size() == groups.size(), "a plan has the steps of every group");
  std::vector<GroupSteps> plan;
  for (const auto &[base, gamma] : given) {
    const auto units = size_t(output_count(spec, groups[plan.size()]));
    require(has_shape(base, units, kLevels) && gamma >= 0 && gamma < 64, "base must be [U, 8], gamma 0..63");
    for (size_t i = 0; i < base.size(); ++i)
      require(base.data()[i] >= 0 && base.data()[i] < kStepCount, "a base step is outside the table of steps");
    plan.push_back({copy(base), gamma});
  }
  return plan;
}

inline Networks networks_of(const ModelSpec &spec, const NetworkArrays &given) {
  const auto steps = coding_steps(spec);
  require(given.size() == steps.size(), "there is a network for every coding step");
  Networks networks;
  for (const auto &[w1, b1, w2, b2, shift] : given) {
    const size_t step = networks.size();
    const int inputs = input_count(spec, int(step)), outputs = network_outputs(spec, steps[step]);
    const int predicted = (outputs - int(steps[step].size())) / 2;
    require(has_shape(w1, size_t(spec.context.hidden), size_t(inputs)) && w2.shape(0) == size_t(outputs),
            "a network has the weights of its coding step");
    networks.push_back(std::make_shared<const IntNetwork>(network_of(w1, b1, w2, b2, shift, predicted)));
  }
  return networks;
}

// A tile's header, its seeds and their model. The hash grid's signs are the caller's.
struct SeedCoding {
  Header header;
  std::vector<int32_t> corner;
  std::vector<int8_t> log_size;
  AttributeModel model;
  TileSeeds seeds;

  SeedCoding(const nanobind::bytes &fields, const Array<const int32_t, 2> &corners,
             const Array<const int8_t, 1> &log_sizes, const Plan &plan, const NetworkArrays &networks,
             const std::string &isa)
      : header(decode_header(bytes_of(fields))), corner(copy(corners)), log_size(copy(log_sizes)),
        model(attribute_model(header.spec, plan_of(header.spec, plan), networks_of(header.spec, networks),
                              header.quality, header.family, choose_isa(isa))),
        seeds(header.spec.context, (require_seeds(corners, log_sizes), corner), log_size) {}

  static void require_seeds(const Array<const int32_t, 2> &corners, const Array<const int8_t, 1> &log_sizes) {
    require(has_shape(corners, log_sizes.shape(0), 2), "corner must be [N, 2], log_size [N]");
    require_cells(log_sizes);
  }
};

}  // namespace sgi
