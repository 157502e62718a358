#include "dataset.hpp"

#include <algorithm>

#include "band.hpp"

Dataset::Dataset(std::shared_ptr<Source> source, uint32_t level) : source_(std::move(source)), level_(level) {
  uint32_t width = 0, height = 0;
  sgi_get_level(source_->stream.get(), level, &width, &height);
  nRasterXSize = int(width);
  nRasterYSize = int(height);
  for (int band = 1; band <= int(source_->info.channels); ++band) SetBand(band, new Band(this, band));
  oMDMD.SetMetadataItem("INTERLEAVE", "PIXEL", "IMAGE_STRUCTURE");
  oMDMD.SetMetadataItem("COMPRESSION", "SGICODEC", "IMAGE_STRUCTURE");
  double error = -1;
  const bool is_exact = !level && sgi_get_max_error(source_->stream.get(), &error) == SGI_OK && error == 0;
  oMDMD.SetMetadataItem("COMPRESSION_REVERSIBILITY", is_exact ? "LOSSLESS" : "LOSSY", "IMAGE_STRUCTURE");
  if (level) return;
  for (uint32_t next = 1; next < source_->info.levels; ++next)
    overviews_.push_back(std::make_unique<Dataset>(source_, next));
  describe();
}

// What travels with the stream, as the drivers of other formats tell it.
void Dataset::describe() {
  for (const auto &[domain, items] : source_->described.domains) {
    CPLStringList copy(items);
    oMDMD.SetMetadata(copy.List(), domain.c_str());
  }
  if (const Tags xmp = source_->metadata(SGI_METADATA_XMP); xmp.bytes) {
    const std::string text(static_cast<const char *>(xmp.bytes), xmp.size);
    char *domain[] = {const_cast<char *>(text.c_str()), nullptr};
    oMDMD.SetMetadata(domain, "xml:XMP");
  }
  if (const Tags icc = source_->metadata(SGI_METADATA_ICC); icc.bytes) {
    char *text = CPLBase64Encode(int(icc.size), static_cast<const GByte *>(icc.bytes));
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
  const size_t stride = size_t(columns) * info.channels * GDALGetDataTypeSizeBytes(source_->type());
  if (sgi_draw(source_->stream.get(), &view, buffer, stride) == SGI_OK) return CE_None;
  CPLError(CE_Failure, CPLE_AppDefined, "%s", sgi_error());
  return CE_Failure;
}

bool Dataset::placed(double *transform) const {
  const auto &found = source_->described.transform;
  if (level_ || !found) return false;
  std::copy(found->begin(), found->end(), transform);
  return true;
}

const OGRSpatialReference *Dataset::GetSpatialRef() const {
  const OGRSpatialReference &system = source_->described.system;
  return system.IsEmpty() ? GDALPamDataset::GetSpatialRef() : &system;
}

int Dataset::GetGCPCount() { return has_points() ? source_->described.point_count : GDALPamDataset::GetGCPCount(); }

const GDAL_GCP *Dataset::GetGCPs() {
  return has_points() ? source_->described.points.get() : GDALPamDataset::GetGCPs();
}

const OGRSpatialReference *Dataset::GetGCPSpatialRef() const {
  return has_points() ? &source_->described.system_of_points : GDALPamDataset::GetGCPSpatialRef();
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
  VSILFILE *file = info->fpL;
  info->fpL = nullptr;
  const std::shared_ptr<Source> source = open_source(info->pszFilename, file);
  if (!source) return nullptr;
  source->exact = CPLFetchBool(info->papszOpenOptions, "EXACT", false);
  auto dataset = std::make_unique<Dataset>(source, 0);
  dataset->SetDescription(info->pszFilename);
  dataset->TryLoadXML();
  return dataset.release();
}
