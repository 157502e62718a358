// A channel of a level of a stream as a band of GDAL.
#pragma once
#include "dataset.hpp"

class Band final : public GDALPamRasterBand {
 public:
  Band(Dataset *dataset, int band);

  double GetNoDataValue(int *found) override;
  double GetScale(int *found) override;
  double GetOffset(int *found) override;
  const char *GetUnitType() override;
  GDALColorInterp GetColorInterpretation() override { return described().colour; }
  int GetOverviewCount() override { return owner().overviews(); }
  GDALRasterBand *GetOverview(int index) override {
    return index < 0 || index >= owner().overviews() ? nullptr : owner().overview(index)->GetRasterBand(nBand);
  }

 protected:
  CPLErr IReadBlock(int column, int row, void *data) override;

 private:
  Dataset &owner() const { return *static_cast<Dataset *>(poDS); }
  const DescribedBand &described() const { return owner().source().described.bands[size_t(nBand - 1)]; }
};
