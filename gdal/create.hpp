// Datasets of GDAL as new streams: CreateCopy, by the installed program `sgi`.
#pragma once
#include <gdal_priv.h>

extern const char *const kCreationOptions;  // as GDAL lists them, in XML

// Writes a copy of a dataset to a stream, which is opened then. Null, with an error of GDAL's, where that fails;
// strict: also where something of the source is lost besides the loss that the options ask for.
GDALDataset *create_copy(const char *name, GDALDataset *source, bool is_strict, const CPLStringList &options,
                         GDALProgressFunc progress, void *user);
