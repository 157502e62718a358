// Streams of sgicodec in GDAL: windows and overviews as the decoder renders them, from any file that GDAL opens.
#include <cpl_vsi.h>
#include <gdal_pam.h>
#include <sgi.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <new>
#include <vector>

#include "place.hpp"

namespace {

constexpr int kBlock = 256;

struct Source {
  struct CloseFile {
    void operator()(VSILFILE *file) const { VSIFCloseL(file); }
  };
  struct CloseStream {
    void operator()(sgi_stream *stream) const { sgi_close(stream); }
  };
  std::unique_ptr<VSILFILE, CloseFile> file;
  std::unique_ptr<sgi_stream, CloseStream> stream;  // which reads the file, and so goes first
  sgi_info info{};
  bool exact = false;
  Place place;

  const void *metadata(sgi_metadata kind, size_t *size) const {
    const void *bytes = nullptr;
    return sgi_get_metadata(stream.get(), kind, &bytes, size) == SGI_OK ? bytes : nullptr;
  }
};

int64_t read_file(void *user, uint64_t offset, void *buffer, size_t count) {
  VSILFILE *file = static_cast<VSILFILE *>(user);
  if (VSIFSeekL(file, offset, SEEK_SET) != 0) return -1;
  return int64_t(VSIFReadL(buffer, 1, count, file));
}

GDALDataType type_of(int sample) {
  return sample == SGI_SAMPLE_U8 ? GDT_Byte : sample == SGI_SAMPLE_U16 ? GDT_UInt16 : GDT_Float32;
}

GDALColorInterp colour_of(int layout, int band) {
  constexpr GDALColorInterp kGray[] = {GCI_GrayIndex, GCI_AlphaBand};
  constexpr GDALColorInterp kColours[] = {GCI_RedBand, GCI_GreenBand, GCI_BlueBand, GCI_AlphaBand};
  if (layout == SGI_LAYOUT_MULTI) return GCI_Undefined;
  return layout == SGI_LAYOUT_GRAY || layout == SGI_LAYOUT_GRAY_ALPHA ? kGray[band - 1] : kColours[band - 1];
}

// A level of a stream: the picture, whose overviews the other levels are, or one of those.
class Dataset final : public GDALPamDataset {
 public:
  Dataset(std::shared_ptr<Source> source, uint32_t level);

  static int identify(GDALOpenInfo *info);
  static GDALDataset *open(GDALOpenInfo *info);

#if GDAL_VERSION_NUM >= GDAL_COMPUTE_VERSION(3, 12, 0)
  CPLErr GetGeoTransform(GDALGeoTransform &transform) const override {
    return placed(transform.data()) ? CE_None : GDALPamDataset::GetGeoTransform(transform);
  }
#else
  CPLErr GetGeoTransform(double *transform) override {
    return placed(transform) ? CE_None : GDALPamDataset::GetGeoTransform(transform);
  }
#endif
  const OGRSpatialReference *GetSpatialRef() const override;
  // Fills samples [rows, columns, C] with a block.
  CPLErr draw(int column, int row, int columns, int rows, void *buffer);

  const Source &source() const { return *source_; }
  int overviews() const { return int(overviews_.size()); }
  Dataset *overview(int index) const { return overviews_[size_t(index)].get(); }

 private:
  void describe();
  // Fills the six numbers of a transform, if the stream has one.
  bool placed(double *transform) const;
  std::shared_ptr<Source> source_;
  std::vector<std::unique_ptr<Dataset>> overviews_;
};

class Band final : public GDALPamRasterBand {
 public:
  Band(Dataset *dataset, int band) {
    poDS = dataset;
    nBand = band;
    eDataType = type_of(dataset->source().info.sample);
    nBlockXSize = std::min(kBlock, dataset->GetRasterXSize());
    nBlockYSize = std::min(kBlock, dataset->GetRasterYSize());
  }

  double GetNoDataValue(int *found) override {
    const Source &source = owner().source();
    const bool has = source.info.has_nodata || source.place.nodata;
    if (!has) return GDALPamRasterBand::GetNoDataValue(found);
    if (found) *found = TRUE;
    return source.info.has_nodata ? source.info.nodata : *source.place.nodata;
  }
  GDALColorInterp GetColorInterpretation() override { return colour_of(owner().source().info.layout, nBand); }
  int GetOverviewCount() override { return owner().overviews(); }
  GDALRasterBand *GetOverview(int index) override {
    return index < 0 || index >= owner().overviews() ? nullptr : owner().overview(index)->GetRasterBand(nBand);
  }

 protected:
  CPLErr IReadBlock(int column, int row, void *data) override;

