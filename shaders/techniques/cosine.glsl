/*---
provides = ["technique"]
name = "cosine"
title = "Cosine-weighted hemisphere"
source = "Malley's method; density cos/pi (EON paper, eq. 21)"
---*/
#include "common/hemisphere.glsl"

DirectionSample sample_direction(vec3 wo, vec2 u) {
    return cosine_hemisphere(u);
}

float direction_pdf(vec3 wo, vec3 wi) {
    return INV_PI * max(wi.z, 0.0);
}
