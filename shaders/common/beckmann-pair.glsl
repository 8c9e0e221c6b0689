// Two Beckmann lobes as one sampler of half vectors.
// Source: Kurt, Szirmay-Kalos, Krivanek 2010, eq. 14: each lobe is drawn by its share of the specular reflectance.
#ifndef SAMPLERSCOPE_BECKMANN_PAIR
#define SAMPLERSCOPE_BECKMANN_PAIR

#include "common/beckmann.glsl"

struct BeckmannPair {
    vec2 first;         // mx, my
    vec2 second;
    vec2 probability;   // of the first, of the second
};

BeckmannPair beckmann_pair(float ks1, vec2 first, float ks2, vec2 second) {
    vec2 share = max(vec2(ks1, ks2), 0.0);
    float both = share.x + share.y;
    return BeckmannPair(first, second, both > 0.0 ? share / both : vec2(0.5));
}

// Where the second lobe is the rarer one, its part [1 - P, 1) is measured from 1: u1 - (1 - P) has lost the digits of P.
vec3 beckmann_pair_sample(BeckmannPair pair, vec3 wo, vec2 u) {
    vec2 p = pair.probability;
    bool from_one = p.y < 0.5;
    bool first = from_one ? 1.0 - u.x > p.y : u.x < p.x; // a lobe of probability 0 is never drawn
    float second_u1 = from_one ? 1.0 - (1.0 - u.x) / p.y : (u.x - p.x) / p.y;
    float u1 = min(first ? u.x / p.x : second_u1, ONE_MINUS_EPSILON);
    vec2 lobe = first ? pair.first : pair.second;
    return reflect_about(wo, beckmann_slope(vec2(u1, u.y), lobe.x, lobe.y));
}

// share times the density of wi.
float beckmann_pair_density(float share, BeckmannPair pair, vec3 wo, vec3 wi) {
    HalfVector h = half_vector(wi, wo);
    return beckmann_density(share * pair.probability.x, h, pair.first.x, pair.first.y)
        + beckmann_density(share * pair.probability.y, h, pair.second.x, pair.second.y);
}

#endif
