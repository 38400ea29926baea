// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/gdal_library.hpp"

#include <dlfcn.h>

#include "core/error.hpp"

namespace terrane {

void load_gdal() {
#ifdef TERRANE_GDAL_LIBRARY
  static void* const library = dlopen(TERRANE_GDAL_LIBRARY, RTLD_LAZY | RTLD_GLOBAL);
  if (!library)
    throw Error(ErrorKind::internal, "gdal", "the library " TERRANE_GDAL_LIBRARY " cannot be loaded; install GDAL 3.6");
#endif
}

void say_nothing(CPLErr, CPLErrorNum, const char*) {}

}  // namespace terrane
