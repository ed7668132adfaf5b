#include "cxx20.h"

#include <span>

std::size_t SurvivorsInCxx20(const halfspace::AaboWorld3& world,
                             const halfspace::Aabo3& query,
                             halfspace::Span<std::uint32_t> indices) {
  const std::span<std::uint32_t> standard = indices;
  return halfspace::Survivors(world, query, standard.first(1),
                              {.schedule = halfspace::Schedule::kFlat});
}
