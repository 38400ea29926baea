// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <set>

#include "core/error.hpp"
#include "ops/frame.hpp"
#include "ops/parameters.hpp"

namespace terrane {
namespace {

std::string text_parameter(const Plan& plan, const char* name) {
  const auto it = plan.parameters.find(name);
  return it == plan.parameters.end() || it->is_null() ? "" : it->get<std::string>();
}

std::vector<std::string> names_of(const std::vector<Surface>& surfaces) {
  std::vector<std::string> names;
  for (const Surface& s : surfaces) names.push_back(s.slot), names.push_back(s.name);
  return names;
}

/// The last rule that speaks of a surface, those that name it before those for all.
std::string rule_for(const Surface& surface, const std::vector<CrsRule>& rules) {
  std::string general, own;
  for (const CrsRule& rule : rules) {
    if (rule.input.empty()) general = rule.crs;
    if (rule.input == surface.slot || rule.input == surface.name) own = rule.crs;
  }
  return own.empty() ? general : own;
}

/// What stands before the colon in INPUT:CRS to mean this surface alone.
std::string address(const Surface& surface, const std::vector<const Surface*>& all) {
  const auto same = std::count_if(all.begin(), all.end(), [&](const Surface* s) { return s->slot == surface.slot; });
  return same > 1 ? surface.name : surface.slot;
}

std::string shown(const Crs& crs) {
  const std::string id = crs.id();
  return id.size() <= 40 && !id.empty() ? id : crs.name();
}

bool looks_like_degrees(const Box& b) {
  return b.xmin >= -360 && b.xmax <= 360 && b.ymin >= -90 && b.ymax <= 90 && b.xmin <= b.xmax;
}

/// Longitudes may be counted on past a full turn, by tiles that cross where their count begins.
bool can_be_degrees(const Box& b) { return b.xmin >= -720 && b.xmax <= 720 && b.ymin >= -90 && b.ymax <= 90; }

/// Degrees that cannot be degrees, and metres that look like degrees.
void check_magnitudes(const std::vector<const Surface*>& surfaces, bool refuse, Context& context) {
  const auto empty = [](const Box& b) { return !(b.xmin <= b.xmax); };
  bool large = false;
  for (const Surface* s : surfaces) large = large || (!empty(box_of(*s)) && !looks_like_degrees(box_of(*s)));
  for (const Surface* s : surfaces) {
    const Box b = box_of(*s);
    if (empty(b)) continue;
    const bool small = looks_like_degrees(b);
    if (s->crs.known() && s->crs.geographic() && !can_be_degrees(b)) {
      const std::string message = "input '" + s->name + "' is said to be in " + shown(s->crs) +
                                  " (degrees), but its coordinates go beyond what longitudes and latitudes can be";
      if (refuse)
        throw Error(ErrorKind::input, "not-degrees",
                    message + "; say which CRS it is in with crs=" + address(*s, surfaces) + ":CRS");
      context.warn(
          {"not-degrees", s->name, "", message, "say which CRS it is in with crs=" + address(*s, surfaces) + ":CRS"});
    } else if (s->crs.known() && !s->crs.geographic() && !s->crs.local() && small) {
      const std::string message = "input '" + s->name + "' is said to be in " + shown(s->crs) + " (" +
                                  s->crs.length_unit() + "), but all its coordinates could be degrees";
      if (refuse && large)
        throw Error(
            ErrorKind::input, "degrees-as-metres",
            message + " while other inputs' could not; say crs=" + address(*s, surfaces) + ":EPSG:4326 if they are");
      context.warn(
          {"degrees-as-metres", s->name, "", message, "say crs=" + address(*s, surfaces) + ":EPSG:4326 if they are"});
    }
  }
}

void check_vertical(const std::vector<const Surface*>& surfaces, const Crs& target, Context& context) {
  std::set<std::string> known;
  const Surface* unknown = nullptr;
  for (const Surface* s : surfaces) {
    const std::string datum = s->crs.vertical_datum();
    if (datum == "unknown")
      unknown = s;
    else
      known.insert(datum);
  }
  const bool settled = target.known() && target.vertical_datum() != "unknown";
  if (known.size() > 1 && !settled)
    throw Error(ErrorKind::input, "vertical-datum",
                "the inputs' heights refer to different vertical datums (" + *known.begin() + ", " + *known.rbegin() +
                    "); name one for the result, as in target-crs=EPSG:25831+5773");
  if (settled && unknown)
    context.warn({"heights-unshifted", unknown->name, "",
                  "input '" + unknown->name +
                      "' does not say to which vertical datum its heights refer; they were not "
                      "shifted to " +
                      target.vertical_datum(),
                  "name it, as in crs=EPSG:25831+5773"});
  else if (target.known() && !settled && !known.empty())
    context.warn({"heights-unshifted", "", "",
                  "heights still refer to " + *known.begin() + ", which target-crs does not say",
                  "name it there, as in target-crs=EPSG:25831+5773"});
  else if (surfaces.size() > 1 && unknown && known.empty())
    context.warn({"vertical-datum-unknown", "", "",
                  "no input says to which vertical datum its heights refer; they are "
                  "taken to be the same",
                  "name it, as in crs=EPSG:25831+5773"});
}

std::string crs_list(const std::vector<const Surface*>& surfaces) {
  std::string list;
  for (const Surface* s : surfaces)
    if (list.size() < 400) list += (list.empty() ? "" : ", ") + ("'" + s->name + "' in ") + shown(s->crs);
  return list;
}

[[noreturn]] void refuse_mixed(const std::vector<const Surface*>& surfaces) {
  std::vector<Box> boxes;
  std::vector<Crs> all;
  bool local = false;
  for (const Surface* s : surfaces) {
    boxes.push_back(box_of(*s));
    all.push_back(s->crs);
    local = local || s->crs.local();
  }
  if (local)
    throw Error(ErrorKind::input, "mixed-crs",
                "local frames have no place on the Earth and cannot be put together with others: " +
                    crs_list(surfaces) + "; say which CRS they are in with crs=INPUT:CRS");
  throw Error(ErrorKind::input, "mixed-crs",
              "the inputs are in different coordinate reference systems: " + crs_list(surfaces) +
                  "; choose that of the result, for example target-crs=" + suggest_crs(boxes, all).id());
}

/// Of CRSs with the same plan the one that says most, and among those the first by its name: not the first given.
const Crs& most_telling(const std::vector<const Surface*>& surfaces) {
  const auto key = [](const Surface* s) { return std::pair(s->crs.vertical_datum() == "unknown", s->crs.id()); };
  return (*std::min_element(surfaces.begin(), surfaces.end(),
                            [&](const Surface* a, const Surface* b) { return key(a) < key(b); }))
      ->crs;
}

/// What is made from nothing is where `crs` says.
Crs crs_of_nothing(const Plan& plan) {
  if (!text_parameter(plan, "target-crs").empty())
    throw Error(ErrorKind::usage, "bad-parameter",
                "'" + plan.operation->id + "' has no input to transform; say with crs where the result is");
  const auto rules = parse_crs_rules(text_parameter(plan, "crs"), {});
  return rules.empty() ? Crs() : Crs::parse(rules.front().crs);
}

/// The CRS of the result where a lattice settles it, else what target-crs says.
std::string target_of(const std::vector<Surface>& surfaces, const Plan& plan) {
  const std::string asked = text_parameter(plan, "target-crs");
  for (const Surface& s : surfaces) {
    if (!is_lattice(s, *plan.operation) || !s.crs.known()) continue;
    if (!asked.empty() && !Crs::parse(asked).same_plan(s.crs))
      throw Error(ErrorKind::usage, "bad-parameter",
                  "the cells of '" + s.name + "' are in " + shown(s.crs) + ", so the result cannot be in " + asked +
                      "; leave target-crs out, or '" + s.slot + "'");
    const bool same = std::all_of(surfaces.begin(), surfaces.end(),
                                  [&](const Surface& other) { return !other.crs.known() || other.crs.same_plan(s.crs); });
    if (asked.empty() && !same) return s.crs.id();
  }
  return asked;
}

}  // namespace

bool is_lattice(const Surface& surface, const Operation& operation) {
  return std::any_of(operation.inputs.begin(), operation.inputs.end(),
                     [&](const InputSlot& slot) { return slot.lattice && slot.name == surface.slot; });
}

Box box_of(const Surface& surface) {
  if (const Tin* tin = std::get_if<Tin>(&surface.value)) return bounds(*tin);
  if (const Raster* dem = std::get_if<Raster>(&surface.value)) {
    const Point2 first = dem->place(0, 0), last = dem->place(dem->width - 1, dem->height - 1);
    return {first.x, last.y, last.x, first.y};
  }
  if (const PointCloud* cloud = std::get_if<PointCloud>(&surface.value)) return bounds(Tin{cloud->points, {}});
  return bounds(Tin{});
}

void assign_crs(std::vector<Surface>& surfaces, const Plan& plan) {
  const auto names = names_of(surfaces);
  const auto forced = parse_crs_rules(text_parameter(plan, "crs"), names);
  const auto assumed = parse_crs_rules(text_parameter(plan, "assume-crs"), names);
  for (Surface& s : surfaces) {
    if (s.level()) continue;
    if (const std::string text = rule_for(s, forced); !text.empty())
      s.crs = Crs::parse(text);
    else if (const std::string fallback = rule_for(s, assumed); !s.crs.known() && !fallback.empty())
      s.crs = Crs::parse(fallback);
  }
}

Crs choose_crs(const std::vector<Surface>& surfaces, const Plan& plan, Context& context) {
  if (surfaces.empty()) return crs_of_nothing(plan);
  std::vector<const Surface*> known, unknown;
  for (const Surface& s : surfaces)
    if (!s.level() && !is_lattice(s, *plan.operation)) (s.crs.known() ? known : unknown).push_back(&s);
  for (const Surface& s : surfaces)
    if (known.empty() && is_lattice(s, *plan.operation) && s.crs.known()) known.push_back(&s);
  const std::string target = target_of(surfaces, plan);

  if (known.empty()) {
    if (!target.empty())
      throw Error(ErrorKind::input, "missing-crs",
                  "no input says in which CRS it is, so nothing can be transformed to " + target +
                      "; say it with assume-crs=CRS");
    if (!unknown.empty())
      context.warn({"no-crs", "", "",
                    "no input says in which CRS it is: all are taken to be in one local frame, in metres",
                    "say it with assume-crs"});
    check_magnitudes(unknown, false, context);
    return {};
  }
  if (!unknown.empty())
    throw Error(ErrorKind::input, "missing-crs",
                "input '" + unknown.front()->name + "' does not say in which CRS it is, others do ('" +
                    known.front()->name + "' is in " + shown(known.front()->crs) + "); say it with assume-crs=" +
                    address(*unknown.front(), unknown) + ":CRS, or assume-crs=" + shown(known.front()->crs));
  check_magnitudes(known, plan.operation->intake.check, context);
  const Crs chosen = target.empty() ? most_telling(known) : Crs::parse(target);
  if (plan.operation->intake.check) check_vertical(known, target.empty() ? Crs() : chosen, context);
  for (const Surface* s : known) {
    const bool both_local = s->crs.local() && chosen.local();
    if (s->crs.same_plan(chosen) || both_local) continue;
    if (target.empty() || s->crs.local() || chosen.local()) refuse_mixed(known);
  }
  return chosen;
}

}  // namespace terrane
