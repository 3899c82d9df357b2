// What lets one header be compiled by OpenCL C on the device and by C++ in the host's tests, and a kernel be written
// once for SIMD of any width.
//
// `Float` is WIDTH floats side by side: WIDTH rays or photons are worked on by one work-item. CPUs take 4, 8 or 16 (a
// compiler that packs work-items into SIMD lanes by itself gives up at the first surprise), GPUs take 1. Comparisons
// give masks (`Mask`), `mask ? yes : no` chooses lane by lane, `mask == 0` negates, & and | combine.
//
// On the host include it through device/kernel_headers.hpp, which puts everything into namespace vitrum::kernel.
// Both sides round alike: no contraction (the host compiles with -ffp-contract=off), fma where it is meant, and no
// built-in (dot, length, mix) whose order of roundings is the device's own business.
#ifndef VITRUM_PORTABILITY_H
#define VITRUM_PORTABILITY_H

#ifdef __OPENCL_VERSION__

#pragma OPENCL FP_CONTRACT OFF
// static, so that no copy of each function is compiled for itself beside those that are inlined.
#define FUNCTION static inline __attribute__((always_inline))
// Fetches a line of memory that will soon be read or written, where a processor wants to be told.
#if defined(__clang__) && defined(__x86_64__)
#define PREFETCH(address) __builtin_prefetch((const void*)(ulong)(address))
#define PREFETCH_TO_WRITE(address) __builtin_prefetch((const void*)(ulong)(address), 1)
#else
#define PREFETCH(address)
#define PREFETCH_TO_WRITE(address)
#endif
// A kernel whose SIMD is its own: a compiler that packs work-items into lanes is told not to (OpenCL 1.2, 6.7.2).
#define KERNEL __kernel __attribute__((vec_type_hint(Float)))
// The body of a kernel. PoCL compiles a kernel three times over, but what it calls only once.
#define BODY static __attribute__((noinline)) void
// ulong8 passes between functions in another way with AVX-512 than without: no matter, since all of them are inlined.
#ifdef __clang__
#pragma clang diagnostic ignored "-Wpsabi"
#endif

#ifndef WIDTH
#error "WIDTH: rays per work-item, 1, 4, 8 or 16"
#endif
// For tools/check_races: dead lanes may hold anything, which costs nothing, but oclgrind takes `mask ? yes : no` of
// vectors for a use of both. At WIDTH 1 there are none, and all is checked as it is.
#if defined(SIMULATED) && WIDTH > 1
#define CLEAR_DEAD_LANES
#endif
#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)

#if WIDTH == 1
typedef float Float;
typedef int Int;
typedef int Mask;
typedef uint Uint;
typedef ulong Ulong;
#define TO_FLOAT(x) ((float)(x))
#define TO_INT(x) ((int)(x))
#define TO_UINT(x) ((uint)(x))
#define TO_ULONG(x) ((ulong)(x))
#define AS_FLOAT(x) as_float(x)
#define AS_UINT(x) as_uint(x)
#define AS_INT(x) as_int(x)
#define LOAD(array, i) ((array)[i])
#define STORE(array, i, value) ((array)[i] = (value))
#define LANES 0u
#define LANE(value, type, lane) (value)
#define SET_LANE(value, type, lane, to) ((value) = (to))
#define GATHER(type, array, i) ((array)[i])
#else
typedef JOIN(float, WIDTH) Float;
typedef JOIN(int, WIDTH) Int;
typedef JOIN(int, WIDTH) Mask;
typedef JOIN(uint, WIDTH) Uint;
typedef JOIN(ulong, WIDTH) Ulong;
#define TO_FLOAT(x) JOIN(convert_float, WIDTH)(x)
#define TO_INT(x) JOIN(convert_int, WIDTH)(x)
#define TO_UINT(x) JOIN(convert_uint, WIDTH)(x)
#define TO_ULONG(x) JOIN(convert_ulong, WIDTH)(x)
#define AS_FLOAT(x) JOIN(as_float, WIDTH)(x)
#define AS_UINT(x) JOIN(as_uint, WIDTH)(x)
#define AS_INT(x) JOIN(as_int, WIDTH)(x)
#define LOAD(array, i) JOIN(vload, WIDTH)(0, (array) + (i))
#define STORE(array, i, value) JOIN(vstore, WIDTH)((value), 0, (array) + (i))
#define LANE(value, type, lane) (((const type*)&(value))[lane])
#define SET_LANE(value, type, lane, to) (((type*)&(value))[lane] = (to))
#if WIDTH == 4
#define LANES ((Uint)(0, 1, 2, 3))
#elif WIDTH == 8
#define LANES ((Uint)(0, 1, 2, 3, 4, 5, 6, 7))
#else
#define LANES ((Uint)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15))
#endif
// array[i] in each lane, of floats or uints; i below 2^31. One instruction where the processor has it: spelt out, it is a
// hundred for the compiler to chew on.
#define GATHER(type, array, i) JOIN(GATHER_, type)(array, i)
#define GATHER_Float(array, i) gathered((array), (i))
#define GATHER_Uint(array, i) AS_UINT(gathered((__global const float*)(array), (i)))
static inline __attribute__((always_inline)) Float gathered(__global const float* array, const Uint i) {
#if WIDTH == 16 && defined(__AVX512F__)
  return as_float16(__builtin_ia32_gathersiv16sf((Float)(0.0f), (const void*)(ulong)array, as_int16(i), (ushort)0xffff, 4));
#elif WIDTH == 8 && defined(__AVX2__)
  return as_float8(__builtin_ia32_gatherd_ps256((Float)(0.0f), (const float*)(ulong)array, as_int8(i),
                                                as_float8((int8)(-1)), 4));
#else
  Float values;
  for (uint lane = 0; lane < WIDTH; ++lane) ((float*)&values)[lane] = array[((const uint*)&i)[lane]];
  return values;
#endif
}
#endif

