// Python bindings: one file for each part of the native code, all bound by module.cpp.
#pragma once
#include <nanobind/nanobind.h>

void bind_attributes(nanobind::module_ &m);
void bind_base(nanobind::module_ &m);
void bind_constants(nanobind::module_ &m);
void bind_decoder(nanobind::module_ &m);
void bind_errors(nanobind::module_ &m);
void bind_fit(nanobind::module_ &m);
void bind_header(nanobind::module_ &m);
void bind_image(nanobind::module_ &m);
void bind_metrics(nanobind::module_ &m);
void bind_model(nanobind::module_ &m);
void bind_raster(nanobind::module_ &m);
void bind_rdoq(nanobind::module_ &m);
void bind_stream_reader(nanobind::module_ &m);
void bind_symbol_coder(nanobind::module_ &m);
void bind_restoration(nanobind::module_ &m);
void bind_residual(nanobind::module_ &m);
void bind_texture_coding(nanobind::module_ &m);
void bind_tile(nanobind::module_ &m);
