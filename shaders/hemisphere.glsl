/*---
provides = ["technique"]
name = "hemisphere"
title = "Polar coordinates of the hemisphere, for integrals over directions"
source = "with s = 1 - u1 and z = 1 - s^2 the density is 1/(4 pi s)"
---*/
// Smooth at the normal (u1 = 1) and without cancellation at the horizon (u1 = 0). The azimuth counts from wo.
#include "common/circle.glsl"

DirectionSample sample_direction(vec3 wo, vec2 u) {
    float s = 1.0 - u.x;
    float sine = s * sqrt(2.0 - s * s);
    float length_xy = length(wo.xy);
    vec2 x = length_xy > 0.0 ? wo.xy / length_xy : vec2(1.0, 0.0);
    vec2 turned = point_on_circle(u.y);
    vec2 xy = vec2(x.x * turned.x - x.y * turned.y, x.y * turned.x + x.x * turned.y);
    return DirectionSample(vec3(sine * xy, u.x * (2.0 - u.x)), 0.25 * INV_PI / s);
}

float direction_pdf(vec3 wo, vec3 wi) {
    return 0.25 * INV_PI / sqrt(1.0 - min(wi.z, 1.0));
}
