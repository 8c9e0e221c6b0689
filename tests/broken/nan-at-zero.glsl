/*---
provides = ["technique"]
name = "nan-at-zero"
title = "Cosine; a ratio that is 0/0 at u1 = 0"
source = "a planted bug"
---*/
#include "common/hemisphere.glsl"

DirectionSample sample_direction(vec3 wo, vec2 u) {
    DirectionSample s = cosine_hemisphere(u);
    s.wi.z = u.x / sqrt(u.x);
    return s;
}

float direction_pdf(vec3 wo, vec3 wi) {
    return INV_PI * max(wi.z, 0.0);
}
