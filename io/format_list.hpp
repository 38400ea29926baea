// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "io/format.hpp"

// One maker per format file, for the list in formats.cpp.
namespace terrane {

Format obj_format();
Format json_format();
Format ply_format();
Format geotiff_format();
Format hgt_format();
Format ascii_grid_format();
Format las_format();
Format point_table_format();

}  // namespace terrane
