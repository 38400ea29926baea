// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <memory>

#include "core/error.hpp"
#include "core/profile_chart.hpp"
#include "core/section.hpp"
#include "core/validate.hpp"
#include "ops/columns.hpp"
#include "ops/inputs.hpp"
#include "ops/measure.hpp"
#include "ops/operations.hpp"
#include "ops/parameters.hpp"

namespace terrane {
namespace {

constexpr std::size_t most_panels = 20;  // of a picture

struct ProfileParameters {
  std::optional<Vectors> line;
  std::string line_crs;
  long size = 1200;

  void visit(Fields& f) {
    f.vectors("line", line, "The line, or several: a file, WKT, or x,y,x,y. Of polygons the borders are taken.");
    f.crs("line-crs", line_crs, "The CRS of the line, whatever it says itself.");
    f.integer("size", size, {.minimum = 200, .maximum = 8192}, "Pixels across the picture (PNG).");
  }
};

void check(const nlohmann::json& values, const std::vector<InputPart>&) {
  if (!filled<ProfileParameters>(values).line)
    throw Error(ErrorKind::usage, "missing-parameter", "'profile' needs the parameter line: a file, WKT, or x,y,x,y");
}

/// A line with the section along it and what it came with.
struct Profile {
  nlohmann::json properties;
  Section section;
  std::vector<double> distance;  // of each row
};

struct Profiles {
  std::vector<Profile> all;
  std::vector<std::string> columns, names;
};

/// The places of a line, those left out that are where the one before is.
std::vector<Point2> places_of(const Line& line) {
  std::vector<Point2> places;
  for (const Point& p : line)
    if (!(std::max(std::fabs(p.x), std::fabs(p.y)) <= largest_coordinate)) {
      throw Error(ErrorKind::input, "overflow",
                  "parameter 'line': the place " + nlohmann::json(p.x).dump() + ", " + nlohmann::json(p.y).dump() +
                      " is too far away to compute with; coordinates up to 1e100 can be");
    } else if (places.empty() || !(places.back() == plan(p))) {
      places.push_back(plan(p));
    }
  return places;
}

std::vector<std::pair<nlohmann::json, std::vector<Point2>>> lines_of(Vectors vectors) {
  std::vector<std::pair<nlohmann::json, std::vector<Point2>>> lines;
  for (Feature& feature : vectors.features) {
    Vectors one;
    one.features.push_back(std::move(feature));
    for (const Line& line : one.lines())
      if (auto places = places_of(line); places.size() > 1)
        lines.emplace_back(one.features.front().properties, std::move(places));
  }
  if (lines.empty())
    throw Error(ErrorKind::input, "no-line",
                "parameter 'line' holds no line of two places or more; give a file of lines, WKT, or x,y,x,y");
  return lines;
}

/// Distances along a line of its rows: on the ground where coordinates are degrees.
std::vector<double> distances(const Section& section, const Crs& crs) {
  std::vector<double> along;
  double sum = 0;
  for (std::size_t k = 0; k < section.rows.size(); ++k) {
    if (k > 0 && !(section.rows[k].at == section.rows[k - 1].at))
      sum += line_length(crs, section.rows[k - 1].at, section.rows[k].at);
    along.push_back(sum);
  }
  return along;
}

std::string csv(const Profiles& p) {
  const bool several = p.all.size() > 1;
  std::string text = several ? "line,distance,x,y" : "distance,x,y";
  for (const std::string& column : p.columns) text += "," + csv_cell(column);
  text += "\n";
  for (std::size_t n = 0; n < p.all.size(); ++n) {
    const Profile& profile = p.all[n];
    for (std::size_t k = 0; k < profile.section.rows.size(); ++k) {
      if (several) text += std::to_string(n + 1) + ",";
      add_number(text, profile.distance[k]);
      text += ',';
      add_number(text, profile.section.rows[k].at.x);
      text += ',';
      add_number(text, profile.section.rows[k].at.y);
      for (std::size_t i = 0; i < p.columns.size(); ++i) text += ',', add_number(text, profile.section.height(k, i));
      text += '\n';
    }
  }
  return text;
}

/// A line in space for every stretch that a surface has of a line.
Vectors features(const Profiles& p) {
  Vectors made;
  for (std::size_t n = 0; n < p.all.size(); ++n)
    for (std::size_t i = 0; i < p.columns.size(); ++i) {
      const Profile& profile = p.all[n];
      Line run;
      double from = 0;
      int count = 0;
      const auto finish = [&](std::size_t last) {
        if (run.size() > 1) {
          Feature feature{profile.properties};
          feature.properties["surface"] = p.names[i];
          feature.properties["run"] = ++count;
          if (p.all.size() > 1) feature.properties["line"] = n + 1;
          feature.properties["from"] = from;
          feature.properties["to"] = profile.distance[last];
          feature.lines.push_back(std::move(run));
          made.features.push_back(std::move(feature));
        }
        run.clear();
      };
      for (std::size_t k = 0; k < profile.section.rows.size(); ++k) {
        const double z = profile.section.height(k, i);
        if (std::isnan(z)) {
          finish(k > 0 ? k - 1 : 0);
          continue;
        }
        if (run.empty()) from = profile.distance[k];
        const Point2 at = profile.section.rows[k].at;
        if (run.empty() || !(run.back() == Point{at.x, at.y, z})) run.push_back({at.x, at.y, z});
      }
      finish(profile.section.rows.size() - 1);
    }
  return made;
}

std::string title_of(const Profiles& p, std::size_t n) {
  for (const char* key : {"name", "Name", "NAME", "id"})
    if (const auto it = p.all[n].properties.find(key); it != p.all[n].properties.end() && !it->is_null())
      return it->is_string() ? it->get<std::string>() : it->dump();
  return p.all.size() > 1 ? "Line " + std::to_string(n + 1) : "";
}

Picture picture(const Profiles& p, ChartOptions options) {
  if (p.all.size() > most_panels)
    throw Error(ErrorKind::input, "too-many-lines",
                "a picture shows at most " + std::to_string(most_panels) + " lines, and there are " +
                    std::to_string(p.all.size()) + "; choose some, or CSV or GeoJSON");
  std::vector<ChartPanel> panels;
  for (std::size_t n = 0; n < p.all.size(); ++n)
    panels.push_back({&p.all[n].section, p.all[n].distance, title_of(p, n)});
  options.names = p.names;
  return profile_chart(panels, options);
}

ChartOptions chart_options(const Crs& crs, long size) {
  ChartOptions options;
  options.size = static_cast<int>(size);
  if (!crs.known()) return options;
  options.length_unit = crs.geographic() ? "m" : crs.length_unit();
  options.height_unit = crs.height_unit();
  options.heights_per_length = crs.metres_per_length_unit() / crs.metres_per_height_unit();
  return options;
}

/// How much of the lines each surface has, and a warning where that is nothing.
nlohmann::json report_of(const Profiles& p, Context& context) {
  nlohmann::json report = {{"type", "ProfileReport"}, {"lines", nlohmann::json::array()}};
  std::vector<bool> met(p.columns.size());
  for (const Profile& profile : p.all) {
    nlohmann::json covered = nlohmann::json::array();
    for (std::size_t i = 0; i < p.columns.size(); ++i) {
      double length = 0;
      for (std::size_t k = 1; k < profile.distance.size(); ++k)
        if (!std::isnan(profile.section.height(k - 1, i)) && !std::isnan(profile.section.height(k, i)))
          length += profile.distance[k] - profile.distance[k - 1];
      covered.push_back({{"name", p.names[i]}, {"length", length}});
      met[i] = met[i] || length > 0;
    }
    report["lines"].push_back(
        {{"length", profile.distance.back()}, {"rows", profile.distance.size()}, {"covered", covered}});
  }
  for (std::size_t i = 0; i < met.size(); ++i)
    if (!met[i])
      context.warn({"no-overlap", p.names[i], "", "the line does not meet '" + p.names[i] + "'",
                    "check the CRS of the line (line-crs)"});
  return report;
}

Outcome run(std::vector<Surface>& inputs, const ProfileParameters& p, Context& context) {
  const auto surfaces = surfaces_of(inputs, "surface");
  const Crs& crs = surfaces.front()->crs;
  const auto lines = lines_of(*p.line);
  std::vector<std::unique_ptr<const FaceGrid>> grids;
  std::vector<const FaceGrid*> views;
  const auto profiles = std::make_shared<Profiles>();
  profiles->columns = height_columns(surfaces);
  for (const Surface* s : surfaces) {
    grids.push_back(std::make_unique<FaceGrid>(s->tin()));
    views.push_back(grids.back().get());
    profiles->names.push_back(s->name);
  }
  for (const auto& [properties, line] : lines) {
    Section cut = section(line, views, context);
    std::vector<double> distance = distances(cut, crs);
    profiles->all.push_back({properties, std::move(cut), std::move(distance)});
  }
  Outcome outcome;
  outcome.result = report_of(*profiles, context);
  outcome.csv = [profiles] { return csv(*profiles); };
  outcome.features = [profiles] { return features(*profiles); };
  outcome.picture = [profiles, options = chart_options(crs, p.size)] { return picture(*profiles, options); };
  return outcome;
}

}  // namespace

Operation profile() {
  return operation<ProfileParameters>(
      {.id = "profile",
       .title = "Heights along a line",
       .description =
           "The heights of one or more surfaces along a line, at its corners and wherever it crosses an edge of any of "
           "them: between two rows every surface is straight. Where one jumps, begins or ends there are two rows at "
           "one "
           "distance, what lies before and what lies behind; where there is none its cell is empty. Distances are in "
           "the CRS's length unit, in metres on the ground where coordinates are degrees (the line is straight in "
           "degrees). As GeoJSON a line in space for each stretch of each surface, as PNG a chart.",
       .inputs = {{"surface", 1, 0, false, "The surfaces: TINs or rasters."}},
       .output_formats = {"csv", "geojson", "png"},
       .result = ResultKind::table,
       .check = check,
       .example = {.parameters = {{"line", "500000,4400100;500390,4400150"}}}},
      run);
}

}  // namespace terrane
