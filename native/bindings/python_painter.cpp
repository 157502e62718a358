#include "bindings/python_painter.hpp"

#include <nanobind/ndarray.h>

#include <initializer_list>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "bindings/held.hpp"
#include "model/texture_tables.hpp"

namespace nb = nanobind;

namespace sgi {
namespace {

// A numpy array of what somebody else holds, for as long as a call takes.
template <class T>
nb::object shown(const T *first, std::initializer_list<int64_t> sizes) {
  const std::vector<size_t> shape(sizes.begin(), sizes.end());
  const nb::ndarray<nb::numpy, const T> array(first, shape.size(), shape.data(), nb::handle());
  return nb::cast(array, nb::rv_policy::reference);
}

nb::dlpack::dtype type_of(const Samples &samples) {
  switch (samples.type) {
    case SampleType::u8: return nb::dtype<uint8_t>();
    case SampleType::u16: return nb::dtype<uint16_t>();
    default: return nb::dtype<float>();
  }
}

nb::object shown_samples(const Samples &samples, const View &view, int channels) {
  const size_t shape[] = {size_t(view.height), size_t(view.width), size_t(channels)};
  const int64_t strides[] = {samples.row_stride, channels, 1};
  const nb::ndarray<nb::numpy> array(samples.first, 3, shape, nb::handle(), strides, type_of(samples));
  return nb::cast(array, nb::rv_policy::reference);
}

// Lines, their places and weights, and planes; None for what is not there.
nb::object background_of(const Background &b, const View &view, int channels) {
  const nb::object none = nb::none();
  const nb::object planes = b.planes ? shown(b.planes, {channels, b.height, b.plane_width}) : none;
  if (!b.taps) return nb::make_tuple(none, none, none, planes);
  return nb::make_tuple(shown(b.lines, {channels, b.count, b.width}), shown(b.top, {view.height}),
                        shown(b.down, {view.height, b.taps}), planes);
}

nb::object shown_texture(const std::optional<TextureTables> &t) {
  if (!t) return nb::none();
  const auto all = [](const auto &values) { return shown(values.data(), {int64_t(values.size())}); };
  const nb::object mix = t->mix ? shown(t->mix, {9}) : nb::object(nb::none());
  return nb::make_tuple(shown(t->amplitudes, {t->amplitude_count}), all(t->across), all(t->down), all(t->cells),
                        all(t->start), all(t->shown), t->blocks_across, mix);
}

class PythonPainter : public Painter {
 public:
  explicit PythonPainter(nb::object painter)
      : most_channels_(nb::cast<int>(painter.attr("most_channels"))), painter_(std::move(painter)) {}

  int most_channels() const override { return most_channels_; }

  void draw(const Gaussians &g, const View &view, float cutoff, const Background &background,
            const TextureView *texture, const Samples &samples) override {
    std::optional<TextureTables> tables;
    if (texture) tables = texture_tables(texture->texture, texture->x, texture->y, texture->mix);
    if (texture && !tables) throw std::overflow_error("more texture than 32 bits count");
    const nb::gil_scoped_acquire lock;
    const nb::object mapping =
        samples.clip ? nb::object(nb::make_tuple(shown(samples.low, {g.channels}), shown(samples.span, {g.channels})))
                     : nb::object(nb::none());
    try {
      (*painter_).attr("paint")(shown(g.means, {g.count, 2}), shown(g.covariances, {g.count, 3}),
                                shown(g.colours, {g.count, g.channels}), shown_samples(samples, view, g.channels),
                                nb::make_tuple(view.x0, view.y0), cutoff, background_of(background, view, g.channels),
                                shown_texture(tables), mapping);
    } catch (const nb::python_error &error) {
      if (error.matches(PyExc_OverflowError)) throw std::overflow_error(error.what());
      throw;
    }
  }

 private:
  const int most_channels_;
  const Held painter_;
};

}  // namespace

std::shared_ptr<Painter> python_painter(nb::object painter) {
  return std::make_shared<PythonPainter>(std::move(painter));
}

}  // namespace sgi
