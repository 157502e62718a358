// Streams and their levels as datasets of GDAL.
#pragma once
#include <gdal_pam.h>

#include <memory>
#include <vector>

#include "source.hpp"

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
  int GetGCPCount() override;
  const GDAL_GCP *GetGCPs() override;
  const OGRSpatialReference *GetGCPSpatialRef() const override;
  // Fills samples [rows, columns, C] with a block.
  CPLErr draw(int column, int row, int columns, int rows, void *buffer);

  const Source &source() const { return *source_; }
  int overviews() const { return int(overviews_.size()); }
  Dataset *overview(int index) const { return overviews_[size_t(index)].get(); }

 private:
  void describe();
  // Fills the six numbers of a transform, if the stream has one.
  bool placed(double *transform) const;
  bool has_points() const { return level_ == 0 && source_->described.point_count; }

  std::shared_ptr<Source> source_;
  uint32_t level_;
  std::vector<std::unique_ptr<Dataset>> overviews_;
};
