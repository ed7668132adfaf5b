#include "c/call.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "halfspace/version.h"

namespace halfspace::c {
namespace {

// Nothing is allocated for a message: there may be no memory.
constinit thread_local char last_error[512] = "";

// More than a struct will ever have: so a size that was never set is found, and
// no memory far behind the struct is read.
constexpr std::size_t kLargestStruct = 4096;

[[gnu::format(printf, 2, 3)]] void SetMessage(const Call& call,
                                              const char* format, ...) {
  // Into a buffer of its own, because an argument can be part of the last
  // message.
  char text[sizeof(last_error)];
  const int length = std::snprintf(text, sizeof(text), "%s: ", call.name());
  const auto begin =
      std::min(static_cast<std::size_t>(std::max(length, 0)), sizeof(text) - 1);
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text + begin, sizeof(text) - begin, format, arguments);
  va_end(arguments);
  std::memcpy(last_error, text, sizeof(text));
}

}  // namespace

void Call::Fail(hs_status status, const char* format, ...) const {
  char text[sizeof(last_error)];
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof(text), format, arguments);
  va_end(arguments);
  SetMessage(*this, "%s", text);
  throw Failure{status};
}

void Call::FailNull(const char* argument) const {
  Fail(HS_INVALID_ARGUMENT, "%s: expected a pointer, got null", argument);
}

void Call::FailMisaligned(const char* argument, std::size_t alignment) const {
  Fail(HS_INVALID_ARGUMENT,
       "%s: expected memory aligned to %zu bytes, got a misaligned pointer",
       argument, alignment);
}

void Call::FailTooMany(const char* argument, std::size_t count) const {
  Fail(HS_INVALID_ARGUMENT,
       "%s: expected a size that fits the address space, got %zu elements",
       argument, count);
}

namespace {

constexpr std::string_view kPrefix = "halfspace: ";
constexpr std::string_view kAllocator = "MemoryResource::allocate: ";

}  // namespace

const char* TextOf(const std::invalid_argument& error) {
  const std::string_view what = error.what();
  // A handler could throw another message.
  if (what.substr(0, kPrefix.size()) != kPrefix) return what.data();
  const std::string_view text = what.substr(kPrefix.size());
  const std::size_t end = text.find(": ");
  constexpr std::size_t kNone = std::string_view::npos;
  const bool has_function =
      end != kNone && text.substr(0, end).find(' ') == kNone;
  return text.data() + (has_function ? end + 2 : 0);
}

bool IsOfAllocator(const std::invalid_argument& error) {
  const std::string_view what = error.what();
  return what.substr(0, kPrefix.size()) == kPrefix &&
         what.substr(kPrefix.size(), kAllocator.size()) == kAllocator;
}

hs_status StatusOfException(const Call& call) noexcept {
  try {
    throw;
  } catch (const Failure& failure) {
    return failure.status;
  } catch (const std::bad_alloc&) {
    SetMessage(call, "an allocation failed");
    return HS_OUT_OF_MEMORY;
  } catch (const std::length_error&) {
    SetMessage(call, "expected sizes that fit the address space, got more");
    return HS_OUT_OF_MEMORY;
  } catch (const std::invalid_argument& error) {
    SetMessage(call, "%s%s",
               IsOfAllocator(error) ? "config->allocator.allocate: " : "",
               TextOf(error));
    return HS_INVALID_ARGUMENT;
  } catch (const std::exception& error) {
    SetMessage(call, "an exception ended the call: %s", error.what());
    return HS_INTERNAL;
  } catch (...) {
    SetMessage(call,
               "an exception of a callback, an allocator or an error handler "
               "ended the call");
    return HS_INTERNAL;
  }
}

