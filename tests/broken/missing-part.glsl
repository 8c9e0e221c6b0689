/*---
provides = ["technique"]
name = "missing-part"
title = "Cosine, but only the half of the hemisphere with x > 0 is ever drawn"
source = "a planted bug"
---*/
#include "common/hemisphere.glsl"

DirectionSample sample_direction(vec3 wo, vec2 u) {
    DirectionSample s = cosine_hemisphere(u);
    s.wi.x = abs(s.wi.x);
    s.pdf *= 2.0;
    return s;
}

float direction_pdf(vec3 wo, vec3 wi) {
    return wi.x >= 0.0 ? 2.0 * INV_PI * max(wi.z, 0.0) : 0.0;
}
