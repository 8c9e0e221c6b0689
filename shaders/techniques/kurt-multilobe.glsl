/*---
provides = ["technique"]
name = "kurt-multilobe"
title = "Two Beckmann half vectors"
source = "Kurt, Szirmay-Kalos, Krivanek 2010, eq. 14 and 16 to 20: a lobe by its share of ks, the density the weighted sum"
models = ["kurt-multilobe"]
uses = ["ks1", "mx1", "my1", "ks2", "mx2", "my2"]
below_horizon = true
mixture = true
---*/
#include "common/beckmann-pair.glsl"

float direction_pdf(vec3 wo, vec3 wi) {
    return beckmann_pair_density(1.0, beckmann_pair(ks1, vec2(mx1, my1), ks2, vec2(mx2, my2)), wo, wi);
}

// The density is taken at the rounded direction, where the model is evaluated too: what both share cancels.
DirectionSample sample_direction(vec3 wo, vec2 u) {
    vec3 wi = beckmann_pair_sample(beckmann_pair(ks1, vec2(mx1, my1), ks2, vec2(mx2, my2)), wo, u);
    return DirectionSample(wi, direction_pdf(wo, wi));
}
