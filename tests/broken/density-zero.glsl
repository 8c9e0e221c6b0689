/*---
provides = ["technique"]
name = "density-zero"
title = "Cosine with a density of 0 in a cone about the normal, where the sampler still draws"
source = "a planted bug"
---*/
#include "common/hemisphere.glsl"

DirectionSample sample_direction(vec3 wo, vec2 u) {
    return cosine_hemisphere(u);
}

float direction_pdf(vec3 wo, vec3 wi) {
    return wi.z > 0.95 ? 0.0 : INV_PI * max(wi.z, 0.0);
}
