/*---
provides = ["technique"]
name = "below-horizon"
title = "Uniform on the sphere of a tilted lobe: directions below the horizon keep their density"
source = "a planted bug"
---*/
#include "common/circle.glsl"

DirectionSample sample_direction(vec3 wo, vec2 u) {
    float z = 1.1 * u.x - 0.1;
    return DirectionSample(vec3(sqrt(1.0 - z * z) * point_on_circle(u.y), z), 0.5 * INV_PI / 1.1);
}

float direction_pdf(vec3 wo, vec3 wi) {
    return wi.z >= -0.1 ? 0.5 * INV_PI / 1.1 : 0.0;
}
