/*---
provides = ["technique"]
name = "ggx-half-vector"
title = "GGX half vector"
source = "Walter et al., Microfacet Models for Refraction through Rough Surfaces (2007), eq. 35 and 36"
models = ["ggx"]
uses = ["mx", "my"]
below_horizon = true
---*/
#include "common/ggx.glsl"

float direction_pdf(vec3 wo, vec3 wi) {
    HalfVector h = half_vector(wi, wo);
    return reflected_density(1.0, ggx_distribution(h, mx, my) * h.cosine, 0.0, h);
}

// The density is taken at the rounded direction, where the model is evaluated too: what both share cancels.
DirectionSample sample_direction(vec3 wo, vec2 u) {
    vec3 wi = reflect_about(wo, ggx_slope(u, mx, my));
    return DirectionSample(wi, direction_pdf(wo, wi));
}
