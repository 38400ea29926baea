// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ops/operation.hpp"

// The operations, one file each (ops/op_*.cpp); the catalogue lists them in the order of the documentation.
namespace terrane {

Operation add();
Operation subtract();
Operation merge_operation();
Operation seams_operation();
Operation volume_operation();
Operation logic_and();
Operation logic_or();
Operation logic_xor();
Operation logic_nand();
Operation logic_nor();
Operation logic_not();
Operation threshold();
Operation quantize();
Operation clip_operation();
Operation synthesize_rectangle();
Operation synthesize_circle();
Operation synthesize_ellipse();
Operation synthesize_polygon();
Operation triangulate_operation();
Operation render();
Operation rasterize_operation();
Operation profile();
Operation sample();
Operation contour();
Operation simplify_operation();
Operation transform_operation();
Operation validate();
Operation info();
Operation convert();
Operation echo();

}  // namespace terrane
