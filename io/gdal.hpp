// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <cpl_error.h>
#include <gdal_priv.h>

// GDAL for untrusted bytes: one named driver, files that exist in memory only, under names we make.
namespace terrane {

/// Registers the few drivers we use (GTiff, PNG, MEM); safe to call from everywhere.
void register_drivers();

/// While it lives, this thread's GDAL looks at no neighbouring file, no PAM, no world file, and says nothing.
class ClosedGdal {
 public:
  ClosedGdal();
  ~ClosedGdal();
  ClosedGdal(const ClosedGdal&) = delete;
  ClosedGdal& operator=(const ClosedGdal&) = delete;

 private:
  std::vector<std::pair<const char*, std::string>> before_;
};

/// A file in GDAL's memory under a fresh name. The bytes given are not copied and must outlive it.
class MemoryFile {
 public:
  MemoryFile(std::string_view bytes, std::string_view extension);
  explicit MemoryFile(std::string_view extension);  // to be written
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  const std::string& name() const { return name_; }
  std::string contents() const;

 private:
  std::string name_;
};

struct CloseDataset {
  void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};
using DatasetHandle = std::unique_ptr<GDALDataset, CloseDataset>;

}  // namespace terrane
