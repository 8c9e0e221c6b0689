/*---
provides = ["technique"]
name = "no-jacobian"
title = "Half vector about the normal; its density is taken for that of wi, without 1/(4 wo.h)"
source = "a planted bug"
below_horizon = true
---*/
#include "common/hemisphere.glsl"

DirectionSample sample_direction(vec3 wo, vec2 u) {
    DirectionSample h = cosine_hemisphere(u);
    return DirectionSample(reflect(-wo, h.wi), dot(wo, h.wi) > 0.0 ? h.pdf : 0.0);
}

float direction_pdf(vec3 wo, vec3 wi) {
    return INV_PI * normalize(wi + wo).z;
}
