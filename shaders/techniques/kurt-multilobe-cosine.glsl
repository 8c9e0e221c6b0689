/*---
provides = ["technique"]
name = "kurt-multilobe-cosine"
title = "Two Beckmann half vectors + cosine (mixture)"
source = "one-sample mixture of the sampling of Kurt, Szirmay-Kalos, Krivanek 2010, eq. 14 and 16 to 20, and of a cosine lobe"
models = ["kurt-multilobe"]
uses = ["ks1", "mx1", "my1", "ks2", "mx2", "my2"]
below_horizon = true
mixture = true
[left_out]
"half-vector lobe" = { lobe_probability = 0.0 }
"cosine lobe" = { lobe_probability = 1.0 }
[parameters.lobe_probability]
min = 0.0
max = 1.0
default = 0.5
unit = ""
help = "probability of the half-vector lobe; cosine otherwise"
---*/
#include "common/beckmann-pair.glsl"
#include "common/hemisphere.glsl"
#include "common/mixture.glsl"

float direction_pdf(vec3 wo, vec3 wi) {
    float lobe = beckmann_pair_density(lobe_probability, beckmann_pair(ks1, vec2(mx1, my1), ks2, vec2(mx2, my2)), wo, wi);
    return lobe + (1.0 - lobe_probability) * INV_PI * max(wi.z, 0.0);
}

// The density is taken at the rounded direction, where the model is evaluated too: what both share cancels.
DirectionSample sample_direction(vec3 wo, vec2 u) {
    bool lobe = u.x < lobe_probability; // never at probability 0, so u1 / P is not 0/0
    vec2 v = vec2(lobe ? u.x / lobe_probability : stretched(u.x, lobe_probability), u.y);
    vec3 wi = lobe ? beckmann_pair_sample(beckmann_pair(ks1, vec2(mx1, my1), ks2, vec2(mx2, my2)), wo, v) : cosine_hemisphere(v).wi;
    return DirectionSample(wi, direction_pdf(wo, wi));
}