 private:
  Dataset &owner() const { return *static_cast<Dataset *>(poDS); }
};

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

Dataset::Dataset(std::shared_ptr<Source> source, uint32_t level) : source_(std::move(source)) {
  uint32_t width = 0, height = 0;
  sgi_get_level(source_->stream.get(), level, &width, &height);
  nRasterXSize = int(width);
  nRasterYSize = int(height);
  for (int band = 1; band <= int(source_->info.channels); ++band) SetBand(band, new Band(this, band));
  oMDMD.SetMetadataItem("INTERLEAVE", "PIXEL", "IMAGE_STRUCTURE");
  if (level) return;
  for (uint32_t next = 1; next < source_->info.levels; ++next)
    overviews_.push_back(std::make_unique<Dataset>(source_, next));
  describe();
}

// What travels with the stream, as the drivers of other formats tell it.
void Dataset::describe() {
  oMDMD.SetMetadata(source_->place.metadata.List());
  if (source_->place.rpc.Count()) oMDMD.SetMetadata(source_->place.rpc.List(), "RPC");
  oMDMD.SetMetadataItem("COMPRESSION", "SGICODEC", "IMAGE_STRUCTURE");
  size_t size = 0;
  if (const void *xmp = source_->metadata(SGI_METADATA_XMP, &size)) {
    const std::string text(static_cast<const char *>(xmp), size);
    char *domain[] = {const_cast<char *>(text.c_str()), nullptr};
    oMDMD.SetMetadata(domain, "xml:XMP");
  }
  if (const void *icc = source_->metadata(SGI_METADATA_ICC, &size)) {
    char *text = CPLBase64Encode(int(size), static_cast<const GByte *>(icc));
    oMDMD.SetMetadataItem("SOURCE_ICC_PROFILE", text, "COLOR_PROFILE");
    CPLFree(text);
  }
}

CPLErr Dataset::draw(int column, int row, int columns, int rows, void *buffer) {
  const sgi_info &info = source_->info;
  const double across = double(info.width) / nRasterXSize, down = double(info.height) / nRasterYSize;
  sgi_view view{};
  view.struct_size = sizeof view;
  view.x = column * across;
  view.y = row * down;
  // The last pixel ends where the picture does, whatever is lost by rounding.
  view.width = std::min(columns * across, info.width - view.x);
  view.height = std::min(rows * down, info.height - view.y);
  view.columns = uint32_t(columns);
  view.rows = uint32_t(rows);
  view.sample = info.sample;
  view.exact = source_->exact;
  const size_t stride = size_t(columns) * info.channels * GDALGetDataTypeSizeBytes(type_of(info.sample));
  if (sgi_draw(source_->stream.get(), &view, buffer, stride) == SGI_OK) return CE_None;
  CPLError(CE_Failure, CPLE_AppDefined, "%s", sgi_error());
  return CE_Failure;
}

bool Dataset::placed(double *transform) const {
  if (!source_->place.transform) return false;
  std::copy(source_->place.transform->begin(), source_->place.transform->end(), transform);
  return true;
}

const OGRSpatialReference *Dataset::GetSpatialRef() const {
  return source_->place.system.IsEmpty() ? GDALPamDataset::GetSpatialRef() : &source_->place.system;
}

int Dataset::identify(GDALOpenInfo *info) {
  return info->nHeaderBytes > 0 && sgi_is_stream(info->pabyHeader, size_t(info->nHeaderBytes));
}

GDALDataset *Dataset::open(GDALOpenInfo *info) {
  if (!identify(info) || !info->fpL) return nullptr;
  if (info->eAccess == GA_Update) {
    CPLError(CE_Failure, CPLE_NotSupported, "streams of sgicodec are read only");
    return nullptr;
  }
  auto source = std::make_shared<Source>();
  source->file.reset(info->fpL);
  info->fpL = nullptr;
  source->exact = CPLFetchBool(info->papszOpenOptions, "EXACT", false);
  VSILFILE *file = source->file.get();
  VSIFSeekL(file, 0, SEEK_END);
  sgi_stream *stream = nullptr;
  if (sgi_open(read_file, file, VSIFTellL(file), nullptr, &stream) != SGI_OK) {
    CPLError(CE_Failure, CPLE_OpenFailed, "%s: %s", info->pszFilename, sgi_error());
    return nullptr;
  }
  source->stream.reset(stream);
  source->info.struct_size = sizeof source->info;
  if (sgi_get_info(stream, &source->info) != SGI_OK) return nullptr;
  size_t size = 0;
  if (const void *tags = source->metadata(SGI_METADATA_PLACE, &size))
    source->place = place_of(static_cast<const uint8_t *>(tags), size);
  auto dataset = std::make_unique<Dataset>(std::move(source), 0);
  dataset->SetDescription(info->pszFilename);
  dataset->TryLoadXML();
  return dataset.release();
}

}  // namespace

extern "C" __attribute__((visibility("default"))) void GDALRegister_SGICODEC() {
  if (!GDAL_CHECK_VERSION("SGICODEC") || GDALGetDriverByName("SGICODEC")) return;
  auto driver = std::make_unique<GDALDriver>();
  driver->SetDescription("SGICODEC");
  driver->SetMetadataItem(GDAL_DCAP_RASTER, "YES");
  driver->SetMetadataItem(GDAL_DCAP_VIRTUALIO, "YES");
  driver->SetMetadataItem(GDAL_DMD_LONGNAME, "sgicodec: structured 2D Gaussians");
  driver->SetMetadataItem(GDAL_DMD_EXTENSION, "sgi");
  driver->SetMetadataItem(GDAL_DMD_MIMETYPE, "image/x-sgicodec");
  driver->SetMetadataItem(GDAL_DMD_OPENOPTIONLIST,
                          "<OpenOptionList><Option name='EXACT' type='boolean' default='NO' description='Render small "
                          "overviews from all that the stream holds'/></OpenOptionList>");
  driver->pfnIdentify = Dataset::identify;
  driver->pfnOpen = Dataset::open;
  GetGDALDriverManager()->RegisterDriver(driver.release());
}