#else  // C++
#define FUNCTION inline
#define AS_FLOAT(x) std::bit_cast<float>(x)
#define TO_INT(x) static_cast<int>(x)
#endif

typedef struct {
  Float x, y, z;
} Vec3;

FUNCTION Vec3 make_vec3(Float x, Float y, Float z) {
  Vec3 v;
  v.x = x;
  v.y = y;
  v.z = z;
  return v;
}

FUNCTION Vec3 add3(Vec3 a, Vec3 b) { return make_vec3(a.x + b.x, a.y + b.y, a.z + b.z); }
FUNCTION Vec3 subtract3(Vec3 a, Vec3 b) { return make_vec3(a.x - b.x, a.y - b.y, a.z - b.z); }
FUNCTION Vec3 multiply3(Vec3 a, Vec3 b) { return make_vec3(a.x * b.x, a.y * b.y, a.z * b.z); }
FUNCTION Vec3 scale3(Float s, Vec3 a) { return make_vec3(s * a.x, s * a.y, s * a.z); }
FUNCTION Vec3 negate3(Vec3 a) { return make_vec3(-a.x, -a.y, -a.z); }
FUNCTION Vec3 select3(Mask which, Vec3 yes, Vec3 no) {
  return make_vec3(which ? yes.x : no.x, which ? yes.y : no.y, which ? yes.z : no.z);
}

// a + s b
FUNCTION Vec3 along3(Vec3 a, Float s, Vec3 b) { return make_vec3(fma(s, b.x, a.x), fma(s, b.y, a.y), fma(s, b.z, a.z)); }

FUNCTION Float dot3(Vec3 a, Vec3 b) { return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z)); }

FUNCTION Vec3 cross3(Vec3 a, Vec3 b) {
  return make_vec3(fma(a.y, b.z, -(a.z * b.y)), fma(a.z, b.x, -(a.x * b.z)), fma(a.x, b.y, -(a.y * b.x)));
}

FUNCTION Float length3(Vec3 a) { return sqrt(dot3(a, a)); }
FUNCTION Vec3 normalize3(Vec3 a) { return scale3(1.0f / length3(a), a); }

// fmin and fmax spend instructions on NaN; here the second argument comes out where either is NaN.
FUNCTION Float larger(Float a, Float b) { return a > b ? a : b; }
FUNCTION Float smaller(Float a, Float b) { return a < b ? a : b; }
FUNCTION Vec3 larger3(Vec3 a, Vec3 b) { return make_vec3(larger(a.x, b.x), larger(a.y, b.y), larger(a.z, b.z)); }
FUNCTION Vec3 smaller3(Vec3 a, Vec3 b) { return make_vec3(smaller(a.x, b.x), smaller(a.y, b.y), smaller(a.z, b.z)); }

#ifdef __OPENCL_VERSION__
// Three floats from `index` on, another index in each lane.
#define GATHER3(array, index)                                                                                        \
  make_vec3(GATHER(Float, array, index), GATHER(Float, (array) + 1, index), GATHER(Float, (array) + 2, index))

// Fields of a table of structs, another entry in each lane. A struct's size is a multiple of 4 bytes.
#define FIELD(type, element, table, field, index)                                                                    \
  GATHER(type, (__global const element*)&(table)->field, (index) * (uint)(sizeof(*(table)) / 4))
#define FIELD3(table, field, index)                                                                                  \
  make_vec3(FIELD(Float, float, table, field[0], index), FIELD(Float, float, table, field[1], index),                \
            FIELD(Float, float, table, field[2], index))

