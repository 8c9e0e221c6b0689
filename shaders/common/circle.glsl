// A point on the unit circle from a uniform number, with one polynomial pair for cosine and sine.
#ifndef SAMPLERSCOPE_CIRCLE
#define SAMPLERSCOPE_CIRCLE

// (cos 2 pi u, sin 2 pi u) for u in [0, 1). u is first reduced to an eighth turn around the nearest quarter, which is
// exact in binary; there the polynomials (Cephes library, sinf.c and cosf.c) are good to 1 ulp. Exact at quarter turns.
vec2 point_on_circle(float u) {
    float quarter = floor(4.0 * u + 0.5);
    float a = (u - 0.25 * quarter) * 6.28318530717958648;
    float t = a * a;
#ifdef DOUBLE_PRECISION // a file widened to double: the polynomials end at float32
    float s = sin(a), c = cos(a);
#else
    float s = a + a * t * ((-1.9515295891e-4 * t + 8.3321608736e-3) * t - 1.6666654611e-1);
    float c = 1.0 - 0.5 * t + t * t * ((2.443315711809948e-5 * t - 1.388731625493765e-3) * t + 4.166664568298827e-2);
#endif
    uint q = uint(quarter);
    vec2 p = (q & 1u) == 0u ? vec2(c, s) : vec2(s, c);
#ifdef DOUBLE_PRECISION
    return vec2(((q + 1u) & 2u) != 0u ? -p.x : p.x, (q & 2u) != 0u ? -p.y : p.y);
#else // the same by the sign bits
    return uintBitsToFloat(floatBitsToUint(p) ^ (uvec2(q + 1u, q) << 30u & 0x80000000u));
#endif
}

#endif
