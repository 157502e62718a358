#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <memory>

#include "bindings/bindings.hpp"
#include "bindings/checks.hpp"
#include "bitstream/tree_walk.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using sgi::Array;
using sgi::as_array;
using sgi::has_shape;
using sgi::require;
using sgi::TreeBatch;

namespace {

using Scenery = std::shared_ptr<sgi::TreeScenery>;

// The network of one child number, made ready once.
class TreeNetwork {
 public:
  TreeNetwork(Array<const int64_t, 2> w1, Array<const int64_t, 1> b1, Array<const int64_t, 2> w2,
              Array<const int64_t, 1> b2, int shift, int child, const std::string &isa)
      : child_(child), network_(weights(w1, b1, w2, b2, shift, child), sgi::choose_isa(isa)) {}

  // Rows [n, 3] of a batch.
  void rows(const TreeBatch &batch, int shift, int most, int threads, int16_t *out) const {
    require(batch.child == child_, "the network is that of another child number");
    batch.rows(network_, shift, most, threads, out);
  }

 private:
  static sgi::NetworkWeights weights(const Array<const int64_t, 2> &w1, const Array<const int64_t, 1> &b1,
                                     const Array<const int64_t, 2> &w2, const Array<const int64_t, 1> &b2, int shift,
                                     int child) {
    require(child >= 0 && child < 4 && w1.shape(1) == size_t(sgi::tree_input_count(child)),
            "w1 must be [hidden, inputs]");
    require(w2.shape(0) == kOutputs, "weights must be those of 3 outputs");
    return sgi::network_weights(w1, b1, w2, b2, shift, kOutputs);
  }

  static constexpr int kOutputs = 3;

  int child_;
  sgi::Network network_;
};

void make_scenery(sgi::TreeScenery *self, int64_t width, int64_t height, Array<const int64_t, 3> base, int64_t cell,
                  int quality) {
  require(width >= 1 && height >= 1 && width <= 1 << 24 && height <= 1 << 24 && cell >= 0,
          "sides 1..2**24, cell from 0");
  const auto channels = int64_t(base.shape(0)), rows = int64_t(base.shape(1)), columns = int64_t(base.shape(2));
  new (self) sgi::TreeScenery(width, height, base.data(), channels, rows, columns, cell, quality);
}

using Codes = nb::ndarray<nb::numpy, int64_t, nb::ndim<1>>;

Codes codes(const TreeBatch &batch) {
  std::vector<int64_t> codes;
  for (const int32_t parent : batch.members) codes.push_back(batch.of->code(parent, batch.child));
  const size_t n = codes.size();
  return as_array<int64_t>(std::move(codes), std::array{n});
}

auto inputs(const TreeBatch &batch) {
  const std::array shape{batch.members.size(), size_t(sgi::tree_input_count(batch.child))};
  std::vector<int16_t> out(shape[0] * shape[1]);
  batch.inputs(out.data());
  return as_array<int16_t>(std::move(out), shape);
}

auto rows(const TreeBatch &batch, const TreeNetwork &network, int shift, int most, int threads) {
  require(shift >= 1 && shift <= 20 && most >= 0 && most <= 1 << 13, "shift 1..20, most 0..2^13");
  const std::array<size_t, 2> shape{batch.members.size(), 3};
  std::vector<int16_t> out(shape[0] * shape[1]);
  network.rows(batch, shift, most, threads, out.data());
  return as_array<int16_t>(std::move(out), shape);
}

auto seed_rows(const TreeBatch &batch, Array<const int16_t, 2> rows, Array<const uint8_t, 1> split, int16_t certain) {
  const size_t n = batch.members.size();
  require(has_shape(rows, n, 3) && split.shape(0) == n, "rows [n, 3], split [n]");
  std::vector<int16_t> out(n);
  batch.seed_rows(rows.data(), split.data(), certain, out.data());
  return as_array<int16_t>(std::move(out), std::array{n});
}

using Flags = Array<const uint8_t, 1>;

void walk_tree(Scenery scenery, int64_t most, const nb::typed<nb::callable, std::pair<Flags, Flags>(TreeBatch)> &code) {
  std::vector<sgi::LevelSeeds> found;
  const auto ask = [&](const TreeBatch &batch, uint8_t *split, uint8_t *seed) {
    const auto flags = nb::cast<std::pair<Flags, Flags>>(code(TreeBatch(batch)));
    for (const auto &[given, to] : {std::pair{&flags.first, split}, std::pair{&flags.second, seed}}) {
      require(int64_t(given->shape(0)) == batch.size(), "flags must be [n]");
      for (size_t i = 0; i < given->shape(0); ++i) {
        require(given->data()[i] <= 1, "flags must be 0 or 1");
        to[i] = given->data()[i];
      }
    }
    return true;
  };
  sgi::walk_tree(scenery, most, ask, found);
}

}  // namespace

void bind_tree(nb::module_ &m) {
  m.def("tree_input_count", &sgi::tree_input_count, "child"_a);
  using Weights = Array<const int64_t, 2>;
  using Biases = Array<const int64_t, 1>;
  nb::class_<TreeNetwork>(m, "TreeNetwork")
      .def(nb::init<Weights, Biases, Weights, Biases, int, int, const std::string &>(), "w1"_a, "b1"_a, "w2"_a, "b2"_a,
           "shift"_a, "child"_a, "isa"_a);
  nb::class_<sgi::TreeScenery>(m, "TreeScenery")
      .def("__init__", &make_scenery, "width"_a, "height"_a, "base"_a, "cell"_a, "quality"_a);
  nb::class_<TreeBatch>(m, "TreeBatch", "Nodes of one level and child number that are coded together.")
      .def_prop_ro("level", [](const TreeBatch &batch) { return batch.of->level(); })
      .def_ro("child", &TreeBatch::child)
      .def("__len__", &TreeBatch::size)
      .def_prop_ro(
          "needed",
          [](const TreeBatch &batch) { return as_array<uint8_t, bool>(batch.needed, std::array{batch.needed.size()}); },
          nb::rv_policy::move,
          "Which [n] must not be empty, being the last of their parent's children where the others are.")
      .def_prop_ro("codes", &codes, nb::rv_policy::move, "Morton codes [n] at their level.")
      .def_prop_ro("inputs", &inputs, nb::rv_policy::move, "What a prediction sees [n, inputs], in 1/64.")
      .def("rows", &rows, "network"_a, "shift"_a, "most"_a, "threads"_a,
           "What the network of this child number says [n, 3]: log-odds in units of 2^(shift - 8), clipped to ±most\n"
           "and moved by `most`.")
      .def("seed_rows", &seed_rows, "rows"_a, "split"_a, "certain"_a,
           "The row of every seed flag [n]: `certain` where it is needed.");
  m.def("walk_tree", &walk_tree, "scenery"_a, "max_seeds"_a, "code"_a);
}
