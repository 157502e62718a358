#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

#include "../../raster/cpp/binding.hpp"
#include "bind_bitstream.hpp"
#include "tree_inputs.hpp"

namespace nb = nanobind;
using sgi::Array;
using sgi::has_shape;
using sgi::require;

namespace {

using SplitNodes =
    std::tuple<Array<const int32_t, 1>, Array<const int32_t, 1>, Array<const int32_t, 2>, Array<const int16_t, 2>>;
using Slots = std::tuple<Array<const uint8_t, 2>, Array<const int16_t, 3>>;

sgi::SplitNodes checked(const SplitNodes &nodes) {
  const auto &[x, y, neighbour, above] = nodes;
  const size_t count = x.shape(0);
  require(count < (size_t(1) << 28) && y.shape(0) == count && has_shape(neighbour, count, sgi::kSides) &&
              has_shape(above, count, sgi::kAbove),
          "x, y [P]; neighbour [P, 8]; above [P, 31]");
  for (size_t i = 0; i < neighbour.size(); ++i)
    require(neighbour.data()[i] >= 0 && size_t(neighbour.data()[i]) <= count, "neighbours must be indices, or P");
  return {x.data(), y.data(), neighbour.data(), above.data(), int64_t(count)};
}

sgi::Slots checked(const Slots &slots, int64_t count) {
  const auto &[exists, flags] = slots;
  require(has_shape(exists, size_t(count) + 1, 4) && has_shape(flags, size_t(count) + 1, 4) && flags.shape(2) == 2,
          "exists [P + 1, 4], flags [P + 1, 4, 2]");
  return {exists.data(), flags.data()};
}

void base_detail(Array<const int64_t, 3> base, Array<int16_t, 3> out) {
  require(out.shape(0) == base.shape(1) && out.shape(1) == base.shape(2) && out.shape(2) == sgi::kDetail,
          "out must be [rows, columns, 5]");
  nb::gil_scoped_release release;
  sgi::base_detail(base.data(), int64_t(base.shape(0)), int64_t(base.shape(1)), int64_t(base.shape(2)), out.data());
}

sgi::BaseDetail checked(const Array<const int16_t, 3> &detail, int cell) {
  require(detail.shape(2) == sgi::kDetail && cell >= 1, "detail [rows, columns, 5]; cell from 1");
  return {detail.size() ? detail.data() : nullptr, int64_t(detail.shape(0)), int64_t(detail.shape(1)), cell};
}

void check_batch(const Array<const int16_t, 1> &head, int level, int child, const Array<const int32_t, 1> &members,
                 int64_t count) {
  require(child >= 0 && child < 4 && level >= 0 && level <= 16, "child 0..3, level 0..16");
  require(head.shape(0) == sgi::kHead, "head [11]");
  for (size_t i = 0; i < members.size(); ++i)
    require(members.data()[i] >= 0 && members.data()[i] < count, "members must be indices");
}

void tree_inputs(const SplitNodes &nodes, const Slots &states, Array<const int16_t, 3> detail, int cell,
                 Array<const int16_t, 1> head, int level, int child, Array<const int32_t, 1> members,
                 Array<int16_t, 2> out) {
  const sgi::SplitNodes parents = checked(nodes);
  const sgi::Slots slots = checked(states, parents.count);
  const sgi::BaseDetail base = checked(detail, cell);
  check_batch(head, level, child, members, parents.count);
  require(has_shape(out, members.shape(0), size_t(sgi::tree_input_count(child))), "out must be [n, inputs]");
  sgi::tree_inputs(parents, slots, base, head.data(), level, child, members.data(), int64_t(members.shape(0)),
                   out.data());
}

// The network of one child number, made ready once.
class TreeNetwork {
 public:
  TreeNetwork(Array<const int64_t, 2> w1, Array<const int64_t, 1> b1, Array<const int64_t, 2> w2,
              Array<const int64_t, 1> b2, int shift, int child, const std::string &isa)
      : child_(child), network_(weights(w1, b1, w2, b2, shift, child), isa) {}

  void rows(const SplitNodes &nodes, const Slots &states, Array<const int16_t, 3> detail, int cell,
            Array<const int16_t, 1> head, int level, Array<const int32_t, 1> members, int shift, int most, int threads,
            Array<int16_t, 2> out) const {
    const sgi::SplitNodes parents = checked(nodes);
    const sgi::Slots slots = checked(states, parents.count);
    const sgi::BaseDetail base = checked(detail, cell);
    check_batch(head, level, child_, members, parents.count);
    require(has_shape(out, members.shape(0), size_t(network_.outputs())), "out must be [n, outputs]");
    require(shift >= 1 && shift <= 20 && most >= 0 && most <= 1 << 13, "shift 1..20, most 0..2^13");
    nb::gil_scoped_release release;
    sgi::tree_rows(network_, parents, slots, base, head.data(), level, child_, members.data(),
                   int64_t(members.shape(0)), shift, most, threads, out.data());
  }

