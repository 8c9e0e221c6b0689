/*---
provides = ["technique"]
name = "not-normalised"
title = "Cosine; the direction loses its length towards grazing views"
source = "a planted bug"
---*/
#include "common/hemisphere.glsl"

DirectionSample sample_direction(vec3 wo, vec2 u) {
    DirectionSample s = cosine_hemisphere(u);
    s.wi *= 1.0 + 1.0e-3 * (1.0 - wo.z);
    return s;
}

float direction_pdf(vec3 wo, vec3 wi) {
    return INV_PI * max(wi.z, 0.0);
}
