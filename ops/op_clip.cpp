// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>

#include "core/clip.hpp"
#include "core/volume.hpp"
#include "ops/heights.hpp"
#include "ops/inputs.hpp"
#include "ops/operations.hpp"
#include "ops/parameters.hpp"
#include "ops/region.hpp"
#include "ops/union_area.hpp"

namespace terrane {
namespace {

struct ClipParameters {
  std::optional<Vectors> region;
  std::string region_crs;
  std::vector<double> bbox;
  Side side = Side::inside;
  bool allow_empty = false;

  void visit(Fields& f) {
    f.vectors("region", region,
              "The region of interest: polygons with holes, or closed lines. Several are united; which way their rings "
              "run says nothing; what a ring that crosses itself encloses is decided by parity, with a warning.");
    f.crs("region-crs", region_crs, "The CRS of the region, where its bytes do not say it.");
    f.numbers("bbox", bbox, "A box as region: xmin,ymin,xmax,ymax in the CRS of the result.");
    f.choice("side", side, {{"inside", Side::inside}, {"outside", Side::outside}},
             "The part of the surface that is returned.");
    f.boolean("allow-empty", allow_empty,
              "Return an empty surface, with a warning, where nothing of the surface lies on that side.");
  }
};

void check(const nlohmann::json& parameters, const std::vector<InputPart>&) {
  const auto given = [&](const char* name) { return parameters.contains(name) && !parameters[name].is_null(); };
  if (given("region") == given("bbox"))
    throw Error(ErrorKind::usage, "region",
                given("region") ? "'clip' takes a region or a bbox, not both" : "'clip' needs a region or a bbox");
  if (!given("bbox")) return;
  const auto box = parameters["bbox"].get<std::vector<double>>();
  if (box.size() != 4 || !(box[0] < box[2]) || !(box[1] < box[3]))
    throw Error(ErrorKind::usage, "bad-parameter",
                "parameter 'bbox' takes four numbers xmin,ymin,xmax,ymax, the first two below the last two");
}

PlanRegion region_of(const ClipParameters& p, Context& context) {
  return p.region ? area_of(*p.region, "region", context)
                  : plan_region(Box{p.bbox[0], p.bbox[1], p.bbox[2], p.bbox[3]});
}

/// `region`: kept while the check looks at it.
HeightFold height_on_side(Side side, std::shared_ptr<const Surface> region) {
  return [side, region](const std::vector<std::optional<HeightRange>>& z) -> std::optional<HeightRange> {
    return z[1].has_value() == (side == Side::inside) ? z[0] : std::nullopt;
  };
}

/// Nothing on the side asked for, or all of it.
void judge_emptiness(const Surface& surface, const Surface& region, const ClipParameters& p, bool empty, double area,
                     double whole, Context& context) {
  if (p.side == Side::inside && empty) {
    if (!p.allow_empty) refuse_no_overlap(surface, region, "allow-empty=true");
    warn_no_overlap(surface, region, context);
  }
  if (p.side == Side::inside) return;
  if (empty) {
    const std::string message = "all of '" + surface.name + "' lies inside the region";
    if (!p.allow_empty)
      throw Error(ErrorKind::input, "nothing-left",
                  message + ", so nothing is left outside; check their CRSs, or say allow-empty=true");
    context.warn({"nothing-left", surface.name, "", message + "; the result is empty", "check their CRSs"});
  } else if (area >= whole) {
    context.warn({"no-overlap", surface.name, "",
                  "the region and '" + surface.name + "' do not overlap: all of it was kept", "check their CRSs"});
  }
}

Outcome run(std::vector<Surface>& inputs, const ClipParameters& p, Context& context) {
  Surface& surface = input(inputs, "surface");
  PlanRegion area = region_of(p, context);
  Clipped clipped = clip(surface.tin(), area, p.side, context);
  auto region = std::make_shared<Surface>(Surface{.slot = "region",
                                                  .name = p.region ? "region" : "bbox",
                                                  .sha256 = "",
                                                  .value = std::move(area.tin),
                                                  .crs = surface.crs});

  Outcome outcome;
  const double whole = plan_area(surface.tin(), context), returned = plan_area(clipped.tin, context);
  judge_emptiness(surface, *region, p, clipped.tin.faces.empty(), returned, whole, context);
  outcome.fields = height_fields({&surface.tin(), &region->tin()}, context);
  if (const auto united = union_area(outcome.fields, context)) {
    const double shared = whole + plan_area(region->tin(), context) - *united;
    outcome.expected_area = p.side == Side::inside ? shared : whole - shared;
  }
  outcome.expected_height = height_on_side(p.side, region);
  outcome.rounding = clipped.rounding;
  outcome.result = std::move(clipped.tin);
  return outcome;
}

}  // namespace

Operation clip_operation() {
  return operation<ClipParameters>(
      {.id = "clip",
       .title = "Cut a surface with a region of interest",
       .description =
           "The part of a surface inside or outside polygons or a box. Faces that the region's border does not touch "
           "are "
           "returned as they are; those it cuts keep their planes, and walls are cut with them. Inside and outside are "
           "the whole: their areas add up, and they meet vertex on vertex, so that a merge gives the surface back.",
       .inputs = {{"surface", 1, 1, false, "The surface to cut: a TIN or a raster."}},
       .check = check,
       .example = {.parameters = {{"bbox", "500100,4400100,500200,4400200"}}}},
      run);
}

}  // namespace terrane
