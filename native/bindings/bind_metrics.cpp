#include <nanobind/stl/string.h>

#include "bindings/arrays.hpp"
#include "bindings/bindings.hpp"
#include "metrics/visual_reference.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using sgi::Array;
using sgi::require;

namespace {

sgi::SrgbPicture shape_of(const Array<const float, 3> &picture) {
  return {picture.data(), int(picture.shape(0)), int64_t(picture.shape(1)), int64_t(picture.shape(2))};
}

// A reference, and the shape that decoded pictures must have.
class VisualReference {
 public:
  VisualReference(Array<const float, 3> original, int threads, const std::string &isa)
      : reference_(shape_of(original), threads, sgi::choose_isa(isa)),
        shape_{original.shape(0), original.shape(1), original.shape(2)} {}

  double score(Array<const float, 3> decoded) const {
    require_shape(decoded);
    nb::gil_scoped_release release;
    return reference_.score(decoded.data());
  }
  double gradient(Array<const float, 3> decoded, Array<float, 3> out) const {
    require_shape(decoded);
    require_shape(out);
    nb::gil_scoped_release release;
    return reference_.gradient(decoded.data(), out.data());
  }

 private:
  template <class A>
  void require_shape(const A &array) const {
    for (size_t i = 0; i < 3; ++i) require(array.shape(i) == shape_[i], "a picture has not the original's shape");
  }

  sgi::VisualReference reference_;
  size_t shape_[3];
};

}  // namespace

void bind_metrics(nb::module_ &m) {
  nb::class_<VisualReference>(m, "VisualReference")
      .def(nb::init<Array<const float, 3>, int, const std::string &>(), "original"_a, "threads"_a, "isa"_a)
      .def("score", &VisualReference::score, "decoded"_a)
      .def("gradient", &VisualReference::gradient, "decoded"_a, "out"_a);
}
