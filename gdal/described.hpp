// What travels with a stream besides its samples, as GDAL's own reader of GeoTIFF understands it.
#pragma once
#include <cpl_string.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tags.hpp"

using Domains = std::map<std::string, CPLStringList>;  // of metadata, by their names

struct DescribedBand {
  std::string description, unit;
  std::optional<double> nodata, scale, offset;
  GDALColorInterp colour = GCI_Undefined;
  Domains domains;
};

struct Described {
  std::optional<std::array<double, 6>> transform;
  OGRSpatialReference system;
  std::shared_ptr<GDAL_GCP> points;  // of the ground, `point_count`
  int point_count = 0;
  OGRSpatialReference system_of_points;
  Domains domains;
  std::vector<DescribedBand> bands;
};

struct Tags {
  const void *bytes;
  size_t size;
};

// Of tags of TIFF: where the picture lies and what its samples mean, and EXIF. Nothing of damaged ones; statistics of
// samples, which are not these any more, are left out.
Described described_by(Tags place, Tags exif, const Layout &layout);
