#include "halfspace/fit_many.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "dispatch/default_fp_mode.h"
#include "dispatch/errors/error.h"
#include "dispatch/errors/memory_checks.h"
#include "dispatch/targets/chosen_target.h"
#include "kernels/fit_many/kernel_table.h"

namespace halfspace::detail {
namespace {

using dispatch::CheckPointer;
using dispatch::Overlap;
using dispatch::ThrowInvalid;
using kernels::FitJob;
using kernels::FitTally;

void CheckSize(std::string_view call, std::string_view argument,
               std::size_t given, std::size_t expected) {
  if (given == expected) return;
  ThrowInvalid(call, argument,
               std::to_string(expected) + ", as many as planes.size asks for",
               std::to_string(given));
}

// The names of a source in messages: the argument, which also names its
// elements, and the members that have its columns.
struct SourceNames {
  std::string_view argument;
  std::string_view member;
  std::string_view last_member = {};  // of columns from `dims` on
};

// Checks the arguments that all calls have, then runs the kernel.
class Call {
 public:
  Call(const char* name, const SourceNames& source_names, const Source& source,
       const Output& output, const FitOptions& options)
      : name_(name),
        source_names_(source_names),
        // Also if there is no choice, because it checks the target.
        target_index_(dispatch::IndexOf(options.target, name)),
        source_(source),
        output_(output),
        options_(options) {}

  // Checks another input of so many bytes.
  void CheckInput(const void* begin, std::size_t bytes, std::size_t alignment,
                  std::string_view argument) const {
    if (output_.size == 0 || bytes == 0) return;
    const auto name = [&] { return argument; };
    CheckPointer(name_, begin, alignment, name,
                 [] { return "readable memory"; });
    CheckApart(begin, bytes, name);
  }

  Target Run(Span<const std::uint32_t> indices, Span<const std::size_t> ends,
             FitStatus* status) const {
    if (options_.inverted > Inverted::kEmpty) {
      ThrowInvalid(name_, "options.inverted", "one of the enumerators",
                   std::to_string(static_cast<int>(options_.inverted)));
    }
    if (output_.size != 0) Check();
    const bool is_double = source_.columns.is_double;
    const FitJob job = {
        .columns = source_.columns,
        .planes = output_.planes.data(),
        .size = output_.size,
        .indices = indices.data(),
        .ends = ends.data(),
        .inverted_is_empty = options_.inverted == Inverted::kEmpty};
    const dispatch::DefaultFpMode mode;
    const FitKernels& kernels = source_.kernels[is_double ? 0 : target_index_];
    const FitTally tally = kernels.fit(job);
    Count(tally, status);
    return is_double ? CompiledTargets()[target_index_]
                     : Target::FromHighwayBit(tally.target);
  }

 private:
  // The name of the member that has the pointer of a column.
  std::string ColumnName(std::size_t c) const {
    const auto dims = static_cast<std::size_t>(source_.dims);
    std::string name(source_names_.argument);
    name += '.';
    name += c < dims ? source_names_.member : source_names_.last_member;
    const bool is_alone =
        source_.has_one_pointer || source_.column_count == c - c % dims + 1;
    return is_alone ? name : name + "[" + std::to_string(c % dims) + "]";
  }

  void CheckSource() const {
    const std::string_view argument = source_names_.argument;
    const Columns& columns = source_.columns;
    if (columns.size == 0) return;
    dispatch::CheckExtent(name_, argument, columns.scalar_bytes(), columns.size,
                          columns.stride,
                          source_.has_one_pointer ? source_.column_count : 1);
    for (std::size_t c = 0; c < source_.column_count; ++c) {
      CheckPointer(
          name_, columns.column[c], columns.scalar_bytes(),
          [&] { return ColumnName(c); },
          [&] {
            return std::to_string(columns.size) + ' ' + std::string(argument);
          });
    }
  }

  std::string PlaneName(std::size_t plane) const {
    return dispatch::PlaneName(
        "planes", static_cast<std::size_t>(source_.dims) + 1, plane);
  }

