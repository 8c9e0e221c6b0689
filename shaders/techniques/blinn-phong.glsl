/*---
provides = ["technique"]
name = "blinn-phong"
title = "Blinn-Phong half vector"
source = "half vectors with density (n + 1)/(2 pi) (n.h)^n: Ashikhmin and Shirley 2000 with nu = nv = n"
models = ["blinn-phong"]
uses = ["n"]
below_horizon = true
---*/
#include "common/phong.glsl"

float direction_pdf(vec3 wo, vec3 wi) {
    return phong_density(half_vector(wi, wo), n, n);
}

// The density is taken at the rounded direction, where the model is evaluated too: what both share cancels.
DirectionSample sample_direction(vec3 wo, vec2 u) {
    vec3 wi = reflect_about(wo, phong_slope(u, n, n));
    return DirectionSample(wi, direction_pdf(wo, wi));
}