 private:
  static sgi::NetworkWeights weights(const Array<const int64_t, 2> &w1, const Array<const int64_t, 1> &b1,
                                     const Array<const int64_t, 2> &w2, const Array<const int64_t, 1> &b2, int shift,
                                     int child) {
    const size_t hidden = w1.shape(0), outputs = w2.shape(0);
    require(child >= 0 && child < 4 && w1.shape(1) == size_t(sgi::tree_input_count(child)), "w1 must be [hidden, inputs]");
    require(b1.shape(0) == hidden && w2.shape(1) == hidden && b2.shape(0) == outputs, "weights do not fit each other");
    require(shift >= 2 && shift <= 20, "shift must be 2..20");
    return {w1.data(),   b1.data(),    w2.data(),    b2.data(), int(w1.shape(1)),
            int(hidden), int(outputs), int(outputs), shift};
  }

  int child_;
  sgi::Network network_;
};

void children_inside(const SplitNodes &nodes, int level, int64_t width, int64_t height, Array<uint8_t, 2> exists) {
  const sgi::SplitNodes parents = checked(nodes);
  require(level >= 0 && level <= 16 && has_shape(exists, size_t(parents.count) + 1, 4), "exists must be [P + 1, 4]");
  sgi::children_inside(parents, level, width, height, exists.data());
}

int64_t begin_batch(Array<const uint8_t, 2> exists, Array<const uint8_t, 1> occupied, int child,
                    Array<int32_t, 1> members, Array<uint8_t, 1> needed) {
  const size_t count = occupied.shape(0);
  require(child >= 0 && child < 4 && has_shape(exists, count + 1, 4), "child 0..3, exists [P + 1, 4]");
  require(members.shape(0) == count + 1 && needed.shape(0) == count + 1, "members and needed have room for P + 1");
  return sgi::begin_batch(int64_t(count), exists.data(), occupied.data(), child, members.data(), needed.data());
}

void end_batch(Array<const int32_t, 1> members, int child, Array<const uint8_t, 1> split_flags,
               Array<const uint8_t, 1> seed_flags, Array<int16_t, 3> flags, Array<uint8_t, 1> occupied) {
  const size_t n = members.shape(0), count = occupied.shape(0);
  require(child >= 0 && child < 4 && split_flags.shape(0) == n && seed_flags.shape(0) == n &&
              has_shape(flags, count + 1, 4) && flags.shape(2) == 2,
          "flags [n]; of all slots [P + 1, 4, 2]");
  for (size_t i = 0; i < n; ++i)
    require(members.data()[i] >= 0 && size_t(members.data()[i]) < count, "members must be indices");
  sgi::end_batch(members.data(), int64_t(n), child, split_flags.data(), seed_flags.data(), flags.data(),
                 occupied.data());
}

void split_children(const SplitNodes &nodes, const Slots &states, Array<const int32_t, 1> found,
                    Array<int32_t, 2> number, Array<int32_t, 1> x, Array<int32_t, 1> y, Array<int32_t, 2> neighbour,
                    Array<int16_t, 2> above) {
  const sgi::SplitNodes parents = checked(nodes);
  const sgi::Slots slots = checked(states, parents.count);
  const size_t m = found.shape(0);
  require(has_shape(number, size_t(parents.count) + 1, 4) && x.shape(0) == m && y.shape(0) == m &&
              has_shape(neighbour, m, sgi::kSides) && has_shape(above, m, sgi::kAbove),
          "outputs must be as of split nodes");
  for (size_t i = 0; i < m; ++i)
    require(found.data()[i] >= 0 && found.data()[i] < 4 * parents.count, "found must be slots");
  nb::gil_scoped_release release;
  sgi::split_children(parents, slots, found.data(), int64_t(m), number.data(), x.data(), y.data(), neighbour.data(),
                      above.data());
}

}  // namespace

void bind_tree(nb::module_ &m) {
  m.def("tree_input_count", &sgi::tree_input_count);
  m.def("base_detail", &base_detail);
  m.def("children_inside", &children_inside);
  m.def("begin_batch", &begin_batch);
  m.def("end_batch", &end_batch);
  m.def("tree_inputs", &tree_inputs);
  m.def("split_children", &split_children);
  using Weights = Array<const int64_t, 2>;
  using Biases = Array<const int64_t, 1>;
  nb::class_<TreeNetwork>(m, "TreeNetwork")
      .def(nb::init<Weights, Biases, Weights, Biases, int, int, const std::string &>())
      .def("rows", &TreeNetwork::rows);
}