  template <typename Visit>
  void ForEachPlane(const Visit& visit) const {
    for (std::size_t p = 0; p < output_.planes.size(); ++p) {
      if (((output_.wanted >> p) & 1) != 0) visit(p, output_.planes[p]);
    }
  }

  // Throws if a plane before plane `end` overlaps these `bytes` bytes.
  template <typename Name>
  void CheckApart(const void* other, std::size_t bytes, const Name& name,
                  std::size_t end = kMaxPlanes) const {
    ForEachPlane([&](std::size_t p, const float* plane) {
      if (p < end &&
          Overlap(plane, output_.size * sizeof(float), other, bytes)) {
        dispatch::ThrowOverlap(name_, PlaneName(p), name());
      }
    });
  }

  void CheckOutput() const {
    dispatch::CheckAddressable(name_, "planes.size", output_.size,
                               sizeof(float));
    ForEachPlane([&](std::size_t p, const float* plane) {
      CheckPointer(
          name_, plane, alignof(float), [&] { return PlaneName(p); },
          [&] { return std::to_string(output_.size) + " floats"; });
    });
    ForEachPlane([&](std::size_t p, const float* plane) {
      CheckApart(
          plane, output_.size * sizeof(float), [&] { return PlaneName(p); }, p);
    });
  }

  void Check() const {
    CheckSource();
    CheckOutput();
    for (std::size_t c = 0; c < source_.column_count; ++c) {
      CheckApart(
          source_.columns.column[c],
          dispatch::ColumnBytes(source_.columns.size, source_.columns.stride,
                                source_.columns.scalar_bytes()),
          [&] { return ColumnName(c); });
    }
  }

  void Count(const FitTally& tally, FitStatus* status) const {
    if (status == nullptr) return;
    if (status->everything == 0 && tally.everything != 0) {
      status->first_everything = status->results + tally.first_everything;
    }
    status->everything += tally.everything;
    status->results += output_.size;
  }

  const char* name_;
  SourceNames source_names_;
  std::size_t target_index_;
  const Source& source_;
  const Output& output_;
  const FitOptions& options_;
};

}  // namespace

Target BoundBoxes(const Source& boxes, const Output& output,
                  const FitOptions& options, FitStatus* status) {
  const Call call("BoundBoxes", {"boxes", "min", "max"}, boxes, output,
                  options);
  CheckSize("BoundBoxes", "boxes.count", boxes.columns.size, output.size);
  return call.Run({}, {}, status);
}

Target BoundSpheres(const Source& spheres, const Output& output,
                    const FitOptions& options, FitStatus* status) {
  const Call call("BoundSpheres", {"spheres", "center", "radius"}, spheres,
                  output, options);
  CheckSize("BoundSpheres", "spheres.count", spheres.columns.size, output.size);
  return call.Run({}, {}, status);
}

Target BoundTriangles(const Source& vertices, Span<const std::uint32_t> indices,
                      const Output& output, const FitOptions& options,
                      FitStatus* status) {
  constexpr std::size_t kCorners = 3;
  const Call call("BoundTriangles", {"vertices", "coords"}, vertices, output,
                  options);
  dispatch::CheckAddressable("BoundTriangles", "planes.size", output.size,
                             kCorners * sizeof(float));
  CheckSize("BoundTriangles", "indices.size()", indices.size(),
            kCorners * output.size);
  call.CheckInput(indices.data(), indices.size() * sizeof(std::uint32_t),
                  alignof(std::uint32_t), "indices");
  return call.Run(indices, {}, status);
}

Target BoundPointSets(const Source& points, Span<const std::size_t> ends,
                      const Output& output, const FitOptions& options,
                      FitStatus* status) {
  const Call call("BoundPointSets", {"points", "coords"}, points, output,
                  options);
  CheckSize("BoundPointSets", "ends.size()", ends.size(), output.size);
  call.CheckInput(ends.data(), ends.size() * sizeof(std::size_t),
                  alignof(std::size_t), "ends");
  return call.Run({}, ends, status);
}

}  // namespace halfspace::detail
