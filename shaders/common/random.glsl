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

// (u1, u2) in [0, 1)^2. u1 keeps 48 random bits, so that near 0 its grid is as fine as float32: techniques whose weight
// has a tail put it there. u2 has 24 bits.
vec2 random_pair(uvec2 counter, uvec2 key) {
    uvec4 bits = pcg4d(uvec4(counter, key));
    float u1 = float(int(bits.x >> 8u)) * 5.9604644775390625e-8 + float(int(bits.y >> 8u)) * 3.5527136788005009e-15;
    float u2 = float(int(bits.z >> 8u)) * 5.9604644775390625e-8;
    return vec2(min(u1, ONE_MINUS_EPSILON), u2);
}

#endif
