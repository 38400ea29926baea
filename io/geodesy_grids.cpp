// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include <dlfcn.h>
#include <proj.h>

#include "io/geodesy_osr.hpp"

// Which grids a transformation would need. GDAL can say only that there is no way, so PROJ is asked. It is always
// loaded, because GDAL stands on it, but it is not ours to link with: its functions are looked up by name.
namespace terrane {

namespace {

template <class Function>
Function* proj_function(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_DEFAULT, name));
}

struct Proj {
#define TERRANE_PROJ(name) decltype(::proj_##name)* name = proj_function<decltype(::proj_##name)>("proj_" #name)
  TERRANE_PROJ(context_create);
  TERRANE_PROJ(context_destroy);
  TERRANE_PROJ(context_set_enable_network);
  TERRANE_PROJ(log_level);
  TERRANE_PROJ(create);
  TERRANE_PROJ(destroy);
  TERRANE_PROJ(create_operation_factory_context);
  TERRANE_PROJ(operation_factory_context_destroy);
  TERRANE_PROJ(operation_factory_context_set_allow_ballpark_transformations);
  TERRANE_PROJ(operation_factory_context_set_grid_availability_use);
  TERRANE_PROJ(operation_factory_context_set_spatial_criterion);
  TERRANE_PROJ(operation_factory_context_set_area_of_interest);
  TERRANE_PROJ(create_operations);
  TERRANE_PROJ(list_get_count);
  TERRANE_PROJ(list_get);
  TERRANE_PROJ(list_destroy);
  TERRANE_PROJ(coordoperation_get_grid_used_count);
  TERRANE_PROJ(coordoperation_get_grid_used);
#undef TERRANE_PROJ

  bool complete() const {
    return context_create && context_destroy && context_set_enable_network && log_level && create && destroy &&
           create_operation_factory_context && operation_factory_context_destroy &&
           operation_factory_context_set_allow_ballpark_transformations &&
           operation_factory_context_set_grid_availability_use && operation_factory_context_set_spatial_criterion &&
           operation_factory_context_set_area_of_interest && create_operations && list_get_count && list_get &&
           list_destroy && coordoperation_get_grid_used_count && coordoperation_get_grid_used;
  }
};

const Proj& proj() {
  static const Proj functions;
  return functions;
}

/// The grids an operation lacks.
std::vector<std::string> lacking(PJ_CONTEXT* context, const PJ* operation) {
  std::vector<std::string> names;
  const int count = proj().coordoperation_get_grid_used_count(context, operation);
  for (int k = 0; k < count; ++k) {
    const char* name = nullptr;
    int available = 1;
    if (proj().coordoperation_get_grid_used(context, operation, k, &name, nullptr, nullptr, nullptr, nullptr, nullptr,
                                            &available) &&
        !available && name && *name)
      names.emplace_back(name);
  }
  return names;
}

}  // namespace

std::vector<std::string> missing_grids(const Crs& from, const Crs& to, const Box& lon_lat) {
  if (!proj().complete()) return {};
  const auto context =
      std::unique_ptr<PJ_CONTEXT, decltype(proj().context_destroy)>(proj().context_create(), proj().context_destroy);
  proj().context_set_enable_network(context.get(), 0);
  proj().log_level(context.get(), PJ_LOG_NONE);
  using Object = std::unique_ptr<PJ, decltype(proj().destroy)>;
  const Object source(proj().create(context.get(), from.inside().definition.c_str()), proj().destroy);
  const Object target(proj().create(context.get(), to.inside().definition.c_str()), proj().destroy);
  const auto factory =
      std::unique_ptr<PJ_OPERATION_FACTORY_CONTEXT, decltype(proj().operation_factory_context_destroy)>(
          proj().create_operation_factory_context(context.get(), nullptr), proj().operation_factory_context_destroy);
  if (!source || !target || !factory) return {};
  proj().operation_factory_context_set_allow_ballpark_transformations(context.get(), factory.get(), 0);
  proj().operation_factory_context_set_grid_availability_use(context.get(), factory.get(),
                                                             PROJ_GRID_AVAILABILITY_IGNORED);
  proj().operation_factory_context_set_spatial_criterion(context.get(), factory.get(),
                                                         PROJ_SPATIAL_CRITERION_PARTIAL_INTERSECTION);
  if (is_area(lon_lat)) {
    const Box area = area_of_interest(lon_lat);
    proj().operation_factory_context_set_area_of_interest(context.get(), factory.get(), area.xmin, area.ymin, area.xmax,
                                                          area.ymax);
  }
  const auto list = std::unique_ptr<PJ_OBJ_LIST, decltype(proj().list_destroy)>(
      proj().create_operations(context.get(), source.get(), target.get(), factory.get()), proj().list_destroy);
  std::vector<std::string> names;
  const int count = list ? proj().list_get_count(list.get()) : 0;
  for (int k = 0; k < count && names.size() < 3; ++k) {
    const Object operation(proj().list_get(context.get(), list.get(), k), proj().destroy);
    if (!operation) continue;
    for (std::string& name : lacking(context.get(), operation.get()))
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(std::move(name));
  }
  return names;
}

}  // namespace terrane
