#pragma once
// The kernels' shared headers compiled as C++, in namespace vitrum::kernel: structs of the buffers, field numbers, and
// fresnel.cl for the tests. One lane wide.

#include <bit>
#include <cmath>
#include <cstdint>

namespace vitrum::kernel {

using uint = uint32_t;
using ulong = uint64_t;
using Float = float;
using Int = int;
using Mask = bool;
using Uint = uint32_t;
using std::fabs;
using std::fma;
using std::rint;
using std::sqrt;

#include "film.h"
#include "fresnel.cl"
#include "outcome.h"
#include "patch.h"
#include "photon_map.h"
#include "sequence.h"
#include "types.h"

static_assert(sizeof(SphereData) == 32);
static_assert(sizeof(FlatData) == 80);
static_assert(sizeof(MaterialData) == 64);
static_assert(sizeof(MediumData) == 32);
static_assert(sizeof(InterfaceData) == 16);
static_assert(sizeof(LightData) == 96);
static_assert(sizeof(LightFace) == 32);
static_assert(sizeof(TextureData) == 48);
static_assert(sizeof(CameraData) == 72);
static_assert(sizeof(CameraSample) == 24);
static_assert(sizeof(PhotonRunData) == 228);
static_assert(sizeof(GridData) == 24);
static_assert(sizeof(BucketData) == 52);

}  // namespace vitrum::kernel
