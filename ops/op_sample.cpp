// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <memory>
#include <set>

#include "core/error.hpp"
#include "core/face_grid.hpp"
#include "core/parallel.hpp"
#include "ops/columns.hpp"
#include "ops/inputs.hpp"
#include "ops/json_value.hpp"
#include "ops/operations.hpp"
#include "ops/parameters.hpp"

namespace terrane {
namespace {

struct SampleParameters {
  std::optional<Vectors> points;
  std::string points_crs;

  void visit(Fields& f) {
    f.points(
        "points", points,
        "The points: a file (a table with a line of names, too), WKT, or x,y;x,y. Of lines and polygons the corners are "
        "taken. Their properties stay.");
    f.crs("points-crs", points_crs, "The CRS of the points, whatever they say themselves.");
  }
};

void check(const nlohmann::json& values, const std::vector<InputPart>&) {
  if (!filled<SampleParameters>(values).points)
    throw Error(ErrorKind::usage, "missing-parameter", "'sample' needs the parameter points: a file, or x,y;x,y");
}

/// Points with the heights of every surface there.
struct Samples {
  std::vector<Feature> features;  // whose points these are, their shapes taken out
  struct Place {
    std::size_t feature;
    Point at;  // z: as the point came, NaN where it had none
  };
  std::vector<Place> places;
  std::vector<std::string> columns;
  std::vector<double> heights;  // places * columns, NaN outside
  bool given_heights = false;

  const double* row(std::size_t place) const { return heights.data() + place * columns.size(); }
};

Samples samples_of(Vectors points) {
  Samples s;
  for (Feature& feature : points.features) {
    for (const Point& p : feature.points) {
      s.places.push_back({s.features.size(), p});
      s.given_heights = s.given_heights || !std::isnan(p.z);
    }
    s.features.push_back({std::move(feature.properties)});
  }
  return s;
}

/// Finds the heights on one surface; on how many places it has one.
std::size_t read_heights(const Tin& tin, std::size_t column, Samples& s, Context& context) {
  const FaceGrid grid(tin);
  const std::size_t columns = s.columns.size();
  parallel_for(context, s.places.size(), chunk_for(context, s.places.size()), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      s.heights[k * columns + column] = grid.height(plan(s.places[k].at)).value_or(NAN);
  });
  std::size_t found = 0;
  for (std::size_t k = 0; k < s.places.size(); ++k) found += !std::isnan(s.heights[k * columns + column]);
  return found;
}

/// Names of properties in the order in which they come, none of them that of another column.
std::vector<std::pair<std::string, std::string>> property_columns(const Samples& s) {
  std::vector<std::pair<std::string, std::string>> names;  // of the property, of the column
  std::set<std::string> seen, taken(s.columns.begin(), s.columns.end());
  taken.insert({"x", "y", "given_z"});
  for (const Feature& feature : s.features)
    for (const auto& [name, value] : feature.properties.items()) {
      if (!seen.insert(name).second) continue;
      std::string column = name;
      while (!taken.insert(column).second) column += "_";
      names.emplace_back(name, column);
    }
  return names;
}

std::string property_text(const nlohmann::json& value) {
  if (value.is_null()) return "";
  return value.is_string() ? csv_cell(value.get_ref<const std::string&>()) : csv_cell(value.dump());
}

/// Every point of a feature repeats its properties.
class Repeated {
 public:
  void add(std::size_t bytes) {
    bytes_ += bytes;
    if (bytes_ > most)
      throw Error(ErrorKind::limit, "too-many-properties",
                  "the properties of the points, repeated for each, come to more than 256 MiB; send fewer of them");
  }

