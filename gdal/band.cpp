#include "band.hpp"

#include <algorithm>
#include <new>

namespace {

constexpr int kBlock = 256;

// What a stream states, or else a file of GDAL's beside it.
template <class Else>
double stated(const std::optional<double> &value, int *found, const Else &other) {
  if (!value) return other();
  if (found) *found = TRUE;
  return *value;
}

}  // namespace

Band::Band(Dataset *dataset, int band) {
  poDS = dataset;
  nBand = band;
  eDataType = dataset->source().type();
  nBlockXSize = std::min(kBlock, dataset->GetRasterXSize());
  nBlockYSize = std::min(kBlock, dataset->GetRasterYSize());
  GDALMajorObject::SetDescription(described().description.c_str());
  for (const auto &[domain, items] : described().domains) {
    CPLStringList copy(items);
    oMDMD.SetMetadata(copy.List(), domain.c_str());
  }
}

// Alpha is never nodata: samples of 0 in it are what they are.
double Band::GetNoDataValue(int *found) {
  const Source &source = owner().source();
  std::optional<double> nodata = described().nodata;
  if (source.info.has_nodata) nodata = source.info.nodata;
  if (source.layout().has_alpha && nBand == int(source.info.channels)) nodata.reset();
  return stated(nodata, found, [&] { return GDALPamRasterBand::GetNoDataValue(found); });
}

double Band::GetScale(int *found) {
  return stated(described().scale, found, [&] { return GDALPamRasterBand::GetScale(found); });
}

double Band::GetOffset(int *found) {
  return stated(described().offset, found, [&] { return GDALPamRasterBand::GetOffset(found); });
}

const char *Band::GetUnitType() {
  return described().unit.empty() ? GDALPamRasterBand::GetUnitType() : described().unit.c_str();
}

// All bands of a block are drawn at once: those of the others go to GDAL's cache.
CPLErr Band::IReadBlock(int column, int row, void *data) {
  const int columns = std::min(nBlockXSize, nRasterXSize - column * nBlockXSize);
  const int rows = std::min(nBlockYSize, nRasterYSize - row * nBlockYSize);
  const int bands = poDS->GetRasterCount(), bytes = GDALGetDataTypeSizeBytes(eDataType);
  std::vector<uint8_t> samples;
  try {
    samples.resize(size_t(columns) * rows * bands * bytes);
  } catch (const std::bad_alloc &) {
    CPLError(CE_Failure, CPLE_OutOfMemory, "there is no memory for a block of %d bands", bands);
    return CE_Failure;
  }
  if (owner().draw(column * nBlockXSize, row * nBlockYSize, columns, rows, samples.data()) != CE_None)
    return CE_Failure;
  const auto copy = [&](int band, void *block) {
    for (int y = 0; y < rows; ++y)
      GDALCopyWords64(samples.data() + (size_t(y) * columns * bands + band - 1) * bytes, eDataType, bands * bytes,
                      static_cast<uint8_t *>(block) + size_t(y) * nBlockXSize * bytes, eDataType, bytes, columns);
  };
  copy(nBand, data);
  for (int band = 1; band <= bands; ++band) {
    if (band == nBand) continue;
    GDALRasterBand *other = poDS->GetRasterBand(band);
    if (GDALRasterBlock *known = other->TryGetLockedBlockRef(column, row)) {
      known->DropLock();
    } else if (GDALRasterBlock *block = other->GetLockedBlockRef(column, row, TRUE)) {
      copy(band, block->GetDataRef());
      block->DropLock();
    }
  }
  return CE_None;
}
