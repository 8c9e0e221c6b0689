/*---
provides = ["technique"]
name = "cltc-mis"
title = "Clipped LTC + uniform (MIS)"
source = "Portsmouth, Kutz, Hill 2024 (EON), Listing 4: one-sample MIS, with a uniform lobe that is uniform"
models = ["eon", "eon-approx", "fon"]
uses = ["roughness"]
mixture = true
[left_out]
"uniform lobe" = { roughness = 0.0 }
---*/
#include "common/frame.glsl"
#include "common/hemisphere.glsl"
#include "common/ltc.glsl"

// r^0.1 good to 1 ulp for every r, denormals too: drivers' pow is not. Scaled by 2^40 so that y^10 stays normal.
float tenth_root(float r) {
    float x = max(r, 0.0) * 1099511627776.0;
    float y = pow(x, 0.1);
    float y2 = y * y, y4 = y2 * y2;
    return x > 0.0 ? 0.0625 * (y + 0.1 * y * (x / (y4 * y4 * y2) - 1.0)) : 0.0;
}

// Probability of the uniform lobe (Listing 4). 0 at roughness 0.
float uniform_probability(float mu) {
    return tenth_root(roughness) * (0.162925 + mu * (-0.372058 + (0.538233 - 0.290822 * mu) * mu));
}

float u1_split(vec3 wo) {
    return uniform_probability(wo.z);
}

DirectionSample sample_direction(vec3 wo, vec2 u) {
    LtcLobe lobe = eon_lobe(wo.z, roughness);
    vec2 frame = azimuth(wo);
    float probability = uniform_probability(wo.z);
    DirectionSample s;
    if (u.x < probability) { // never at probability 0, whose reciprocal is infinite
        s = uniform_hemisphere(vec2(u.x * (1.0 / probability), u.y));
        s.pdf = probability * UNIFORM_DENSITY + (1.0 - probability) * cltc_density(lobe, s.wi);
    } else {
        s = cltc_sample(lobe, vec2((u.x - probability) * (1.0 / (1.0 - probability)), u.y));
        s.pdf = probability * UNIFORM_DENSITY + (1.0 - probability) * s.pdf;
    }
    s.wi = from_azimuth_frame(s.wi, frame);
    return s;
}

float direction_pdf(vec3 wo, vec3 wi) {
    float probability = uniform_probability(wo.z);
    float lobe = cltc_density(eon_lobe(wo.z, roughness), to_azimuth_frame(wi, azimuth(wo)));
    return wi.z >= 0.0 ? probability * UNIFORM_DENSITY + (1.0 - probability) * lobe : 0.0;
}
