/*---
provides = ["technique"]
name = "swapped-directions"
title = "A lobe about the mirror direction whose density is asked with wo and wi swapped"
source = "a planted bug"
---*/
#include "common/hemisphere.glsl"

// A cosine lobe, tilted so that it depends on the view: half of it uniform in azimuth, half towards the view.
float tilted(vec3 wo, vec3 wi) {
    return INV_PI * max(wi.z, 0.0) * (1.0 + 0.9 * (2.0 * wo.z * wo.z - 1.0) * (2.0 * wi.z * wi.z - 1.0) * wo.z);
}

DirectionSample sample_direction(vec3 wo, vec2 u) {
    // u.x is the distribution function of t = z^2: t + k (t^2 - t) with k = 0.9 wo.z cos 2 theta_o; solved for t.
    float k = 0.9 * (2.0 * wo.z * wo.z - 1.0) * wo.z;
    float t = 2.0 * u.x / ((1.0 - k) + sqrt((1.0 - k) * (1.0 - k) + 4.0 * k * u.x));
    vec3 wi = vec3(sqrt(1.0 - t) * point_on_circle(u.y), sqrt(t));
    return DirectionSample(wi, tilted(wo, wi));
}

float direction_pdf(vec3 wo, vec3 wi) {
    return tilted(wi, wo);
}
