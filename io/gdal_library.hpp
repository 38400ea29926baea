// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cpl_error.h>

namespace terrane {

/// GDAL and the hundred libraries that it stands on take longer to load than most surfaces take to read, so the program
/// `terrane` is not bound to them: whoever needs GDAL calls this before anything of it. Nothing happens the second time
/// or where GDAL is there already. Throws Error{internal, "gdal"} when it cannot be loaded.
void load_gdal();

/// An error handler. Unlike GDAL's own it has an address before GDAL is there.
void say_nothing(CPLErr level, CPLErrorNum number, const char* message);

}  // namespace terrane
