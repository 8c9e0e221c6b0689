/*---
provides = ["technique"]
name = "ggx-vndf-caps"
title = "GGX visible normals by spherical caps"
source = "Dupuy and Benyoub, Sampling Visible GGX Normals with Spherical Caps (2023): the density of ggx-vndf by another map"
models = ["ggx"]
uses = ["mx", "my"]
below_horizon = true
---*/
#include "common/ggx-visible.glsl"

float direction_pdf(vec3 wo, vec3 wi) {
    return ggx_visible_density(wo, wi, 0.0, mx, my);
}

DirectionSample sample_direction(vec3 wo, vec2 u) {
    return ggx_cap_sample(wo, u, 0.0, mx, my);
}
