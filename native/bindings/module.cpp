// The native module: arrays in, arrays out; no link against torch or numpy.
#include "bindings/bindings.hpp"

NB_MODULE(_native, m) {
  for (const auto bind : {bind_attributes, bind_base, bind_constants, bind_decoder, bind_errors, bind_fit, bind_header,
                          bind_image, bind_metrics, bind_model, bind_raster, bind_rdoq, bind_restoration,
                          bind_stream_reader, bind_residual, bind_symbol_coder, bind_texture_coding, bind_tile})
    bind(m);
}
