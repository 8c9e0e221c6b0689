/*---
provides = ["technique"]
name = "cltc"
title = "Clipped LTC"
source = "Portsmouth, Kutz, Hill 2024 (EON), section 3.1 and Listing 3, clipped on the side that the sign of d asks for"
models = ["eon", "eon-approx", "fon"]
uses = ["roughness"]
singular = ["the density is zero on a part of the hemisphere where the model is not, for every roughness above 0"]
[left_out]
"linear transformation" = { roughness = 0.0 }
---*/
#include "common/frame.glsl"
#include "common/ltc.glsl"

DirectionSample sample_direction(vec3 wo, vec2 u) {
    DirectionSample s = cltc_sample(eon_lobe(wo.z, roughness), u);
    s.wi = from_azimuth_frame(s.wi, azimuth(wo));
    return s;
}

float direction_pdf(vec3 wo, vec3 wi) {
    return cltc_density(eon_lobe(wo.z, roughness), to_azimuth_frame(wi, azimuth(wo)));
}
