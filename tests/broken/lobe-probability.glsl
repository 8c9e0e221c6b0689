/*---
provides = ["technique"]
name = "lobe-probability"
title = "Cosine and uniform lobe, chosen with 1/4 and weighted with 1/2"
source = "a planted bug"
mixture = true
---*/
#include "common/hemisphere.glsl"

float direction_pdf(vec3 wo, vec3 wi) {
    return wi.z >= 0.0 ? 0.5 * INV_PI * wi.z + 0.5 * UNIFORM_DENSITY : 0.0;
}

DirectionSample sample_direction(vec3 wo, vec2 u) {
    DirectionSample s;
    if (u.x < 0.25) {
        s = uniform_hemisphere(vec2(u.x / 0.25, u.y));
    } else {
        s = cosine_hemisphere(vec2((u.x - 0.25) / 0.75, u.y));
    }
    s.pdf = direction_pdf(wo, s.wi);
    return s;
}
