// Vectors of LANES numbers, in GCC's and Clang's vector extension: each operator works on all of them at once. Only
// tiles.cpp includes this, once per instruction set; the unnamed namespace keeps the copies apart.
#pragma once
#include <cstdint>
#include <cstring>

#if LANES == 16
#include <immintrin.h>
#endif

namespace maulstick {
namespace {

typedef float Floats __attribute__((vector_size(4 * LANES)));
typedef int32_t Ints __attribute__((vector_size(4 * LANES)));

inline Floats all(float x) { return Floats{} + x; }
inline Ints all(int32_t x) { return Ints{} + x; }
inline Floats load(const float* p) { Floats x; std::memcpy(&x, p, sizeof x); return x; }
inline Ints load(const int32_t* p) { Ints x; std::memcpy(&x, p, sizeof x); return x; }
inline void store(int32_t* p, Ints x) { std::memcpy(p, &x, sizeof x); }
inline void store(float* p, Floats x) { std::memcpy(p, &x, sizeof x); }

#if LANES == 16                       // GCC makes two instructions of a choice
constexpr __mmask16 every_lane = 0xffff;   // without a mask GCC warns of its own header
inline Floats smaller(Floats a, Floats b) { return (Floats)_mm512_maskz_min_ps(every_lane, (__m512)a, (__m512)b); }
inline Floats larger(Floats a, Floats b) { return (Floats)_mm512_maskz_max_ps(every_lane, (__m512)a, (__m512)b); }
#elif defined(__AVX__) && LANES == 8
inline Floats smaller(Floats a, Floats b) { return __builtin_ia32_minps256(a, b); }
inline Floats larger(Floats a, Floats b) { return __builtin_ia32_maxps256(a, b); }
#else
inline Floats smaller(Floats a, Floats b) { return a < b ? a : b; }
inline Floats larger(Floats a, Floats b) { return a > b ? a : b; }
#endif

inline Floats absolute(Floats x) { return (Floats)((Ints)x & 0x7fffffff); }

inline float smaller(float a, float b) { return a < b ? a : b; }
inline float larger(float a, float b) { return a > b ? a : b; }

inline Floats root(Floats x) {
  Floats y;
  for (int i = 0; i < LANES; ++i) y[i] = __builtin_sqrtf(x[i]);
  return y;
}

typedef float Four __attribute__((vector_size(16)));

inline float sum(Floats x) {                               // halves are added to one another
  Four part[LANES / 4];
  std::memcpy(part, &x, sizeof x);
  for (int n = LANES / 8; n > 0; n /= 2)
    for (int i = 0; i < n; ++i) part[i] += part[i + n];
  return (part[0][0] + part[0][2]) + (part[0][1] + part[0][3]);
}

inline bool any(Ints mask) {
#if LANES == 16
  return _mm512_test_epi32_mask((__m512i)mask, (__m512i)mask) != 0;
#elif defined(__AVX__) && LANES == 8
  return !__builtin_ia32_ptestz256((long long __attribute__((vector_size(32))))mask, (long long __attribute__((vector_size(32))))mask);
#else
  typedef int64_t Words __attribute__((vector_size(4 * LANES)));
  Words w = (Words)mask;
  int64_t or_all = 0;
  for (int i = 0; i < LANES / 2; ++i) or_all |= w[i];
  return or_all != 0;
#endif
}

// One bit per lane that is true.
inline uint32_t bits_of(Ints mask) {
#if LANES == 16
  return _mm512_test_epi32_mask((__m512i)mask, (__m512i)mask);
#elif defined(__AVX__) && LANES == 8
  return uint32_t(__builtin_ia32_movmskps256((Floats)mask));
#else
  uint32_t bits = 0;
  for (int i = 0; i < LANES; ++i) bits |= uint32_t(mask[i] & 1) << i;
  return bits;
#endif
}

#if defined(__AVX2__) && LANES == 8
struct Orders {                       // of each set of bits: the lanes that it holds, in order
  alignas(64) int32_t lanes[256][8];
  constexpr Orders() : lanes{} {
    for (int bits = 0; bits < 256; ++bits)
      for (int i = 0, n = 0; i < 8; ++i)
        if (bits >> i & 1) lanes[bits][n++] = i;
  }
};
constexpr Orders orders;
#endif

// Stores the lanes whose bits are set one after another; what follows them up to LANES is overwritten.
template <class Number, class Lanes>
inline void store_some(Number* p, Lanes x, uint32_t bits) {
#if LANES == 16
  store(p, (Lanes)_mm512_maskz_compress_epi32(__mmask16(bits), (__m512i)x));
#elif defined(__AVX2__) && LANES == 8
  store(p, (Lanes)__builtin_ia32_permvarsi256((Ints)x, load(orders.lanes[bits])));
#else
  for (int i = 0; i < LANES; ++i)
    if (bits >> i & 1) *p++ = x[i];
#endif
}

// Natural logarithm of positive, normal x, to about one unit in the last place: the exponent apart, a polynomial in the
// mantissa (with the coefficients of Cephes' logf).
inline Floats natural_log(Floats x) {
  Ints bits = (Ints)x;
  Ints exponent = (bits >> 23) - 126;
  Floats m = (Floats)((bits & 0x007fffff) | 0x3f000000);   // [0.5, 1)
  Ints low = m < all(0.707106781f);
  exponent += low;                                         // a true comparison is -1
  m = (low ? m + m : m) - 1.0f;
  Floats e = __builtin_convertvector(exponent, Floats);
  Floats z = m * m;
  Floats y = all(7.0376836292e-2f);
  y = y * m - 1.1514610310e-1f;
  y = y * m + 1.1676998740e-1f;
  y = y * m - 1.2420140846e-1f;
  y = y * m + 1.4249322787e-1f;
  y = y * m - 1.6668057665e-1f;
  y = y * m + 2.0000714765e-1f;
  y = y * m - 2.4999993993e-1f;
  y = y * m + 3.3333331174e-1f;
  y = y * m * z;
  y += e * -2.12194440e-4f;
  y -= 0.5f * z;
  return m + y + e * 0.693359375f;
}

// e to the power of x, for x <= 0 (Cephes' expf); 0 below -87.
inline Floats exponential(Floats x) {
  Ints vanishes = x < all(-87.0f);
  x = larger(x, all(-87.0f));
  Ints n = __builtin_convertvector(x * 1.44269504f - 0.5f, Ints);   // truncation towards 0 rounds, as x <= 0
  Floats e = __builtin_convertvector(n, Floats);
  x = x - e * 0.693359375f + e * 2.12194440e-4f;
  Floats y = all(1.9875691500e-4f);
  y = y * x + 1.3981999507e-3f;
  y = y * x + 8.3334519073e-3f;
  y = y * x + 4.1665795894e-2f;
  y = y * x + 1.6666665459e-1f;
  y = y * x + 5.0000001201e-1f;
  y = y * x * x + x + 1.0f;
  y = y * (Floats)((n + 127) << 23);
  return vanishes ? all(0.0f) : y;
}

}  // namespace
}  // namespace maulstick
