// SPDX-License-Identifier: GPL-3.0-or-later
#include "ops/frame.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include "core/error.hpp"
#include "core/validate.hpp"
#include "ops/heights.hpp"
#include "ops/measure.hpp"
#include "ops/parameters.hpp"
#include "core/side_by_side.hpp"

namespace terrane {
namespace {

/// One place would be on the sheet twice.
[[noreturn]] void refuse_twice_round(const Surface& west, const Surface& east) {
  const auto range = [](const Surface& s) {
    const Box box = box_of(s);
    return "'" + s.name + "' (" + nlohmann::json(box.xmin).dump() + " to " + nlohmann::json(box.xmax).dump() + ")";
  };
  const std::string which =
      &west == &east ? "those of " + range(west) : "together those of " + range(west) + " and " + range(east);
  throw Error(ErrorKind::input, "longitudes",
              "longitudes go more than once round the globe: " + which + "; clip '" + east.name +
                  "', or shift it to the range of the other inputs");
}

/// What a raster was, for `info`.
nlohmann::json raster_facts(const Raster& dem) {
  std::size_t voids = 0;
  double low = INFINITY, high = -INFINITY;
  for (double z : dem.samples)
    if (std::isnan(z))
      ++voids;
    else
      low = std::min(low, z), high = std::max(high, z);
  nlohmann::json range;
  if (low <= high) range = {low, high};
  return {{"width", dem.width},
          {"height", dem.height},
          {"cell_size", {dem.dx, dem.dy}},
          {"north_west_sample", {dem.x0, dem.y0}},
          {"voids", voids},
          {"height_range", range}};
}

/// What a raster says of its own heights holds where its CRS says otherwise.
void convert_heights(Raster& dem, const Surface& s, Context& context) {
  const double factor = Length{1, s.height_unit}.in(s.crs.metres_per_height_unit());
  if (dem.samples.empty() || std::fabs(factor - 1) < 1e-9) return;
  for (double& z : dem.samples) z *= factor;
  context.warn({"heights-converted", s.name, "",
                "the raster says its heights are in " + s.height_unit + "; they were converted to " +
                    s.crs.height_unit(),
                "correct the unit in the file, or give the CRS with assume-crs, if this is wrong"});
}

/// Whole tiles of geographic CRSs beside each other, however their longitudes are counted.
void unwrap(std::vector<Surface>& surfaces) {
  std::vector<Surface*> tiles;
  std::vector<Box> boxes;
  for (Surface& s : surfaces)
    if (!s.level() && s.crs.known() && s.crs.geographic() && box_of(s).xmin <= box_of(s).xmax)
      tiles.push_back(&s), boxes.push_back(box_of(s));
  if (tiles.size() < 2) return;
  const auto shifts = unwrap_longitudes(boxes);
  std::size_t west = 0, east = 0;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    boxes[i].xmin += shifts[i], boxes[i].xmax += shifts[i];
    if (boxes[i].xmin < boxes[west].xmin) west = i;
    if (boxes[i].xmax > boxes[east].xmax) east = i;
  }
  if (boxes[east].xmax - boxes[west].xmin > 360 + 1e-6) refuse_twice_round(*tiles[west], *tiles[east]);
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    if (shifts[i] == 0) continue;
    if (Tin* tin = std::get_if<Tin>(&tiles[i]->value))
      for (Point& p : tin->vertices) p.x += shifts[i];
    else if (PointCloud* cloud = std::get_if<PointCloud>(&tiles[i]->value))
      for (Point& p : cloud->points) p.x += shifts[i];
    else
      std::get<Raster>(tiles[i]->value).x0 += shifts[i];
  }
}

