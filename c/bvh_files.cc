// hs_bvh_...() of blobs and files.
#include <cstddef>
#include <cstdint>

#include "c/bvh.h"
#include "c/call.h"
#include "c/files.h"

namespace halfspace::c {
namespace {

void Verify(const Call& call, const hs_bvh& bvh) {
  if (bvh.core.Verify()) return;
  call.Fail(HS_CORRUPT, "",
            "expected the bytes that hs_bvh_blob() returned, got altered ones: "
            "store the BVH again");
}

// Bytes that are no BVH are HS_CORRUPT. A mistake of the caller's is not.
void LoadBytes(const Call& call, const char* argument, hs_bvh& bvh,
               Span<const std::byte> bytes, bool is_in_place) {
  try {
    bvh.core.Load(bytes, is_in_place);
  } catch (const Error& error) {
    if (error.argument() != "blob") throw;
    call.Fail(HS_CORRUPT, error, argument);
  }
}

hs_bvh* FromBytes(const Call& call, const char* argument,
                  const BvhConfig& config, Span<const std::byte> bytes) {
  auto bvh = MakeBvh(config.layout, config.options.memory);
  LoadBytes(call, argument, *bvh, bytes, /*is_in_place=*/false);
  Verify(call, *bvh);
  return bvh.release();
}

hs_bvh* Load(const Call& call, const char* path, const BvhConfig& config) {
  const Mapped file{MapFile(call, path)};
  return FromBytes(call, "path", config, file.bytes);
}

}  // namespace

NewBvh MapBvh(const Call& call, const char* path, const BvhConfig& config) {
  auto bvh = MakeBvh(config.layout, config.options.memory);
  bvh->mapped = MapFile(call, path);
  LoadBytes(call, "path", *bvh, bvh->mapped, /*is_in_place=*/true);
  return bvh;
}

// The file of a BVH without memory has a header as well: an empty file is one
// that was lost.
void SaveBvh(const Call& call, const char* path, const PlaneLayout& layout,
             const detail::BvhTree& tree) {
  NewFile file(call, path, NewFile::kToPublish);
  const Span<const std::byte> blob = tree.Blob();
  if (blob.empty()) {
    detail::BvhTree empty(TypeOf(layout), tree.memory());
    empty.Reserve(1);
    file.Write(call, empty.Blob());
  } else {
    file.Write(call, blob);
  }
  file.Publish(call);
}

}  // namespace halfspace::c

using halfspace::Span;
using halfspace::c::BvhConfig;
using halfspace::c::Call;
using halfspace::c::Run;

hs_bvh::~hs_bvh() {
  if (!mapped.empty()) halfspace::c::Unmap(mapped);
}

hs_status hs_bvh_blob(const hs_bvh* bvh, const void** data, size_t* size) {
  return Run("hs_bvh_blob", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    call.CheckPointer("data", data);
    call.CheckPointer("size", size);
    const Span<const std::byte> blob = bvh->core.Blob();
    *data = blob.data();
    *size = blob.size();
  });
}

hs_status hs_blob_kind(const void* data, size_t size, hs_kind* kind) {
  return Run("hs_blob_kind", [&](const Call& call) {
    const auto* const bytes = static_cast<const std::byte*>(data);
    call.CheckArray("data", bytes, size);
    call.CheckPointer("kind", kind);
    const hs_kind found =
        halfspace::c::KindOf(halfspace::detail::LayoutOfBlob({bytes, size}));
    if (found == 0) {
      call.Fail(HS_CORRUPT, "data",
                "expected the bytes of a stored BVH, got others");
    }
    *kind = found;
  });
}

hs_status hs_bvh_from_blob(const hs_bvh_config* config, const void* data,
                           size_t size, hs_bvh** bvh) {
  return Run("hs_bvh_from_blob", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    const BvhConfig read(call, config);
    const auto* const bytes = static_cast<const std::byte*>(data);
    call.CheckArray("data", bytes, size);
    *bvh = halfspace::c::FromBytes(call, "data", read, {bytes, size});
  });
}

hs_status hs_bvh_in_place(const hs_bvh_config* config, const void* data,
                          size_t size, hs_bvh** bvh) {
  return Run("hs_bvh_in_place", [&](const Call& call) {
    constexpr size_t kAlignment = 64;
    call.CheckPointer("bvh", bvh);
    const BvhConfig read(call, config);
    const auto* const bytes = static_cast<const std::byte*>(data);
    call.CheckArray("data", bytes, size);
    auto loaded = halfspace::c::MakeBvh(read.layout, read.options.memory);
    halfspace::c::LoadBytes(
        call, "data", *loaded, {bytes, size},
        reinterpret_cast<std::uintptr_t>(bytes) % kAlignment == 0);
    *bvh = loaded.release();
  });
}

hs_status hs_bvh_save(const hs_bvh* bvh, const char* path) {
  return Run("hs_bvh_save", [&](const Call& call) {
    const halfspace::c::NoCancel no_cancel;
    call.CheckPointer("bvh", bvh);
    call.CheckPointer("path", path);
    halfspace::c::SaveBvh(call, path, bvh->layout, bvh->core);
  });
}

hs_status hs_bvh_load(const hs_bvh_config* config, const char* path,
                      hs_bvh** bvh) {
  return Run("hs_bvh_load", [&](const Call& call) {
    const halfspace::c::NoCancel no_cancel;
    call.CheckPointer("bvh", bvh);
    call.CheckPointer("path", path);
    *bvh = halfspace::c::Load(call, path, BvhConfig(call, config));
  });
}

hs_status hs_bvh_map(const hs_bvh_config* config, const char* path,
                     hs_bvh** bvh) {
  return Run("hs_bvh_map", [&](const Call& call) {
    const halfspace::c::NoCancel no_cancel;
    call.CheckPointer("bvh", bvh);
    call.CheckPointer("path", path);
    *bvh = halfspace::c::MapBvh(call, path, BvhConfig(call, config)).release();
  });
}

hs_status hs_bvh_verify(const hs_bvh* bvh) {
  return Run("hs_bvh_verify", [&](const Call& call) {
    call.CheckPointer("bvh", bvh);
    halfspace::c::Verify(call, *bvh);
  });
}
