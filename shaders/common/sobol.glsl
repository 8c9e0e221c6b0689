// The two-dimensional Sobol' sequence with Owen scrambling, by hashing: no tables, no loops.
#ifndef SAMPLERSCOPE_SOBOL
#define SAMPLERSCOPE_SOBOL

// Nested uniform scrambling of a bit-reversed number: each bit is flipped by a hash of the bits below it. Laine and
// Karras 2011; constants as in Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020, and its revision.
uint laine_karras(uint x, uint seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16u) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

// The product of the Pascal matrix modulo 2 and the bits of n, bit-reversed: entry (i, j) is 1 where the binary digits
// of i are among those of j (Lucas' theorem), so the product is a sum over supersets, one digit after another.
uint pascal_product(uint n) {
    n ^= (n >> 1u) & 0x55555555u;
    n ^= (n >> 2u) & 0x33333333u;
    n ^= (n >> 4u) & 0x0f0f0f0fu;
    n ^= (n >> 8u) & 0x00ff00ffu;
    return n ^ ((n >> 16u) & 0x0000ffffu);
}

float unit_interval(uint x) {
    float u = float(int(x >> 8u)) * 5.9604644775390625e-8 + float(int(x & 255u)) * 2.3283064365386963e-10;
    return min(u, ONE_MINUS_EPSILON);
}

// Point `index` of the sequence that the key scrambles. Reversed, the first coordinate is the index itself.
vec2 scrambled_sobol_pair(uint index, uvec2 key) {
    uint x = bitfieldReverse(laine_karras(index, key.x));
    uint y = bitfieldReverse(laine_karras(pascal_product(index), key.y));
    return vec2(unit_interval(x), unit_interval(y));
}

#endif
