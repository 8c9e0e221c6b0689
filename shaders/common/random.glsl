// Counter-based random numbers: a pure function of key and counter, so any sample can be drawn alone and again.
#ifndef SAMPLERSCOPE_RANDOM
#define SAMPLERSCOPE_RANDOM

// The pcg4d hash: a bijection of 128 bits. Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020.
uvec4 pcg4d(uvec4 v) {
    v = v * 1664525u + 1013904223u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    v ^= v >> 16u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}

const float ONE_MINUS_EPSILON = 0.999999940395355; // 1 - 2^-24, the largest float below 1

// (u1, u2) in [0, 1)^2 from two words. u1 keeps 40 bits, so that its grid is fine near 0, where techniques whose weight
// has a tail put it; u2 has the other 24.
vec2 unit_square(uint a, uint b) {
    float low = float(int(((a & 255u) << 8u) | (b & 255u))) * 9.094947017729282e-13;
    float u1 = float(int(a >> 8u)) * 5.9604644775390625e-8 + low;
    // The largest float below 1 at most; positive floats are in the order of their bits, which are the faster to compare.
    return vec2(uintBitsToFloat(min(floatBitsToUint(u1), 0x3f7fffffu)), float(int(b >> 8u)) * 5.9604644775390625e-8);
}

// Two samples from one hash: (u1, u2) of sample 2 n in xy and of sample 2 n + 1 in zw, for the counter (n, block).
vec4 random_samples(uvec2 counter, uvec2 key) {
    uvec4 bits = pcg4d(uvec4(counter, key));
    return vec4(unit_square(bits.x, bits.y), unit_square(bits.z, bits.w));
}

#endif
