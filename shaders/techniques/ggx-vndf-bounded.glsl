/*---
provides = ["technique"]
name = "ggx-vndf-bounded"
title = "GGX visible normals, bounded"
source = "Eto and Tokuyoshi, Bounded VNDF Sampling for Smith-GGX Reflections (2023), eq. 5 and 6"
models = ["ggx"]
uses = ["mx", "my"]
below_horizon = true
---*/
#include "common/ggx-visible.glsl"

// 1 - k of eq. 5: the part of the cap's depth that holds only directions below the horizon, by the smaller alpha up to 1.
float spared_depth(vec3 wo) {
    float alpha = min(min(mx, my), 1.0);
    float s = 1.0 + length(wo.xy), squared = alpha * alpha;
    return 2.0 * squared * s / (s * s + squared * wo.z * wo.z);
}

float direction_pdf(vec3 wo, vec3 wi) {
    return ggx_visible_density(wo, wi, spared_depth(wo), mx, my);
}

DirectionSample sample_direction(vec3 wo, vec2 u) {
    return ggx_cap_sample(wo, u, spared_depth(wo), mx, my);
}
