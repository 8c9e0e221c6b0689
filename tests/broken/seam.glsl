/*---
provides = ["technique"]
name = "seam"
title = "Cosine whose azimuth is computed in two branches that do not meet at 180 degrees"
source = "a planted bug"
---*/
#include "common/hemisphere.glsl"

float brightness(vec3 wo) {
    return wo.y >= 0.0 ? 0.5 : -0.5;
}

float direction_pdf(vec3 wo, vec3 wi) {
    return INV_PI * max(wi.z, 0.0) * (1.0 + brightness(wo) * (wi.x > 0.0 ? 1.0 : -1.0));
}

DirectionSample sample_direction(vec3 wo, vec2 u) {
    float right = 0.5 * (1.0 + brightness(wo));
    bool is_right = u.y < right;
    float v = is_right ? 0.5 * u.y / right : 0.5 + 0.5 * (u.y - right) / (1.0 - right);
    DirectionSample s = cosine_hemisphere(vec2(u.x, v - 0.25 + (v < 0.25 ? 1.0 : 0.0)));
    s.pdf = direction_pdf(wo, s.wi);
    return s;
}
