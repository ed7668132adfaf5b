// What every function of the C API shares: a call ends with a status, whatever
// happens in it.
#ifndef HALFSPACE_C_CALL_H_
#define HALFSPACE_C_CALL_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <new>
#include <string_view>
#include <type_traits>
#include <utility>

#include "halfspace/c/halfspace.h"
#include "halfspace/detail/plane_arrays.h"
#include "halfspace/error.h"
#include "halfspace/memory.h"
#include "halfspace/targets.h"

// The formats of C99, which gcc for Windows knows under another name.
#if defined(__MINGW32__) && !defined(__clang__)
#define HALFSPACE_PRINTF gnu_printf
#else
#define HALFSPACE_PRINTF printf
#endif

namespace halfspace::c {

// Thrown by Call::Fail(), which has written the message.
struct Failure {
  hs_status status;
};

// The name of an argument, of a field of it, or of an element.
class Name {
 public:
  // Implicit, as most are the name of an argument. "" is for a message that is
  // about no argument alone.
  // NOLINTNEXTLINE(google-explicit-constructor)
  Name(const char* argument, const char* field = "",
       std::size_t index = Error::kNoIndex);
  Name(std::string_view argument, std::size_t index);

  const char* c_str() const { return text_.data(); }

 private:
  std::array<char, 96> text_;
};

// The name of the function that was called, and its errors: a message that
// begins with the name, and a Failure, of which Run() makes the status.
class Call {
 public:
  explicit constexpr Call(const char* name) : name_(name) {}

  const char* name() const { return name_; }

  // Writes the message "NAME: ARGUMENT: FORMAT..." and throws.
  [[noreturn, gnu::cold, gnu::format(HALFSPACE_PRINTF, 4, 5)]] void Fail(
      hs_status status, const Name& argument, const char* format, ...) const;

  // Writes the message of an error of the C++ library, whose argument has this
  // name here, and throws.
  [[noreturn, gnu::cold]] void Fail(hs_status status, const Error& error,
                                    const char* argument) const;

  // Fails if the pointer is null, or is not aligned for its type.
  template <typename T>
  void CheckPointer(const char* argument, T* pointer) const {
    if (pointer == nullptr) FailNull(argument);
    if constexpr (!std::is_function_v<T>) {
      if (reinterpret_cast<std::uintptr_t>(pointer) % alignof(T) != 0) {
        FailMisaligned(argument, alignof(T));
      }
    }
  }
  // Fails if the array is null or misaligned, or too large for the address
  // space. Without elements it may be null.
  template <typename T>
  void CheckArray(const char* argument, const T* array,
                  std::size_t count) const {
    if (count == 0) return;
    CheckPointer(argument, array);
    if (count > PTRDIFF_MAX / sizeof(T)) FailTooMany(argument, count);
  }

 private:
  [[noreturn, gnu::cold]] void FailNull(const char* argument) const;
  [[noreturn, gnu::cold]] void FailMisaligned(const char* argument,
                                              std::size_t alignment) const;
  [[noreturn, gnu::cold]] void FailTooMany(const char* argument,
                                           std::size_t count) const;

  const char* name_;
};

// The status of the exception that is being handled, and its message.
hs_status StatusOfException(const Call& call) noexcept;

// Runs body(call), and returns how it ended.
template <typename Body>
hs_status Run(const char* name, const Body& body) noexcept {
  const Call call(name);
  try {
    body(call);
    return HS_OK;
  } catch (...) {
    return StatusOfException(call);
  }
}

// Writes what get() returns of `from` to `*value`.
template <typename From, typename Value, typename Function>
hs_status Get(const char* name, const char* from_name, const From* from,
              const char* value_name, Value* value, const Function& get) {
  return Run(name, [&](const Call& call) {
    call.CheckPointer(from_name, from);
    call.CheckPointer(value_name, value);
    *value = get();
  });
}

// Copies the fields that the caller's struct has over those of `options`, which
// has the defaults. Each struct begins with its size. A struct of another
// version ends between two fields: so a field that is added must not be placed
// in the padding at the end of the struct, and its size must be a multiple
// of 4.
void ReadStruct(const Call& call, const char* argument, const void* given,
                void* options, std::size_t size);
hs_status WriteDefaults(const char* name, const void* defaults,
                        std::size_t size, void* options,
                        std::size_t struct_size);
// The function of the C API that writes the defaults of a struct.
#define HALFSPACE_DEFAULTS_OF(Type, defaults)                                 \
  hs_status Type##_default(Type* to, size_t struct_size) {                    \
    return halfspace::c::WriteDefaults(#Type "_default",                      \
                                       &halfspace::c::defaults, sizeof(Type), \
                                       to, struct_size);                      \
  }

template <typename Options>
Options ReadOptions(const Call& call, const char* argument,
                    const Options* given, const Options& defaults) {
  Options options = defaults;
  if (given != nullptr) {
    call.CheckPointer(argument, given);
    ReadStruct(call, argument, given, &options, sizeof(options));
  }
  return options;
}
// As ReadOptions(), but null is an error.
template <typename Config>
Config ReadConfig(const Call& call, const Config* given,
                  const Config& defaults) {
  call.CheckPointer("config", given);
  return ReadOptions(call, "config", given, defaults);
}

// Null is the chosen target.
Target ReadTarget(const Call& call, const char* argument, const char* name);
MemoryResource ReadAllocator(const Call& call, const hs_allocator& allocator,
                             const char* argument = "config->allocator");

// An object in memory of its own resource.
template <typename T, typename... Arguments>
T* New(const MemoryResource& memory, Arguments&&... arguments) {
  static_assert(alignof(T) <= 64);
  void* const block = detail::AllocateBlock(memory, sizeof(T));
  try {
    return new (block) T(std::forward<Arguments>(arguments)...);
  } catch (...) {
    detail::FreeBlock(memory, block, sizeof(T));
    throw;
  }
}
// `memory` is a copy, as the object has the other.
template <typename T>
void Delete(MemoryResource memory, T* object) noexcept {
  object->~T();
  detail::FreeBlock(memory, object, sizeof(T));
}

}  // namespace halfspace::c

#endif  // HALFSPACE_C_CALL_H_
