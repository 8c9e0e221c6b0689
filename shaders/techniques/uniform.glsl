/*---
provides = ["technique"]
name = "uniform"
title = "Uniform hemisphere"
source = "density 1/(2 pi); the cosine is uniform in [0, 1)"
---*/
#include "common/hemisphere.glsl"

DirectionSample sample_direction(vec3 wo, vec2 u) {
    return uniform_hemisphere(u);
}

float direction_pdf(vec3 wo, vec3 wi) {
    return wi.z >= 0.0 ? UNIFORM_DENSITY : 0.0;
}
