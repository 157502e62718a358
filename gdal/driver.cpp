// Streams of sgicodec in GDAL: windows and overviews as the decoder renders them, from any file that GDAL opens.
#include <gdal_pam.h>

#include <memory>

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
  driver->SetMetadataItem(GDAL_DMD_OPENOPTIONLIST,
                          "<OpenOptionList><Option name='EXACT' type='boolean' default='NO' description='Render small "
                          "overviews from all that the stream holds'/></OpenOptionList>");
  driver->pfnIdentify = Dataset::identify;
  driver->pfnOpen = Dataset::open;
  GetGDALDriverManager()->RegisterDriver(driver.release());
}
