#include "create.hpp"

#include <cpl_conv.h>
#include <cpl_minixml.h>
#include <cpl_spawn.h>
#include <cpl_string.h>
#include <cpl_vsi.h>

#include <cctype>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace {

constexpr double kCopied = 0.05;  // share of the progress that the copy in TIFF has

// A file that goes with this object.
struct Scratch {
  std::string path;
  // Removes what GDAL writes beside it.
  void clear() const {
    for (const char *more : {".aux.xml", ".msk"}) VSIUnlink((path + more).c_str());
  }
  ~Scratch() {
    clear();
    VSIUnlink(path.c_str());
  }
};

// Says that something is lost: an error where the copy is to be strict. Whether to go on.
bool lose(bool is_strict, const char *name, const std::string &what) {
  CPLError(is_strict ? CE_Failure : CE_Warning, CPLE_NotSupported, "%s: %s", name, what.c_str());
  return !is_strict;
}

std::string joined(const std::set<std::string> &words) {
  std::string text;
  for (const std::string &word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

// The nodata values of bands but alpha: more than one where they differ, or where some have none.
std::set<std::string> nodata_of(GDALDataset &source) {
  std::set<std::string> values;
  for (GDALRasterBand *band : source.GetBands()) {
    int is_stated = FALSE;
    const double nodata = band->GetNoDataValue(&is_stated);
    if (band->GetColorInterpretation() == GCI_AlphaBand) continue;
    values.insert(!is_stated ? "none" : std::isnan(nodata) ? "nan" : CPLSPrintf("%.17g", nodata));
  }
  return values;
}

// What a stream has no place for, whatever tags say.
std::vector<std::string> losses(GDALDataset &source, const CPLStringList &options) {
  const int bands = source.GetRasterCount();
  GDALRasterBand &first = *source.GetRasterBand(1);
  const GDALDataType type = first.GetRasterDataType();
  std::vector<std::string> found;
  if (type != GDT_Byte && type != GDT_UInt16 && type != GDT_Float32)
    found.push_back(std::string("samples of ") + GDALGetDataTypeName(type) + " become Float32");
  if (first.GetColorTable() && bands <= 2 && (type == GDT_Byte || type == GDT_UInt16))
    found.push_back("a palette becomes its colours; class numbers, colour table, nodata and alpha are not kept");
  if (!(first.GetMaskFlags() & (GMF_ALL_VALID | GMF_ALPHA | GMF_NODATA)))
    found.push_back("the mask is not kept; gdalwarp -dstalpha makes alpha of it, which is kept beside gray or RGB");
  const bool can_be_alpha = bands == 2 || bands == 4;
  for (int band = 1; band <= bands; ++band)
    if (source.GetRasterBand(band)->GetColorInterpretation() == GCI_AlphaBand && !(can_be_alpha && band == bands) &&
        !EQUAL(options.FetchNameValueDef("ALPHA", ""), "band"))
      found.push_back("alpha becomes a band like the others; it is kept as the last one beside gray or RGB");
  return found;
}

bool accepts(const char *name, GDALDataset &source, bool is_strict, const CPLStringList &options) {
  const int bands = source.GetRasterCount();
  if (!bands) {
    CPLError(CE_Failure, CPLE_NotSupported, "%s: the source has no bands", name);
    return false;
  }
  const GDALDataType type = source.GetRasterBand(1)->GetRasterDataType();
  for (int band = 1; band <= bands; ++band) {
    if (source.GetRasterBand(band)->GetRasterDataType() == type && !GDALDataTypeIsComplex(type)) continue;
    CPLError(CE_Failure, CPLE_NotSupported, "%s: bands of a stream are real numbers of one type; choose one by -ot",
             name);
    return false;
  }
  if (const auto values = nodata_of(source); values.size() > 1) {
    CPLError(CE_Failure, CPLE_NotSupported,
             "%s: nodata of bands differs (%s), of which a stream has one for all; choose bands by -b, or one value by "
             "-a_nodata",
             name, joined(values).c_str());
    return false;
  }
  for (const std::string &what : losses(source, options))
    if (!lose(is_strict, name, what)) return false;
  return true;
}

// What GDAL has written in XML because TIFF has no tags for it, by GDAL's own names. Besides that, the XML repeats
// names and the place, calls bands without a meaning gray where TIFF does not, and counts the source's samples.
std::set<std::string> untagged(const CPLXMLNode *parent) {
  const std::set<std::string> aside = {"Description", "GeoTransform", "Histograms"};
  std::set<std::string> names;
  for (const CPLXMLNode *item = parent ? parent->psChild : nullptr; item; item = item->psNext) {
    if (item->eType != CXT_Element) continue;
    const std::string name = item->pszValue, value = CPLGetXMLValue(item, "", "");
    const bool is_plain = name == "ColorInterp" && (value == "Gray" || value == "Undefined");
    if (name == "PAMRasterBand")
      names.merge(untagged(item));
    else if (!is_plain && !aside.count(name))
      names.insert(name);
  }
  return names;
}

// What is said of a copy, which nobody knows, said of the output.
std::string renamed(std::string text, const std::string &copy, const std::string &name) {
  for (const auto &[from, to] : {std::pair<std::string, std::string>{copy + ": ", ""}, {copy, name}})
    for (size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
      text.replace(at, from.size(), to);
  return text;
}

struct Message {
  CPLErr kind;
  CPLErrorNum number;
  std::string text;
};

void CPL_STDCALL keep_message(CPLErr kind, CPLErrorNum number, const char *text) {
  static_cast<std::vector<Message> *>(CPLGetErrorHandlerUserData())->push_back({kind, number, text});
}

// The dataset as GeoTIFF, which `sgi` reads with all that its tags say.
bool copied(GDALDataset &source, const Scratch &tiff, const char *name, bool is_strict, GDALProgressFunc progress,
            void *user) {
  CPLStringList options;
  options.SetNameValue("BIGTIFF", "IF_SAFER");
  const GDALDataType type = source.GetRasterBand(1)->GetRasterDataType();
  options.SetNameValue("TILED", type == GDT_Float64 ? "NO" : "YES");  // OpenImageIO reads no 64-bit floats in tiles
  // Samples of fewer bits would be stretched to all of their type.
  if (type == GDT_Byte || type == GDT_UInt16 || type == GDT_UInt32)
    options.SetNameValue("NBITS", std::to_string(GDALGetDataTypeSizeBits(type)).c_str());
  // TIFF would have three colours and others, of which a stream makes bands without a meaning: so tags state colours.
  const int bands = source.GetRasterCount();
  if (bands > 4 || (bands == 4 && source.GetRasterBand(4)->GetColorInterpretation() != GCI_AlphaBand))
    options.SetNameValue("PHOTOMETRIC", "MINISBLACK");
  GDALDriver *driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  if (!driver) {
    CPLError(CE_Failure, CPLE_AppDefined, "%s: GDAL has no driver GTiff, which a copy is made with", name);
    return false;
  }
  const CPLConfigOptionSetter beside("GDAL_PAM_ENABLED", "YES", false);  // so that it tells what has no tags
  void *scaled = GDALCreateScaledProgress(0, kCopied, progress, user);
  std::vector<Message> messages;
  CPLPushErrorHandlerEx(keep_message, &messages);
  GDALDatasetUniquePtr copy(
      driver->CreateCopy(tiff.path.c_str(), &source, is_strict, options.List(), GDALScaledProgress, scaled));
  const bool is_made = copy != nullptr;
  copy.reset();
  CPLPopErrorHandler();
  GDALDestroyScaledProgress(scaled);
  for (const Message &message : messages)
    CPLError(message.kind, message.number, "%s: %s", name, renamed(message.text, tiff.path, name).c_str());
  if (!is_made) return false;
  const std::string beside_it = tiff.path + ".aux.xml";
  VSIStatBufL status;
  CPLXMLTreeCloser said(VSIStatL(beside_it.c_str(), &status) == 0 ? CPLParseXMLFile(beside_it.c_str()) : nullptr);
  const std::string lost = joined(untagged(CPLGetXMLNode(said.get(), "=PAMDataset")));
  tiff.clear();  // `sgi` would name them
  return lost.empty() || lose(is_strict, name, "what GeoTIFF has no tags for is not kept: " + lost);
}

// Options of `sgi encode` that have a value, as GDAL names them.
constexpr const char *kValues[] = {"QUALITY", "EFFORT", "MAX_ERROR", "PSNR", "BPP",
                                   "TUNE",    "RANGE",  "ALPHA",     "TILE", "THREADS"};

std::string option_of(const char *name) {
  std::string option = std::string("--") + name;
  for (char &letter : option) letter = letter == '_' ? '-' : char(std::tolower(static_cast<unsigned char>(letter)));
  return option;
}

// The words of a command that encodes a picture.
CPLStringList command(const CPLStringList &options, const std::string &picture, const std::string &out) {
  CPLStringList words;
  for (const char *word : {options.FetchNameValueDef("PROGRAM", "sgi"), "encode", "--force", "--quiet", "--progress",
                           "off", "--output", out.c_str()})
    words.AddString(word);
  for (const char *name : kValues) {
    const char *value = options.FetchNameValue(name);
    if (!value) continue;
    words.AddString(option_of(name).c_str());
    words.AddString(value);
  }
  if (options.FetchBool("LOSSLESS", false)) words.AddString("--lossless");
  words.AddString("--");
  words.AddString(picture.c_str());
  return words;
}

// Runs a command; what it says on stderr becomes an error of GDAL's.
bool ran(const char *name, const CPLStringList &words) {
  CPLErrorReset();
  CPLPushErrorHandler(CPLQuietErrorHandler);
  CPLSpawnedProcess *process = CPLSpawnAsync(nullptr, words.List(), FALSE, FALSE, TRUE, nullptr);
  CPLPopErrorHandler();
  if (!process) {
    CPLError(CE_Failure, CPLE_AppDefined,
             "%s: the program %s, which encodes, does not start; say where it is: -co "
             "PROGRAM=/path/of/sgi",
             name, words[0]);
    return false;
  }
  std::string said;
  const CPL_FILE_HANDLE errors = CPLSpawnAsyncGetErrorFileHandle(process);
  for (char byte; CPLPipeRead(errors, &byte, 1);) said += byte;
  const int status = CPLSpawnAsyncFinish(process, TRUE, FALSE);
  while (!said.empty() && said.back() == '\n') said.pop_back();
  said = renamed(said, words[words.Count() - 1], name);
  if (status == 0) {
    if (!said.empty()) CPLError(CE_Warning, CPLE_AppDefined, "%s: %s", name, said.c_str());
    return true;
  }
  if (said.empty()) said = std::string(words[0]) + " ended with " + std::to_string(status);
  CPLError(CE_Failure, CPLE_AppDefined, "%s: %s", name, said.c_str());
  return false;
}

}  // namespace

const char *const kCreationOptions =
    "<CreationOptionList>"
    "<Option name='QUALITY' type='float' min='1' max='100' description='90 visually lossless, 40 preview'/>"
    "<Option name='EFFORT' type='int' min='1' max='9' description='More is smaller and slower'/>"
    "<Option name='LOSSLESS' type='boolean' default='NO' description='Every sample as it is'/>"
    "<Option name='MAX_ERROR' type='float' min='0' description='Levels by which no sample may be off'/>"
    "<Option name='PSNR' type='float' description='PSNR to end at, in dB'/>"
    "<Option name='BPP' type='float' description='Bits per pixel to end at, never above'/>"
    "<Option name='TUNE' type='string-select' description='What to look good to'>"
    "<Value>visual</Value><Value>psnr</Value></Option>"
    "<Option name='RANGE' type='string' description='Samples: used, type or LOW,HIGH'/>"
    "<Option name='ALPHA' type='string-select' default='auto' description='What a last band declared as alpha becomes'>"
    "<Value>auto</Value><Value>band</Value><Value>none</Value></Option>"
    "<Option name='TILE' type='int' min='0' description='Side of the tiles of a large picture, in pixels'/>"
    "<Option name='THREADS' type='int' min='0' default='0' description='0 is one per core'/>"
    "<Option name='PROGRAM' type='string' default='sgi' description='Path of the program that encodes'/>"
    "</CreationOptionList>";

GDALDataset *create_copy(const char *name, GDALDataset *source, bool is_strict, const CPLStringList &options,
                         GDALProgressFunc progress, void *user) {
  if (!accepts(name, *source, is_strict, options)) return nullptr;
  const bool is_virtual = STARTS_WITH(name, "/vsi");
  const std::string beside =
      is_virtual ? CPLGenerateTempFilename("sgicodec") : name + ("." + std::to_string(CPLGetPID()));
  const Scratch tiff{beside + ".copy.tif"}, encoded{is_virtual ? beside + ".sgi" : ""};
  if (!copied(*source, tiff, name, is_strict, progress, user)) return nullptr;
  const std::string out = is_virtual ? encoded.path : name;
  if (!ran(name, command(options, tiff.path, out))) return nullptr;
  if (is_virtual && CPLCopyFile(name, out.c_str()) != 0) {
    CPLError(CE_Failure, CPLE_FileIO, "%s: it cannot be written", name);
    return nullptr;
  }
  if (!progress(1, "", user)) return nullptr;
  return GDALDataset::Open(name, GDAL_OF_RASTER | GDAL_OF_VERBOSE_ERROR);
}
