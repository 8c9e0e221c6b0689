/*---
provides = ["technique"]
name = "nan-at-grazing"
title = "Cosine; a ratio that is 0/0 where the view is exactly at the horizon"
source = "a planted bug"
---*/
#include "common/hemisphere.glsl"

DirectionSample sample_direction(vec3 wo, vec2 u) {
    DirectionSample s = cosine_hemisphere(u);
    s.pdf *= wo.z / wo.z;
    return s;
}

float direction_pdf(vec3 wo, vec3 wi) {
    return INV_PI * max(wi.z, 0.0);
}