/// Rasters of one input and CRS that are pieces of one become one surface, which stands where the first did.
void join_rasters(std::vector<Surface>& surfaces, bool join_overlaps, std::vector<InputRecord>& records) {
  std::vector<Surface> joined;
  std::vector<bool> done(surfaces.size());
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    if (done[i]) continue;
    if (!std::holds_alternative<Raster>(surfaces[i].value)) {
      joined.push_back(std::move(surfaces[i]));
      continue;
    }
    std::vector<std::size_t> members;
    std::vector<Raster> rasters;
    for (std::size_t j = i; j < surfaces.size(); ++j) {
      const Surface& s = surfaces[j];
      if (done[j] || !std::holds_alternative<Raster>(s.value) || s.slot != surfaces[i].slot) continue;
      if (s.crs.known() != surfaces[i].crs.known() || (s.crs.known() && s.crs.id() != surfaces[i].crs.id())) continue;
      members.push_back(j);
      done[j] = true;
    }
    if (members.size() == 1) {
      joined.push_back(std::move(surfaces[i]));
      continue;
    }
    for (std::size_t j : members) rasters.push_back(std::move(std::get<Raster>(surfaces[j].value)));
    std::vector<int> groups;
    auto pieces = join_on_lattice(rasters, join_overlaps, groups);
    for (std::size_t g = 0; g < pieces.size(); ++g) {
      Surface whole = surfaces[members.front()];
      whole.value = std::move(pieces[g]);
      whole.name.clear();
      std::size_t count = 0;
      for (std::size_t m = 0; m < members.size(); ++m)
        if (groups[m] == static_cast<int>(g)) {
          whole.name += (whole.name.empty() ? "" : " + ") + surfaces[members[m]].name;
          if (++count == 1) whole.sha256 = surfaces[members[m]].sha256, whole.source = surfaces[members[m]].source;
        }
      for (std::size_t m = 0; m < members.size(); ++m)
        if (groups[m] == static_cast<int>(g) && count > 1) records[members[m]].joined = whole.name;
      joined.push_back(std::move(whole));
    }
  }
  surfaces = std::move(joined);
}

void refuse_empty(const Surface& s, const Operation& operation) {
  if (s.level() || s.points() || !s.tin().faces.empty() || operation.intake.empty_allowed) return;
  throw Error(ErrorKind::input, "empty-surface",
              "input '" + s.name + "' has no faces, and '" + operation.id + "' needs a surface");
}

/// Where only some inputs know their vertical datum, how far apart the heights are where both have one.
void warn_half_known_datum(const std::vector<Surface>& surfaces, Context& context) {
  const Surface *known = nullptr, *unknown = nullptr;
  for (const Surface& s : surfaces)
    if (!s.level() && s.crs.known()) (s.crs.vertical_datum() == "unknown" ? unknown : known) = &s;
  if (!known || !unknown) return;
  std::vector<double> jumps;
  const HeightField field(known->tin());
  const auto& vertices = unknown->tin().vertices;
  const std::size_t step = std::max<std::size_t>(1, vertices.size() / 2000);
  for (std::size_t v = 0; v < vertices.size(); v += step)
    if (const auto r = field.at(plan(vertices[v]), 0); r.found) jumps.push_back(vertices[v].z - r.height.low);
  std::string difference = "they do not overlap, so the difference is not known";
  if (!jumps.empty()) {
    std::nth_element(jumps.begin(), jumps.begin() + jumps.size() / 2, jumps.end());
    difference = "where they overlap the median difference is " + nlohmann::json(jumps[jumps.size() / 2]).dump();
  }
  context.warn({"vertical-datum-unknown", unknown->name, "",
                "the heights of '" + known->name + "' refer to " + known->crs.vertical_datum() + ", those of '" +
                    unknown->name + "' do not say; they are taken to be the same; " + difference,
                "name it, as in crs=" + unknown->slot + ":EPSG:25831+5773"});
}

/// Lengths and areas of a projected CRS far from where it is meant for.
void warn_distorted(const std::vector<Surface>& surfaces, const Crs& crs, Context& context) {
  if (!crs.known() || crs.geographic() || crs.local()) return;
  for (const Surface& s : surfaces) {
    const Box box = box_of(s);
    if (s.level() || !(box.xmin <= box.xmax)) continue;
    const double scale = scale_factor(crs, {(box.xmin + box.xmax) / 2, (box.ymin + box.ymax) / 2});
    if (std::fabs(scale - 1) <= 0.05) continue;
    context.warn({"scale-distorted", s.name, "",
                  "lengths in " + crs.name() + " are " + nlohmann::json(scale).dump() +
                      " times those on the ground at '" + s.name + "'",
                  "choose a target-crs that suits the place"});
    return;
  }
}

