// Where a picture lies, by the tags of TIFF that travel with a stream.
#pragma once
#include <cpl_string.h>
#include <ogr_spatialref.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

struct Place {
  std::optional<std::array<double, 6>> transform;
  OGRSpatialReference system;
  std::optional<double> nodata;
  CPLStringList metadata, rpc;
};

// What GDAL's own reader of GeoTIFF makes of the tags; nothing of damaged ones.
Place place_of(const uint8_t *tags, size_t size);
