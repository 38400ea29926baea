// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/gdal.hpp"

#include <atomic>

#include <cpl_conv.h>
#include <cpl_vsi.h>
#include <gdal_frmts.h>

#include "io/gdal_library.hpp"

namespace terrane {

namespace {

constexpr std::pair<const char*, const char*> settings[] = {{"GDAL_DISABLE_READDIR_ON_OPEN", "EMPTY_DIR"},
                                                            {"GDAL_PAM_ENABLED", "NO"},
                                                            {"GDAL_GEOREF_SOURCES", "INTERNAL"},
                                                            {"GTIFF_POINT_GEO_IGNORE", "TRUE"},
                                                            {"GTIFF_REPORT_COMPD_CS", "YES"},
                                                            {"OSR_STRIP_TOWGS84", "YES"},
                                                            {"GDAL_NUM_THREADS", "1"},
                                                            {"CPL_CURL_ENABLE_VSIMEM", "NO"},
                                                            {"GDAL_ENABLE_TIFF_SPLIT", "NO"}};

std::string fresh_name(std::string_view extension) {
  static std::atomic<unsigned long long> counter = 0;
  return "/vsimem/terrane-" + std::to_string(++counter) + "/data" + std::string(extension);
}

}  // namespace

void register_drivers() {
  static const bool done = [] {
    load_gdal();
    GDALRegister_GTiff();
    GDALRegister_PNG();
    GDALRegister_MEM();
    return true;
  }();
  (void)done;
}

ClosedGdal::ClosedGdal() {
  register_drivers();
  CPLPushErrorHandler(say_nothing);
  for (const auto& [key, value] : settings) {
    const char* before = CPLGetThreadLocalConfigOption(key, nullptr);
    before_.emplace_back(key, before ? before : "");
    CPLSetThreadLocalConfigOption(key, value);
  }
}

ClosedGdal::~ClosedGdal() {
  for (const auto& [key, value] : before_) CPLSetThreadLocalConfigOption(key, value.empty() ? nullptr : value.c_str());
  CPLPopErrorHandler();
  CPLErrorReset();
}

MemoryFile::MemoryFile(std::string_view bytes, std::string_view extension) : name_(fresh_name(extension)) {
  // GDAL wants bytes it may write to; the file is only ever opened for reading.
  auto* data = reinterpret_cast<GByte*>(const_cast<char*>(bytes.data()));
  if (VSILFILE* file = VSIFileFromMemBuffer(name_.c_str(), data, bytes.size(), false)) VSIFCloseL(file);
}

MemoryFile::MemoryFile(std::string_view extension) : name_(fresh_name(extension)) {}

MemoryFile::~MemoryFile() { VSIUnlink(name_.c_str()); }

std::string MemoryFile::contents() const {
  vsi_l_offset size = 0;
  const GByte* bytes = VSIGetMemFileBuffer(name_.c_str(), &size, false);
  return bytes ? std::string(reinterpret_cast<const char*>(bytes), size) : "";
}

}  // namespace terrane
