/*---
provides = ["technique"]
name = "ashikhmin-shirley"
title = "Ashikhmin-Shirley half vector"
source = "Ashikhmin and Shirley, An anisotropic Phong BRDF model (2000), section 3.1"
models = ["ashikhmin-shirley"]
uses = ["nu", "nv"]
below_horizon = true
---*/
#include "common/phong.glsl"

float direction_pdf(vec3 wo, vec3 wi) {
    return phong_density(half_vector(wi, wo), nu, nv);
}

// The density is taken at the rounded direction, where the model is evaluated too: what both share cancels.
DirectionSample sample_direction(vec3 wo, vec2 u) {
    vec3 wi = reflect_about(wo, phong_slope(u, nu, nv));
    return DirectionSample(wi, direction_pdf(wo, wi));
}
