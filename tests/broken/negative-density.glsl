/*---
provides = ["technique"]
name = "negative-density"
title = "Cosine with a correction that takes the density below zero near the horizon"
source = "a planted bug"
---*/
#include "common/hemisphere.glsl"

DirectionSample sample_direction(vec3 wo, vec2 u) {
    DirectionSample s = cosine_hemisphere(u);
    s.pdf -= 0.01 * (1.0 - wo.z);
    return s;
}

float direction_pdf(vec3 wo, vec3 wi) {
    return INV_PI * max(wi.z, 0.0) - 0.01 * (1.0 - wo.z);
}
