/*---
provides = ["technique"]
name = "thin-tail"
title = "A lobe with a density of cos^2, which vanishes at the horizon faster than the light: rare fireflies"
source = "a planted bug"
---*/
#include "common/circle.glsl"

DirectionSample sample_direction(vec3 wo, vec2 u) {
    float z = pow(u.x, 0.2);
    return DirectionSample(vec3(sqrt(1.0 - z * z) * point_on_circle(u.y), z), 2.5 * INV_PI * z * z * z * z);
}

float direction_pdf(vec3 wo, vec3 wi) {
    float z = max(wi.z, 0.0);
    return 2.5 * INV_PI * z * z * z * z;
}
