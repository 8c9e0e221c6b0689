/*---
provides = ["technique"]
name = "not-uniform"
title = "A uniform lobe with u1 taken as the radius on the disk"
source = "a planted bug"
---*/
#include "common/hemisphere.glsl"

DirectionSample sample_direction(vec3 wo, vec2 u) {
    return DirectionSample(vec3(u.x * point_on_circle(u.y), sqrt(1.0 - u.x * u.x)), UNIFORM_DENSITY);
}

float direction_pdf(vec3 wo, vec3 wi) {
    return wi.z >= 0.0 ? UNIFORM_DENSITY : 0.0;
}
