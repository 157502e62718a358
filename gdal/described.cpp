#include "described.hpp"

#include <cpl_error.h>
#include <cpl_vsi.h>

namespace {

// What is said of the source's samples and overviews, which are others now.
bool is_of_source(const char *item) {
  constexpr const char *kStarts[] = {"STATISTICS_", "APPROX_STATISTICS_", "TIFFTAG_MINSAMPLEVALUE",
                                     "TIFFTAG_MAXSAMPLEVALUE", "OVR_RESAMPLING_ALG"};
  for (const char *start : kStarts)
    if (STARTS_WITH_CI(item, start)) return true;
  return false;
}

CPLStringList domain_of(GDALMajorObject &object, const char *name) {
  CPLStringList kept;
  for (char **item = object.GetMetadata(name); item && *item; ++item)
    if (!is_of_source(*item)) kept.AddString(*item);
  return kept;
}

Domains domains_of(GDALMajorObject &object) {
  Domains found;
  const CPLStringList names(object.GetMetadataDomainList(), TRUE);
  for (int i = 0; i < names.Count(); ++i) {
    if (EQUAL(names[i], "IMAGE_STRUCTURE") || EQUAL(names[i], "DERIVED_SUBDATASETS")) continue;
    const CPLStringList items = domain_of(object, names[i]);
    if (items.Count()) found[names[i]] = items;
  }
  return found;
}

DescribedBand described_band(GDALRasterBand &band) {
  DescribedBand found;
  found.description = band.GetDescription();
  found.unit = band.GetUnitType();
  found.colour = band.GetColorInterpretation();
  const auto stated = [&](double (GDALRasterBand::*get)(int *)) {
    int is_stated = FALSE;
    const double value = (band.*get)(&is_stated);
    return is_stated ? std::optional<double>(value) : std::nullopt;
  };
  found.nodata = stated(&GDALRasterBand::GetNoDataValue);
  found.scale = stated(&GDALRasterBand::GetScale);
  found.offset = stated(&GDALRasterBand::GetOffset);
  found.domains = domains_of(band);
  return found;
}

// Calls use(dataset) with a file in memory, if GDAL opens it.
template <class Use>
void opened(std::vector<uint8_t> &tiff, const Use &use) {
  if (tiff.empty()) return;
  const std::string name = CPLSPrintf("/vsimem/sgicodec-%p.tif", static_cast<const void *>(tiff.data()));
  VSIFCloseL(VSIFileFromMemBuffer(name.c_str(), tiff.data(), tiff.size(), FALSE));
  {
    CPLErrorHandlerPusher quiet(CPLQuietErrorHandler);
    const char *drivers[] = {"GTiff", nullptr};
    GDALDatasetUniquePtr file(GDALDataset::Open(name.c_str(), GDAL_OF_RASTER | GDAL_OF_INTERNAL, drivers));
    if (file) use(*file);
  }
  CPLErrorReset();
  VSIUnlink(name.c_str());
}

void describe_place(std::vector<uint8_t> tiff, Described &found) {
  opened(tiff, [&](GDALDataset &file) {
    std::array<double, 6> transform;
    if (file.GetGeoTransform(transform.data()) == CE_None) found.transform = transform;
    if (const OGRSpatialReference *system = file.GetSpatialRef()) found.system = *system;
    found.point_count = file.GetGCPCount();
    found.points = {GDALDuplicateGCPs(found.point_count, file.GetGCPs()),
                    [count = found.point_count](GDAL_GCP *points) {
                      GDALDeinitGCPs(count, points);
                      CPLFree(points);
                    }};
    if (const OGRSpatialReference *system = file.GetGCPSpatialRef()) found.system_of_points = *system;
    found.domains = domains_of(file);
    for (int band = 1; band <= file.GetRasterCount(); ++band)
      found.bands[size_t(band - 1)] = described_band(*file.GetRasterBand(band));
  });
}

// EXIF as GDAL's readers of TIFF and JPEG name its items.
void describe_camera(std::vector<uint8_t> tiff, Described &found) {
  constexpr uint16_t kMake = 271, kModel = 272;
  CPLStringList items;
  opened(tiff, [&](GDALDataset &file) {
    const CPLStringList tags = domain_of(file, "");
    for (int i = 0; i < tags.Count(); ++i)
      if (STARTS_WITH(tags[i], "TIFFTAG_")) found.domains[""].AddString(tags[i]);
    items = domain_of(file, "EXIF");
  });
  if (const std::string make = text_of(tiff, kMake); !make.empty()) items.SetNameValue("EXIF_Make", make.c_str());
  if (const std::string model = text_of(tiff, kModel); !model.empty()) items.SetNameValue("EXIF_Model", model.c_str());
  if (items.Count()) found.domains["EXIF"] = items;
}

}  // namespace

Described described_by(Tags place, Tags exif, const Layout &layout) {
  // A stream without such tags has none in its directory.
  static constexpr uint8_t kNothing[] = {'I', 'I', 42, 0, 8, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  Described found;
  found.bands.resize(size_t(layout.bands));
  const auto tiff = [&](Tags tags, std::initializer_list<uint16_t> wanted) {
    return as_tiff(static_cast<const uint8_t *>(tags.bytes), tags.bytes ? tags.size : 0, layout, wanted);
  };
  describe_place(tiff({kNothing, sizeof kNothing}, {}), found);
  describe_place(tiff(place, {282, 283, 296, 33550, 33922, 34264, 34735, 34736, 34737, 42112, 42113, 50844}), found);
  describe_camera(tiff(exif, {269, 270, 271, 272, 282, 283, 296, 305, 306, 315, 316, 33432, 34665, 34853}), found);
  return found;
}
