// The part of the program that is compiled as C++20.
#ifndef CONSUMER_CXX20_H_
#define CONSUMER_CXX20_H_

#include <halfspace/halfspace.h>

#include <cstddef>
#include <cstdint>

std::size_t SurvivorsInCxx20(const halfspace::AaboWorld3& world,
                             const halfspace::Aabo3& query,
                             halfspace::Span<std::uint32_t> indices);

#endif  // CONSUMER_CXX20_H_
