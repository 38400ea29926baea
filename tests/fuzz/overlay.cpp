// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "core/error.hpp"
#include "core/merge.hpp"
#include "core/overlay.hpp"
#include "fuzz/meshes.hpp"
#include "support/merge_judge.hpp"
#include "support/overlay_judge.hpp"

namespace {

void print(const terrane::Tin& tin) {
  for (const terrane::Point& p : tin.vertices) std::fprintf(stderr, "v %.17g %.17g %.17g\n", p.x, p.y, p.z);
  for (const terrane::Face& f : tin.faces) std::fprintf(stderr, "f %d %d %d\n", f[0] + 1, f[1] + 1, f[2] + 1);
  std::fprintf(stderr, "\n");
}

}  // namespace

// libFuzzer on the overlay, or with TERRANE_FUZZ_MERGE on merges: any bytes are small valid meshes, most of them
// degenerate, and every promise is judged on the result.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace terrane;
  const fuzz::Bytes all(data, size);
  Context context;
  std::string wrong;
  std::vector<Tin> tiles;
#ifdef TERRANE_FUZZ_MERGE
  fuzz::Bytes bytes = all;
  MergeOptions options;
  const unsigned choices = bytes.next();
  const fuzz::Frame frame(bytes.next());
  options.overlap = static_cast<Overlap>(choices % 6);
  if (choices & 128) options.assembly.seam = Seam::split;
  while (bytes.left() > 0 && tiles.size() < 5)
    if (const Tin tile = fuzz::mesh(bytes, frame); !tile.faces.empty()) tiles.push_back(tile);
  if (tiles.size() < 2) return 0;
  try {
    wrong = support::broken_promises(tiles, options, merge(tiles, options, context));
#else
  const fuzz::Pair pair = fuzz::pair(all);
  tiles = {pair.a, pair.b};
  if (pair.a.faces.empty() || pair.b.faces.empty()) return 0;
  try {
    const Overlay overlaid = overlay(pair.a, pair.b, pair.options, context);
    wrong = support::broken_promises(pair.a, pair.b, pair.options, overlaid);
    if (!wrong.empty())
      std::fprintf(stderr, "snapped %d by %g, moved by %g\n", overlaid.rounding.snapped, overlaid.rounding.max_snap,
                   overlaid.rounding.max_move);
#endif
  } catch (const Error& error) {  // a refusal is no fault, an error of ours is
    if (error.kind != ErrorKind::input) wrong = error.what();
  }
  if (wrong.empty()) return 0;
  for (const Tin& tin : tiles) print(tin);
  std::fprintf(stderr, "broken: %s\n", wrong.c_str());
  std::abort();
}
