/*---
provides = ["technique"]
name = "sharp-lobe"
title = "Half vectors on a curve a thousandth wide; the density is that of a curve longer by a fifth"
source = "a planted bug"
below_horizon = true
[parameters.across]
min = 0.0015
max = 0.003
default = 0.002
---*/
#include "common/beckmann.glsl"

float direction_pdf(vec3 wo, vec3 wi) {
    return beckmann_density(1.0, half_vector(wi, wo), 2.4, across);
}

DirectionSample sample_direction(vec3 wo, vec2 u) {
    vec3 wi = reflect_about(wo, beckmann_slope(u, 2.0, across));
    return DirectionSample(wi, direction_pdf(wo, wi));
}
