// The native module: arrays in, arrays out; no link against torch or numpy.
#include <nanobind/nanobind.h>

#include "../../bitstream/cpp/bind_bitstream.hpp"
#include "../../fit/cpp/bind_seed_fit.hpp"
#include "../../image/cpp/bind_image.hpp"
#include "../../model/cpp/bind_model.hpp"
#include "../../refine/cpp/bind_refine.hpp"
#include "bind_raster.hpp"

NB_MODULE(_native, m) {
  bind_bitstream(m);
  bind_image(m);
  bind_model(m);
  bind_raster(m);
  bind_refine(m);
  bind_seed_fit(m);
}
