/*---
provides = ["technique"]
name = "ltc-nonnegative"
title = "LTC, non-negative (d = 0)"
source = "Portsmouth, Kutz, Hill 2024 (EON), section 3.1 and Listing 2 with d = 0"
models = ["eon", "eon-approx", "fon"]
uses = ["roughness"]
[left_out]
"linear transformation" = { roughness = 0.0 }
---*/
#include "common/frame.glsl"
#include "common/ltc.glsl"

DirectionSample sample_direction(vec3 wo, vec2 u) {
    DirectionSample s = ltc_sample(eon_lobe_nonnegative(wo.z, roughness), u);
    s.wi = from_azimuth_frame(s.wi, azimuth(wo));
    return s;
}

float direction_pdf(vec3 wo, vec3 wi) {
    return ltc_density(eon_lobe_nonnegative(wo.z, roughness), to_azimuth_frame(wi, azimuth(wo)));
}
