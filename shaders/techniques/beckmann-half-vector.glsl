/*---
provides = ["technique"]
name = "beckmann-half-vector"
title = "Beckmann half vector"
source = "Kurt, Szirmay-Kalos, Krivanek 2010, eq. 16 to 20"
models = ["kurt-plausible", "kurt", "kurt-coupled", "ward", "ward-duer", "cook-torrance"]
uses = ["mx", "my"]
below_horizon = true
---*/
#include "common/beckmann.glsl"

float direction_pdf(vec3 wo, vec3 wi) {
    return beckmann_density(1.0, half_vector(wi, wo), mx, my);
}

// The density is taken at the rounded direction, where the model is evaluated too: what both share cancels.
DirectionSample sample_direction(vec3 wo, vec2 u) {
    vec3 wi = reflect_about(wo, beckmann_slope(u, mx, my));
    return DirectionSample(wi, direction_pdf(wo, wi));
}