 private:
  static constexpr std::size_t most = 256 << 20;
  std::size_t bytes_ = 0;
};

std::string csv(const Samples& s) {
  const auto properties = property_columns(s);
  std::string text;
  for (const auto& [name, column] : properties) text += csv_cell(column) + ",";
  text += s.given_heights ? "x,y,given_z" : "x,y";
  for (const std::string& column : s.columns) text += "," + csv_cell(column);
  text += "\n";
  std::string own;  // what the feature's properties come to
  Repeated repeated;
  for (std::size_t k = 0; k < s.places.size(); ++k) {
    const Samples::Place& place = s.places[k];
    if (k == 0 || place.feature != s.places[k - 1].feature) {
      own.clear();
      const auto& values = s.features[place.feature].properties;
      for (const auto& [name, column] : properties)
        own += (values.contains(name) ? property_text(values[name]) : "") + ",";
    }
    repeated.add(own.size());
    text += own;
    add_number(text, place.at.x);
    text += ',';
    add_number(text, place.at.y);
    if (s.given_heights) text += ',', add_number(text, place.at.z);
    for (std::size_t i = 0; i < s.columns.size(); ++i) text += ',', add_number(text, s.row(k)[i]);
    text += '\n';
  }
  return text;
}

/// A point each, at its height where there is one surface, with the heights among the properties.
Vectors features(const Samples& s) {
  Vectors made;
  Repeated repeated;
  std::size_t own = 0;
  for (std::size_t k = 0; k < s.places.size(); ++k) {
    const Samples::Place& place = s.places[k];
    if (k == 0 || place.feature != s.places[k - 1].feature)
      own = json_text(s.features[place.feature].properties).size();
    repeated.add(own);
    Feature feature = s.features[place.feature];
    if (s.given_heights && !std::isnan(place.at.z)) feature.properties["given_z"] = place.at.z;
    for (std::size_t i = 0; i < s.columns.size(); ++i) {
      const double z = s.row(k)[i];
      feature.properties[s.columns[i]] = std::isnan(z) ? nlohmann::json() : nlohmann::json(z);
    }
    feature.points.push_back({place.at.x, place.at.y, s.columns.size() == 1 ? s.row(k)[0] : NAN});
    made.features.push_back(std::move(feature));
  }
  return made;
}

Outcome run(std::vector<Surface>& inputs, const SampleParameters& p, Context& context) {
  const auto surfaces = surfaces_of(inputs, "surface");
  const auto s = std::make_shared<Samples>(samples_of(*p.points));
  if (s->places.empty())
    throw Error(ErrorKind::input, "no-points", "parameter 'points' holds no point; give a file of points, or x,y;x,y");
  s->columns = height_columns(surfaces);
  s->heights.assign(s->places.size() * surfaces.size(), NAN);
  nlohmann::json report = {
      {"type", "SampleReport"}, {"points", s->places.size()}, {"surfaces", nlohmann::json::array()}};
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    context.progress("sample", static_cast<double>(i) / static_cast<double>(surfaces.size()));
    const std::size_t found = read_heights(surfaces[i]->tin(), i, *s, context);
    report["surfaces"].push_back({{"name", surfaces[i]->name}, {"column", s->columns[i]}, {"found", found}});
    if (found == 0)
      context.warn({"no-overlap", surfaces[i]->name, "", "none of the points lies on '" + surfaces[i]->name + "'",
                    "check the CRS of the points (points-crs)"});
  }
  Outcome outcome;
  outcome.result = std::move(report);
  outcome.csv = [s] { return csv(*s); };
  outcome.features = [s] { return features(*s); };
  return outcome;
}

}  // namespace

Operation sample() {
  return operation<SampleParameters>(
      {.id = "sample",
       .title = "Heights at points",
       .description =
           "The height of every surface at every point, a row per point and a column per surface, with the points' own "
           "properties; nothing where there is no surface, the upper height at a wall. A vertex has its height "
           "exactly.",
       .inputs = {{"surface", 1, 0, false, "The surfaces: TINs or rasters."}},
       .output_formats = {"csv", "geojson"},
       .result = ResultKind::table,
       .check = check,
       .example = {.parameters = {{"points", "500100,4400100;500150,4400150"}}}},
      run);
}

}  // namespace terrane