void ReadStruct(const Call& call, const char* argument, const void* given,
                void* options, std::size_t size) {
  std::size_t given_size = 0;
  std::memcpy(&given_size, given, sizeof(given_size));
  if (given_size < sizeof(given_size) || given_size > kLargestStruct) {
    call.Fail(HS_INVALID_ARGUMENT,
              "%s->struct_size: expected sizeof *%s, as the function "
              "..._default() sets it, got %zu",
              argument, argument, given_size);
  }
  if (given_size % 4 != 0) {
    call.Fail(HS_INVALID_ARGUMENT,
              "%s->struct_size: expected a multiple of 4, as the function "
              "..._default() sets it, got %zu",
              argument, given_size);
  }
  const auto* const bytes = static_cast<const unsigned char*>(given);
  for (std::size_t i = size; i < given_size; ++i) {
    if (bytes[i] == 0) continue;
    call.Fail(HS_INVALID_ARGUMENT,
              "%s: expected a struct of up to %zu bytes, or 0 in the others, "
              "as this library knows no more fields, got another value at byte "
              "%zu: use a newer library",
              argument, size, i);
  }
  std::memcpy(options, given, std::min(size, given_size));
}

hs_status WriteDefaults(const char* name, const void* defaults,
                        std::size_t size, void* options,
                        std::size_t struct_size) {
  return Run(name, [&](const Call& call) {
    if (options == nullptr) {
      call.Fail(HS_INVALID_ARGUMENT,
                "the struct: expected a pointer, got null");
    }
    if (struct_size < sizeof(std::size_t) || struct_size > kLargestStruct ||
        struct_size % 4 != 0) {
      call.Fail(HS_INVALID_ARGUMENT,
                "struct_size: expected the sizeof of the struct, got %zu",
                struct_size);
    }
    std::memset(options, 0, struct_size);
    std::memcpy(options, defaults, std::min(size, struct_size));
    std::memcpy(options, &struct_size, sizeof(struct_size));
  });
}

Target ReadTarget(const Call& call, const char* argument, const char* name) {
  if (name == nullptr) return {};
  const std::optional<Target> target = FindTarget(name);
  if (!target) {
    call.Fail(HS_INVALID_ARGUMENT,
              "%s->target: expected null or a name of hs_target_name(), got "
              "\"%.64s\"",
              argument, name);
  }
  return *target;
}

MemoryResource ReadAllocator(const Call& call, const hs_allocator& allocator) {
  if ((allocator.allocate == nullptr) != (allocator.deallocate == nullptr)) {
    call.Fail(HS_INVALID_ARGUMENT,
              "config->allocator: expected both functions or neither, got %s "
              "alone",
              allocator.allocate != nullptr ? "allocate" : "deallocate");
  }
  return {allocator.allocate, allocator.deallocate, allocator.context};
}

}  // namespace halfspace::c

using halfspace::c::Call;

const char* hs_version() { return HALFSPACE_VERSION_STRING; }

const char* hs_last_error() { return halfspace::c::last_error; }

const char* hs_status_name(hs_status status) {
  switch (status) {
    case HS_OK:
      return "HS_OK";
    case HS_INVALID_ARGUMENT:
      return "HS_INVALID_ARGUMENT";
    case HS_OUT_OF_MEMORY:
      return "HS_OUT_OF_MEMORY";
    case HS_IO_ERROR:
      return "HS_IO_ERROR";
    case HS_CORRUPT:
      return "HS_CORRUPT";
    case HS_UNSUPPORTED:
      return "HS_UNSUPPORTED";
    case HS_INTERNAL:
      return "HS_INTERNAL";
  }
  return "unknown status";
}

size_t hs_target_count() { return halfspace::SupportedTargets().size(); }

const char* hs_target_name(size_t i) {
  const auto targets = halfspace::SupportedTargets();
  // Names are literals of Highway, so they end with a null character.
  return i < targets.size() ? targets[i].name().data() : nullptr;
}

hs_status hs_chosen_target(const char** name) {
  return halfspace::c::Run("hs_chosen_target", [&](const Call& call) {
    call.CheckPointer("name", name);
    *name = halfspace::ChosenTarget().name().data();
  });
}
