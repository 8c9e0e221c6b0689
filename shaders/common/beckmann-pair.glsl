// Two Beckmann lobes as one sampler of half vectors.
// Source: Kurt, Szirmay-Kalos, Krivanek 2010, eq. 14: each lobe is drawn by its share of the specular reflectance.
#ifndef SAMPLERSCOPE_BECKMANN_PAIR
#define SAMPLERSCOPE_BECKMANN_PAIR

#include "common/beckmann.glsl"
#include "common/mixture.glsl"

struct BeckmannPair {
    vec2 first;         // mx, my
    vec2 second;
    vec2 probability;   // of the first, of the second
};

BeckmannPair beckmann_pair(float ks1, vec2 first, float ks2, vec2 second) {
    float both = ks1 + ks2;
    return BeckmannPair(first, second, both > 0.0 ? vec2(ks1, ks2) / both : vec2(0.5));
}

vec3 beckmann_pair_sample(BeckmannPair pair, vec3 wo, vec2 u) {
    bool first = u.x < pair.probability.x; // never at probability 0, so u1 / P is not 0/0
    vec2 lobe = first ? pair.first : pair.second;
    float u1 = first ? u.x / pair.probability.x : stretched(u.x, pair.probability.x);
    return reflect_about(wo, beckmann_slope(vec2(u1, u.y), lobe.x, lobe.y));
}

float beckmann_pair_density(BeckmannPair pair, vec3 wo, vec3 wi) {
    HalfVector h = half_vector(wi, wo);
    return pair.probability.x * beckmann_density(h, pair.first.x, pair.first.y)
        + pair.probability.y * beckmann_density(h, pair.second.x, pair.second.y);
}

#endif
