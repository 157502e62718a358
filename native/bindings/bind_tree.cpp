#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <tuple>

#include "bindings/bindings.hpp"
#include "bindings/trees.hpp"
#include "bitstream/given_tree.hpp"
#include "bitstream/position_flags.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using sgi::Array;
using sgi::as_array;
using sgi::GivenTree;
using sgi::require;
using sgi::TreeBatch;

namespace {

using Corners = Array<const int32_t, 2>;
using LogSizes = Array<const int8_t, 1>;

template <class T>
auto flat(std::vector<T> values) {
  const std::array shape{values.size()};
  return as_array<T>(std::move(values), shape);
}

GivenTree given_tree(const sgi::TreeScenery &scenery, const Corners &corner, const LogSizes &log_size) {
  require(sgi::has_shape(corner, log_size.shape(0), 2), "corner must be [N, 2], log_size [N]");
  return {scenery, corner.data(), log_size.data(), int64_t(log_size.shape(0))};
}

auto position_flags(std::pair<int64_t, int64_t> size, const sgi::BaseLayer &base, int64_t cell, int quality,
                    const Corners &corner, const LogSizes &log_size, int threads, const std::string &isa) {
  const sgi::TreeScenery scenery = sgi::scenery_of(size, base, cell, quality);
  const GivenTree tree = given_tree(scenery, corner, log_size);
  std::vector<std::tuple<decltype(flat<uint8_t>({})), decltype(flat<int16_t>({}))>> found;
  sgi::code_flags(scenery, tree.count(), threads, sgi::choose_isa(isa),
                  [&](const TreeBatch &batch, bool is_split, const std::vector<int16_t> &rows, uint8_t *flags) {
                    tree.fill(batch, is_split, flags);
                    found.emplace_back(flat(std::vector<uint8_t>(flags, flags + rows.size())), flat(rows));
                  });
  return found;
}

auto tree_examples(std::pair<int64_t, int64_t> size, const sgi::BaseLayer &base, int64_t cell, int quality,
                   const Corners &corner, const LogSizes &log_size, int child) {
  const sgi::TreeScenery scenery = sgi::scenery_of(size, base, cell, quality);
  const GivenTree tree = given_tree(scenery, corner, log_size);
  std::vector<std::tuple<int, decltype(as_array<int16_t>({}, std::array<size_t, 2>{})), decltype(flat<uint8_t>({})),
                         decltype(flat<uint8_t>({})), decltype(flat<uint8_t>({}))>>
      found;
  sgi::walk_tree(scenery, tree.count(), [&](const TreeBatch &batch, uint8_t *split, uint8_t *seed) {
    tree.fill(batch, true, split), tree.fill(batch, false, seed);
    if (batch.child != child) return;
    const std::array shape{batch.members.size(), size_t(sgi::tree_input_count(child))};
    std::vector<int16_t> inputs(shape[0] * shape[1]);
    batch.inputs(inputs.data());
    found.emplace_back(batch.of.level(), as_array<int16_t>(std::move(inputs), shape),
                       flat(std::vector<uint8_t>(split, split + shape[0])),
                       flat(std::vector<uint8_t>(seed, seed + shape[0])), flat(batch.needed));
  });
  return found;
}

auto flag_frequencies() {
  std::vector<int64_t> frequencies = sgi::flag_frequencies();
  const std::array shape{frequencies.size() / 2, size_t(2)};
  return as_array<int64_t>(std::move(frequencies), shape);
}

}  // namespace

void bind_tree(nb::module_ &m) {
  m.def("flag_frequencies", &flag_frequencies, "Frequencies [rows, 2] of the flags of a tree of seeds.");
  m.def("position_flags", &position_flags, "size"_a, "base"_a, "cell"_a, "quality"_a, "corner"_a, "log_size"_a,
        "threads"_a, "isa"_a,
        "The flags of the tree of these seeds and the rows of their frequencies, in groups as they are coded.");
  m.def("tree_examples", &tree_examples, "size"_a, "base"_a, "cell"_a, "quality"_a, "corner"_a, "log_size"_a, "child"_a,
        "Of each level's nodes of a child number: the level, what a prediction sees [n, inputs] in 1/64, which are\n"
        "split and which carry seeds, and which must not be empty.");
}
