// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/memory.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <iterator>

namespace terrane {
namespace {

struct Row {
  std::string_view operation;
  MemoryFigures figures;
};

// The least is what identical surfaces, or none but one, take; the most what two surveys of one place take that have no
// vertex in common, whatever the parameters that are usual; a fifth is added, as more threads take more.
constexpr Row figures[] = {
    {"add", {{60, 1900}, {}}},
    {"subtract", {{22, 560}, {}}},
    {"merge", {{85, 2600}, {}}},
    {"seams", {{85, 2600}, {}}},
    {"volume", {{22, 1900}, {}}},
    {"and", {{60, 600}, {}}},
    {"or", {{60, 600}, {}}},
    {"xor", {{60, 600}, {}}},
    {"nand", {{60, 600}, {}}},
    {"nor", {{60, 600}, {}}},
    {"not", {{75, 200}, {}}},
    {"threshold", {{160, 400}, {}}},
    {"quantize", {{160, 500}, {}}},
    {"clip", {{75, 180}, {}}},
    {"synthesize-rectangle", {{45, 100}, {}}},
    {"synthesize-circle", {{100, 500}, {}}},
    {"synthesize-ellipse", {{100, 500}, {}}},
    {"synthesize-polygon", {{45, 100}, {}}},
    {"triangulate", {{60, 850}, {}}},
    {"rasterize", {{60, 120}, {12, 70}}},
    {"render", {{60, 120}, {5, 12}}},
    {"profile", {{60, 120}, {}}},
    {"sample", {{60, 120}, {}}},
    {"contour", {{70, 350}, {}}},
    {"simplify", {{110, 750}, {}}},
    {"transform", {{60, 120}, {}}},
    {"validate", {{60, 140}, {}}},
    {"info", {{35, 70}, {}}},
    {"convert", {{60, 150}, {}}},
};

const std::string remedy = " Use fewer or smaller inputs.";

std::string megabytes(std::uint64_t bytes) { return std::to_string((bytes + (1 << 20) - 1) >> 20); }

std::uint64_t faces_of(const Surface& surface) {
  if (const Tin* tin = std::get_if<Tin>(&surface.value)) return tin->faces.size();
  if (const PointCloud* cloud = std::get_if<PointCloud>(&surface.value)) return 2 * cloud->points.size();
  return 0;  // a level; a raster, which is no TIN yet
}

std::string may_take(std::uint64_t limit) { return "the " + megabytes(limit) + " MB that one execution may take"; }

}  // namespace

MemoryFigures memory_figures(std::string_view operation) {
  const auto row = std::find_if(std::begin(figures), std::end(figures),
                                [&](const Row& r) { return r.operation == operation; });
  return row == std::end(figures) ? MemoryFigures{} : row->figures;
}

AddressSpace address_space() {
  AddressSpace space;
  // Without an allocation: this is also asked when one has failed.
  char text[4096] = {};
  if (const int file = open("/proc/self/status", O_RDONLY | O_CLOEXEC); file >= 0) {
    if (read(file, text, sizeof text - 1) < 0) text[0] = 0;
    close(file);
  }
  const auto field = [&](const char* name) -> std::uint64_t {
    const char* at = std::strstr(text, name);
    return at ? std::strtoull(at + std::strlen(name), nullptr, 10) << 10 : 0;
  };
  space.now = field("VmSize:");
  space.peak = field("VmPeak:");
  rlimit most;
  if (getrlimit(RLIMIT_AS, &most) == 0 && most.rlim_cur != RLIM_INFINITY) space.limit = most.rlim_cur;
  return space;
}

void require_memory(std::uint64_t used, std::uint64_t count, const std::string& things, const MemoryUse& each) {
  const std::uint64_t limit = address_space().limit, need = used + count * each.least;
  if (limit == 0 || need <= limit) return;
  throw Error(ErrorKind::limit, "out-of-memory",
              "The work needs at least " + megabytes(need) + " MB, which is more than " + may_take(limit) + ": " +
                  megabytes(used) + " MB are in use before it, and " + std::to_string(count) + " " + things +
                  " take " + std::to_string(each.least) + " to " + std::to_string(each.most) + " bytes each." + remedy);
}

Error out_of_memory(const std::string& reckoned) {
  const AddressSpace space = address_space();
  const std::string most = space.limit ? may_take(space.limit) : "there is";
  return {ErrorKind::limit, "out-of-memory",
          "The work needs more memory than " + most + ": it had taken up to " + megabytes(space.peak) +
              " MB when it asked for more." + reckoned + remedy};
}

void MemoryNeed::count(const std::vector<Surface>& inputs) {
  faces_ = 0;
  for (const Surface& surface : inputs) faces_ += faces_of(surface);
  require_memory(used_, faces_, "faces", face_);
}

Error MemoryNeed::exceeded() const {
  if (faces_ == 0) return out_of_memory();
  return out_of_memory(" '" + operation_ + "' takes " + std::to_string(face_.least) + " to " +
                       std::to_string(face_.most) + " bytes for a face of its inputs: with " + std::to_string(faces_) +
                       " faces " + megabytes(used_ + faces_ * face_.least) + " to " +
                       megabytes(used_ + faces_ * face_.most) + " MB in all.");
}

}  // namespace terrane
