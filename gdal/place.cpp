#include "place.hpp"

#include <cpl_error.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

namespace {

constexpr size_t kHead = 10, kRow = 12;

struct Row {
  uint8_t bytes[kRow];
  uint16_t tag() const { return uint16_t(bytes[0] | bytes[1] << 8); }
};

void put(uint8_t *at, uint32_t value, int bytes) {
  for (int index = 0; index < bytes; ++index) at[index] = uint8_t(value >> 8 * index);
}

Row row_of(uint16_t tag, uint16_t type, uint32_t value) {
  Row row{};
  put(row.bytes, tag, 2);
  put(row.bytes + 2, type, 2);
  put(row.bytes + 4, 1, 4);
  put(row.bytes + 8, value, 4);
  return row;
}

// The tags as those of a picture of one black pixel, or nothing. Values stay where they are: a new directory comes
// last.
std::vector<uint8_t> as_tiff(const uint8_t *tags, size_t size) {
  if (size < kHead || std::memcmp(tags, "II*\0\x08\0\0\0", 8) != 0) return {};
  const size_t count = tags[8] | tags[9] << 8;
  if (size < kHead + kRow * count || size > (1 << 28)) return {};
  std::vector<Row> rows(count);
  if (count) std::memcpy(rows.data(), tags + kHead, kRow * count);
  const uint32_t pixel = uint32_t(size + size % 2), directory = pixel + 2;
  constexpr uint16_t kShort = 3, kLong = 4;
  rows.insert(rows.end(), {row_of(256, kShort, 1), row_of(257, kShort, 1), row_of(258, kShort, 8),
                           row_of(259, kShort, 1), row_of(262, kShort, 1), row_of(273, kLong, pixel),
                           row_of(277, kShort, 1), row_of(278, kShort, 1), row_of(279, kShort, 1)});
  std::stable_sort(rows.begin(), rows.end(), [](const Row &a, const Row &b) { return a.tag() < b.tag(); });
  std::vector<uint8_t> tiff(tags, tags + size);
  tiff.resize(directory + 2 + kRow * rows.size() + 4);
  put(tiff.data() + 4, directory, 4);
  put(tiff.data() + directory, uint32_t(rows.size()), 2);
  std::memcpy(tiff.data() + directory + 2, rows.data(), kRow * rows.size());
  return tiff;
}

}  // namespace

Place place_of(const uint8_t *tags, size_t size) {
  Place place;
  std::vector<uint8_t> tiff = as_tiff(tags, size);
  if (tiff.empty()) return place;
  const std::string name = CPLSPrintf("/vsimem/sgicodec-%p.tif", static_cast<const void *>(tiff.data()));
  VSIFCloseL(VSIFileFromMemBuffer(name.c_str(), tiff.data(), tiff.size(), FALSE));
  {
    CPLErrorHandlerPusher quiet(CPLQuietErrorHandler);
    const char *drivers[] = {"GTiff", nullptr};
    GDALDatasetUniquePtr file(GDALDataset::Open(name.c_str(), GDAL_OF_RASTER | GDAL_OF_INTERNAL, drivers));
    if (file) {
      std::array<double, 6> transform;
      if (file->GetGeoTransform(transform.data()) == CE_None) place.transform = transform;
      if (const OGRSpatialReference *system = file->GetSpatialRef()) place.system = *system;
      int found = 0;
      const double nodata = file->GetRasterBand(1)->GetNoDataValue(&found);
      if (found) place.nodata = nodata;
      place.metadata = CPLStringList(CSLDuplicate(file->GetMetadata()), TRUE);
      place.rpc = CPLStringList(CSLDuplicate(file->GetMetadata("RPC")), TRUE);
    }
  }
  CPLErrorReset();
  VSIUnlink(name.c_str());
  return place;
}