DemOptions dem_options(const Plan& plan, const Crs& crs) {
  DemOptions options;
  if (plan.operation->intake.every_sample) return options;
  options.max_error = Length::of(plan.parameters.at("max-error")).in(crs.known() ? crs.metres_per_height_unit() : 1.0);
  if (const auto it = plan.parameters.find("max-triangles"); it != plan.parameters.end() && !it->is_null())
    options.max_triangles = it->get<std::size_t>();
  return options;
}

bool wants_provenance(const Plan& plan) { return plan.parameters.value("provenance", false); }

/// A TIN as it came, in `to`.
std::shared_ptr<const Tin> as_given(const Tin& tin, const Crs& from, const Crs& to) {
  Tin copy = tin;
  if (differs(from, to)) move_points(copy.vertices, from, to);
  return std::make_shared<const Tin>(std::move(copy));
}

/// What was moved round the globe after it was copied.
void unwrap_given(std::vector<Surface>& surfaces) {
  for (Surface& s : surfaces) {
    if (!s.given || !s.crs.known() || !s.crs.geographic()) continue;
    const double shift = 360 * std::round((bounds(s.tin()).xmin - bounds(*s.given).xmin) / 360);
    if (shift == 0 || !std::isfinite(shift)) continue;
    Tin moved = *s.given;
    for (Point& p : moved.vertices) p.x += shift;
    s.given = std::make_shared<const Tin>(std::move(moved));
  }
}

/// Makes a TIN in `crs` of a surface. Returns the planarity error that costs.
double bring(Surface& s, const Crs& crs, const Plan& plan, Context& context) {
  if (const Raster* dem = std::get_if<Raster>(&s.value)) {
    DemTin made = dem_tin(*dem, s.crs, crs, s.name, dem_options(plan, crs), context);
    s.max_error = made.error;
    if (wants_provenance(plan)) s.given = std::make_shared<const Tin>(made.tin);
    s.value = std::move(made.tin);
    return made.planarity_error;
  }
  if (PointCloud* cloud = std::get_if<PointCloud>(&s.value)) {
    if (differs(s.crs, crs)) move_points(cloud->points, s.crs, crs);
    return 0;
  }
  double planarity_error = 0;
  Tin tin = std::move(std::get<Tin>(s.value));
  if (wants_provenance(plan)) s.given = as_given(tin, s.crs, crs);
  if (plan.operation->intake.check) tin = checked(std::move(tin), s.name, context);
  move_to(tin, s.crs, crs, s.name, planarity_error, context);
  // Places may have become one: a pole is a whole row of longitudes.
  if (plan.operation->intake.check && differs(s.crs, crs)) tin = checked(std::move(tin), s.name, context);
  s.value = std::move(tin);
  return planarity_error;
}

/// Makes TINs in `crs` of all surfaces, side by side unless there are rasters: one takes far more memory on its way to
/// a TIN than the TIN does. Returns the largest planarity error.
double bring_all(std::vector<Surface>& surfaces, const Crs& crs, const Plan& plan, std::vector<double>& areas,
                 Context& context) {
  std::vector<double> errors(surfaces.size(), 0), sizes;
  areas.assign(surfaces.size(), 0);
  bool rasters = false;
  for (const Surface& s : surfaces) {
    const Tin* tin = std::get_if<Tin>(&s.value);
    sizes.push_back(tin ? static_cast<double>(tin->faces.size()) : 0);
    rasters = rasters || std::holds_alternative<Raster>(s.value);
  }
  const auto one = [&](std::size_t i, Context& own) {
    Surface& s = surfaces[i];
    if (s.level()) return;
    errors[i] = bring(s, crs, plan, own);
    refuse_empty(s, *plan.operation);
    if (s.points()) return;
    areas[i] = domain_area(s.tin(), crs, own);
  };
  if (rasters)
    for (std::size_t i = 0; i < surfaces.size(); ++i) one(i, context);
  else
    side_by_side(sizes, context, one);
  return std::accumulate(errors.begin(), errors.end(), 0.0, [](double a, double b) { return std::max(a, b); });
}

