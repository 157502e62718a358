// Streams of sgicodec in GDAL: windows and overviews as the decoder renders them, from any file that GDAL opens; copies
// by the program that encodes.
#include <gdal_pam.h>

#include <memory>

#include "create.hpp"
#include "dataset.hpp"

extern "C" __attribute__((visibility("default"))) void GDALRegister_SGICODEC() {
  if (!GDAL_CHECK_VERSION("SGICODEC") || GDALGetDriverByName("SGICODEC")) return;
  auto driver = std::make_unique<GDALDriver>();
  driver->SetDescription("SGICODEC");
  driver->SetMetadataItem(GDAL_DCAP_RASTER, "YES");
  driver->SetMetadataItem(GDAL_DCAP_VIRTUALIO, "YES");
  driver->SetMetadataItem(GDAL_DMD_LONGNAME, "sgicodec: structured 2D Gaussians");
  driver->SetMetadataItem(GDAL_DMD_EXTENSION, "sgi");
  driver->SetMetadataItem(GDAL_DMD_MIMETYPE, "image/x-sgicodec");
  driver->SetMetadataItem(GDAL_DMD_CREATIONDATATYPES, "Byte UInt16 Float32");
  driver->SetMetadataItem(GDAL_DMD_CREATIONOPTIONLIST, kCreationOptions);
  driver->SetMetadataItem(GDAL_DMD_OPENOPTIONLIST,
                          "<OpenOptionList><Option name='EXACT' type='boolean' default='NO' description='Render small "
                          "overviews from all that the stream holds'/></OpenOptionList>");
  driver->pfnIdentify = Dataset::identify;
  driver->pfnOpen = Dataset::open;
  // The type of a list of options is another from GDAL 3.13 on.
  driver->pfnCreateCopy = [](const char *name, GDALDataset *source, int is_strict, auto options,
                             GDALProgressFunc progress, void *user) -> GDALDataset * {
    const CPLStringList copy(CSLDuplicate(options), TRUE);
    return create_copy(name, source, is_strict, copy, progress, user);
  };
  GetGDALDriverManager()->RegisterDriver(driver.release());
}
