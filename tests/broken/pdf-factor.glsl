/*---
provides = ["technique"]
name = "pdf-factor"
title = "Cosine, density twice too large"
source = "a planted bug"
---*/
#include "common/hemisphere.glsl"

DirectionSample sample_direction(vec3 wo, vec2 u) {
    DirectionSample s = cosine_hemisphere(u);
    return DirectionSample(s.wi, 2.0 * s.pdf);
}

float direction_pdf(vec3 wo, vec3 wi) {
    return 2.0 * INV_PI * max(wi.z, 0.0);
}