/// Lattices are no surfaces: they stand aside while these are brought together.
std::vector<Surface> take_lattices(std::vector<Surface>& surfaces, const Operation& operation) {
  const auto first = std::stable_partition(surfaces.begin(), surfaces.end(),
                                           [&](const Surface& s) { return !is_lattice(s, operation); });
  std::vector<Surface> lattices(std::make_move_iterator(first), std::make_move_iterator(surfaces.end()));
  surfaces.erase(first, surfaces.end());
  return lattices;
}

}  // namespace

Frame common_frame(std::vector<Surface>& surfaces, const Plan& plan, Context& context) {
  const Operation& operation = *plan.operation;
  assign_crs(surfaces, plan);
  for (Surface& s : surfaces)
    if (Raster* dem = std::get_if<Raster>(&s.value)) {
      convert_heights(*dem, s, context);
      if (operation.result == ResultKind::report) s.source = raster_facts(*dem);
    }
  Frame frame;
  frame.crs = choose_crs(surfaces, plan, context);
  for (Surface& s : surfaces)
    if (double* level = std::get_if<double>(&s.value)) {
      *level = Length{*level, s.level_unit}.in(frame.crs.known() ? frame.crs.metres_per_height_unit() : 1.0);
      s.level_unit.clear();
    }
  for (const Surface& s : surfaces) {
    InputRecord record{.slot = s.slot, .name = s.name, .sha256 = s.sha256, .crs = s.crs};
    record.raster = std::holds_alternative<Raster>(s.value);
    record.word = s.word;
    if (s.level() && s.word.empty()) record.level = std::get<double>(s.value);
    frame.inputs.push_back(std::move(record));
    if (operation.intake.raster_only && std::holds_alternative<Tin>(s.value))
      throw Error(
          ErrorKind::input, "not-a-raster",
          "input '" + s.name + "' is a TIN already; '" + operation.id +
              "' takes a raster or points (use 'convert' for TINs)");
  }
  std::vector<Surface> lattices = take_lattices(surfaces, operation);
  if (operation.intake.check) unwrap(surfaces);
  if (operation.intake.join_rasters)
    join_rasters(surfaces, plan.parameters.value("overlap", "") != "sum", frame.inputs);

  nlohmann::json from = nlohmann::json::array();
  for (const Surface& s : surfaces)
    if (frame.crs.known() && differs(s.crs, frame.crs) && std::find(from.begin(), from.end(), s.crs.id()) == from.end())
      from.push_back(s.crs.id());
  std::vector<double> areas;
  const double planarity_error = bring_all(surfaces, frame.crs, plan, areas, context);
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const Surface& s = surfaces[i];
    if (s.level()) continue;
    for (InputRecord& record : frame.inputs)
      if (record.joined.empty() && record.name == s.name && record.slot == s.slot && record.sha256 == s.sha256) {
        if (s.points()) {
          record.vertices = std::get<PointCloud>(s.value).points.size();
          continue;
        }
        record.vertices = s.tin().vertices.size();
        record.faces = s.tin().faces.size();
        record.area_2d = areas[i];
      }
  }
  if (operation.intake.check) {
    warn_half_known_datum(surfaces, context);
    warn_distorted(surfaces, frame.crs, context);
  }
  for (Surface& s : lattices) surfaces.push_back(std::move(s));
  for (Surface& s : surfaces) s.crs = frame.crs;
  if (!from.empty()) {
    if (operation.intake.check && lattices.empty()) unwrap(surfaces);
    unwrap_given(surfaces);
    frame.reprojection = {{"from", from}, {"to", frame.crs.id()}, {"planarity_error", planarity_error}};
  }
  return frame;
}

}  // namespace terrane