// A bit for each lane of a mask that is set.
FUNCTION uint lane_bits(const Mask mask) {
#if WIDTH == 1
  return mask != 0;
#elif WIDTH == 16 && defined(__AVX512DQ__)
  return (ushort)__builtin_ia32_cvtd2mask512(mask);
#elif WIDTH == 8 && defined(__AVX__)
  return (uint)__builtin_ia32_movmskps256(as_float8(mask));
#else
  uint bits = 0;
  for (uint lane = 0; lane < WIDTH; ++lane) bits |= LANE(mask, int, lane) != 0 ? 1u << lane : 0u;
  return bits;
#endif
}

// And back.
FUNCTION Mask mask_of(const uint bits) { return (((Uint)(bits) >> LANES) & 1u) != 0; }

#define ANY(mask) (lane_bits(mask) != 0)
FUNCTION uint lowest_bit(const uint bits) { return 31u - clz(bits & (0u - bits)); }
FUNCTION uint first_lane(const Mask mask) { return lowest_bit(lane_bits(mask)); }
FUNCTION uint lanes_set(const Mask mask) { return popcount(lane_bits(mask)); }
// Goes through the lanes of a mask that are set.
#define FOR_LANES(lane, mask) \
  for (uint bits_ = lane_bits(mask), lane = lowest_bit(bits_); bits_ != 0; bits_ &= bits_ - 1, lane = lowest_bit(bits_))

// Writes the lanes of `which` side by side, and anything behind them, WIDTH values at most.
#if WIDTH == 16 && defined(__AVX512F__)
#define PACKS_LANES 1
FUNCTION void pack_lanes(const Mask which, const Float value, __global float* to) {
  STORE(to, 0, as_float16(__builtin_ia32_compresssf512_mask(value, value, (ushort)lane_bits(which))));
}
#else
#define PACKS_LANES 0
#endif

// The lanes that hold one of `count` entries.
FUNCTION Mask lanes_below(uint first, uint count) { return LANES + first < count; }

// Two vectors side by side. For tools/check_races, number by number: oclgrind 21.10 falls over wide ones that are joined.
#ifdef SIMULATED
#define JOINING(half, whole)                                                            \
  FUNCTION float##whole joined##half(const float##half low, const float##half high) {   \
    float##whole v;                                                                     \
    for (uint k = 0; k < half; ++k) {                                                   \
      ((float*)&v)[k] = ((const float*)&low)[k];                                        \
      ((float*)&v)[half + k] = ((const float*)&high)[k];                                \
    }                                                                                   \
    return v;                                                                           \
  }
#else
#define JOINING(half, whole) \
  FUNCTION float##whole joined##half(const float##half low, const float##half high) { return (float##whole)(low, high); }
#endif
JOINING(2, 4)
JOINING(4, 8)
JOINING(8, 16)

// v.hi, which oclgrind 21.10 takes for a vector that nobody wrote.
FUNCTION float8 upper8(const float16 v) {
#ifdef SIMULATED
  float8 upper;
  for (uint k = 0; k < 8; ++k) ((float*)&upper)[k] = ((const float*)&v)[8 + k];
  return upper;
#else
  return v.hi;
#endif
}

FUNCTION float least8(const float8 v) {
  const float4 of_four = fmin(v.lo, v.hi);
  const float2 of_two = fmin(of_four.lo, of_four.hi);
  return min(of_two.x, of_two.y);
}

// One lane of a Vec3.
#define LANE3(v, lane) ((float3)(LANE((v).x, float, lane), LANE((v).y, float, lane), LANE((v).z, float, lane)))

// dot3 and cross3 of one lane.
FUNCTION float lane_dot3(float3 a, float3 b) { return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z)); }
FUNCTION float3 lane_cross3(float3 a, float3 b) {
  return (float3)(fma(a.y, b.z, -(a.z * b.y)), fma(a.z, b.x, -(a.x * b.z)), fma(a.x, b.y, -(a.y * b.x)));
}

FUNCTION void set_lane3(Vec3* v, uint lane, float3 to) {
  SET_LANE(v->x, float, lane, to.x);
  SET_LANE(v->y, float, lane, to.y);
  SET_LANE(v->z, float, lane, to.z);
}
#endif

FUNCTION Float max_channel(Vec3 a) { return larger(larger(a.x, a.y), a.z); }
FUNCTION Float largest3(Vec3 a) { return larger(larger(fabs(a.x), fabs(a.y)), fabs(a.z)); }
// normalize3 of vectors of any size: squares of what a tiny triangle has would be 0.
FUNCTION Vec3 normalize_any3(Vec3 a) { return normalize3(scale3(1.0f / largest3(a), a)); }

#endif
